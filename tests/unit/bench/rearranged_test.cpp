// Edits in which nothing is drawn: their suite, the maps of rows, true scenes, figures of holes.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "engine/base/thread_pool.h"
#include "engine/edit/request/sentence_plan.h"
#include "engine/laboratory/eval/eval_compound.h"
#include "engine/laboratory/eval/eval_rearranged_summary.h"
#include "engine/laboratory/eval/hole_figures.h"
#include "engine/laboratory/eval/rearranged_truth.h"
#include "engine/raster/rasterizer.h"

namespace rearranged_test {

namespace {

using namespace gse;
using namespace gse::bench;
using Json = nlohmann::ordered_json;

constexpr int Cases = 30;  // every sentence of every kind at least once
// Values are kept as float: eight of its steps for a product of a few of them.
constexpr double Rounding = 8 * 1.2e-7;

synth::SceneSpec small_spec() {
    synth::SceneSpec spec;
    spec.gaussian_budget = 600;
    spec.seed = 5;
    return spec;
}

RowPairs same_rows(std::size_t count) {
    RowPairs pairs;
    for (std::size_t row = 0; row < count; ++row) pairs.emplace_back(row, row);
    return pairs;
}

EvalCase asking(const AskedPlace& asked) {
    EvalCase edit{"move", small_spec(), small_spec(), {}, {}, {}};
    edit.asked = asked;
    return edit;
}

Image plain(float value) { return Image(16, 16, 3, value); }

}  // namespace

DOCTEST_TEST_CASE("every sentence of the suite is one step of the operation that its kind names") {
    const std::map<std::string, std::string> operations{{"remove", "remove"},
                                                        {"resize", "transform"},
                                                        {"move", "transform"},
                                                        {"rotate", "transform"},
                                                        {"duplicate", "duplicate"}};
    for (const auto& edit : make_suite(3, Cases, rearranged_kinds())) {
        edit::EditRequest request;
        request.source = edit.word;
        request.prompt = edit.prompt;
        const auto plan = edit::plan_of(request, language::plan::scene_words(scene_words_of(edit.source)));
        DOCTEST_CAPTURE(edit.prompt);
        DOCTEST_REQUIRE(plan.steps.size() == 1);
        DOCTEST_CHECK(std::string(name_of(plan.steps.front().operation)) == operations.at(edit.kind));
    }
}

DOCTEST_TEST_CASE("half of the removals are of scans, and other kinds do not depend on these") {
    int scans = 0;
    for (const auto& edit : make_suite(3, 10, {"remove"})) scans += edit.asked.scanned ? 1 : 0;
    DOCTEST_CHECK(scans == 5);
    const auto alone = make_suite(3, 4, {"add"}), among = make_suite(3, 8, {"add", "remove"});
    for (std::size_t i = 0; i < alone.size(); ++i) DOCTEST_CHECK(alone[i].prompt == among[2 * i].prompt);
}

DOCTEST_TEST_CASE("rows under a map have no error against it, and the shift of it is found again") {
    const auto scene = directional_scene(small_spec());
    const auto axes = front_axes(scene.spec);
    const auto& rows = scene.scene.gaussians;
    const auto extent = extent_of(rows, axes);
    const auto map =
        asked_map(asking({.size = 1.3, .degrees = 40, .right = 1, .distance = 0.5}), extent, axes);
    const GaussianSet there = placed(rows, map);
    const auto error = map_error(rows, there, same_rows(rows.size()), map);
    const double reach = 8;  // world units: the ground and the move
    DOCTEST_CHECK(error.position < reach * Rounding);
    DOCTEST_CHECK(error.covariance < Rounding);
    DOCTEST_CHECK(error.colour < Rounding);
    DOCTEST_CHECK(length(fitted_shift(rows, there, same_rows(rows.size()), map) - map.shift) <
                  reach * Rounding);
}

DOCTEST_TEST_CASE("a wrong turn, size or colour shows in its own error") {
    const auto scene = directional_scene(small_spec());
    const auto& rows = scene.scene.gaussians;
    const auto axes = front_axes(scene.spec);
    const auto pairs = same_rows(rows.size());
    const auto turned = asked_map(asking({.degrees = 5}), extent_of(rows, axes), axes);
    const auto error = map_error(rows, placed(rows, turned), pairs, {});
    DOCTEST_CHECK(error.position > 0.01);
    DOCTEST_CHECK(error.colour > 1e-3);
    synth::Placing larger;
    larger.size = 1.1;
    DOCTEST_CHECK(map_error(rows, placed(rows, larger), pairs, {}).covariance > 0.1);
}

DOCTEST_TEST_CASE("a thing that is moved to the right is farther right in the picture from its front") {
    const auto spec = small_spec();
    const auto axes = front_axes(spec);
    const auto scene = synth::generate(spec);
    const Camera camera = synth::scene_camera(scene, synth::turn_of(spec), 0.3, 1, 64, 64);
    const Vec3 right = camera.rotation * axes.right;
    DOCTEST_CHECK(right.x == doctest::Approx(1));
    DOCTEST_CHECK(dot(camera.forward(), axes.forward) < -0.9);
    DOCTEST_CHECK(dot(cross(axes.right, axes.up), axes.forward) == doctest::Approx(1));
}

DOCTEST_TEST_CASE("the ground alone is the scene's ground without its shadow") {
    const auto scene = synth::generate(small_spec());
    const GaussianSet alone = synth::ground_under(scene.spec, {});
    const synth::Placing same;
    const GaussianSet under = synth::ground_under(scene.spec, {&same, 1});
    const auto dark = shadowed_rows(scene);
    std::size_t darker = 0;
    for (std::size_t row = 0; row < alone.size(); ++row) {
        DOCTEST_CHECK(scene.parts[row] == synth::Part::Ground);
        for (std::size_t k = row * 3; k < row * 3 + 3; ++k) {
            DOCTEST_CHECK(alone.position()[k] == scene.scene.gaussians.position()[k]);
            DOCTEST_CHECK(under.sh()[k] == doctest::Approx(scene.scene.gaussians.sh()[k]));
            DOCTEST_CHECK(alone.sh()[k] >= under.sh()[k]);
        }
        darker += dark[row];
    }
    DOCTEST_CHECK(darker > 0);
    DOCTEST_CHECK(darker < alone.size());
}

DOCTEST_TEST_CASE("a scan lacks ground beneath the thing and nothing of the thing") {
    ThreadPool pool(2);
    const auto rasterizer = raster::make_fast_rasterizer(pool);
    const auto scene = synth::generate(small_spec());
    const auto scan = scanned(scene, *rasterizer);
    const auto count = [](const synth::SynthScene& of, synth::Part part) {
        return std::count(of.parts.begin(), of.parts.end(), part);
    };
    DOCTEST_CHECK(count(scan, synth::Part::Ground) < count(scene, synth::Part::Ground));
    DOCTEST_CHECK(count(scan, synth::Part::Object) == count(scene, synth::Part::Object));
    DOCTEST_CHECK(scan.scene.gaussians.size() == scan.parts.size());
}

DOCTEST_TEST_CASE(
    "figures of a hole count its pixels only, and a plain colour is as good as the truth where "
    "that is plain") {
    Mask hole(16, 16);
    hole.at(8, 8) = hole.at(9, 8) = 1;
    Image deleted = plain(0.5f), healed = plain(0.5f);
    for (const int x : {8, 9})
        for (int c = 0; c < 3; ++c) deleted.at(x, 8, c) = 0, healed.at(x, 8, c) = 0.6f;
    healed.at(0, 0, 0) = 1;  // outside
    HoleFigures figures;
    figures.add(plain(0.5f), deleted, healed, hole);
    const Json json = figures.json();
    DOCTEST_CHECK(json["psnr_hole_db"].get<double>() == doctest::Approx(20).epsilon(1e-3));
    DOCTEST_CHECK(json["psnr_hole_deleted_db"].get<double>() ==
                  doctest::Approx(-20 * std::log10(0.5)).epsilon(1e-3));
    DOCTEST_CHECK(json["psnr_hole_mean_db"].get<double>() > 60);
    DOCTEST_CHECK(json["hole_share"].get<double>() == doctest::Approx(2.0 / 256));
    DOCTEST_CHECK(HoleFigures().json()["psnr_hole_db"].is_null());
}

DOCTEST_TEST_CASE("the summary tells the largest of errors and the mean of the rest") {
    const auto entry = [](double place, double position) {
        return Json{{"index", 0},
                    {"kind", "move"},
                    {"prompt", "move the bear to the left"},
                    {"scanned", false},
                    {"judgement", {{"passed", true}}},
                    {"rearranged", {{"place_error", place}, {"position_error", position}}}};
    };
    Json failed = entry(9, 9);
    failed["error"] = "not found";
    const Json edits = Json::array({entry(0.1, 1e-7), entry(0.3, 3e-7), failed});
    const Json summary = rearranged_summary(edits);
    DOCTEST_CHECK(summary["move_place_error"].get<double>() == doctest::Approx(0.2));
    DOCTEST_CHECK(summary["move_position_error"].get<double>() == doctest::Approx(3e-7));
    DOCTEST_CHECK(summary["move_edits"] == 2);
    DOCTEST_CHECK(rearranged_lines(edits).find("move the bear to the left") != std::string::npos);
    DOCTEST_CHECK(rearranged_lines(Json::array()).empty());
}

}  // namespace rearranged_test
