// A scene's cameras: which count, what is said of those that do not, and what they tell about up.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/io/cameras/cameras.h"
#include "engine/io/project/load_scene.h"
#include "engine/io/scene/scene_file.h"
#include "engine/laboratory/synth/synth.h"
#include "engine/pipeline/report/scene_report.h"
#include "engine/pipeline/scene/scene_loading.h"
#include "engine/pipeline/scene/scene_tools.h"
#include "engine/scene/origin/world_offset.h"
#include "tests/test_paths.h"

namespace scene_loading_test {

namespace {

using namespace gse;
using test::ScratchFolder;

/// A scene whose file does not say which way is up.
std::filesystem::path some_scene(const ScratchFolder& scratch) {
    Scene scene = synth::generate({}).scene;
    scene.info.up_known = false;
    const auto path = scratch.path() / "scene.ply";
    save_scene(path, scene);
    return path;
}

std::vector<View> around(const std::filesystem::path& scene, const Vec3& up) {
    return orbit_views(fit_orbit(compute_statistics(load_scene(scene).gaussians), up), 6, 64, 64);
}

}  // namespace

DOCTEST_TEST_CASE("cameras beside a scene are taken, and tell which way is up where the file does not") {
    const ScratchFolder scratch;
    const auto scene = some_scene(scratch);
    DOCTEST_CHECK(pipeline::load_scene_with_cameras(scene).views.empty());
    save_cameras_json(scratch.path() / "cameras.json", around(scene, {0, 0, 1}));
    const auto loaded = pipeline::load_scene_with_cameras(scene);
    DOCTEST_CHECK(loaded.views.size() == 6);
    DOCTEST_CHECK(loaded.scene.info.up.z > 0.99);
    DOCTEST_CHECK(loaded.notes.size() == 1);
    const auto without = pipeline::load_scene_with_cameras(scene, "none");
    DOCTEST_CHECK(without.views.empty());
    DOCTEST_CHECK(without.scene.info.up.y < -0.99);
    DOCTEST_CHECK(without.notes.empty());
}

DOCTEST_TEST_CASE("a broken camera file is noted, one that was named is an error") {
    const ScratchFolder scratch;
    const auto scene = some_scene(scratch);
    const auto cameras = scratch.path() / "cameras.json";
    write_file(cameras, "[{\"id\": 0");
    const auto loaded = pipeline::load_scene_with_cameras(scene);
    DOCTEST_CHECK(loaded.views.empty());
    DOCTEST_REQUIRE(loaded.notes.size() == 1);
    DOCTEST_CHECK(loaded.notes[0].find("cannot be used") != std::string::npos);
    DOCTEST_CHECK_THROWS_AS(pipeline::load_scene_with_cameras(scene, cameras.string()), Error);
}

DOCTEST_TEST_CASE("one bad camera beside a scene costs that camera, and a note names it") {
    const ScratchFolder scratch;
    const auto scene = some_scene(scratch);
    save_cameras_json(scratch.path() / "cameras.json", around(scene, {0, 0, 1}));
    auto entries = try_parse_json(read_file(scratch.path() / "cameras.json"));
    entries[2]["img_name"] = "third.png";
    entries[2]["position"] = nullptr;
    write_file(scratch.path() / "cameras.json", entries.dump());
    const auto loaded = pipeline::load_scene_with_cameras(scene);
    DOCTEST_CHECK(loaded.views.size() == 5);
    DOCTEST_REQUIRE(loaded.notes.size() == 2);  // the other one tells which way is up
    DOCTEST_CHECK(loaded.notes[0].find("third.png") != std::string::npos);
    const auto report = pipeline::scene_report(scene);
    DOCTEST_CHECK(report.at("cameras") == 5);
    DOCTEST_CHECK(report.at("warnings").dump().find("third.png") != std::string::npos);
}

DOCTEST_TEST_CASE("cameras that cannot be used do not hide what the report says of their scene") {
    const ScratchFolder scratch;
    const auto scene = some_scene(scratch);
    const auto whole = pipeline::scene_report(scene);
    write_file(scratch.path() / "cameras.json", "[{\"id\": 0");
    const auto report = pipeline::scene_report(scene);
    DOCTEST_CHECK(report.at("splats") == whole.at("splats"));
    DOCTEST_CHECK(report.at("bounds") == whole.at("bounds"));
    DOCTEST_CHECK(report.at("cameras") == 0);
    DOCTEST_REQUIRE(report.at("warnings").size() == whole.at("warnings").size() + 1);
    const std::string text = pipeline::report_text(report);
    DOCTEST_CHECK(text.find("the cameras beside the scene cannot be used") != std::string::npos);
    DOCTEST_CHECK(text.find("cameras.json") != std::string::npos);
}

DOCTEST_TEST_CASE("cameras that look elsewhere are left out, with a word, and say nothing about up") {
    const ScratchFolder scratch;
    const auto scene = some_scene(scratch);
    auto views = around(scene, {0, 0, 1});
    for (auto& view : views) view.camera.translation = view.camera.translation + Vec3{1000, 0, 0};
    save_cameras_json(scratch.path() / "cameras.json", views);
    const auto loaded = pipeline::load_scene_with_cameras(scene);
    DOCTEST_CHECK(loaded.views.empty());
    DOCTEST_REQUIRE(loaded.notes.size() == 1);
    DOCTEST_CHECK(loaded.notes[0].find("elsewhere") != std::string::npos);
    DOCTEST_CHECK(loaded.scene.info.up.y < -0.99);
}

DOCTEST_TEST_CASE("cameras of a world far from the origin follow its scene, those made near it stay") {
    const ScratchFolder scratch;
    const Vec3 utm{455123, 5410987, 321};
    constexpr double rounding = 1e-6;  // of doubles of that size, and of numbers in the file
    Scene scene = synth::generate({}).scene;
    scene.info.offset = utm;
    const auto path = scratch.path() / "scene.ply";
    save_scene(path, scene);
    const auto near = around(path, {0, -1, 0});
    const auto far_off = [&](const std::vector<View>& views) {
        double worst = 0;
        for (std::size_t i = 0; i < views.size(); ++i)
            worst = std::max(worst, length(views[i].camera.centre() - near[i].camera.centre()));
        return worst;
    };
    for (const bool in_world : {true, false}) {
        save_cameras_json(scratch.path() / "cameras.json", in_world ? moved(near, utm) : near);
        const auto loaded = pipeline::load_scene_with_cameras(path);
        DOCTEST_REQUIRE(loaded.views.size() == near.size());
        DOCTEST_CHECK(loaded.scene.info.offset == utm);
        DOCTEST_CHECK(far_off(loaded.views) < rounding);
    }
    save_cameras_json(scratch.path() / "cameras.json", moved(near, utm));
    pipeline::RenderParameters picture;
    picture.view = 2;
    const Camera chosen = pipeline::choose_camera(load_scene(path), path, picture);
    DOCTEST_CHECK(length(chosen.centre() - near[2].camera.centre()) < rounding);
    const auto orbit = pipeline::viewpoints_of(path, 6);  // to be written: of the world
    DOCTEST_CHECK(length(orbit[0].camera.centre() - utm) < 100);
    DOCTEST_CHECK(length(pipeline::viewpoints_of(path)[1].camera.centre() - near[1].camera.centre() - utm) <
                  rounding);
}

}  // namespace scene_loading_test
