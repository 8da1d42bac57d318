// Sentences with several changes: their suite, their steps, and what later steps leave of earlier ones.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <map>
#include <string>

#include "engine/base/error.h"
#include "engine/edit/request/sentence_plan.h"
#include "engine/laboratory/eval/eval_compound.h"
#include "engine/laboratory/eval/eval_compound_summary.h"
#include "engine/laboratory/eval/eval_suite.h"

namespace compound_test {

namespace {

using namespace gse;
using namespace gse::bench;
using Json = nlohmann::ordered_json;

constexpr int Cases = 24;  // every pattern of changes several times

edit::EditRequest request_of(const EvalCase& edit) {
    edit::EditRequest request;
    request.source = edit.word;
    request.prompt = edit.prompt;
    return request;
}

std::string words_of(const synth::SceneSpec& spec) {
    return spec.object + '/' + spec.material + '/' + spec.accessory + '/' + spec.accessory_colour + '/' +
           spec.ground;
}

/// Looks, place and things that differ.
int changes_of(const EvalCase& edit) {
    const auto &a = edit.source, &b = edit.target;
    const bool look = a.object == b.object && a.material != b.material;
    const bool worn_look = a.accessory == b.accessory && a.accessory_colour != b.accessory_colour;
    return (a.object != b.object) + look + (a.ground != b.ground) + (a.accessory != b.accessory) + worn_look;
}

/// A result of `count` splats at distinct places, every one of which is the base's of the same number.
edit::EditResult unchanged(std::size_t count) {
    edit::EditResult result;
    GaussianData data;
    data.resize(count);
    for (std::size_t row = 0; row < count; ++row) data.position[row * 3] = static_cast<float>(row);
    result.set = GaussianSet(std::move(data));
    result.label.assign(count, 0);
    result.hole_fill.assign(count, 0);
    for (std::size_t row = 0; row < count; ++row)
        result.base_to_new.push_back(static_cast<std::int64_t>(row));
    return result;
}

}  // namespace

DOCTEST_TEST_CASE("a compound case changes two or three things, and its plan has a step for each") {
    std::map<int, int> counts;
    std::map<std::string, int> kinds;
    for (const auto& edit : make_suite(1, Cases, {"compound"})) {
        DOCTEST_CAPTURE(edit.prompt);
        DOCTEST_CHECK(synth::held_out(edit.target));
        const auto scene = language::plan::scene_words(scene_words_of(edit.source));
        const auto plan = edit::plan_of(request_of(edit), scene);
        DOCTEST_CHECK(static_cast<int>(plan.steps.size()) == changes_of(edit));
        ++counts[changes_of(edit)];
        auto spec = edit.source;
        for (const auto& step : plan.steps) {
            const auto part = case_of_step(spec, step);
            DOCTEST_CHECK(words_of(part.source) != words_of(part.target));
            ++kinds[part.kind];
            spec = part.target;
        }
        DOCTEST_CHECK(words_of(spec) == words_of(edit.target));
    }
    DOCTEST_CHECK(counts[2] + counts[3] == Cases);
    DOCTEST_CHECK(counts[3] > 0);
    for (const char* kind : {"recolour", "material", "ground", "add", "replace"}) {
        DOCTEST_CAPTURE(kind);
        DOCTEST_CHECK(kinds[kind] > 0);
    }
}

DOCTEST_TEST_CASE("compound cases are drawn apart: other kinds are the same with and without them") {
    const auto alone = make_suite(1, 5, eval_kinds());
    auto kinds = eval_kinds();
    kinds.emplace_back("compound");
    const auto beside = make_suite(1, 6, kinds);
    for (std::size_t i = 0; i < alone.size(); ++i) {
        DOCTEST_CHECK(alone[i].prompt == beside[i].prompt);
        DOCTEST_CHECK(alone[i].source.seed == beside[i].source.seed);
    }
    DOCTEST_CHECK(beside.back().kind == "compound");
}

DOCTEST_TEST_CASE("a step that the synthetic world does not have is refused") {
    language::plan::Step step;
    step.operation = language::plan::Operation::Remove;
    DOCTEST_CHECK_THROWS_AS(case_of_step({}, step), Error);
    step.operation = language::plan::Operation::Recolour;
    step.subject.links = {{"house", {}, {}}};
    step.text = "blue";
    DOCTEST_CHECK_THROWS_AS(case_of_step({}, step), Error);
}

DOCTEST_TEST_CASE("new splats belong to what the step makes, and ground that was hidden to the ground") {
    using synth::Part;
    auto result = unchanged(4);
    result.base_to_new = {0, -1, 1};  // the middle one is gone; two are new
    result.hole_fill[3] = 1;
    const auto parts = parts_after({Part::Ground, Part::Object, Part::Object}, result, Part::Accessory);
    DOCTEST_CHECK(parts == std::vector<Part>{Part::Ground, Part::Object, Part::Accessory, Part::Ground});
}

DOCTEST_TEST_CASE("splats of an earlier step count as lost when a later one touches them without a label") {
    auto first = unchanged(5);
    first.label = {1, 1, 1, 1, 0};
    auto second = unchanged(4);
    second.base_to_new = {0, 1, 2, -1, 3};
    GaussianData data;
    data.resize(4);
    const float places[] = {0, 9, 9, 4};  // rows 1 and 2 have moved
    for (std::size_t row = 0; row < 4; ++row) data.position[row * 3] = places[row];
    second.set = GaussianSet(std::move(data));
    second.label.assign(4, 0);
    second.hole_fill.assign(4, 0);
    const auto kept = kept_rows({{&first, {0, 1, 0, 0, 1}}, {&second, {}}}, 0);
    DOCTEST_CHECK(kept.rows == 4);
    DOCTEST_CHECK(kept.met == 1);   // row 1: the later step may change it
    DOCTEST_CHECK(kept.lost == 2);  // row 2 differs, row 3 is gone
}

DOCTEST_TEST_CASE("the compound summary counts lost splats and refused steps, and leaves other kinds out") {
    const auto step = [](const char* kind, double reduction, bool passed) {
        return Json{{"kind", kind},
                    {"target", "blue"},
                    {"l1_reduction", reduction},
                    {"psnr_outside_db", 50},
                    {"judgement", {{"passed", passed}, {"reason", "too little changed"}}}};
    };
    const Json edit{{"index", 0},
                    {"kind", "compound"},
                    {"prompt", "a blue bear wearing a hat"},
                    {"steps", Json::array({step("recolour", 0.75, true), step("add", 0.25, false)})},
                    {"kept", Json::array({{{"step", 0},
                                           {"rows", 10},
                                           {"met", 3},
                                           {"lost", 1},
                                           {"colour_error", 0.125},
                                           {"colour_error_at_end", 0.25}}})}};
    const Json other{{"kind", "recolour"}, {"l1_reduction", 0.5}};
    const Json failed{{"kind", "compound"}, {"error", "not found"}};
    const auto summary = compound_summary(Json::array({other, edit, failed}));
    DOCTEST_CHECK(summary["compound_steps"] == 2);
    DOCTEST_CHECK(summary["compound_steps_refused"] == 0.5);
    DOCTEST_CHECK(summary["compound_add_l1_reduction"] == 0.25);
    DOCTEST_CHECK(summary["compound_recolour_l1_reduction"] == 0.75);
    DOCTEST_CHECK(summary["compound_lost_splats"] == 1);
    DOCTEST_CHECK(summary["compound_colour_error"] == 0.125);
    DOCTEST_CHECK(summary["compound_colour_error_at_end"] == 0.25);
    DOCTEST_CHECK(compound_summary(Json::array({other, failed})).empty());
    const auto lines = compound_lines(Json::array({other, edit}));
    DOCTEST_CHECK(lines.find("kept 6 of 10 splats") != std::string::npos);
    DOCTEST_CHECK(lines.find("REFUSED: too little changed") != std::string::npos);
}

}  // namespace compound_test
