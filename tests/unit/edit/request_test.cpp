// The field list of a request, its JSON form, and what is refused.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <array>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include "engine/edit/request/checked_request.h"
#include "engine/edit/request/decide_mode.h"
#include "engine/edit/request/edit_method.h"
#include "engine/edit/request/request.h"
#include "engine/edit/request/unchecked_request.h"
#include "engine/edit/request/vocabulary.h"
#include "engine/edit/search/locate.h"
#include "engine/edit/target_views/view_round.h"
#include "engine/language/news.h"
#include "engine/language/sentence.h"
#include "engine/language/vocabulary.h"
#include "engine/language/words.h"

namespace request_test {

namespace {

using namespace gse;
using edit::EditRequest;

EditRequest bear(const std::string& source, const std::string& prompt, const std::string& target) {
    EditRequest request;
    request.source = source;
    request.prompt = prompt;
    request.target = target;
    return request;
}

edit::EditMode mode_of(const std::string& source, const std::string& prompt, const std::string& target) {
    return edit::decide_mode(edit::check(bear(source, prompt, target)), std::nullopt).first;
}

/// Another value that the field's range allows.
template <class T> T changed(const T& value) {
    if constexpr (std::is_same_v<T, bool>) return !value;
    else if constexpr (std::is_same_v<T, std::string>) return value + "x";
    else if constexpr (std::is_same_v<T, Overridable>) {
        T other = value;
        other = changed(static_cast<double>(value));
        return other;
    } else if constexpr (std::is_floating_point_v<T>) return value > 0 ? value * T(0.9) : T(0.25);
    else return value + 1;
}

}  // namespace

DOCTEST_TEST_CASE("every field survives JSON, has a help text and a name of its own") {
    EditRequest request;
    std::set<std::string> names;
    EditRequest::visit_fields(request, [&](const char* name, auto& value, const char* help, auto...) {
        value = changed(value);
        DOCTEST_CHECK(names.insert(name).second);
        DOCTEST_CHECK(std::string(help).size() > 10);
    });
    const auto json = fields_to_json(request);
    DOCTEST_CHECK(json.size() == names.size());
    EditRequest copy;
    fields_from_json(copy, json);
    DOCTEST_CHECK(fields_to_json(copy) == json);
    DOCTEST_CHECK(fields_to_json(EditRequest{}) != json);
    // Every member is in the list: the struct is no larger than its listed members and padding.
    std::size_t listed = 0;
    EditRequest::visit_fields(
        request, [&](const char*, auto& value, const char*, auto...) { listed += sizeof(value); });
    DOCTEST_CHECK(sizeof(EditRequest) - listed < 8 * names.size());
}

DOCTEST_TEST_CASE("settings of earlier versions that are no longer there are read and ignored") {
    EditRequest request;
    fields_from_json(request, {{"polish_steps", 20}, {"iterations", 7}});
    DOCTEST_CHECK(request.iterations == 7);
    request.iterations = EditRequest{}.iterations;
    DOCTEST_CHECK(fields_to_json(request) == fields_to_json(EditRequest{}));
    DOCTEST_CHECK_THROWS_AS(fields_from_json(request, {{"polish_steps", 20}, {"no_such_field", 1}}), Error);
}

DOCTEST_TEST_CASE("settings are read under the names that they had before, too") {
    const std::map<std::string, nlohmann::ordered_json> before{
        {"tau", 0.75},         {"keep_mass", 0.5},     {"fallback_mass", 0.25}, {"second_look", 5},
        {"focus", false},      {"rivals", "hat"},      {"evidence_px", 2.5},    {"left_out", "3, 17"},
        {"look_again", false}, {"look_again_tau", 0.5}};
    DOCTEST_CHECK(before.size() == EditRequest::Renamed.size());
    for (const auto& renamed : EditRequest::Renamed) {
        DOCTEST_CAPTURE(renamed.before);
        EditRequest old_name, new_name;
        fields_from_json(old_name, {{renamed.before, before.at(renamed.before)}});
        fields_from_json(new_name, {{renamed.now, before.at(renamed.before)}});
        DOCTEST_CHECK(fields_to_json(old_name) == fields_to_json(new_name));
        DOCTEST_CHECK(fields_to_json(old_name) != fields_to_json(EditRequest{}));
        DOCTEST_CHECK_FALSE(fields_to_json(old_name).contains(renamed.before));
        nlohmann::ordered_json both;
        both[renamed.before] = both[renamed.now] = before.at(renamed.before);
        DOCTEST_CHECK_THROWS_AS(fields_from_json(old_name, both), Error);
    }
}

DOCTEST_TEST_CASE("JSON with an unknown name, a wrong type or a value out of range is refused") {
    EditRequest request;
    DOCTEST_CHECK_THROWS_AS(fields_from_json(request, {{"no_such_field", 1}}), Error);
    DOCTEST_CHECK_THROWS_AS(fields_from_json(request, {{"iterations", "many"}}), Error);
    DOCTEST_CHECK_THROWS_AS(fields_from_json(request, {{"label_threshold", 1.5}}), Error);
    EditRequest hostile;
    hostile.prompt = "a blue bear";
    hostile.source = "bear";
    DOCTEST_CHECK(edit::check(hostile).target() == "blue");
    hostile.rate_colour = std::numeric_limits<double>::quiet_NaN();
    DOCTEST_CHECK_THROWS_AS(edit::check(hostile), Error);
    // A number without limits would let anything pass.
    EditRequest::visit_fields(
        request, [](const char* name, const auto& value, const char*, const auto&... range) {
            using Value = std::remove_cvref_t<decltype(value)>;
            const bool limited = sizeof...(range) == 1 || !std::is_arithmetic_v<Value> ||
                                 std::is_same_v<Value, bool> || std::string(name) == "seed";
            DOCTEST_CHECK_MESSAGE(limited, name);
        });
}

DOCTEST_TEST_CASE("a request is checked in one sentence") {
    DOCTEST_CHECK_THROWS_AS(edit::check(bear("bear", "", "hat")), Error);
    DOCTEST_CHECK_THROWS_AS(edit::check(bear("bear", "a blue bear", "hat")), Error);
    DOCTEST_CHECK_THROWS_AS(edit::check(bear("", "a blue bear", "")), Error);
    DOCTEST_CHECK_THROWS_AS(edit::check(bear("bear", "a bluebear", "blue")),
                            Error);  // whole words only
    EditRequest request = bear("bear", "a blue bear", "blue");
    request.mode = "guess";
    DOCTEST_CHECK_THROWS_AS(edit::check(request), Error);
    try {
        edit::check(bear("bear", "a blue bear", "hat"));
    } catch (const Error& error) {
        DOCTEST_CHECK(error.code() == ErrorCode::InvalidArgument);
        DOCTEST_CHECK(error.message().find("hat") != std::string::npos);
        DOCTEST_CHECK(std::string(error.what()).find('\n') == std::string::npos);
    }
    const auto good = edit::check(bear("Bear", "A BLUE bear.", "Blue")).plain();
    DOCTEST_CHECK(good.source == "bear");
    DOCTEST_CHECK(good.target == "blue");
    DOCTEST_CHECK(edit::check(bear("", "a golden statue", "golden")).plain().source == "golden");
}

DOCTEST_TEST_CASE(
    "a checked request is written as it was checked, and derives others with the same settings") {
    auto written = bear("Bear", "A red bear, wearing a hat.", "Hat");
    written.views = 7;
    written.mode = "add";
    const auto request = edit::check(written);
    DOCTEST_CHECK(request.mode == edit::EditMode::Add);
    DOCTEST_CHECK(request.prompt() == written.prompt);
    DOCTEST_CHECK(request.sentence().prompt() == "a red bear wearing a hat");
    written.source = "bear", written.target = "hat";
    DOCTEST_CHECK(fields_to_json(request.plain()) == fields_to_json(written));
    DOCTEST_CHECK(!request.target_open());
    written.mode = "auto", written.target.clear();
    const auto open = edit::check(written);
    DOCTEST_CHECK(!open.mode);
    DOCTEST_CHECK(open.plain().mode == "auto");
    DOCTEST_CHECK(open.target_open());

    const auto red = open.with_target("red");
    DOCTEST_CHECK(red.target() == "red");
    DOCTEST_CHECK(red.sentence().before() == "a bear wearing a hat");
    DOCTEST_CHECK(red.target_open());
    const auto told = request.reworded("a red bear wearing a blue hat", "blue hat");
    DOCTEST_CHECK(told.prompt() == "a red bear wearing a blue hat");
    DOCTEST_CHECK(told.sentence().before() == "a red bear");
    DOCTEST_CHECK(told.mode == edit::EditMode::Add);
    const auto wearer = edit::check(bear("hat", "a bear wearing a crown", "crown")).search_for("bear");
    DOCTEST_CHECK(wearer.prompt() == "a bear wearing a hat");
    DOCTEST_CHECK(wearer.source() == "bear");
    DOCTEST_CHECK(wearer.target() == "hat");
    DOCTEST_CHECK(wearer.mode == edit::EditMode::Modify);
    for (const auto* other : {&red, &told}) DOCTEST_CHECK(other->views == 7);
}

DOCTEST_TEST_CASE("words that nobody has checked mean what they say so far") {
    EditRequest typed = bear("bear", "a bear wearing a red", "");
    DOCTEST_CHECK(edit::planned_mode(typed) == edit::EditMode::Modify);
    DOCTEST_CHECK(edit::unchecked_sentence(typed).target().empty());
    typed.prompt += " hat", typed.target = "hat";
    DOCTEST_CHECK(edit::planned_mode(typed) == edit::EditMode::Add);
    DOCTEST_CHECK(edit::planned_steps(typed) == edit::loop_steps(typed, edit::EditMode::Add));
    typed.mode = "modify";
    DOCTEST_CHECK(edit::planned_mode(typed) == edit::EditMode::Modify);
    DOCTEST_CHECK(edit::planned_mode({}) == edit::EditMode::Modify);
}

DOCTEST_TEST_CASE("the sentence decides whether something is changed or added") {
    using edit::EditMode;
    DOCTEST_CHECK(mode_of("statue", "a golden statue", "golden") == EditMode::Modify);
    DOCTEST_CHECK(mode_of("bear", "a bear made of stone", "stone") == EditMode::Modify);
    DOCTEST_CHECK(mode_of("bear", "turn the bear into gold", "gold") == EditMode::Modify);
    DOCTEST_CHECK(mode_of("grass", "a bear on the snow", "snow") == EditMode::Modify);
    DOCTEST_CHECK(mode_of("grass", "a bear in a forest", "forest") == EditMode::Modify);
    DOCTEST_CHECK(mode_of("bear", "a bear wearing a red hat", "red") == EditMode::Add);
    DOCTEST_CHECK(mode_of("bear", "a red bear wearing a blue hat", "hat") == EditMode::Add);
    DOCTEST_CHECK(mode_of("bear", "a bear with flames", "flames") == EditMode::Add);
    DOCTEST_CHECK(mode_of("statue", "a green statue in flames on the grass", "flames") == EditMode::Add);
    DOCTEST_CHECK(mode_of("cat", "a cat in a red hat", "hat") == EditMode::Add);
    DOCTEST_CHECK(mode_of("statue", "a statue in gold", "gold") == EditMode::Modify);
    DOCTEST_CHECK(mode_of("bear", "add a hat to the bear", "hat") == EditMode::Add);
    DOCTEST_CHECK(mode_of("bear", "a hat on the bear", "hat") == EditMode::Add);
    auto request = edit::check(bear("bear", "a red bear wearing a blue hat", "hat"));
    // The detector sees one already.
    DOCTEST_CHECK(edit::decide_mode(request, 0.8).first == EditMode::Modify);
    DOCTEST_CHECK(edit::decide_mode(request, 0.1).first == EditMode::Add);
    request.mode = EditMode::Modify;
    DOCTEST_CHECK(edit::decide_mode(request, 0.0).first == EditMode::Modify);
    request = edit::check(bear("bear", "a blue bear", "blue"));
    request.mode = EditMode::Add;
    DOCTEST_CHECK(edit::decide_mode(request, 1.0).first == EditMode::Add);
}

DOCTEST_TEST_CASE(
    "another thing in the source's place replaces it, whatever word of its phrase is the new one") {
    using edit::EditMode;
    const auto thing_of = [](const char* source, const char* prompt, const char* target) {
        return edit::check(bear(source, prompt, target)).sentence().replacement();
    };
    for (const auto& [source, prompt, target, thing] : std::vector<std::array<const char*, 4>>{
             {"bear", "a blue dog on the grass", "dog", "dog"},
             {"bear", "a red cat on the grass", "red", "cat"},
             {"bear", "a red cat on the grass", "grass", "cat"},
             {"bear", "turn the bear into a wooden dog", "dog", "dog"},
             {"chair", "a bear on a sofa", "sofa", "sofa"},
             {"hat", "a bear wearing a crown", "crown", "crown"},
             {"teddy bear", "a polar bear on the grass", "polar bear", "polar bear"},
             {"car", "a small house", "small", "house"}}) {
        const char* sentence = prompt;
        DOCTEST_CAPTURE(sentence);
        DOCTEST_CHECK(thing_of(source, prompt, target) == thing);
        DOCTEST_CHECK(mode_of(source, prompt, target) == EditMode::Replace);
    }
    for (const auto& [source, prompt, target] :
         std::vector<std::array<const char*, 3>>{{"bear", "a blue bear on the grass", "blue"},
                                                 {"grass", "a bear on the snow", "snow"},
                                                 {"bear", "a bear made of gold", "gold"},
                                                 {"statue", "made of gold", "gold"},
                                                 {"bear", "turn the bear into stone", "stone"},
                                                 {"bear", "a bear wearing a hat", "hat"},
                                                 {"statue", "golden", "golden"},
                                                 {"bear", "a teddy bear on the grass", "teddy bear"}}) {
        const char* sentence = prompt;
        DOCTEST_CAPTURE(sentence);
        DOCTEST_CHECK(thing_of(source, prompt, target).empty());
        DOCTEST_CHECK(mode_of(source, prompt, target) != EditMode::Replace);
    }
    auto request = bear("bear", "a red cat on the grass", "cat");
    for (const char* asked : {"modify", "replace", "add"}) {  // what the artist says wins
        request.mode = asked;
        const auto checked = edit::check(request);
        DOCTEST_CHECK(edit::mode_name(edit::decide_mode(checked, std::nullopt).first) == std::string(asked));
        DOCTEST_CHECK(checked.plain().mode == asked);
        DOCTEST_CHECK(edit::mode_name(*edit::mode_named(asked)) == std::string(asked));
    }
    DOCTEST_CHECK(!edit::mode_named("auto"));
}

DOCTEST_TEST_CASE("what gets another shape has rounds of its own; what is set wins") {
    using edit::EditMode;
    EditRequest request;
    request.method = "auto";
    request.shape_rounds = 2;
    const auto recolour = edit::round_plan(request, EditMode::Modify),
               shape = edit::round_plan(request, EditMode::Replace);
    DOCTEST_CHECK(edit::method_of(request).draws_views());
    DOCTEST_CHECK(!recolour.anew);
    DOCTEST_CHECK(shape.anew);
    DOCTEST_CHECK(edit::loop_steps(request, EditMode::Modify) == request.rounds * request.fit_steps);
    DOCTEST_CHECK(edit::loop_steps(request, EditMode::Replace) ==
                  request.shape_rounds * request.shape_fit_steps);
    request.shape_strength = 0.9;
    request.shape_again_strength = 0.45;
    DOCTEST_CHECK(recolour.views == request.edited_views);
    DOCTEST_CHECK(shape.views == request.shape_views);
    request.shape_steps = 8;
    const auto half = edit::round_plan(request, EditMode::Replace);
    DOCTEST_CHECK(half.steps_of(0) == 8);
    DOCTEST_CHECK(half.steps_of(1) == 4);
    DOCTEST_CHECK(half.view_steps_within(2 * request.shape_fit_steps) == 12);
    DOCTEST_CHECK(half.view_steps_within(1) == 8);
    // Four steps of 0.9 in eighths are above it, none of 0.45 in quarters: the others count half.
    request.shape_guided_until = 0.5;
    const auto guided = edit::round_plan(request, EditMode::Replace);
    DOCTEST_CHECK(guided.guided_steps_of(0) == 4 + 4 * 0.5);
    DOCTEST_CHECK(guided.guided_steps_of(1) == 4 * 0.5);
    DOCTEST_CHECK(edit::round_plan(request, EditMode::Modify).guided_steps_of(0) == request.view_steps);
    const auto free = edit::loop_settings(request, EditMode::Replace, true);
    DOCTEST_CHECK(free.iterations == 2 * request.shape_fit_steps);
    DOCTEST_CHECK(free.geometry_share == 1);
    DOCTEST_CHECK(free.colour_coupling == 0);
    DOCTEST_CHECK(free.anchor_position == 0);
    request.geometry_share = 0.5;
    request.max_aspect = 9;
    const auto asked = edit::loop_settings(request, EditMode::Replace, true);
    DOCTEST_CHECK(asked.geometry_share == 0.5);
    DOCTEST_CHECK(asked.max_aspect == 9);
    const EditRequest usual;
    DOCTEST_CHECK(edit::loop_settings(usual, EditMode::Modify, true).geometry_share == usual.geometry_share);
    DOCTEST_CHECK(fields_to_json(edit::loop_settings(usual, EditMode::Add, false)) ==
                  fields_to_json<edit::EditSettings>(usual));
    // By the paper's way, too.
    DOCTEST_CHECK(edit::loop_settings(usual, EditMode::Replace, false).geometry_share == 1);
    // What is shown the scene begins from noise alone, unless it is asked otherwise.
    DOCTEST_CHECK(edit::loop_settings(usual, EditMode::Modify, true).view_strength == usual.view_strength);
    DOCTEST_CHECK(edit::loop_settings(usual, EditMode::Modify, true, true).view_strength == 1);
    DOCTEST_CHECK(edit::loop_settings(usual, EditMode::Modify, true, true).view_steps == usual.restyle_steps);
    DOCTEST_CHECK(edit::restyling(usual, EditMode::Replace).view_steps == usual.view_steps);
    request.view_strength = 0.5;
    DOCTEST_CHECK(edit::loop_settings(request, EditMode::Modify, true, true).view_strength == 0.5);
}

namespace {

/// Sets every number that the loop may override to its default.
EditRequest with_defaults_set() {
    EditRequest request;
    EditRequest::visit_fields(request, [](const char*, auto& value, const char*, const auto&...) {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, Overridable>)
            value = static_cast<double>(value);
    });
    return request;
}

nlohmann::ordered_json overridable_fields(const edit::EditSettings& settings) {
    nlohmann::ordered_json json;
    edit::EditSettings::visit_fields(
        settings, [&](const char* name, const auto& value, const char*, const auto&...) {
            if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, Overridable>)
                json[name] = static_cast<double>(value);
        });
    return json;
}

}  // namespace

