// Label operations: areas of the screen against exact geometry, set algebra, growing, histogram.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include "engine/scene/label_ops.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/scene/random_sets.h"

namespace label_ops_test {

using namespace gse;
using namespace gse::test;

namespace {

constexpr double PixelTolerance = 0.75;  // areas are exact to half a pixel in x and y: a diagonal of 0.71

GaussianSet cloud(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    GaussianData data;
    data.resize(count);
    for (float& value : data.position) value = static_cast<float>(random.uniform(-1, 1));
    for (float& value : data.opacity_logit) value = 2;
    return GaussianSet(std::move(data));
}

Camera camera_at(double distance) {
    return Camera::look_at({0, 0, -distance}, {0, 0, 0}, {0, -1, 0}, 0.9, 400, 300);
}

struct Pixel {
    double x = 0, y = 0, z = 0;
};

Pixel project(const GaussianSet& set, const Camera& camera, std::size_t row) {
    const auto p = set.position();
    const Vec3 c = camera.to_camera({static_cast<double>(p[row * 3]), static_cast<double>(p[row * 3 + 1]),
                                     static_cast<double>(p[row * 3 + 2])});
    return {camera.fx * c.x / c.z + camera.cx, camera.fy * c.y / c.z + camera.cy, c.z};
}

/// A line of splats one unit apart, label on those in [from, to).
NamedLabel line_label(std::size_t count, std::size_t from, std::size_t to) {
    std::vector<std::uint8_t> rows(count, 0);
    for (std::size_t row = from; row < to; ++row) rows[row] = 1;
    return combine(empty_label("line", count), rows, LabelOperation::Add);
}

GaussianSet line_set(std::size_t count) {
    GaussianData data;
    data.resize(count);
    for (std::size_t row = 0; row < count; ++row) data.position[row * 3] = static_cast<float>(row);
    return GaussianSet(std::move(data));
}

}  // namespace

DOCTEST_TEST_CASE("a polygon and a brush pick the rows whose centres they cover") {
    const GaussianSet set = cloud(5000, 1);
    const Camera camera = camera_at(4);
    ScreenArea rectangle;
    rectangle.polygon = {{100, 80}, {300, 80}, {300, 200}, {100, 200}};
    ScreenArea brush;
    brush.circles = {{150, 120}, {260, 160}};
    brush.radius_px = 30;
    const auto in_rectangle = rows_in_area(set, camera, rectangle);
    const auto in_brush = rows_in_area(set, camera, brush);
    std::size_t inside = 0;
    for (std::size_t row = 0; row < set.size(); ++row) {
        const Pixel p = project(set, camera, row);
        const double dx = std::max(100 - p.x, p.x - 300), dy = std::max(80 - p.y, p.y - 200);
        const double outside = std::max(dx, dy);
        if (outside < -PixelTolerance) DOCTEST_CHECK(in_rectangle[row] == 1);
        if (outside > PixelTolerance) DOCTEST_CHECK(in_rectangle[row] == 0);
        inside += in_rectangle[row];
        // Distance to the stroke's segment.
        const double t =
            std::clamp(((p.x - 150) * 110 + (p.y - 120) * 40) / (110.0 * 110 + 40.0 * 40), 0.0, 1.0);
        const double away = std::hypot(p.x - 150 - 110 * t, p.y - 120 - 40 * t);
        if (away < 30 - 1.2) DOCTEST_CHECK(in_brush[row] == 1);  // the joined rim waves by under 1 %
        if (away > 30 + PixelTolerance) DOCTEST_CHECK(in_brush[row] == 0);
    }
    DOCTEST_CHECK(inside > 100);
    ThreadPool pool(2);
    PickOptions threaded;
    threaded.pool = &pool;
    DOCTEST_CHECK(rows_in_area(set, camera, rectangle, threaded) == in_rectangle);
}

DOCTEST_TEST_CASE("front only takes what the depth shows, invisible and hidden rows stay out") {
    GaussianSet set = cloud(3000, 2);
    GaussianData data = set.to_data();
    data.opacity_logit[0] = -20;
    data.position[0] = data.position[1] = data.position[2] = 0;
    data.position[3] = std::numeric_limits<float>::quiet_NaN();
    data.position[6] = 0, data.position[7] = 0, data.position[8] = -10;  // behind the camera
    set = GaussianSet(std::move(data));
    const Camera camera = camera_at(4);
    ScreenArea all;
    all.polygon = {{-10, -10}, {1000, -10}, {1000, 1000}, {-10, 1000}};
    Image depth(100, 75, 1, 4.0f);  // a quarter of the resolution; the wall is at the cloud's centre
    for (int y = 0; y < 75; ++y)
        for (int x = 50; x < 100; ++x) depth.at(x, y, 0) = 0;  // nothing seen on the right: no limit there
    PickOptions options;
    options.depth = &depth;
    const auto rows = rows_in_area(set, camera, all, options);
    DOCTEST_CHECK(rows[0] == 0);
    DOCTEST_CHECK(rows[1] == 0);
    DOCTEST_CHECK(rows[2] == 0);
    std::size_t hidden = 0;
    for (std::size_t row = 3; row < set.size(); ++row) {
        const Pixel p = project(set, camera, row);
        const bool on_screen = p.x >= 0 && p.y >= 0 && p.x < 400 && p.y < 300;
        const bool expected = on_screen && (p.x >= 200 || p.z <= 4.0 * (1 + options.depth_tolerance));
        DOCTEST_CHECK((rows[row] != 0) == expected);
        hidden += on_screen && !expected ? 1 : 0;
    }
    DOCTEST_CHECK(hidden > 100);
    DOCTEST_CHECK(rows_in_area(set, camera, {}) == std::vector<std::uint8_t>(set.size(), 0));
}

DOCTEST_TEST_CASE("rows outside a mask of the view do not count, at any resolution of it") {
    const GaussianSet set = cloud(3000, 3);
    const Camera camera = camera_at(4);
    ScreenArea all;
    all.polygon = {{-10, -10}, {1000, -10}, {1000, 1000}, {-10, 1000}};
    Mask upper(80, 60);  // a fifth of the resolution
    for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 80; ++x) upper.at(x, y) = 1;
    PickOptions options;
    options.mask = &upper;
    const auto rows = rows_in_area(set, camera, all, options), every = rows_in_area(set, camera, all);
    for (std::size_t row = 0; row < set.size(); ++row)
        DOCTEST_CHECK((rows[row] != 0) == (every[row] != 0 && project(set, camera, row).y < 150));
    DOCTEST_CHECK(std::count(rows.begin(), rows.end(), std::uint8_t{1}) > 500);
}

