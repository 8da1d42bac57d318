// Facts of files in the window: coordinates of a far world, further columns, activated values.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "engine/io/cameras/cameras.h"
#include "engine/io/project/load_scene.h"
#include "engine/io/scene/scene_file.h"
#include "tests/ui/app/session.h"

namespace scene_origin_ui_test {

using namespace gse;
using namespace gse::test;

namespace {

const Vec3 Utm{455123, 5410987, 321};
constexpr double Rounding = 1e-6;  // of doubles of that size

bool said(const app::Application& app, const std::string& text) {
    const auto& toasts = app.model().toasts;
    return std::any_of(toasts.begin(), toasts.end(),
                       [&](const auto& toast) { return toast.text.find(text) != std::string::npos; });
}

/// The bundled scene in another place of the world, with a number for every splat.
Scene far_bear() {
    Scene scene = load_scene(app::assets_path() / "scenes/bear/scene.ply");
    std::vector<std::int32_t> numbers(scene.gaussians.size());
    std::iota(numbers.begin(), numbers.end(), 1000);
    std::vector<std::byte> bytes(numbers.size() * sizeof(std::int32_t));
    std::memcpy(bytes.data(), numbers.data(), bytes.size());
    scene.extra = {{"object_id", ColumnType::Int32, std::make_shared<const std::vector<std::byte>>(bytes)}};
    scene.info.offset = Utm;
    return scene;
}

std::int32_t number_of(const Scene& scene, std::size_t row) {
    std::int32_t number = 0;
    std::memcpy(&number, scene.extra.at(0).values->data() + row * sizeof number, sizeof number);
    return number;
}

}  // namespace

DOCTEST_TEST_CASE("a scene far from the origin is exported to its place, with the columns of its file") {
    const Place place;
    Session session;
    auto& app = session.app;
    save_scene(place.folder / "far.ply", far_bear());
    app.run(command::Open{place.folder / "far.ply"});
    DOCTEST_REQUIRE(session.until([&] { return app.model().document != nullptr; }));
    DOCTEST_CHECK(session.until([&] { return said(app, "coordinates are large"); }, 10));
    session.label_the_middle();
    app.run(command::DeleteLabelledSplats{});
    app.run(command::AddView{});
    auto exports = app.model().exports;
    exports.scene_path = (place.folder / "out.ply").string();
    exports.viewpoints_path = (place.folder / "cameras.json").string();
    app.run(command::SetExports{exports});
    app.run(command::ExportScene{});
    DOCTEST_REQUIRE(session.idle());
    app.run(command::ExportViewpoints{});
    DOCTEST_REQUIRE(session.idle());
    const auto& state = app.document().state();
    const Scene written = load_scene(place.folder / "out.ply");
    DOCTEST_REQUIRE(written.gaussians.size() < state.base.size());
    DOCTEST_REQUIRE(written.gaussians.size() == state.current.size());
    DOCTEST_CHECK(written.info.offset == Utm);
    bool same = true;
    for (std::size_t row = 0; row < written.gaussians.size(); ++row)
        same = same && number_of(written, row) == 1000 + static_cast<std::int32_t>((*state.row_ids)[row]);
    DOCTEST_CHECK(same);
    const auto views = load_cameras(place.folder / "cameras.json");
    DOCTEST_REQUIRE(views.size() == state.views.size());
    DOCTEST_CHECK(length(views[0].camera.centre() - state.views[0].camera.centre() - Utm) < Rounding);
    app.shut_down();
}

DOCTEST_TEST_CASE("a scene that looks activated is read anew at the press of a button") {
    const Place place;
    Session session;
    auto& app = session.app;
    Scene scene = load_scene(app::assets_path() / "scenes/bear/scene.ply");
    const GaussianSet raw = scene.gaussians;
    GaussianData data = raw.to_data();
    for (float& value : data.log_scale) value = std::exp(value);
    for (float& value : data.opacity_logit) value = 1 / (1 + std::exp(-value));
    scene.gaussians = GaussianSet(std::move(data));
    save_scene(place.folder / "fog.ply", scene);
    app.run(command::Open{place.folder / "fog.ply"});
    DOCTEST_REQUIRE(session.until([&] { return app.model().document != nullptr; }));
    app.update(session.preview);
    const auto& toasts = app.model().toasts;
    const auto offer = std::find_if(toasts.begin(), toasts.end(),
                                    [](const auto& toast) { return toast.button == "Read them so"; });
    DOCTEST_REQUIRE(offer != toasts.end());
    app.run(command::PressToast{static_cast<std::size_t>(offer - toasts.begin())});
    DOCTEST_REQUIRE(session.until([&] { return app.document().state().info.activated; }));
    const auto scales = app.document().state().current.log_scale();
    double worst = 0;
    for (std::size_t i = 0; i < scales.size(); ++i)
        worst = std::max(worst, std::abs(static_cast<double>(scales[i]) - raw.log_scale()[i]));
    DOCTEST_CHECK(worst < 1e-5);
    app.shut_down();
}

}  // namespace scene_origin_ui_test