DOCTEST_TEST_CASE("a number that is set to its default stays there, whatever suits the edit") {
    const auto request = with_defaults_set();
    const auto defaults = overridable_fields(EditRequest{});
    DOCTEST_CHECK(defaults.size() == 11);
    DOCTEST_CHECK(overridable_fields(edit::loop_settings(request, edit::EditMode::Replace, true)) ==
                  defaults);
    DOCTEST_CHECK(overridable_fields(edit::loop_settings(request, edit::EditMode::Modify, true, true)) ==
                  defaults);
    DOCTEST_CHECK(overridable_fields(edit::loop_settings({}, edit::EditMode::Replace, true)) != defaults);
    EditRequest one;
    one.colour_coupling = 0.9;
    const auto kept = edit::loop_settings(one, edit::EditMode::Replace, true);
    DOCTEST_CHECK(kept.colour_coupling == 0.9);
    DOCTEST_CHECK(kept.geometry_share == 1);
}

DOCTEST_TEST_CASE("JSON tells numbers that were set from those that were not") {
    const auto unset = fields_to_json(EditRequest{}), set = fields_to_json(with_defaults_set());
    DOCTEST_CHECK(unset["colour_coupling"].is_null());
    DOCTEST_CHECK(set["colour_coupling"] == 0.9);
    EditRequest request;
    edit::read_request(request, set);
    DOCTEST_CHECK(request.colour_coupling.is_set());
    edit::read_request(request, unset);
    DOCTEST_CHECK(!request.colour_coupling.is_set());
    DOCTEST_CHECK(request.colour_coupling == 0.9);
    // Versions with "polish_steps" wrote every number.
    auto earlier = set;
    earlier["polish_steps"] = 0;
    earlier["max_growth"] = 3;
    edit::read_request(request, earlier);
    DOCTEST_CHECK(!request.colour_coupling.is_set());
    DOCTEST_CHECK(request.max_growth.is_set());
}

