// Volumes that outlines from several sides enclose: spheres and boxes of which the true outlines are known,
// with wrong and hidden ones.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "engine/base/random.h"
#include "engine/edit/placement/visual_hull.h"
#include "engine/localize/clusters.h"
#include "engine/raster/rasterizer.h"
#include "tests/unit/edit/edit_scenes.h"

namespace visual_hull_test {

namespace {

using namespace gse;

constexpr int Side = 64;
const edit::HullBox Room{{-1.2, -1.2, -1.2}, {1.2, 1.2, 1.2}};

/// Depth along z of the first point of a solid on the ray of each pixel, found by steps; 0 = none.
Image depth_of(const Camera& camera, const std::function<bool(const Vec3&)>& solid) {
    Image depth(camera.width, camera.height, 1);
    const Mat3 to_world = camera.rotation.transposed();
    for (int y = 0; y < camera.height; ++y)
        for (int x = 0; x < camera.width; ++x)
            for (double z = 1; z < 5; z += 0.01) {
                const Vec3 p{(x + 0.5 - camera.cx) / camera.fx * z, (y + 0.5 - camera.cy) / camera.fy * z, z};
                if (!solid(to_world * p + camera.centre())) continue;
                depth.at(x, y, 0) = static_cast<float>(z);
                break;
            }
    return depth;
}

/// Outlines of a solid from `count` cameras on two rings; the picture is red where the surface is at negative
/// z, else blue.
std::vector<edit::HullView> outlines(const std::function<bool(const Vec3&)>& solid, int count = 8) {
    std::vector<edit::HullView> views;
    for (const auto& view : test::ball_views(count, Side)) {
        const Image depth = depth_of(view.camera, solid);
        edit::HullView outline{view.camera, Image(Side, Side, 1), {}, Image(Side, Side, 3)};
        for (int y = 0; y < Side; ++y)
            for (int x = 0; x < Side; ++x) {
                const double z = depth.at(x, y, 0);
                if (z <= 0) continue;
                outline.inside.at(x, y, 0) = 1;
                const auto& c = view.camera;
                const Vec3 p = c.rotation.transposed() *
                                   Vec3{(x + 0.5 - c.cx) / c.fx * z, (y + 0.5 - c.cy) / c.fy * z, z} +
                               c.centre();
                outline.picture.at(x, y, p.z < 0 ? 0 : 2) = 1;
            }
        views.push_back(std::move(outline));
    }
    return views;
}

bool ball(const Vec3& p) { return length(p) < 0.5; }
bool slab(const Vec3& p) { return std::abs(p.x) < 0.7 && std::abs(p.y) < 0.3 && std::abs(p.z) < 0.25; }
bool two_balls(const Vec3& p) {
    return length(p - Vec3{-0.5, 0, 0}) < 0.3 || length(p - Vec3{0.5, 0.1, 0}) < 0.35;
}

/// How well the hull's own outlines are those that were given, the worst view.
double worst_fit(const edit::VisualHull& hull, const std::vector<edit::HullView>& views) {
    double worst = 1;
    for (const auto& view : views)
        worst = std::min(worst, localize::mask_iou(edit::hull_mask(hull, view.camera),
                                                   localize::threshold_map(view.inside, 0.5)));
    return worst;
}

/// Share of the solid's volume that cubes of the hull cover.
double covered(const edit::VisualHull& hull, const std::function<bool(const Vec3&)>& solid) {
    Random random(5);
    int inside = 0, found = 0;
    for (int i = 0; i < 4000; ++i) {
        const Vec3 p{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
        if (!solid(p)) continue;
        ++inside;
        found += std::any_of(hull.centres.begin(), hull.centres.end(), [&](const Vec3& centre) {
            const Vec3 d = p - centre;
            return std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) <= hull.side;
        });
    }
    return static_cast<double>(found) / inside;
}

}  // namespace

DOCTEST_TEST_CASE("a hull holds the thing and has its outlines") {
    for (const auto& solid : {ball, slab, two_balls}) {
        const auto views = outlines(solid);
        const auto hull = edit::carve_hull(views, Room, {.least_share = 1});
        DOCTEST_CHECK(covered(hull, solid) > 0.97);  // the rim of a pixel and of a cube
        DOCTEST_CHECK(worst_fit(hull, views) > 0.85);
        DOCTEST_CHECK(hull.centres.size() > 2500);
        DOCTEST_CHECK(hull.centres.size() < 10000);  // twice what was asked for
    }
}

DOCTEST_TEST_CASE("the cubes of a hull are the places that the plain test has inside") {
    const edit::HullParameters parameters{.cells = 800, .least_share = 0.75};
    const auto views = outlines(slab);
    const auto hull = edit::carve_hull(views, Room, parameters);
    const double slack = 1.5 * hull.side;
    for (const auto& centre : hull.centres)
        DOCTEST_CHECK(edit::hull_share(views, centre, slack, parameters) >= parameters.least_share);
    Random random(3);
    for (int i = 0; i < 3000; ++i) {  // no place inside is far from all cubes
        const Vec3 p{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
        if (edit::hull_share(views, p, slack, parameters) < parameters.least_share) continue;
        double nearest = 1e9;
        for (const auto& centre : hull.centres) nearest = std::min(nearest, length(p - centre));
        DOCTEST_CHECK(nearest < 2 * hull.side);
    }
}

DOCTEST_TEST_CASE("outlines that the border of their picture cuts off say nothing of what is beyond it") {
    auto views = outlines(ball);
    const edit::HullParameters usual, few{.least_framed = 0.5};
    const Vec3 middle{};
    DOCTEST_CHECK(edit::hull_share(views, middle, 0.1, usual) == 1);
    const std::size_t away = (views.size() + 2) / 3;
    for (std::size_t v = 0; v < away; ++v) views[v].camera.cx += 2 * views[v].camera.width;
    DOCTEST_CHECK(edit::hull_share(views, middle, 0.1, usual) < 0);
    DOCTEST_CHECK(edit::hull_share(views, middle, 0.1, few) == 1);
}

DOCTEST_TEST_CASE("one or two wrong outlines do not spoil a hull") {
    const auto truth = outlines(ball);
    const auto right = edit::carve_hull(truth, Room);
    for (const std::size_t wrong : {1, 2}) {
        auto views = truth;
        for (std::size_t v = 0; v < wrong; ++v)
            std::fill(views[3 * v].inside.data.begin(), views[3 * v].inside.data.end(), 0.0f);
        const auto hull = edit::carve_hull(views, Room);
        DOCTEST_CHECK(covered(hull, ball) > 0.95);
        DOCTEST_CHECK(worst_fit(hull, truth) > 0.7);
        views = truth;
        for (std::size_t v = 0; v < wrong; ++v)
            std::fill(views[3 * v].inside.data.begin(), views[3 * v].inside.data.end(), 1.0f);
        DOCTEST_CHECK(covered(edit::carve_hull(views, Room), ball) > 0.97);
        DOCTEST_CHECK(worst_fit(edit::carve_hull(views, Room), truth) > 0.6);
    }
    DOCTEST_CHECK(worst_fit(right, truth) > 0.7);
}

DOCTEST_TEST_CASE("views from which a place is hidden do not count") {
    auto views = outlines(ball);
    // A wall before the thing in three of the views: they show nothing of it.
    for (const std::size_t v : {0, 2, 5}) {
        views[v].surface = Image(Side, Side, 1, 1.0f);
        std::fill(views[v].inside.data.begin(), views[v].inside.data.end(), 0.0f);
    }
    DOCTEST_CHECK(covered(edit::carve_hull(views, Room), ball) > 0.95);
    for (const std::size_t v : {0, 2, 5})
        views[v].surface = {};  // without the wall they say that nothing is there
    DOCTEST_CHECK(edit::carve_hull(views, Room).empty());
    // What is in front of a surface is not hidden by it.
    for (auto& view : views) view.surface = Image(Side, Side, 1, 3.6f);
    auto behind = outlines(ball);
    for (auto& view : behind) view.surface = Image(Side, Side, 1, 4.0f);
    DOCTEST_CHECK(covered(edit::carve_hull(behind, Room), ball) > 0.97);
}

DOCTEST_TEST_CASE("where nothing is enclosed there is no hull, and specks are dropped") {
    auto views = outlines([](const Vec3&) { return false; });
    DOCTEST_CHECK(edit::carve_hull(views, Room).empty());
    DOCTEST_CHECK(edit::carve_hull({}, Room).empty());
    views = outlines(ball);
    DOCTEST_CHECK(edit::carve_hull(views, {}).empty());
    DOCTEST_CHECK(edit::carve_hull(views, {{0, 0, 0}, {std::nan(""), 1, 1}}).empty());
    DOCTEST_CHECK(edit::hull_seeds({}, views, 0).size() == 0);
    const auto with_speck = outlines([](const Vec3& p) {
        return ball(p) || length(p - Vec3{0.8, 0.6, 0.3}) < 0.12;
    });
    const auto hull = edit::carve_hull(with_speck, Room);
    for (const auto& centre : hull.centres) DOCTEST_CHECK(length(centre) < 0.75);
    const auto both = edit::carve_hull(outlines(two_balls), Room);  // wings are two
    DOCTEST_CHECK(
        std::any_of(both.centres.begin(), both.centres.end(), [](const Vec3& p) { return p.x < -0.4; }));
    DOCTEST_CHECK(
        std::any_of(both.centres.begin(), both.centres.end(), [](const Vec3& p) { return p.x > 0.4; }));
}

DOCTEST_TEST_CASE("a hull of one large part and many small ones keeps them all, as flames have") {
    constexpr int Tongues = 5;
    const auto at = [](int i) { return Vec3{-0.8 + 0.4 * i, -0.75, 0.1}; };
    const auto tongue = [&](const Vec3& p, int i) {
        return std::abs(p.x - at(i).x) < 0.09 && std::abs(p.y - at(i).y) < 0.25 &&
               std::abs(p.z - at(i).z) < 0.09;
    };
    const auto flames = [&](const Vec3& p) {
        for (int i = 0; i < Tongues; ++i)
            if (tongue(p, i)) return true;
        return std::abs(p.x) < 0.7 && p.y > 0 && p.y < 0.4 && std::abs(p.z) < 0.35;
    };
    const auto hull = edit::carve_hull(outlines(flames, 12), Room, {.least_share = 1});
    for (int i = 0; i < Tongues; ++i)  // each a thirtieth of the large part
        DOCTEST_CHECK(covered(hull, [&](const Vec3& p) { return tongue(p, i); }) > 0.9);
}

DOCTEST_TEST_CASE("of strict and loose hulls the one is taken that fits the outlines") {
    const auto truth = outlines(slab);
    DOCTEST_CHECK(edit::hull_fit(truth, edit::best_hull(truth, Room)) > 0.9);
    DOCTEST_CHECK(edit::hull_fit(truth, {}) == 0);
    // Half of the outlines are cut off at different places: a strict hull lacks all of that.
    auto views = truth;
    for (std::size_t v = 0; v < views.size(); v += 2)
        for (int y = 0; y < Side; ++y)
            for (int x = 0; x < Side; ++x)
                if (v % 4 == 0 ? x < Side / 2 : x >= Side / 2) views[v].inside.at(x, y, 0) = 0;
    const auto strict = edit::carve_hull(views, Room, {.least_share = 0.95}),
               best = edit::best_hull(views, Room);
    DOCTEST_CHECK(edit::hull_fit(views, best) > edit::hull_fit(views, strict));
    DOCTEST_CHECK(edit::hull_fit(truth, best) > edit::hull_fit(truth, strict));
    // What is hidden behind something else is not asked of an outline.
    views = truth;
    for (auto& view : views) {
        view.surface = Image(Side, Side, 1);
        for (int y = 0; y < Side; ++y)
            for (int x = 0; x < Side / 2; ++x) {
                view.surface.at(x, y, 0) = 1;
                view.inside.at(x, y, 0) = 0;
            }
    }
    const auto whole = edit::carve_hull(truth, Room);
    DOCTEST_CHECK(edit::hull_fit(views, whole) > edit::hull_fit(truth, whole) - 0.1);
}

DOCTEST_TEST_CASE("normals of a hull look away from it") {
    const auto hull = edit::carve_hull(outlines(ball), Room);
    std::size_t outside = 0, right = 0;
    for (std::size_t i = 0; i < hull.centres.size(); ++i) {
        const double size = length(hull.normals[i]);
        DOCTEST_CHECK((size < 1e-9 || std::abs(size - 1) < 1e-9));
        if (size < 0.5) continue;
        ++outside;
        right += dot(hull.normals[i], normalized(hull.centres[i])) > 0.5 ? 1 : 0;
    }
    DOCTEST_CHECK(outside > hull.centres.size() / 10);
    DOCTEST_CHECK(static_cast<double>(right) > 0.95 * static_cast<double>(outside));
}

DOCTEST_TEST_CASE("seeds fill the outlines and have the colour of the side they are seen from") {
    const auto views = outlines(ball);
    const auto hull = edit::carve_hull(views, Room);
    for (const int degree : {0, 2}) {
        const auto seeds = edit::hull_seeds(hull, views, degree, 0.9);
        DOCTEST_REQUIRE(seeds.size() > 300);
        DOCTEST_REQUIRE(seeds.sh.size() == seeds.size() * seeds.sh_stride());
        std::size_t right = 0, sided = 0;
        for (std::size_t row = 0; row < seeds.size(); ++row) {
            const double z = seeds.position[row * 3 + 2];
            const double red = colour_from_sh(seeds.sh[row * seeds.sh_stride()]),
                         blue = colour_from_sh(seeds.sh[row * seeds.sh_stride() + 2]);
            if (std::abs(z) < 0.3) continue;
            ++sided;
            right += (z < 0) == (red > blue) ? 1 : 0;
        }
        DOCTEST_CHECK(static_cast<double>(right) > 0.9 * static_cast<double>(sided));
        const auto rasterizer = raster::make_plain_rasterizer();
        for (const auto& view : views) {
            raster::ForwardOutput output;
            rasterizer->forward(spans(seeds), view.camera, {}, output);
            DOCTEST_CHECK(localize::mask_iou(localize::threshold_map(output.alpha, 0.5),
                                             localize::threshold_map(view.inside, 0.5)) > 0.7);
        }
    }
}

}  // namespace visual_hull_test
