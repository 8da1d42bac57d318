// Files that the window writes: what is on the screen goes into them, and comes back out of them.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "app/application.h"
#include "engine/io/image_file.h"
#include "engine/io/scene_io.h"
#include "engine/scene/label_ops.h"
#include "tests/ui/app/session.h"

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
    app.set_request(request);
    auto exports = app.model().exports;
    exports.scene_path = (place.folder / "scene.ply").string();
    exports.with_labels = true;
    app.set_exports(exports);
    app.edit();
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_REQUIRE(app.model().result_waiting);
    app.export_scene();
    DOCTEST_REQUIRE(session.idle());
    app.update(session.preview);
    const Scene written = load_scene(place.folder / "scene.ply");
    DOCTEST_CHECK(same_colours(written.gaussians, session.preview.last.set));
    DOCTEST_CHECK_FALSE(same_colours(written.gaussians, app.document().state().current));
    DOCTEST_CHECK(written.labels.labels.size() == 1);
    DOCTEST_CHECK(toasted(app, "not applied"));
    app.apply_result();
    app.export_scene();
    app.answer(0);   // another name
    DOCTEST_REQUIRE(session.idle());
    DOCTEST_CHECK(same_colours(load_scene(place.folder / "scene-2.ply").gaussians, app.document().state().current));
    DOCTEST_CHECK(same_colours(load_scene(place.folder / "scene-2.ply").gaussians, written.gaussians));
    app.shut_down();
}

DOCTEST_TEST_CASE("a label that was made by hand is exported, too") {
    const Place place;
    Session session;
    session.open_bear();
    auto& app = session.app;
    ui::ScreenRegion stroke;
    stroke.circles = {{160, 120}};
    stroke.radius_px = 20;
    app.add_label("mine");
    app.select(stroke, ui::SetOperation::Add, true);
    auto exports = app.model().exports;
    exports.scene_path = (place.folder / "scene.ply").string();
    exports.with_labels = true;
    app.set_exports(exports);
    app.export_scene();
    DOCTEST_REQUIRE(session.idle());
    const Scene written = load_scene(place.folder / "scene.ply");
    DOCTEST_REQUIRE(written.labels.labels.size() == 1);
    DOCTEST_CHECK(*written.labels.labels[0].bits == *app.document().state().labels[0].bits);
    app.shut_down();
}