DOCTEST_TEST_CASE("the sentence before an edit lacks what the edit brings") {
    const auto before = [](const char* prompt, const char* source, const char* target) {
        return edit::check(bear(source, prompt, target)).sentence().before();
    };
    DOCTEST_CHECK(before("a blue bear on the grass", "bear", "blue") == "a bear on the grass");
    DOCTEST_CHECK(before("a bear wearing a red hat on the grass", "bear", "hat") == "a bear on the grass");
    DOCTEST_CHECK(before("a bear wearing a red hat on the grass", "hat", "red") ==
                  "a bear wearing a hat on the grass");
    DOCTEST_CHECK(before("a chair made of stone", "chair", "stone") == "a chair");
    DOCTEST_CHECK(before("a red bear standing on the sand", "bear", "sand") == "a red bear");
    DOCTEST_CHECK(before("turn the bear into a panda", "bear", "panda") == "turn the bear");
    DOCTEST_CHECK(before("a panda on the grass", "bear", "panda") == "a bear on the grass");
    DOCTEST_CHECK(before("a bear", "bear", "bear") == "a bear");
    // How the cat looks.
    DOCTEST_CHECK(before("a small red cat on the grass", "bear", "cat") == "a bear on the grass");
    DOCTEST_CHECK(before("a bear on the deep snow", "grass", "snow") == "a bear on the grass");
}

