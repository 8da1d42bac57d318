// Figures of scans against truth made by hand, on scenes of a few splats.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "engine/laboratory/eval/real/real_figures.h"
#include "engine/laboratory/eval/real/real_summary.h"

namespace real_figures_test {

namespace {

using namespace gse;
using namespace gse::bench;
using Json = nlohmann::ordered_json;

// Values are kept as float.
constexpr double Rounding = 1e-6;

float logit(double opacity) { return static_cast<float>(std::log(opacity / (1 - opacity))); }

/// Grey balls at these points.
GaussianSet balls(const std::vector<Vec3>& points, double opacity, double size = 0.1) {
    GaussianData data;
    data.resize(points.size());
    for (std::size_t row = 0; row < points.size(); ++row) {
        for (int axis = 0; axis < 3; ++axis) {
            data.position[row * 3 + static_cast<std::size_t>(axis)] = static_cast<float>(points[row][axis]);
            data.log_scale[row * 3 + static_cast<std::size_t>(axis)] = static_cast<float>(std::log(size));
        }
        data.rotation[row * 4] = 1;
        data.opacity_logit[row] = logit(opacity);
    }
    return GaussianSet(std::move(data));
}

/// A wall of balls in the plane x = 0, -1 to 1 in y and z.
std::vector<Vec3> wall() {
    std::vector<Vec3> points;
    for (int y = -10; y <= 10; ++y)
        for (int z = -10; z <= 10; ++z) points.push_back({0, y / 10.0, z / 10.0});
    return points;
}

TruthRegion half(double sign) { return TruthRegion::Shape(TruthRegion::Halfspace{{0, sign, 0}, 0}); }

RealScene scene_with_front(double front) { return {"scene", {}, "-y", front, true, {20, 140, 260}, {}}; }

RealTask task_of_kind(const std::string& kind) {
    RealTask task;
    task.kind = kind;
    task.about = "thing";
    return task;
}

Json run_of(const std::string& ending, double iou) {
    Json run{
        {"ending", ending}, {"seconds", 2.0}, {"confidence", 0.5}, {"level", "green"}, {"warned", false}};
    if (ending == "refused") run["cause"] = "unsure";
    else run["opacity"] = {{"iou", iou}, {"recall", iou}, {"precision", 1.0}};
    return run;
}

Json task_of(const std::string& name, bool known, const std::string& kind, const Json& runs) {
    return {{"task", name},        {"scene", "s"},     {"source", "bear"},
            {"prompt", "a bear"},  {"kind", kind},     {"runs", runs},
            {"known_word", known}, {"sheet", "a.png"}, {"row", 1}};
}

Json report_of(const Json& tasks) {
    return {{"tasks", tasks},
            {"scenes",
             {{{"scene", "s"}, {"up", {{"truth", "z"}, {"guess", "z"}, {"result", "right"}}}},
              {{"scene", "t"}, {"up", {{"truth", "z"}, {"guess", "-y"}, {"result", "asked"}}}}}}};
}

}  // namespace

DOCTEST_TEST_CASE("an overlap is weighted, and leaves out rows that count neither way") {
    const Rows label{1, 1, 0, 0, 1};
    const TruthRows truth{{1, 0, 1, 0, 0}, {0, 0, 0, 0, 1}};
    const auto weighted = row_overlap(label, truth, {4, 1, 3, 9, 9});
    DOCTEST_CHECK(weighted.iou == doctest::Approx(4.0 / 8));
    DOCTEST_CHECK(weighted.recall == doctest::Approx(4.0 / 7));
    DOCTEST_CHECK(weighted.precision == doctest::Approx(4.0 / 5));
    const auto none = row_overlap(Rows(5), {Rows(5), Rows(5)}, {1, 1, 1, 1, 1});
    DOCTEST_CHECK(none.iou == 0);
    DOCTEST_CHECK(none.recall == 0);
    DOCTEST_CHECK(none.precision == 0);
}

DOCTEST_TEST_CASE("truth is made in the world of the file, and a thing ends where nothing is sure") {
    const auto set = balls({{0, -1, 0}, {0, 1, 0}, {0, -6, 0}}, 0.5);
    const auto centres = world_centres(set, {0, 5, 0});
    DOCTEST_CHECK(centres[0] == Vec3{0, 4, 0});
    const RealThing below{half(1), {}};
    DOCTEST_CHECK(truth_rows(below, centres).thing == Rows{0, 0, 1});
    const RealThing all{half(-1), {TruthRegion::Shape(TruthRegion::Halfspace{{0, -1, 0}, -5})}};
    const auto rows = truth_rows(all, centres);
    DOCTEST_CHECK(rows.thing == Rows{1, 0, 0});
    DOCTEST_CHECK(rows.either == Rows{0, 1, 0});
}

DOCTEST_TEST_CASE("rows are new by their position, and in place by their opacity") {
    const auto before = balls({{0, 0, 0}, {1, 0, 0}}, 0.5);
    const auto after = balls({{1, 0, 0}, {0, -2, 0}, {0, 2, 0}, {0, 3, 0}}, 0.5);
    const auto added = new_rows(after, before);
    DOCTEST_CHECK(added == Rows{0, 1, 1, 1});
    auto data = after.to_data();
    data.opacity_logit[1] = logit(0.9);
    data.opacity_logit[2] = logit(0.1);
    data.opacity_logit[3] = logit(0.2);
    const auto share = place_share(half(1), GaussianSet(data), added, {});
    DOCTEST_REQUIRE(share.has_value());
    DOCTEST_CHECK(share->opacity == doctest::Approx(0.9 / 1.2).epsilon(Rounding));
    DOCTEST_CHECK(share->plain == doctest::Approx(1.0 / 3));
    // In a world whose origin lies four lower, none of them is below 0.
    DOCTEST_CHECK(place_share(half(1), GaussianSet(data), added, {0, 4, 0})->opacity == 0);
    DOCTEST_CHECK(!place_share(half(1), after, Rows(4), {}).has_value());
}

DOCTEST_TEST_CASE("a quantile lies between its neighbours, without values that are not finite") {
    std::vector<double> values{4, 1, std::nan(""), 3, 2};
    DOCTEST_CHECK(quantile_of(values, 0) == 1);
    DOCTEST_CHECK(quantile_of(values, 1) == 4);
    DOCTEST_CHECK(quantile_of(values, 0.5) == doctest::Approx(2.5));
    DOCTEST_CHECK(quantile_of(values, 0.1) == doctest::Approx(1.3));
    std::vector<double> none;
    DOCTEST_CHECK(quantile_of(none, 0.5) == 0);
}

DOCTEST_TEST_CASE(
    "cameras stand around the thing, from its front on, and see a small part with its surroundings") {
    const auto points = wall();
    const auto set = balls(points, 0.9);
    const auto scene = scene_with_front(90);
    const Rows all(points.size(), 1);
    const auto whole = real_cameras(scene, task_of_kind("recolour"), set, {}, all);
    DOCTEST_REQUIRE(whole.sides.size() == 3);
    DOCTEST_CHECK(whole.sides[0].width == RealPictureSide);
    const auto distance = [](const RealCameras& cameras) { return length(cameras.sides[0].centre()); };
    // Up is -y: every side looks down by 15 degrees, the last by 50.
    for (const auto& camera : whole.sides)
        DOCTEST_CHECK(camera.forward().y == doctest::Approx(std::sin(15 * pipeline::Degree)));
    DOCTEST_CHECK(whole.above.forward().y == doctest::Approx(std::sin(50 * pipeline::Degree)));
    // Azimuth 0 is the side nearest to -z; the front lies at 90, and the first side 20 further.
    const Vec3 side = normalized(whole.sides[0].centre());
    DOCTEST_CHECK(std::abs(side.x) ==
                  doctest::Approx(std::cos(15 * pipeline::Degree) * std::sin(110 * pipeline::Degree)));
    Rows few(points.size());
    few[points.size() / 2] = 1;
    const auto part = real_cameras(scene, task_of_kind("recolour"), set, {}, few);
    DOCTEST_CHECK(distance(part) < 0.5 * distance(whole));
    DOCTEST_CHECK(distance(part) > 0.2 * distance(whole));
    // All of a ground is shown, and the place of an addition too.
    DOCTEST_CHECK(distance(real_cameras(scene, task_of_kind("ground"), set, {}, few)) == distance(whole));
    auto add = task_of_kind("add");
    add.place_box = Bounds{{0, -9, 0}, {0, -8, 0}};
    DOCTEST_CHECK(distance(real_cameras(scene, add, set, {}, all)) > 2 * distance(whole));
    const auto moved = real_cameras(scene, add, set, {0, -9, 0}, all);
    DOCTEST_CHECK(distance(moved) < distance(real_cameras(scene, add, set, {}, all)));
}

DOCTEST_TEST_CASE("what is seen is what stands in front, and change is counted within it and beside it") {
    auto points = wall();
    const auto front = points.size();
    for (std::size_t row = 0; row < front; ++row) points.push_back({0.5, points[row].y, points[row].z});
    const auto set = balls(points, 0.99);
    Rows behind(points.size());
    std::fill(behind.begin(), behind.begin() + static_cast<std::ptrdiff_t>(front), std::uint8_t{1});
    Rows upper(points.size());
    for (std::size_t row = 0; row < points.size(); ++row) upper[row] = points[row].y < 0 ? 1 : 0;
    // Seen along x, the two walls hide each other from opposite sides.
    RealScene scene = scene_with_front(90);
    scene.sides = {0, 180, 0};
    const Rows all(points.size(), 1);
    const auto cameras = real_cameras(scene, task_of_kind("recolour"), set, {}, all);
    pipeline::Painter painter;
    const auto far = seen_rows(painter, set, behind, cameras);
    const auto whole = seen_rows(painter, set, all, cameras);
    DOCTEST_REQUIRE(far.size() == 4);
    const bool first_sees = far[0].count() > far[1].count();
    DOCTEST_CHECK(std::max(far[0].count(), far[1].count()) > whole[0].count() / 2);
    DOCTEST_CHECK(std::min(far[0].count(), far[1].count()) < whole[first_sees ? 1 : 0].count() / 4);
    DOCTEST_CHECK(seen_overlap(whole, whole).iou == 1);
    const auto overlap = seen_overlap(far, whole);
    DOCTEST_CHECK(overlap.precision == 1);
    DOCTEST_CHECK(overlap.recall < 1);

    const auto truth = seen_rows(painter, set, upper, cameras);
    auto data = set.to_data();
    for (std::size_t row = 0; row < points.size(); ++row)
        if (upper[row] != 0) std::fill_n(data.sh.begin() + static_cast<std::ptrdiff_t>(row * 3), 3, 1.5f);
    std::vector<Image> before, after, same;
    for (const auto& camera : cameras.sides) {
        before.push_back(real_picture(painter, set, {}, camera));
        after.push_back(real_picture(painter, GaussianSet(data), {}, camera));
    }
    const auto change = seen_change(before, after, truth);
    // The picture from above belongs to the divisor alone.
    const double sides =
        1 - static_cast<double>(truth[3].count()) / static_cast<double>(truth[0].count() + truth[1].count() +
                                                                        truth[2].count() + truth[3].count());
    DOCTEST_CHECK(change.in_truth == doctest::Approx(sides).epsilon(0.02));
    // Splats at the border show faintly beyond it.
    DOCTEST_CHECK(change.spill < change.in_truth / 4);
    DOCTEST_CHECK(seen_change(before, before, truth).in_truth == 0);
}

DOCTEST_TEST_CASE("groups count words apart from boxes, and refusals by cause") {
    Json warned = run_of("done", 0.3);
    warned["level"] = "amber";
    const auto summary = real_summary(report_of(
        {task_of("a", true, "recolour", {{"word", run_of("done", 0.9)}, {"box", run_of("done", 0.4)}}),
         task_of("b", true, "recolour", {{"word", run_of("kept out", 0.2)}}),
         task_of("c", true, "recolour", {{"word", warned}}),
         task_of("d", true, "recolour", {{"word", run_of("refused", 0)}}),
         task_of("e", false, "recolour", {{"word", run_of("done", 0.1)}})}));
    DOCTEST_REQUIRE(summary["groups"].size() == 3);
    const auto& known = summary["groups"][0];
    DOCTEST_CHECK(known["runs"] == 4);
    DOCTEST_CHECK(known["done"] == 2);
    DOCTEST_CHECK(known["kept_out"] == 1);
    DOCTEST_CHECK(known["refused"] == 1);
    DOCTEST_CHECK(known["causes"]["unsure"] == 1);
    DOCTEST_CHECK(known["labels"] == 3);
    DOCTEST_CHECK(known["iou_mean"] == doctest::Approx(1.4 / 3));
    DOCTEST_CHECK(known["iou_median"] == doctest::Approx(0.3));
    DOCTEST_CHECK(known["iou_below_half"] == 2);
    DOCTEST_CHECK(known["iou_below_half_not_amber"] == 0);  // one is amber, one kept out
    DOCTEST_CHECK(known["silent"] == 0);
    DOCTEST_CHECK(known["place_mean"].is_null());
    DOCTEST_CHECK(summary["groups"][1]["iou_below_half_not_amber"] == 1);
    DOCTEST_CHECK(summary["groups"][2]["name"] == "by box");
    DOCTEST_REQUIRE(summary["silent"].size() == 2);
    DOCTEST_CHECK(summary["silent"][0]["task"] == "a");
    DOCTEST_CHECK(summary["silent"][0]["mode"] == "box");
    DOCTEST_CHECK(summary["silent"][1]["task"] == "e");
    DOCTEST_CHECK(summary["up"]["right"] == 1);
    DOCTEST_CHECK(summary["up"]["asked"] == 1);
    DOCTEST_CHECK(summary["up"]["wrong"] == 0);
}

DOCTEST_TEST_CASE("an addition that adds nothing is in no place, and a low place or change is silent") {
    const auto add = [](double share) {
        Json run = run_of("done", 0);
        run.erase("opacity");
        if (share >= 0) run["place_share"] = share;
        return run;
    };
    Json unchanged = run_of("done", 0.95);
    unchanged["seen_change_in_truth"] = 0.1;
    unchanged["front_error"] = 120.0;
    Json near = run_of("done", 0.95), turned = near;
    turned["front_error"] = 47.0;
    near["front_error"] = 10.0;
    const auto report = report_of({task_of("in", true, "add", {{"box", add(0.9)}}),
                                   task_of("beside", true, "add", {{"box", add(0.2)}}),
                                   task_of("nothing", true, "add", {{"box", add(-1)}}),
                                   task_of("same", true, "recolour", {{"box", unchanged}}),
                                   task_of("good", true, "recolour", {{"box", near}, {"word", turned}})});
    const auto summary = real_summary(report);
    const auto& box = summary["groups"][1];
    DOCTEST_CHECK(box["places"] == 3);
    DOCTEST_CHECK(box["place_mean"] == doctest::Approx(1.1 / 3));
    DOCTEST_CHECK(box["place_low"] == 2);
    DOCTEST_CHECK(box["silent"] == 3);
    DOCTEST_CHECK(summary["front"]["box"]["runs"] == 2);
    DOCTEST_CHECK(summary["front"]["box"]["within_15"] == 1);
    DOCTEST_CHECK(summary["front"]["box"]["beyond_90"] == 1);
    DOCTEST_CHECK(summary["front"]["box"]["error_mean"] == doctest::Approx(65));
    auto whole = report;
    whole["summary"] = summary;
    const auto table = real_table(whole);
    for (const char* text :
         {"beside, box: place 0.20", "same, box: seen change 0.10", "1 right, 0 wrong, 1 asked", "  s: 47\n",
          "t: asked (-y guessed, z is true)", "a.png, row 1: in: bear > \"a bear\" (add)"})
        DOCTEST_CHECK_MESSAGE(table.find(text) != std::string::npos, text);
}

}  // namespace real_figures_test
