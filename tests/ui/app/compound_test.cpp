// Sentences with several changes: made one after another, applied together, undone one by one.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <array>

#include "app/session/application.h"
#include "engine/scene/label_ops.h"
#include "tests/ui/app/session.h"

namespace compound_test {

using namespace gse;
using namespace gse::test;

namespace {

constexpr const char* BlueWithHat = "a blue bear wearing a red hat";
constexpr const char* BlueStep = "recolour(bear, blue)";

/// With the bear, the sentence, and settings for a quick edit.
app::Application& opened(Session& session, const std::string& prompt) {
    session.open_bear();
    auto request = session.app.model().request;
    request.prompt = prompt;
    request.target.clear();
    request.method = "views";
    request.edited_views = 2;
    session.app.run(command::SetRequest{request});
    return session.app;
}

/// Mean colour in [0,1] of the rows of a label.
std::array<double, 3> mean_colour(const DocumentState& state, const NamedLabel& label) {
    constexpr double DcBasis = 0.28209479177387814;  // of spherical harmonics, degree 0
    std::array<double, 3> sum{};
    const auto stride = state.current.sh().size() / state.current.size();
    double count = 0;
    for (std::size_t row = 0; row < label.bits->size(); ++row) {
        if ((*label.bits)[row] == 0) continue;
        for (std::size_t c = 0; c < 3; ++c) sum[c] += 0.5 + DcBasis * state.current.sh()[row * stride + c];
        ++count;
    }
    for (auto& value : sum) value /= std::max(1.0, count);
    return sum;
}

const NamedLabel* label_named(const DocumentState& state, const std::string& name) {
    const auto found = std::find_if(state.labels.begin(), state.labels.end(),
                                    [&](const auto& label) { return label.name == name; });
    return found == state.labels.end() ? nullptr : &*found;
}

/// Checks that each name says something. More may stand around it, which pictures show: the ground, a colour.
void check_names(const std::vector<std::string>& names, const std::vector<std::string>& say) {
    DOCTEST_REQUIRE(names.size() == say.size());
    for (std::size_t i = 0; i < names.size(); ++i)
        DOCTEST_CHECK_MESSAGE(names[i].find(say[i]) != std::string::npos, names[i]);
}

void check_stack(const DocumentState& state, const std::vector<std::string>& say) {
    std::vector<std::string> names;
    for (const auto& node : state.stack) names.push_back(node.name);
    check_names(names, say);
}

/// Checks which worn thing, if any, the window asks about before it makes the next edit of the bear.
void check_asked_about(Session& session) {
    struct Next {
        const char *sentence, *asked_about;
    };
    for (const auto& [sentence, asked_about] :
         {Next{"a golden bear", ""}, Next{"make the bear golden", ""},
          Next{"a golden bear wearing a red hat", ""}, Next{"a golden bear wearing a hat", ""},
          Next{"a golden bear with its red hat", ""}, Next{"a bear wearing a green scarf", ""},
          Next{"a bear wearing a red hat and a green scarf", ""}, Next{"a bear in the snow", ""},
          Next{"a bear wearing a red hat in the snow", ""}, Next{"a bear wearing a golden hat", ""},
          Next{"put another hat on the bear", ""}, Next{"a bear wearing a red hat", "hat"}}) {
        auto request = session.app.model().request;
        request.prompt = sentence;
        session.app.run(command::SetRequest{request});
        session.app.update(session.preview);
        DOCTEST_CHECK_MESSAGE(session.app.model().scope.present == asked_about, sentence);
    }
}

}  // namespace

DOCTEST_TEST_CASE("two changes of one sentence wait as one result, and are two edits of the stack") {
    if (!networks()) return;
    const Place place;
    Session session;
    auto& app = opened(session, BlueWithHat);
    const auto base = app.document().state().current;
    app.run(command::Edit{});
    DOCTEST_REQUIRE(session.settled());
    DOCTEST_REQUIRE(app.model().result_waiting);
    DOCTEST_CHECK(app.model().results.size() == 1);
    check_names(app.model().verdict.changes, {"a blue bear", "a blue bear wearing a red hat"});
    DOCTEST_CHECK(app.model().verdict.asked == 2);
    DOCTEST_CHECK(session.until([&] { return app.model().estimate.seconds > 0; }, 5));
    DOCTEST_CHECK(app.model().estimate.step_seconds.size() == 2);
    DOCTEST_CHECK(app.document().state().stack.empty());
    const auto shown = session.preview.last.set;
    DOCTEST_CHECK(shown.size() > base.size());  // with the hat
    app.run(command::AnotherResult{});
    DOCTEST_REQUIRE(app.model().job.running);
    app.run(command::Cancel{});  // while the scene is read
    DOCTEST_REQUIRE(session.settled());
    DOCTEST_CHECK(app.model().result_waiting);
    DOCTEST_CHECK(session.preview.last.set.shares_all_with(shown));

    app.run(command::ApplyResult{});
    app.update(session.preview);
    const auto both = app.document().state();
    check_stack(both, {"a blue bear", "a blue bear wearing a red hat"});
    DOCTEST_CHECK(both.current.size() == shown.size());
    const auto* bear = label_named(both, "bear");
    const auto* hat = label_named(both, "hat");
    DOCTEST_REQUIRE(bear != nullptr);
    DOCTEST_REQUIRE(hat != nullptr);
    const auto blue = mean_colour(both, *bear), red = mean_colour(both, *hat);
    DOCTEST_CHECK(blue[2] > blue[0]);  // the bear was red
    DOCTEST_CHECK(red[0] > red[2]);    // and the hat did not become blue
    check_asked_about(session);

    app.run(command::Undo{});
    app.update(session.preview);
    check_stack(app.document().state(), {"a blue bear"});
    const std::size_t added = both.current.size() - app.document().state().current.size();
    DOCTEST_CHECK(count_labelled(*hat) == added);
    app.run(command::Undo{});
    app.update(session.preview);
    DOCTEST_CHECK(app.document().state().stack.empty());
    DOCTEST_CHECK(app.document().state().current.shares_all_with(base));
    app.run(command::Redo{});
    app.run(command::Redo{});
    app.update(session.preview);
    DOCTEST_CHECK(app.document().state().current.shares_all_with(both.current));
}

DOCTEST_TEST_CASE("a step that is left out is not made, and the sentence can be run again with it") {
    if (!networks()) return;
    const Place place;
    Session session;
    auto& app = opened(session, BlueWithHat);
    const auto base = app.document().state().current;
    app.run(command::Edit{{BlueStep}});
    DOCTEST_REQUIRE(session.settled());
    DOCTEST_REQUIRE(app.model().result_waiting);
    DOCTEST_CHECK(app.model().verdict.asked == 1);
    app.run(command::ApplyResult{});
    app.update(session.preview);
    check_stack(app.document().state(), {"bear wearing a red hat"});
    DOCTEST_CHECK(app.model().made_things == std::vector<std::string>{"hat"});
    const auto& state = app.document().state();
    DOCTEST_CHECK(state.stack[0].name.find("blue") == std::string::npos);
    DOCTEST_CHECK(std::equal(base.sh().begin(), base.sh().end(), state.current.sh().begin()));  // no blue
}

DOCTEST_TEST_CASE("a look that pictures show already is no change") {
    if (!networks()) return;
    const Place place;
    Session session;
    auto& app = opened(session, "a red bear wearing a blue hat");
    app.run(command::Edit{});
    DOCTEST_REQUIRE(session.settled());
    DOCTEST_REQUIRE(app.model().result_waiting);
    app.run(command::ApplyResult{});
    app.update(session.preview);
    check_stack(app.document().state(), {"bear wearing a blue hat"});
}

DOCTEST_TEST_CASE("stopped in its second change, the first waits to be applied") {
    if (!networks()) return;
    const Place place;
    Session session;
    auto& app = opened(session, BlueWithHat);
    app.run(command::Edit{});
    DOCTEST_REQUIRE(session.until([&] {
        return app.model().job.running && app.model().job.title.find("step 2 of 2") != std::string::npos;
    }));
    const auto base = app.document().state().current;
    DOCTEST_CHECK_FALSE(session.preview.last.set.shares_all_with(base));  // the first is seen meanwhile
    app.run(command::Cancel{});
    DOCTEST_REQUIRE(session.settled());
    DOCTEST_REQUIRE(app.model().result_waiting);
    DOCTEST_CHECK(app.model().verdict.asked == 2);
    DOCTEST_CHECK(app.model().verdict.changes.front().starts_with("a blue bear"));
    app.run(command::DiscardResult{});
    app.update(session.preview);
    DOCTEST_CHECK(app.document().state().current.shares_all_with(base));
    DOCTEST_CHECK(app.model().results.empty());
}

DOCTEST_TEST_CASE("a sentence with nothing to do, and one in German, are refused before anything runs") {
    if (!networks()) return;
    const Place place;
    Session session;
    for (const char* prompt : {"leave the bear as it is", "der Bär soll blau sein"}) {
        auto& app = opened(session, prompt);
        app.run(command::Edit{});
        DOCTEST_REQUIRE(session.settled());
        DOCTEST_CHECK_FALSE(app.model().result_waiting);
        DOCTEST_CHECK(app.document().state().stack.empty());
    }
}

}  // namespace compound_test