DOCTEST_TEST_CASE("the things a sentence names are the heads of its noun phrases, each once") {
    using Things = std::vector<std::string>;
    DOCTEST_CHECK(language::Sentence("a white dog wearing a golden crown on the snow").things() ==
                  Things{"dog", "crown", "snow"});
    DOCTEST_CHECK(language::Sentence("A wooden chair in flames, on tiles.").things() ==
                  Things{"chair", "flames", "tiles"});
    DOCTEST_CHECK(language::Sentence("a chair made of stone beside a chair").things() == Things{"chair"});
    DOCTEST_CHECK(language::Sentence("a bear turned into a panda on the grass").things() ==
                  Things{"bear", "grass"});
    DOCTEST_CHECK(language::Sentence("on the").things() == Things{});
    DOCTEST_CHECK(language::Sentence("").things() == Things{});
}

DOCTEST_TEST_CASE("the target is guessed from the sentence") {
    DOCTEST_CHECK(language::guessed_target(language::Sentence("a bear wearing a red hat"), "bear") == "hat");
    DOCTEST_CHECK(language::guessed_target(language::Sentence("a red bear wearing a blue hat on the grass"),
                                           "bear") == "hat");
    DOCTEST_CHECK(language::guessed_target(language::Sentence("a bear with white wings"), "bear") == "wings");
    DOCTEST_CHECK(language::guessed_target(language::Sentence("a green statue in flames on the grass"),
                                           "statue") == "flames");
    DOCTEST_CHECK(language::guessed_target(language::Sentence("a red cat in a hat"), "cat") == "hat");
    DOCTEST_CHECK(language::guessed_target(language::Sentence("a red cat in the snow"), "cat") == "red");
    DOCTEST_CHECK(language::guessed_target(language::Sentence("a blue bear on the grass"), "bear") == "blue");
    DOCTEST_CHECK(language::guessed_target(language::Sentence("a golden statue"), "statue") == "golden");
    DOCTEST_CHECK(language::guessed_target(language::Sentence("a chair made of stone"), "chair") == "stone");
    DOCTEST_CHECK(language::guessed_target(language::Sentence("turn the bear into a panda"), "bear") ==
                  "panda");
    for (const char* sentence : {"turn the bear into a golden bear", "the bear is golden",
                                 "make the bear golden", "paint the bear golden on the grass"}) {
        const auto golden = edit::check(bear("bear", sentence, ""));
        DOCTEST_CHECK_MESSAGE(golden.target() == "golden", sentence);
        DOCTEST_CHECK_MESSAGE(!language::has_phrase(golden.sentence().before(), "golden"), sentence);
        DOCTEST_CHECK_MESSAGE(edit::decide_mode(golden, std::nullopt).first == edit::EditMode::Modify,
                              sentence);
    }
    DOCTEST_CHECK(language::guessed_target(language::Sentence("a panda on the grass"), "bear") == "panda");
    DOCTEST_CHECK(language::guessed_target(language::Sentence("a bear wearing a golden crown"), "hat") ==
                  "crown");  // worn for worn
    DOCTEST_CHECK(language::guessed_target(language::Sentence("a bear wearing a golden crown"), "dog") ==
                  "bear");
    DOCTEST_CHECK(language::guessed_target(language::Sentence("a bear wearing a red hat"), "hat") == "red");
    DOCTEST_CHECK(language::guessed_target(language::Sentence("a photo of a bear"), "bear") == "bear");
    DOCTEST_CHECK(language::guessed_target(language::Sentence("bear"), "bear") == "bear");
    DOCTEST_CHECK(language::guessed_target(language::Sentence("a bear with"), "bear") == "bear");
}

