// Scope of an edit: the label on the screen where it is about the words, else the result of a search.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "app/session/application.h"
#include "engine/scene/label_ops.h"
#include "tests/ui/app/session.h"

namespace scope_test {

using namespace gse;
using namespace gse::test;

namespace {

/// A stroke over the bear, which is small in the home view.
ui::ScreenRegion stroke_over_bear(float radius) {
    ui::ScreenRegion stroke;
    stroke.circles = {{160, 120}};
    stroke.radius_px = radius;
    return stroke;
}

const NamedLabel& active(const app::Application& app) {
    const auto& state = app.document().state();
    DOCTEST_REQUIRE(state.active_label >= 0);
    return state.labels[static_cast<std::size_t>(state.active_label)];
}

}  // namespace

DOCTEST_TEST_CASE("what an addition left behind is not what the next edit of another thing changes") {
    if (!networks()) return;
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    auto request = app.model().request;
    request.prompt = "a bear wearing a blue hat on the grass";
    request.target = "hat";
    request.mode = "add";
    request.iterations = 2;
    request.place_views = 4;
    app.run(command::SetRequest{request});
    app.run(command::Edit{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_REQUIRE(app.model().result_waiting);
    app.run(command::DiscardResult{});
    app.run(command::Select{stroke_over_bear(5), ui::SetOperation::Remove,
                            true});  // says nothing of where the hat goes, and that is said
    app.run(command::Edit{});
    DOCTEST_REQUIRE(session.idle());
    app.update(session.preview);
    bool said = false;
    for (const auto& line : app.model().log)
        said |= line.text == app::AddsElsewhere;  // its toast is gone where the edit took long
    DOCTEST_CHECK(said);
    app.run(command::ApplyResult{});
    DOCTEST_REQUIRE(active(app).name == "hat");
    request = app.model().request;
    request.mode = "auto";
    request.prompt = "a golden bear";
    app.run(command::SetRequest{request});
    app.update(session.preview);
    DOCTEST_CHECK(app.model().scope.by_label);
    DOCTEST_CHECK(app.model().scope.label == "bear");  // its own thing's label is used,
    DOCTEST_CHECK(app.model().scope.shown == "hat");   // not the one that is shown
    const auto hat = *active(app).bits;
    app.run(command::Edit{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_REQUIRE(active(app).name == "bear");
    std::size_t in_hat = 0;
    for (std::size_t row = 0; row < hat.size(); ++row)
        in_hat += hat[row] != 0 && (*active(app).bits)[row] != 0 ? 1 : 0;
    DOCTEST_CHECK(count_labelled(active(app)) > 100);
    DOCTEST_CHECK(in_hat < count_labelled(active(app)) / 2);
    app.shut_down();
}

DOCTEST_TEST_CASE("a thing labelled by hand needs no word of the model where a ground is named in passing") {
    if (!networks()) return;
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    auto request = app.model().request;
    request.source = "flowers";
    request.prompt = "red flowers on the grass";
    request.target.clear();
    request.method = "views";
    request.edited_views = 2;
    app.run(command::SetRequest{request});
    app.run(command::Select{stroke_over_bear(30), ui::SetOperation::Add, true});
    app.run(command::Edit{});
    DOCTEST_REQUIRE(session.settled());
    DOCTEST_CHECK_MESSAGE(app.model().job.error.empty(), app.model().job.error);
    DOCTEST_CHECK(app.model().result_waiting);
    app.shut_down();
}

DOCTEST_TEST_CASE("an addition beside a thing that the model does not know is not taken for that thing") {
    if (!networks()) return;
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    auto request = app.model().request;
    request.source = "panda";  // a thing that the starter model cannot find
    request.prompt = "a panda wearing a blue hat";
    request.target = "hat";
    request.mode = "add";
    request.iterations = 2;
    request.place_views = 4;
    app.run(command::SetRequest{request});
    app.run(command::Select{stroke_over_bear(30), ui::SetOperation::Add, true});
    const auto name = active(app).name;
    app.run(command::Edit{});
    DOCTEST_REQUIRE(session.idle());
    for (const auto& line : app.model().log) DOCTEST_CHECK(line.text != app::AddsElsewhere);
    DOCTEST_REQUIRE(app.model().result_waiting);
    app.run(command::ApplyResult{});
    DOCTEST_REQUIRE(active(app).name == "hat");
    request.prompt = "a golden panda";
    request.target = "golden";
    request.mode = "auto";
    app.run(command::SetRequest{request});
    app.update(session.preview);
    DOCTEST_CHECK(app.model().scope.by_label);
    DOCTEST_CHECK(app.model().scope.label == name);
    DOCTEST_CHECK(app.model().scope.shown == "hat");
    request.source = "hat";  // a follow-up about the addition
    app.run(command::SetRequest{request});
    app.update(session.preview);
    DOCTEST_CHECK(app.model().scope.by_label);
    DOCTEST_CHECK(app.model().scope.label == "hat");
    DOCTEST_CHECK(app.model().scope.shown.empty());
    request.source = "panda";
    request.prompt = "a panda wearing a red hat";
    request.target = "hat";
    app.run(command::SetRequest{request});
    app.update(session.preview);
    DOCTEST_CHECK(app.model().scope.present == "hat");  // a second one is asked about
    app.run(command::Undo{});
    app.update(session.preview);
    DOCTEST_CHECK(app.model().scope.present.empty());
    app.shut_down();
}

DOCTEST_TEST_CASE("the panel's word counts when Edit is pressed: another source is searched for") {
    if (!networks()) return;
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    app.run(command::Select{stroke_over_bear(5), ui::SetOperation::Add, true});
    const auto painted = active(app).name;
    auto request = app.model().request;
    request.source = "grass";
    request.prompt = "a bear on the snow";
    request.target = "snow";
    request.iterations = 2;
    app.run(command::SetRequest{request});
    app.update(session.preview);
    DOCTEST_REQUIRE_FALSE(app.model().scope.by_label);
    app.run(command::Edit{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(active(app).name == "grass");
    DOCTEST_CHECK(app.document().state().labels.front().name == painted);
    app.shut_down();
}

DOCTEST_TEST_CASE("a thing that is cut out without a label gets one of its own name") {
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    ui::ScreenRegion box;
    box.polygon = {{130, 80}, {190, 80}, {190, 160}, {130, 160}};
    app.run(command::CutOut{box, ui::SetOperation::Add});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(active(app).name == "cut out");
    app.run(command::SetActiveLabel{-1});
    app.run(command::CutOut{box, ui::SetOperation::Add});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(active(app).name == "cut out 2");
    app.shut_down();
}

DOCTEST_TEST_CASE(
    "a label that was found and renamed is still the one that the edit changes, with its corrections") {
    if (!networks()) return;
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    auto request = app.model().request;
    request.iterations = 2;
    app.run(command::SetRequest{request});
    app.run(command::Locate{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK_FALSE(app.model().attention_corrected);
    app.run(command::Select{stroke_over_bear(5), ui::SetOperation::Remove, true});
    app.update(session.preview);
    DOCTEST_CHECK(app.model().attention_corrected);  // the masks are from before
    const auto corrected = *active(app).bits;
    app.run(command::RenameLabel{app.document().state().active_label, "Bruno"});
    app.update(session.preview);
    DOCTEST_CHECK(app.model().scope.by_label);
    DOCTEST_CHECK(app.model().scope.label == "Bruno");
    DOCTEST_CHECK(app.model().scope.splats == count_labelled(active(app)));
    app.run(command::Edit{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(app.document().state().labels.size() == 1);
    DOCTEST_CHECK(*active(app).bits == corrected);
    DOCTEST_CHECK_FALSE(app.model().view.tint_labels);  // what was made is to be seen
    auto view = app.model().view;
    view.tint_labels = true;  // by T, a tool or a stroke
    app.run(command::SetViewSettings{view});
    app.update(session.preview);
    DOCTEST_CHECK(session.preview.last.values != nullptr);
    app.run(command::DiscardResult{});
    app.run(command::Locate{});  // another search corrects the same label
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(app.document().state().labels.size() == 1);
    DOCTEST_CHECK(active(app).name == "Bruno");
    app.run(command::SaveProject{place.folder / "bruno.gsep"});
    DOCTEST_REQUIRE(session.idle());
    app.run(command::Open{place.folder / "bruno.gsep"});
    DOCTEST_REQUIRE(session.idle());
    app.update(session.preview);
    DOCTEST_CHECK(app.model().scope.by_label);  // the project keeps the connection
    app.shut_down();
}

DOCTEST_TEST_CASE(
    "who paints a label means it, until another source is edited; the panel can say otherwise") {
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    app.run(command::AddLabel{"label"});
    app.run(command::Select{stroke_over_bear(20), ui::SetOperation::Add, true});
    app.update(session.preview);
    DOCTEST_CHECK(app.model().scope.by_label);
    app.run(command::SetScope{false});
    app.update(session.preview);
    DOCTEST_CHECK_FALSE(app.model().scope.by_label);
    app.run(command::SetScope{true});
    app.update(session.preview);
    DOCTEST_CHECK(app.model().scope.by_label);
    auto request = app.model().request;
    request.source = "grass";
    app.run(command::SetRequest{request});
    app.update(session.preview);
    DOCTEST_CHECK_FALSE(app.model().scope.by_label);
    app.run(command::OpenSample{});  // another document: nothing is labelled there
    DOCTEST_REQUIRE(session.until([&] { return app.document().state().labels.empty(); }));
    app.update(session.preview);
    DOCTEST_CHECK(app.model().scope.label.empty());
    app.shut_down();
}

DOCTEST_TEST_CASE("a label for another thing of the sentence says nothing of its source") {
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    auto request = app.model().request;
    request.source = "bear";
    request.prompt = "paint the bear blue and remove the stones";
    request.target.clear();
    app.run(command::SetRequest{request});
    app.update(session.preview);
    app.run(command::AddLabel{"stone"});
    app.run(command::Select{stroke_over_bear(20), ui::SetOperation::Add, true});
    app.update(session.preview);
    DOCTEST_CHECK(app.model().made_things == std::vector<std::string>{"stone"});
    DOCTEST_CHECK_FALSE(app.model().scope.by_label);  // the first change is the bear's
    request.prompt = "a blue bear";
    app.run(command::SetRequest{request});
    app.update(session.preview);
    DOCTEST_CHECK(app.model().made_things.empty());
    app.shut_down();
}

}  // namespace scope_test
