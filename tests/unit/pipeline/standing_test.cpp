// Up and frame of scanned scenes: guesses against truth, and haze around a scene against the scene alone.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <fmt/core.h>

#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/io/project/load_scene.h"
#include "engine/pipeline/report/scene_report.h"
#include "engine/pipeline/scene/scene_loading.h"
#include "engine/pipeline/scene/scene_tools.h"
#include "tests/test_paths.h"

namespace standing_test {

namespace {

using namespace gse;
using test::available;

double orbit_radius(const std::filesystem::path& path) {
    return pipeline::scene_orbit(load_scene(path), {}).radius;
}

}  // namespace

DOCTEST_TEST_CASE("scanned scenes stand up, or the program asks") {
    constexpr double LeastRight = 0.9;  // share of the scenes that open upright
    const auto folder = test::shared_folder() / "data/real";
    if (!available(folder / "suite.json")) return;
    const auto suite = parse_json(read_file(folder / "suite.json"), "the suite");
    std::size_t right = 0, asked = 0, all = 0;
    for (const auto& one : suite["scenes"]) {
        const auto root = suite["roots"][one["root"].get<std::string>()].get<std::string>();
        const auto path = folder / root / one["file"].get<std::string>();
        if (!available(path)) continue;
        Scene scene = load_scene(path);
        const Vec3 truth = pipeline::parse_up(one["up"].get<std::string>(), scene.info);
        const auto guess = pipeline::guess_up(scene.info, scene.gaussians);
        DOCTEST_REQUIRE(guess);
        const auto text = fmt::format("{}: {} with {:.2f}", one["name"].get<std::string>(),
                                      direction_name(guess->best), guess->confidence());
        DOCTEST_CAPTURE(text);
        DOCTEST_CHECK((guess->up() == truth || !guess->sure()));
        DOCTEST_CHECK(scene.info.up_unsure == !guess->sure());
        ++all;
        if (scene.info.up == truth) ++right;
        if (!guess->sure()) ++asked;
    }
    DOCTEST_CHECK(static_cast<double>(right) >= LeastRight * static_cast<double>(all));
    DOCTEST_CHECK(static_cast<double>(asked) <= (1 - LeastRight) * static_cast<double>(all));
}

DOCTEST_TEST_CASE("the orbit around a hazy scene is that around the scene alone, and the report says why") {
    constexpr double SameOrbit = 0.03;  // a few of the outermost splats go with the haze
    const auto folder = test::shared_folder() / "data/odd/02_far_haze_or_sky_no_cameras";
    if (!available(folder)) return;
    const double alone = orbit_radius(folder / "haze00_control/scene.ply");
    for (const char* name : {"haze1_500", "haze2_300", "haze04_haze_with_cameras"}) {
        const auto path = folder / name / "scene.ply";
        DOCTEST_CAPTURE(name);
        DOCTEST_CHECK(orbit_radius(path) == doctest::Approx(alone).epsilon(SameOrbit));
        const auto statistics = compute_statistics(load_scene(path).gaussians);
        DOCTEST_CHECK(statistics.haze_rows + statistics.sky_rows >= 300);
        DOCTEST_CHECK(pipeline::surroundings_note(statistics).find(" far around the scene are ") !=
                      std::string::npos);
        DOCTEST_CHECK(pipeline::report_text(pipeline::scene_report(path)).find("framed without them") !=
                      std::string::npos);
    }
    const auto control = compute_statistics(load_scene(folder / "haze00_control/scene.ply").gaussians);
    DOCTEST_CHECK(pipeline::surroundings_note(control).empty());
}

DOCTEST_TEST_CASE("no shared scene is taken for hazy: its frame is the old one") {
    const auto folder = test::shared_folder() / "data";
    for (const char* part : {"scenes", "real/scenes"}) {
        if (!available(folder / part)) continue;
        for (const auto& entry : std::filesystem::directory_iterator(folder / part)) {
            DOCTEST_CAPTURE(entry.path().string());
            const auto statistics = compute_statistics(load_scene(entry.path()).gaussians);
            DOCTEST_CHECK(statistics.haze_rows + statistics.sky_rows == 0);
        }
    }
}

}  // namespace standing_test