DOCTEST_TEST_CASE("all that a sentence says of the source or names may be its news") {
    using Words = std::vector<std::string>;
    const auto possible = [](const char* sentence, const char* source, const Words& said = {}) {
        return language::possible_targets(language::Sentence(sentence), source, said);
    };
    DOCTEST_CHECK(possible("a golden bear wearing a red hat on the snow", "bear") ==
                  Words{"hat", "golden", "snow"});
    DOCTEST_CHECK(possible("a golden bear wearing a red hat on the snow", "bear",
                           {"a", "bear", "hat", "red"}) == Words{"golden", "snow"});
    DOCTEST_CHECK(possible("a golden bear on the snow", "grass") == Words{"snow"});  // ground for ground
    DOCTEST_CHECK(possible("a robot on the snow", "ground") == Words{"snow"});
    DOCTEST_CHECK(possible("a golden bear in the wind", "grass") == Words{"bear", "wind"});
    // The sentence alone does not tell.
    DOCTEST_CHECK(possible("a red ball beside a bear", "bear") == Words{"bear", "ball"});
    DOCTEST_CHECK(possible("a blue bear", "bear", {"a", "blue", "bear"}) == Words{"blue"});
    DOCTEST_CHECK(possible("bear", "bear") == Words{"bear"});
    // What wears the source is there.
    DOCTEST_CHECK(language::possible_targets(language::Sentence("a bear wearing a red hat on the grass"),
                                             "hat", {}) == std::vector<std::string>{"red", "grass"});
    DOCTEST_CHECK(language::possible_targets(language::Sentence("a big bear with a hat"), "hat", {}) ==
                  std::vector<std::string>{"hat", "bear"});
}

