// SAM's weights in the artist's window: tried before they count, kept until the next start, and GrabCut is a
// click away.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <fmt/format.h>

#include "engine/base/file.h"
#include "engine/pipeline/run/views.h"
#include "engine/scene/label_ops.h"
#include "tests/ui/app/session.h"

namespace segmenter_test {

using namespace gse;
using namespace gse::test;

DOCTEST_TEST_CASE(
    "a segmenter: bad weights change nothing, good ones cut out the masks and are there again") {
    const auto weights = fs::absolute(goldens_folder() / "sam/sam_original.safetensors").lexically_normal();
    if (!networks() || !available(weights)) return;
    const Place place;
    const auto bad = place.folder / "bad.pth";
    write_file(bad, "no weights");
    {
        Session session;
        session.open_bear();
        auto& app = session.app;
        for (const auto& path : {bad, place.folder / "gone.pth"}) {
            app.run(command::ChooseSegmenter{ui::SegmenterRole::Clicks, path.string()});
            DOCTEST_CHECK(app.model().segmenters[0].checking);
            DOCTEST_REQUIRE(session.settled());
            DOCTEST_CHECK(!app.model().segmenters[0].checking);
            DOCTEST_CHECK(app.model().segmenters[0].path.empty());
            DOCTEST_CHECK(app.model().toasts.back().is_error);
            DOCTEST_CHECK(app.model().toasts.back().text.find("segmenter") != std::string::npos);
        }
        app.run(command::ChooseSegmenter{ui::SegmenterRole::Words, place.folder.string()});  // no CLIPSeg
        DOCTEST_CHECK(app.model().segmenters[1].checking);
        DOCTEST_REQUIRE(session.settled());
        DOCTEST_CHECK(app.model().segmenters[1].path.empty());
        DOCTEST_CHECK(app.model().toasts.back().text.find("segmenter") != std::string::npos);
        app.run(command::ChooseSegmenter{ui::SegmenterRole::Clicks, weights.string()});
        DOCTEST_REQUIRE(session.settled());
        DOCTEST_CHECK(app.model().segmenters[0].path == weights.string());
        app.run(command::Locate{});
        DOCTEST_REQUIRE(
            session.settled());  // of weights drawn at random; whether they find anything is theirs
        app.shut_down();
    }
    Session again;
    DOCTEST_CHECK(again.app.model().segmenters[0].path == weights.string());
    again.app.run(command::ChooseSegmenter{ui::SegmenterRole::Clicks, {}});
    DOCTEST_CHECK(again.app.model().segmenters[0].path.empty());
    again.app.shut_down();
}

DOCTEST_TEST_CASE(
    "a thing in a box is cut out in the background, one step of undo, and no model is loaded for it") {
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    constexpr float Half = 105;  // px, of 240: the home view frames the bear
    ui::ScreenRegion box;
    const auto camera = app.model().camera;
    const auto cx = static_cast<float>(camera.width) / 2, cy = static_cast<float>(camera.height) / 2;
    box.polygon = {
        {cx - Half, cy - Half}, {cx + Half, cy - Half}, {cx + Half, cy + Half}, {cx - Half, cy + Half}};
    app.run(command::CutOut{box, ui::SetOperation::Replace});
    DOCTEST_REQUIRE(session.settled());
    DOCTEST_CHECK(app.model().job.error.empty());
    const auto& state = app.document().state();
    DOCTEST_REQUIRE(state.active_label >= 0);
    const auto cut = count_labelled(state.labels[static_cast<std::size_t>(state.active_label)]);
    // All of the bear, which has six of ten splats, and nothing of the grass.
    DOCTEST_CHECK(cut > state.current.size() * 55 / 100);
    DOCTEST_CHECK(cut < state.current.size() * 65 / 100);
    // From where it was begun is its front later; more of it from elsewhere changes nothing of that.
    const auto looked = [&] { return app.document().state().labels.at(0).looked_from; };
    const auto first = fmt::format("{:.0f}", pipeline::looked_from(camera, state.info.up));
    DOCTEST_CHECK(looked() == first);
    app.run(command::SetCamera{Camera::look_at(camera.centre() + camera.rotation.row(0) * 2.0,
                                               camera.centre() + camera.forward() * 4.0, state.info.up, 0.9,
                                               camera.width, camera.height)});
    app.update(session.preview);
    app.run(command::Select{box, ui::SetOperation::Add, true});
    DOCTEST_CHECK(looked() == first);
    app.run(command::Select{box, ui::SetOperation::Replace, true});
    DOCTEST_CHECK(looked() != first);
    app.run(command::SetCamera{camera});
    app.update(session.preview);
    app.run(command::Undo{});
    app.run(command::Undo{});
    app.run(command::Undo{});
    DOCTEST_CHECK(app.document().state().labels.empty());
    app.run(command::CutOut{box, ui::SetOperation::Replace});
    app.run(command::Cancel{});
    DOCTEST_REQUIRE(session.settled());
    DOCTEST_CHECK(app.document().state().labels.empty());
    for (const auto& toast : app.model().toasts)
        DOCTEST_CHECK_FALSE(toast.is_error);  // it was the artist's wish
    app.shut_down();
}

DOCTEST_TEST_CASE("a click labels the whole thing under it, by the name of what is asked for") {
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    auto request = app.model().request;
    request.source = "skull", request.prompt = "a golden skull", request.target = "golden";
    app.run(command::SetRequest{request});
    app.run(command::AddLabel{"skull"});
    const auto& camera = app.model().camera;
    ui::ScreenRegion click;
    click.polygon = {{static_cast<float>(camera.width) / 2, static_cast<float>(camera.height) / 2}};
    app.run(command::CutOut{click, ui::SetOperation::Add});
    DOCTEST_REQUIRE(session.settled());
    DOCTEST_CHECK(app.model().job.error.empty());
    const auto& state = app.document().state();
    DOCTEST_REQUIRE(state.labels.size() == 1);
    DOCTEST_CHECK(state.labels[0].name == "skull");
    const auto labelled = count_labelled(state.labels[0]);
    DOCTEST_CHECK(labelled > state.current.size() * 50 / 100);  // the bear has six of ten splats
    DOCTEST_CHECK(labelled < state.current.size() * 70 / 100);
    app.update(session.preview);
    DOCTEST_CHECK(app.model().scope.by_label);
    DOCTEST_CHECK(app.model().labelled_by_hand);
    click.polygon = {{2, 2}};  // beside everything
    app.run(command::CutOut{click, ui::SetOperation::Replace});
    DOCTEST_REQUIRE(session.settled());
    DOCTEST_CHECK(count_labelled(app.document().state().labels[0]) == labelled);
    app.run(command::Undo{});
    DOCTEST_CHECK(count_labelled(app.document().state().labels[0]) == 0);
    app.shut_down();
}

}  // namespace segmenter_test
