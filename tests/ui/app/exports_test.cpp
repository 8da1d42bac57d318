// Files that the window writes: what is on the screen goes into them, and comes back out of them.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <fmt/format.h>

#include <cmath>

#include "app/session/application.h"
#include "engine/io/image/image_file.h"
#include "engine/io/project/load_scene.h"
#include "engine/scene/framing.h"
#include "engine/scene/label_ops.h"
#include "tests/ui/app/session.h"

namespace exports_test {

using namespace gse;
using namespace gse::test;

namespace {

bool toasted(const app::Application& app, const std::string& text) {
    for (const auto& toast : app.model().toasts)
        if (toast.text.find(text) != std::string::npos) return true;
    return false;
}

bool same_colours(const GaussianSet& a, const GaussianSet& b) {
    return a.size() == b.size() && std::equal(a.sh().begin(), a.sh().end(), b.sh().begin(), b.sh().end());
}

}  // namespace

DOCTEST_TEST_CASE("a result that waits is what is exported, and the toast says that it is not applied") {
    if (!networks()) return;
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    auto request = app.model().request;
    request.iterations = 2;
    app.run(command::SetRequest{request});
    auto exports = app.model().exports;
    exports.scene_path = (place.folder / "scene.ply").string();
    exports.with_labels = true;
    app.run(command::SetExports{exports});
    app.run(command::Edit{});
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_REQUIRE(app.model().result_waiting);
    app.run(command::ExportScene{});
    DOCTEST_REQUIRE(session.idle());
    app.update(session.preview);
    const Scene written = load_scene(place.folder / "scene.ply");
    DOCTEST_CHECK(same_colours(written.gaussians, session.preview.last.set));
    DOCTEST_CHECK_FALSE(same_colours(written.gaussians, app.document().state().current));
    DOCTEST_CHECK(written.labels.labels.size() == 1);
    DOCTEST_CHECK(toasted(app, "not applied"));
    app.run(command::ApplyResult{});
    app.run(command::ExportScene{});
    app.run(command::Answer{0});  // another name
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(
        same_colours(load_scene(place.folder / "scene-2.ply").gaussians, app.document().state().current));
    DOCTEST_CHECK(same_colours(load_scene(place.folder / "scene-2.ply").gaussians, written.gaussians));
    app.shut_down();
}

DOCTEST_TEST_CASE("a label that was made by hand is exported, too") {
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    session.label_the_middle();
    auto exports = app.model().exports;
    exports.scene_path = (place.folder / "scene.ply").string();
    exports.with_labels = true;
    app.run(command::SetExports{exports});
    app.run(command::ExportScene{});
    DOCTEST_REQUIRE(session.idle());
    const Scene written = load_scene(place.folder / "scene.ply");
    DOCTEST_REQUIRE(written.labels.labels.size() == 1);
    DOCTEST_CHECK(*written.labels.labels[0].bits == *app.document().state().labels[0].bits);
    app.shut_down();
}

DOCTEST_TEST_CASE("a screenshot that is dropped back brings its settings and its camera") {
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    app.update(session.preview);
    Camera camera = app.model().camera;
    camera.translation.z += 0.7;
    camera.fx *= 1.5, camera.fy *= 1.5;
    app.run(command::SetCamera{camera});
    auto settings = app.model().model_settings;
    settings.front = "45";
    settings.guidance.guidance_scale = 6;
    settings.attention.strength = 0.5;
    settings.learn_scene = true;
    settings.learning.steps = 77;
    app.run(command::SetModelSettings{settings});
    app.update(session.preview);
    auto exports = app.model().exports;
    exports.picture_path = (place.folder / "shot.png").string();
    exports.width = 80, exports.height = 80;
    app.run(command::SetExports{exports});
    const auto shown = app.model().camera;
    app.run(command::ExportPicture{});
    DOCTEST_REQUIRE(session.idle());
    const auto seed = app.model().request.seed;
    app.run(command::SetModelSettings{{}});
    auto request = app.model().request;
    request.prompt = "a red bear", request.seed = seed + 5;
    app.run(command::SetRequest{request});
    app.run(command::LookThrough{0});
    app.update(session.preview);
    DOCTEST_REQUIRE_FALSE(app.model().camera.rotation == shown.rotation);
    app.run(command::Open{place.folder / "shot.png"});
    app.update(session.preview);
    DOCTEST_CHECK(app.model().request.prompt == "a blue bear on the grass");
    DOCTEST_CHECK(app.model().request.seed == seed);
    DOCTEST_CHECK(app.model().model_settings.front == "45");
    DOCTEST_CHECK(app.model().model_settings.guidance.guidance_scale == 6);
    DOCTEST_CHECK(app.model().model_settings.attention.strength == 0.5);
    DOCTEST_CHECK(app.model().model_settings.learn_scene);
    DOCTEST_CHECK(app.model().model_settings.learning.steps == 77);
    DOCTEST_CHECK(app.model().camera.rotation == shown.rotation);
    DOCTEST_CHECK(app.model().camera.translation == shown.translation);
    DOCTEST_CHECK(app.model().camera.fx == doctest::Approx(shown.fx));
    app.shut_down();
}

DOCTEST_TEST_CASE("the camera path is work of the project: saved, loaded, and not taken into another scene") {
    const Place place;
    {
        Session session(false);
        session.open_bear();
        auto& app = session.app;
        app.update(session.preview);
        app.run(command::AddCameraKey{});
        app.run(command::LookThrough{1});
        app.update(session.preview);
        app.run(command::AddCameraKey{});
        app.update(session.preview);
        DOCTEST_CHECK(app.model().unsaved);
        app.run(command::SaveProject{place.folder / "path.gsep"});
        DOCTEST_REQUIRE(session.until([&] { return !app.model().unsaved; }, 30));
        app.shut_down();
    }
    Session again(false);
    auto& app = again.app;
    app.run(command::Open{place.folder / "path.gsep"});
    DOCTEST_REQUIRE(again.until([&] { return app.model().document != nullptr; }));
    DOCTEST_REQUIRE(app.model().camera_keys.size() == 2);
    DOCTEST_CHECK(app.model().camera_keys[1].time == 2);
    DOCTEST_CHECK_FALSE(app.model().camera_keys[0].camera.translation ==
                        app.model().camera_keys[1].camera.translation);
    app.run(command::OpenSample{});
    DOCTEST_REQUIRE(again.until([&] { return app.model().project_path.empty(); }));
    DOCTEST_CHECK(app.model().camera_keys.empty());
    app.shut_down();
}

DOCTEST_TEST_CASE("a turntable begins where the artist looks, and a label does not change what it shows") {
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    constexpr int frames = 4, quarter = 1;
    auto exports = app.model().exports;
    exports.width = exports.height = 48;
    exports.frames = frames;
    const auto film = [&](const char* name, double azimuth) {
        app.run(command::SetCamera{orbit_camera(app.model().orbit, azimuth, 320, 240)});
        app.update(session.preview);
        exports.film_path = (place.folder / name).string();
        app.run(command::SetExports{exports});
        app.run(command::ExportTurntable{});
        DOCTEST_REQUIRE(session.idle());
        std::vector<Image> pictures;
        for (int frame = 0; frame < frames; ++frame)
            pictures.push_back(read_image(place.folder / name / fmt::format("frame_{:04}.png", frame)));
        return pictures;
    };
    const auto difference = [](const Image& a, const Image& b) {
        double sum = 0;
        for (std::size_t i = 0; i < a.data.size(); ++i) sum += std::abs(a.data[i] - b.data[i]);
        return sum / static_cast<double>(a.data.size());
    };
    constexpr double start = 0.3, right_angle = 1.5707963267948966;
    const auto turn = film("turn", start), later = film("later", start + quarter * right_angle);
    // The second begins a quarter later in the same round: at the frame after the first, or before it.
    const double same =
        std::min(difference(later[0], turn[quarter]), difference(later[0], turn[frames - quarter]));
    DOCTEST_CHECK(same < 0.25 * difference(later[0], turn[0]));
    ui::ScreenRegion stroke;
    stroke.circles = {{160, 120}};
    stroke.radius_px = 8;
    app.run(command::Select{stroke, ui::SetOperation::Add, true});
    const auto labelled = film("labelled", start);
    for (int frame = 0; frame < frames; ++frame) {
        const auto at = static_cast<std::size_t>(frame);
        DOCTEST_CHECK(difference(labelled[at], turn[at]) == 0);
    }
    app.shut_down();
}

}  // namespace exports_test