DOCTEST_TEST_CASE("what applied edits said already is no news") {
    const auto said = [](const std::vector<EditRequest>& applied) {
        std::vector<language::EditSentence> sentences;
        for (const auto& request : applied) sentences.push_back(edit::check(request).sentence());
        return language::words_said(sentences);
    };
    const auto blue = bear("bear", "a blue bear on the grass", "blue"),
               hat = bear("bear", "a blue bear wearing a hat", "hat");
    DOCTEST_CHECK(language::guessed_target(language::Sentence("a blue bear wearing a hat"), "bear",
                                           said({blue})) == "hat");
    DOCTEST_CHECK(language::guessed_target(language::Sentence("a golden bear wearing a hat"), "bear",
                                           said({blue, hat})) == "golden");
    DOCTEST_CHECK(language::guessed_target(language::Sentence("a blue bear wearing a hat and a scarf"),
                                           "bear", said({blue, hat})) == "scarf");
    DOCTEST_CHECK(language::guessed_target(language::Sentence("a blue bear wearing a red hat"), "bear",
                                           said({blue, hat})) == "hat");
    // Nothing new: the sentence as it is, so that an edit can be repeated.
    DOCTEST_CHECK(language::guessed_target(language::Sentence("a blue bear on the grass"), "bear",
                                           said({blue})) == "blue");
    // What was replaced since can be asked for again.
    const auto red = bear("bear", "a red bear", "red");
    DOCTEST_CHECK(language::guessed_target(language::Sentence("a blue bear wearing a hat"), "bear",
                                           said({hat, red})) == "blue");
    const auto snow = bear("grass", "a bear on the snow", "snow");
    DOCTEST_CHECK(language::guessed_target(language::Sentence("a bear on the grass"), "snow",
                                           said({blue, snow})) == "grass");
    DOCTEST_CHECK(said({}).empty());
}