DOCTEST_TEST_CASE("operations are those of sets, and weights stay as they are") {
    DocumentState state;
    state.current = random_set(500, 0, 4);
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const NamedLabel label = random_label(state, seed);
        std::vector<std::uint8_t> rows(500);
        Random random(seed);
        for (auto& row : rows) row = random.below(2) != 0;
        const auto check = [&](const NamedLabel& result, auto expected) {
            DOCTEST_CHECK(result.weight == label.weight);
            bool all = true;
            for (std::size_t row = 0; row < 500; ++row)
                all &= (*result.bits)[row] == (expected((*label.bits)[row] != 0, rows[row] != 0) ? 1 : 0);
            DOCTEST_CHECK(all);
        };
        check(combine(label, rows, LabelOperation::Add), [](bool a, bool b) { return a || b; });
        check(combine(label, rows, LabelOperation::Remove), [](bool a, bool b) { return a && !b; });
        check(combine(label, rows, LabelOperation::Intersect), [](bool a, bool b) { return a && b; });
        check(combine(label, rows, LabelOperation::Replace), [](bool, bool b) { return b; });
        check(invert(label), [](bool a, bool) { return !a; });
        check(invert(invert(label)), [](bool a, bool) { return a; });
        check(clear(label), [](bool, bool) { return false; });
        const NamedLabel plain = without_corrections(label);
        for (std::size_t row = 0; row < 500; ++row)
            DOCTEST_CHECK((*plain.bits)[row] == ((*label.weight)[row] > label.threshold ? 1 : 0));
        const NamedLabel all = with_threshold(without_corrections(label), -1);
        DOCTEST_CHECK(count_labelled(all) == 500);
    }
}

