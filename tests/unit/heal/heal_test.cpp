// A thing goes and the surfaces behind it go on; everything else stays bit for bit.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "engine/base/error.h"
#include "engine/base/random.h"
#include "engine/evaluate/metrics.h"
#include "engine/heal/heal.h"
#include "engine/math/sh.h"

namespace heal_test {

namespace {

using namespace gse;

/// Scene built of flat splats; up is +y.
struct Builder {
    GaussianData data;
    std::vector<std::uint8_t> thing;

    void add(const Vec3& at, const Vec3& normal, double spacing, const Vec3& colour, bool labelled) {
        const Vec3 other = std::abs(normal.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 0, 1};
        const Vec3 u = normalized(cross(other, normal));
        const Quat q = quaternion(Mat3::from_columns(u, cross(normal, u), normal));
        for (int k = 0; k < 3; ++k) data.position.push_back(static_cast<float>(at[k]));
        for (const double s : {0.65, 0.65, 0.1})
            data.log_scale.push_back(static_cast<float>(std::log(s * spacing)));
        for (const double v : {q.w, q.x, q.y, q.z}) data.rotation.push_back(static_cast<float>(v));
        data.opacity_logit.push_back(3);
        for (int k = 0; k < 3; ++k) data.sh.push_back(static_cast<float>(sh_from_colour(colour[k])));
        thing.push_back(labelled ? 1 : 0);
    }
    /// Square grid of splats over u, v in [-1, 1] where `wanted` says so.
    void sheet(double spacing, const std::function<Vec3(double, double)>& place, const Vec3& normal,
               const std::function<Vec3(const Vec3&)>& colour,
               const std::function<bool(const Vec3&)>& wanted) {
        const int count = static_cast<int>(2 / spacing);
        for (int i = 0; i < count; ++i)
            for (int j = 0; j < count; ++j) {
                const Vec3 at = place((2.0 * i + 1) / count - 1, (2.0 * j + 1) / count - 1);
                if (wanted(at)) add(at, normal, spacing, colour(at), false);
            }
    }
    void ball(const Vec3& centre, double radius, int count, const Vec3& colour, bool labelled) {
        for (int i = 0; i < count; ++i) {
            const double z = 1 - 2 * (i + 0.5) / count, r = std::sqrt(1 - z * z),
                         turn = 2.399963229728653 * i;
            const Vec3 n{r * std::cos(turn), z, r * std::sin(turn)};
            add(centre + n * radius, n, radius * 3.5 / std::sqrt(count), colour, labelled);
        }
    }
    heal::Healed heal(const heal::HealSettings& settings = {}) const {
        return heal::remove_and_heal({GaussianSet(data), thing, {0, 1, 0}}, settings);
    }
};

constexpr double Spacing = 0.05;
constexpr double BallRadius = 0.25;

Vec3 striped(const Vec3& p) {
    return std::fmod(p.x + 10, 0.4) < 0.2 ? Vec3{0.8, 0.7, 0.3} : Vec3{0.2, 0.3, 0.6};
}

Vec3 level(double u, double v) { return {u, 0, v}; }

/// Floor with a hole of `hole` around the origin, and a ball in it.
Builder floor_with_ball(double hole) {
    Builder scene;
    scene.sheet(Spacing, level, {0, 1, 0}, striped, [hole](const Vec3& p) { return length(p) > hole; });
    scene.ball({0, BallRadius, 0}, BallRadius, 300, {0.9, 0.1, 0.1}, true);
    return scene;
}

Vec3 place(const GaussianData& data, std::size_t row) {
    return {data.position[row * 3], data.position[row * 3 + 1], data.position[row * 3 + 2]};
}

}  // namespace

DOCTEST_TEST_CASE("a hole in a floor is closed on the floor, and nothing else changes") {
    const Builder scene = floor_with_ball(0.22);
    const auto healed = scene.heal();
    DOCTEST_REQUIRE(healed.added.size() > 20);
    constexpr double OnFloor = 0.02;  // less than half of the splats' spacing
    for (std::size_t row = 0; row < healed.added.size(); ++row) {
        DOCTEST_CHECK(std::abs(place(healed.added, row).y) < OnFloor);
        DOCTEST_CHECK(length(place(healed.added, row)) < 0.22 + 2 * Spacing);
    }
    for (std::size_t row = 0; row < scene.thing.size(); ++row)
        if (scene.thing[row] != 0) DOCTEST_CHECK(healed.removed[row] == 1);
    const GaussianSet before(scene.data), after = heal::healed_set(before, healed);
    std::vector<std::uint8_t> keep(before.size());
    for (std::size_t row = 0; row < keep.size(); ++row) keep[row] = healed.removed[row] == 0 ? 1 : 0;
    const GaussianSet kept = before.filtered(keep);
    DOCTEST_CHECK(evaluate::changed_rows(kept, after, std::vector<std::uint8_t>(kept.size(), 1)) == 0);
    DOCTEST_CHECK(healed.carried == 0);
    DOCTEST_CHECK(healed.open.empty());
}

DOCTEST_TEST_CASE("stripes go on through the hole") {
    const auto healed = floor_with_ball(0.22).heal();
    std::size_t right = 0, away = 0;
    for (std::size_t row = 0; row < healed.added.size(); ++row) {
        const double into = std::fmod(place(healed.added, row).x + 10, 0.2);
        if (std::min(into, 0.2 - into) < Spacing) continue;  // colours are mixed at a stripe's border
        ++away;
        const Vec3 wanted = striped(place(healed.added, row));
        const Vec3 colour{colour_from_sh(healed.added.sh[row * 3]),
                          colour_from_sh(healed.added.sh[row * 3 + 1]),
                          colour_from_sh(healed.added.sh[row * 3 + 2])};
        right += length(colour - wanted) < 0.2 ? 1U : 0U;
    }
    constexpr double MostRight = 0.95;
    DOCTEST_CHECK(away > 20);
    DOCTEST_CHECK(static_cast<double>(right) > MostRight * static_cast<double>(away));
}

DOCTEST_TEST_CASE("equal inputs give equal results") {
    const Builder scene = floor_with_ball(0.22);
    const auto first = scene.heal(), second = scene.heal();
    DOCTEST_CHECK(first.removed == second.removed);
    DOCTEST_CHECK(first.added.position == second.added.position);
    DOCTEST_CHECK(first.added.sh == second.added.sh);
}

DOCTEST_TEST_CASE("nothing is added where the floor is whole") {
    const auto healed = floor_with_ball(-1).heal();
    DOCTEST_CHECK(healed.added.size() == 0);
    DOCTEST_CHECK(std::count(healed.removed.begin(), healed.removed.end(), 1) == 300);
}

DOCTEST_TEST_CASE("a table's edge goes on straight") {
    constexpr double Edge = -0.3;
    Builder scene;
    scene.sheet(Spacing, level, {0, 1, 0}, striped, [](const Vec3& p) {
        return p.z > Edge && length(p - Vec3{0, 0, -0.2}) > 0.2;
    });
    scene.ball({0, BallRadius, -0.2}, BallRadius, 300, {0.9, 0.1, 0.1}, true);
    const auto healed = scene.heal();
    double first = 1;
    for (std::size_t row = 0; row < healed.added.size(); ++row)
        first = std::min(first, place(healed.added, row).z);
    DOCTEST_CHECK(healed.added.size() > 15);
    DOCTEST_CHECK(first > Edge - Spacing);
    DOCTEST_CHECK(first < Edge + 2 * Spacing);
}

DOCTEST_TEST_CASE("a floor and a wall go on to where they meet") {
    constexpr double Wall = 0.2;
    Builder scene;
    const auto outside = [](const Vec3& p) { return length(p - Vec3{0, 0, Wall}) > 0.25; };
    scene.sheet(Spacing, level, {0, 1, 0}, striped, [&](const Vec3& p) { return p.z < Wall && outside(p); });
    scene.sheet(
        Spacing,
        [](double u, double v) {
            return Vec3{u, v + 1, Wall};
        },
        {0, 0, -1}, striped, outside);
    scene.ball({0, 0.2, 0}, 0.2, 300, {0.9, 0.1, 0.1}, true);
    const auto healed = scene.heal();
    std::size_t on_floor = 0, on_wall = 0;
    for (std::size_t row = 0; row < healed.added.size(); ++row) {
        const Vec3 at = place(healed.added, row);
        on_floor += std::abs(at.y) < 0.03 ? 1U : 0U;
        on_wall += std::abs(at.z - Wall) < 0.03 ? 1U : 0U;
        DOCTEST_CHECK(at.z < Wall + Spacing);
        DOCTEST_CHECK(at.y > -Spacing);
    }
    DOCTEST_CHECK(on_floor > 15);
    DOCTEST_CHECK(on_wall > 15);
}

DOCTEST_TEST_CASE("a dome is closed with its curvature") {
    constexpr double Radius = 1.0;
    Builder scene;
    scene.ball({0, -Radius, 0}, Radius, 6000, {0.5, 0.6, 0.4}, false);
    Builder dome;
    for (std::size_t row = 0; row < scene.thing.size(); ++row) {
        const Vec3 at = place(scene.data, row), n = normalized(at + Vec3{0, Radius, 0});
        if (at.y > -0.8 && std::hypot(at.x, at.z) > 0.25) dome.add(at, n, 0.045, {0.5, 0.6, 0.4}, false);
    }
    dome.ball({0, 0.3, 0}, 0.3, 300, {0.9, 0.1, 0.1}, true);
    const auto healed = dome.heal();
    DOCTEST_REQUIRE(healed.added.size() > 20);
    constexpr double Off = 0.02;  // half of the splats' spacing; a flat lid would be off by 0.03
    for (std::size_t row = 0; row < healed.added.size(); ++row)
        DOCTEST_CHECK(std::abs(length(place(healed.added, row) + Vec3{0, Radius, 0}) - Radius) < Off);
}

DOCTEST_TEST_CASE("what only the thing held goes, and what stands beside it stays") {
    Builder scene = floor_with_ball(0.22);
    const std::size_t hat = scene.thing.size();
    scene.ball({0, 2 * BallRadius + 0.1, 0}, 0.1, 120, {0.1, 0.8, 0.1}, false);
    const std::size_t neighbour = scene.thing.size();
    scene.ball({0.38, 0.12, 0}, 0.12, 120, {0.1, 0.1, 0.8}, false);
    const auto healed = scene.heal();
    const auto gone = [&](std::size_t first) {
        return std::count(healed.removed.begin() + static_cast<std::ptrdiff_t>(first),
                          healed.removed.begin() + static_cast<std::ptrdiff_t>(first + 120), 1);
    };
    DOCTEST_CHECK(gone(hat) == 120);
    DOCTEST_CHECK(gone(neighbour) == 0);
    DOCTEST_CHECK(healed.carried == 120);
    heal::HealSettings settings;
    settings.held_parts = false;
    const auto kept = scene.heal(settings);
    DOCTEST_CHECK(kept.carried == 0);
    DOCTEST_CHECK(kept.removed[hat] == 0);
}

DOCTEST_TEST_CASE("a shadow is lit again, and dark marks stay") {
    Builder scene;
    const auto in_shadow = [](const Vec3& p) { return std::exp(-std::pow(std::hypot(p.x, p.z) / 0.3, 2)); };
    const Vec3 plain{0.7, 0.6, 0.5};
    scene.sheet(
        Spacing, level, {0, 1, 0},
        [&](const Vec3& p) {
            const bool mark = length(p - Vec3{0.7, 0, 0}) < 0.15;
            return plain * (mark ? 0.4 : 1 - 0.5 * in_shadow(p));
        },
        [](const Vec3& p) { return length(p) > 0.15; });
    scene.ball({0, BallRadius, 0}, BallRadius, 300, {0.9, 0.1, 0.1}, true);
    const auto healed = scene.heal();
    DOCTEST_CHECK(healed.shadow > 20);
    double worst = 0;
    for (std::size_t row = 0; row < healed.added.size(); ++row)
        worst = std::max(worst, std::abs(colour_from_sh(healed.added.sh[row * 3]) - plain.x));
    constexpr double MostOff = 0.12;  // of a red of 0.7; the shadow takes up to 0.27
    DOCTEST_CHECK(worst < MostOff);
    for (std::size_t row = 0; row < scene.thing.size(); ++row)
        if (scene.thing[row] == 0 && length(place(scene.data, row) - Vec3{0.7, 0, 0}) < 0.15)
            DOCTEST_CHECK(healed.removed[row] == 0);
}

DOCTEST_TEST_CASE("a long shadow on a floor that goes on beneath the thing is lit again as it was") {
    const auto paint = [](const Vec3& p) {
        return Vec3{0.7, 0.6, 0.5} * (1 + 0.1 * std::sin(9 * p.x + 4 * p.z));
    };
    const auto in_shadow = [](const Vec3& p) { return p.x > -0.2 && p.x < 0.5 && std::abs(p.z) < 0.2; };
    Builder scene;
    scene.sheet(
        Spacing, level, {0, 1, 0},
        [&](const Vec3& p) {
            const Vec3 dark{0.55, 0.57, 0.61};
            return in_shadow(p) ? paint(p) * dark : paint(p);
        },
        [](const Vec3&) { return true; });
    scene.ball({0, BallRadius, 0}, BallRadius, 300, {0.9, 0.1, 0.1}, true);
    const auto healed = scene.heal();
    double squared = 0;
    for (std::size_t row = 0; row < healed.added.size(); ++row) {
        const Vec3 at = place(healed.added, row);
        squared += std::pow(paint(at).x - colour_from_sh(healed.added.sh[row * 3]), 2);
    }
    DOCTEST_REQUIRE(healed.added.size() > 60);
    constexpr double MostOff = 0.06;  // root mean square of a red of 0.7; the shadow takes 0.31
    DOCTEST_CHECK(std::sqrt(squared / static_cast<double>(healed.added.size())) < MostOff);
}

DOCTEST_TEST_CASE("a shadow on tiles of many colours is lit again") {
    const auto paint = [](const Vec3& p) {
        const Vec3 paints[] = {
            {0.8, 0.6, 0.5}, {0.3, 0.6, 0.6}, {0.75, 0.75, 0.7}, {0.35, 0.5, 0.65}, {0.8, 0.7, 0.6}};
        const int x = static_cast<int>(std::floor(p.x / 0.3 + 0.5)),
                  z = static_cast<int>(std::floor(p.z / 0.3 + 0.5));
        return paints[static_cast<std::size_t>((7 * x + 3 * z + x * z + 700) % 5)];
    };
    const auto light = [](const Vec3& p) { return 1 - 0.5 * std::exp(-dot(p, p) / 0.09); };
    constexpr double Fine = 0.025;
    Builder scene;
    scene.sheet(
        Fine, level, {0, 1, 0}, [&](const Vec3& p) { return paint(p) * light(p); },
        [](const Vec3& p) { return length(p) > 0.15; });
    scene.ball({0, BallRadius, 0}, BallRadius, 300, {0.9, 0.1, 0.1}, true);
    const auto healed = scene.heal();
    double before = 0, after = 0;
    std::size_t rows = 0;
    for (std::size_t row = 0; row < healed.added.size(); ++row) {
        const Vec3 at = place(healed.added, row);
        if (length(at) < 0.2) continue;  // the rim of the hole is texture
        before += paint(at).x * (1 - light(at));
        after += std::abs(paint(at).x - colour_from_sh(healed.added.sh[row * 3]));
        ++rows;
    }
    DOCTEST_CHECK(rows > 100);
    constexpr double MostLeft = 0.5;  // of the shadow; paint is told from light by its hue alone
    DOCTEST_CHECK(after < MostLeft * before);
}

DOCTEST_TEST_CASE("a patch that the label left out goes with the thing, and what stands against it stays") {
    Builder scene = floor_with_ball(0.22);
    const auto missed = [&](std::size_t row) {
        return scene.thing[row] != 0 && length(place(scene.data, row) - Vec3{0.2, 0.3, 0}) < 0.12;
    };
    std::vector<std::size_t> patch;
    for (std::size_t row = 0; row < scene.thing.size(); ++row)
        if (missed(row)) patch.push_back(row);
    for (const auto row : patch) scene.thing[row] = 0;
    DOCTEST_REQUIRE(patch.size() > 10);
    const std::size_t neighbour = scene.thing.size();
    scene.ball({-0.44, 0.2, 0}, 0.2, 200, {0.1, 0.1, 0.8}, false);
    const auto healed = scene.heal();
    for (const auto row : patch) DOCTEST_CHECK(healed.removed[row] == 1);
    for (std::size_t row = neighbour; row < scene.thing.size(); ++row)
        DOCTEST_CHECK(healed.removed[row] == 0);
}

DOCTEST_TEST_CASE("what no picture showed under a thing is replaced") {
    Builder scene;
    scene.sheet(Spacing, level, {0, 1, 0}, striped, [](const Vec3& p) { return length(p) > 0.24; });
    const std::size_t garbage = scene.thing.size();
    scene.sheet(
        3 * Spacing, level, {0, 1, 0},
        [](const Vec3&) {
            return Vec3{0.02, 0.05, 0.02};
        },
        [](const Vec3& p) { return length(p) < 0.24; });
    const std::size_t end = scene.thing.size();
    for (int i = 0; i < 8; ++i)  // a box that stands on the floor with its whole base
        scene.sheet(
            Spacing,
            [i](double u, double v) {
                return Vec3{0.22 * u, 0.02 + 0.04 * i, 0.22 * v};
            },
            {0, 1, 0},
            [](const Vec3&) {
                return Vec3{0.9, 0.1, 0.1};
            },
            [](const Vec3& p) { return std::hypot(p.x, p.z) < 0.2; });
    std::fill(scene.thing.begin() + static_cast<std::ptrdiff_t>(end), scene.thing.end(), 1);
    const auto healed = scene.heal();
    DOCTEST_REQUIRE(end > garbage);
    for (std::size_t row = garbage; row < end; ++row) DOCTEST_CHECK(healed.removed[row] == 1);
    double darkest = 1;
    for (std::size_t row = 0; row < healed.added.size(); ++row)
        darkest = std::min(darkest, colour_from_sh(healed.added.sh[row * 3 + 1]));
    DOCTEST_CHECK(healed.added.size() > 60);
    DOCTEST_CHECK(darkest > 0.2);
}

DOCTEST_TEST_CASE("the floor under a table is left alone") {
    Builder scene;
    const auto beside = [](const Vec3& p) { return std::max(std::abs(p.x), std::abs(p.z)) > 0.35; };
    scene.sheet(
        Spacing,
        [](double u, double v) {
            return Vec3{u, -0.25, v};
        },
        {0, 1, 0}, striped, beside);
    scene.sheet(
        Spacing,
        [](double u, double v) {
            return Vec3{0.4 * u, 0, 0.4 * v};
        },
        {0, 1, 0}, striped, [](const Vec3&) { return true; });
    scene.ball({0, BallRadius, 0}, BallRadius, 300, {0.9, 0.1, 0.1}, true);
    const auto healed = scene.heal();
    for (std::size_t row = 0; row < healed.added.size(); ++row)
        DOCTEST_CHECK(place(healed.added, row).y > -0.1);
}

DOCTEST_TEST_CASE("a surface that does not show around the hole is left open") {
    Builder scene;
    scene.sheet(Spacing, level, {0, 1, 0}, striped, [](const Vec3& p) {
        return length(p) > 0.22 && std::abs(std::atan2(p.z, p.x)) < 1.0 && length(p) < 0.8;
    });
    scene.ball({0, BallRadius, 0}, BallRadius, 300, {0.9, 0.1, 0.1}, true);
    const auto healed = scene.heal();
    DOCTEST_CHECK(healed.added.size() < 20);
}

DOCTEST_TEST_CASE("a brush closes the hole inside a ball alone") {
    Builder scene;
    scene.sheet(Spacing, level, {0, 1, 0}, striped, [](const Vec3& p) {
        return length(p - Vec3{0.5, 0, 0}) > 0.15 && length(p + Vec3{0.5, 0, 0}) > 0.15;
    });
    const GaussianSet set(scene.data);
    const auto healed = heal::heal_region({set, scene.thing, {0, 1, 0}}, {0.5, 0, 0}, 0.25);
    DOCTEST_REQUIRE(healed.added.size() > 10);
    for (std::size_t row = 0; row < healed.added.size(); ++row)
        DOCTEST_CHECK(length(place(healed.added, row) - Vec3{0.5, 0, 0}) < 0.25 + Spacing);
}

DOCTEST_TEST_CASE("a thing in the air leaves nothing to heal") {
    Builder scene;
    scene.ball({0, 0, 0}, 0.3, 200, {0.9, 0.1, 0.1}, true);
    const auto healed = scene.heal();
    DOCTEST_CHECK(healed.added.size() == 0);
    DOCTEST_CHECK(healed.surfaces.empty());
    DOCTEST_CHECK(!healed.open.empty());
}

DOCTEST_TEST_CASE("odd scenes and labels are survived") {
    Random random(7);
    const auto odd = [&] {
        const float values[] = {0,
                                1e-20F,
                                1e20F,
                                std::numeric_limits<float>::infinity(),
                                std::numeric_limits<float>::quiet_NaN(),
                                -1e6F};
        return values[random.below(6)];
    };
    for (int round = 0; round < 40; ++round) {
        const Builder whole = floor_with_ball(round % 3 == 0 ? -1 : 0.22);
        GaussianData data;
        std::vector<std::uint8_t> thing;
        const std::size_t count = round % 5 == 0 ? random.below(20) + 1 : whole.data.size();
        for (std::size_t row = 0; row < count; ++row) {
            data.append_row(whole.data, row);
            thing.push_back(round % 4 == 1   ? 1
                            : round % 4 == 2 ? static_cast<std::uint8_t>(random.below(2))
                                             : whole.thing[row]);
        }
        thing[0] = 1;
        for (int i = 0; i < 30; ++i) {
            std::vector<float>* arrays[] = {&data.position, &data.log_scale, &data.rotation,
                                            &data.opacity_logit, &data.sh};
            auto& array = *arrays[random.below(5)];
            array[random.below(array.size())] = odd();
        }
        const GaussianSet set(data);
        const auto healed = heal::remove_and_heal({set, thing, {0, 1, 0}});
        DOCTEST_CHECK(healed.removed.size() == set.size());
        for (const float value : healed.added.position) DOCTEST_CHECK(std::isfinite(value));
        const auto brushed = heal::heal_region({set, thing, {0, 1, 0}}, {0, 0, 0}, 0.2);
        DOCTEST_CHECK(brushed.removed.size() == set.size());
    }
}

DOCTEST_TEST_CASE("bad input gets a clear sentence") {
    const Builder scene = floor_with_ball(0.22);
    const GaussianSet set(scene.data);
    const std::vector<std::uint8_t> none(set.size(), 0), few(3, 1);
    DOCTEST_CHECK_THROWS_AS(heal::remove_and_heal({set, none, {0, 1, 0}}), Error);
    DOCTEST_CHECK_THROWS_AS(heal::remove_and_heal({set, few, {0, 1, 0}}), Error);
    DOCTEST_CHECK_THROWS_AS(heal::remove_and_heal({set, scene.thing, {0, 0, 0}}), Error);
    DOCTEST_CHECK_THROWS_AS(heal::heal_region({set, none, {0, 1, 0}}, {0, 0, 0}, 0), Error);
    JobControl stopped;
    std::stop_source source;
    source.request_stop();
    stopped.stop = source.get_token();
    DOCTEST_CHECK_THROWS_AS(heal::remove_and_heal({set, scene.thing, {0, 1, 0}, stopped}), Error);
}

}  // namespace heal_test