DOCTEST_TEST_CASE(
    "source and target must be known to a model with a fixed vocabulary, other words need not") {
    const std::vector<std::string> known{"a", "in", "the", "on", "bear", "pear", "hat", "golden", "grass"};
    const auto refused = [&](const EditRequest& request, bool by_hand) {
        try {
            edit::require_known_words(edit::check(request), known, {}, by_hand);
            return std::string();
        } catch (const Error& error) {
            DOCTEST_CHECK(error.code() == ErrorCode::InvalidArgument);
            return std::string(error.what());
        }
    };
    DOCTEST_CHECK(refused(bear("bear", "a golden bear on the shiny grass", "golden"), false).empty());
    const auto sign = refused(bear("sign", "a golden sign", "golden"), false);
    for (const char* part : {"\"sign\"", "label it by hand instead", "bear", "grass"})
        DOCTEST_CHECK_MESSAGE(sign.find(part) != std::string::npos, sign);
    DOCTEST_CHECK(sign.find("\"in\"") == std::string::npos);  // no suggestion: it is no thing
    DOCTEST_CHECK(refused(bear("sign", "a golden sign", "golden"), true).empty());
    const auto hat = refused(bear("bear", "a bear wearing a sombrero", "sombrero"), true);
    DOCTEST_CHECK_MESSAGE(hat.find("\"sombrero\"") != std::string::npos, hat);
    DOCTEST_CHECK(language::nearest_words("baer", known) == std::vector<std::string>{"bear"});
    DOCTEST_CHECK(language::nearest_words("bears", known) == std::vector<std::string>{"bear"});
    DOCTEST_CHECK(language::nearest_words("hta", known) == std::vector<std::string>{"hat"});
    DOCTEST_CHECK(language::nearest_words("sign", known).empty());
    // A word with a meaning of its own is not replaced by one of like letters.
    const std::vector<std::string> looks{"beard", "brass", "car", "dog", "hat", "red", "vase", "flames"};
    using Words = std::vector<std::string>;
    DOCTEST_CHECK(language::nearest_words("bears", looks) == Words{"dog"});  // of its kind
    DOCTEST_CHECK(language::nearest_words("cars", looks) == Words{"car"});
    DOCTEST_CHECK(language::nearest_words("flame", looks) == Words{"flames"});
    DOCTEST_CHECK(language::nearest_words("puppies", looks) == Words{"dog"});
    DOCTEST_CHECK(language::nearest_words("automobile", looks) == Words{"car"});
    DOCTEST_CHECK(language::nearest_words("sombrero", looks) == Words{"hat"});
    DOCTEST_CHECK(language::nearest_words("crimson", looks) == Words{"red"});
    DOCTEST_CHECK(language::nearest_words("vaze", looks) == Words{"vase"});
    for (const char* other : {"boards", "grasp", "brains", "rod iron", "base line", "ha"})
        DOCTEST_CHECK_MESSAGE(language::nearest_words(other, looks).empty(), other);
    edit::require_known_words(edit::check(bear("sign", "a jade sign", "jade")), {}, {},
                              false);  // an open vocabulary
}

DOCTEST_TEST_CASE(
    "room for what is new: by its size where something is added, by pixels where something changes") {
    edit::EditRequest request;
    request.dilate_px = 16;
    request.add_margin = 0.5;
    Mask mask(256, 256);
    for (int x = 40; x < 140; ++x) mask.at(x, 100) = 1;
    DOCTEST_CHECK(edit::mask_growth(request, edit::EditMode::Modify, mask) == 8);  // of a 512-pixel picture
    DOCTEST_CHECK(edit::mask_growth(request, edit::EditMode::Add, mask) == 50);
    request.add_margin = 0.1;
    // Never less than twice the pixels.
    DOCTEST_CHECK(edit::mask_growth(request, edit::EditMode::Add, mask) == 16);
    DOCTEST_CHECK(edit::mask_growth(request, edit::EditMode::Add, Mask(256, 256)) == 16);
}

}  // namespace request_test