DOCTEST_TEST_CASE("rows that an edit added belong to its label, and are nobody's correction") {
    NamedLabel found = empty_label("bear", 4);
    found.weight = std::make_shared<const std::vector<float>>(std::vector<float>{0.9f, 0.2f, 0, 0});
    found = with_added(with_bits(found), std::vector<std::uint8_t>{0, 0, 0, 1});
    DOCTEST_CHECK(*found.bits == std::vector<std::uint8_t>{1, 0, 0, 1});
    DOCTEST_CHECK((found.manual == nullptr || std::all_of(found.manual->begin(), found.manual->end(),
                                                          [](auto by_hand) { return by_hand == 0; })));
    DOCTEST_CHECK(count_labelled(with_threshold(found, 0.95f)) == 1);
    const NamedLabel painted = with_added(empty_label("hat", 4), std::vector<std::uint8_t>{0, 0, 0, 1});
    DOCTEST_CHECK(count_labelled(painted) == 1);
}

DOCTEST_TEST_CASE("growing and shrinking go along neighbours") {
    const GaussianSet set = line_set(50);
    const NamedLabel label = line_label(50, 20, 30);
    // The 8th neighbour on a line is 4 away.
    DOCTEST_CHECK(growth_radius(set, *label.bits) == doctest::Approx(4));
    const NamedLabel grown = grow(label, set, 2, 1.5);
    for (std::size_t row = 0; row < 50; ++row)
        DOCTEST_CHECK((*grown.bits)[row] == (row >= 18 && row < 32 ? 1 : 0));
    const NamedLabel shrunk = grow(grown, set, -2, 1.5);
    DOCTEST_CHECK(*shrunk.bits == *label.bits);
    DOCTEST_CHECK(count_labelled(grow(label, set, -9, 1.5)) == 0);
    DOCTEST_CHECK(count_labelled(grow(label, set, 1)) == 18);
    DOCTEST_CHECK(count_labelled(grow(empty_label("none", 50), set, 3)) == 0);
}

DOCTEST_TEST_CASE("growing agrees with a look at all pairs") {
    const GaussianSet set = cloud(600, 9);
    Random random(3);
    std::vector<std::uint8_t> rows(600, 0);
    for (auto& row : rows) row = random.below(12) == 0;
    const NamedLabel label = combine(empty_label("x", 600), rows, LabelOperation::Add);
    for (const double radius : {0.02, 0.15, 0.4}) {
        const NamedLabel grown = grow(label, set, 1, radius), shrunk = grow(invert(label), set, -1, radius);
        for (std::size_t row = 0; row < 600; ++row) {
            bool near = rows[row] != 0;
            for (std::size_t other = 0; other < 600 && !near; ++other) {
                if (rows[other] == 0) continue;
                double sum = 0;
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    const double d = static_cast<double>(set.position()[row * 3 + axis]) -
                                     static_cast<double>(set.position()[other * 3 + axis]);
                    sum += d * d;
                }
                near = sum <= radius * radius;
            }
            DOCTEST_CHECK((*grown.bits)[row] == (near ? 1 : 0));
            DOCTEST_CHECK((*shrunk.bits)[row] == (near ? 0 : 1));
        }
    }
}

DOCTEST_TEST_CASE("the histogram counts every finite weight once") {
    NamedLabel label;
    label.weight = std::make_shared<const std::vector<float>>(std::vector<float>{
        0, 0, 1, 0.999f, 0.5f, 1.0f / 256, std::numeric_limits<float>::quiet_NaN(), 1e-9f});
    const WeightHistogram histogram = weight_histogram(with_bits(label));
    DOCTEST_CHECK(histogram.zeros == 2);
    DOCTEST_CHECK(histogram.bins[255] == 2);
    DOCTEST_CHECK(histogram.bins[128] == 1);
    DOCTEST_CHECK(histogram.bins[1] == 1);
    DOCTEST_CHECK(histogram.bins[0] == 1);
    DOCTEST_CHECK(histogram.highest == 2);
}

}  // namespace label_ops_test
