// The shared change of colour reaches what an affine map can reach, and rows that join late catch up.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/base/random.h"
#include "engine/edit/optimise/common_colour.h"
#include "engine/math/sh.h"

namespace common_colour_test {

namespace {

using namespace gse;

constexpr double Rate = 0.0675;   // that of an edit
constexpr double SameRow = 1e-5;  // float rounding of a hundred steps

std::vector<float> rows_of(const std::vector<Vec3>& colours) {
    std::vector<float> sh;
    for (const auto& colour : colours)
        for (int c = 0; c < 3; ++c) sh.push_back(static_cast<float>(sh_from_colour(colour[c])));
    return sh;
}

double mean_difference(std::span<const float> a, std::span<const float> b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(static_cast<double>(a[i]) - b[i]) * ShC0;
    return sum / static_cast<double>(a.size());
}

/// Colours after `steps` steps towards `goal` under a quadratic loss.
std::vector<float> led(edit::CommonColour& common, std::span<const float> birth, std::span<const float> goal,
                       int steps) {
    std::vector<float> sh(birth.begin(), birth.end()), gradient(birth.size());
    for (int step = 0; step < steps; ++step) {
        for (std::size_t i = 0; i < sh.size(); ++i) gradient[i] = sh[i] - goal[i];
        common.step(gradient, birth, sh, Rate);
    }
    return sh;
}

/// Grain: light and dark of slightly different hue, in light and in shade.
std::vector<Vec3> grain() {
    std::vector<Vec3> colours;
    Random random(2);
    for (int i = 0; i < 300; ++i) {
        const Vec3 paint = i % 3 == 0 ? Vec3{0.33, 0.17, 0.06} : Vec3{0.72, 0.46, 0.22};
        colours.push_back(paint * random.uniform(0.5, 1.1));
    }
    return colours;
}

}  // namespace

DOCTEST_TEST_CASE("grain is painted over and the shading stays") {
    const auto colours = grain();
    std::vector<Vec3> painted;
    for (std::size_t i = 0; i < colours.size(); ++i)
        painted.push_back(Vec3{0.1, 0.2, 0.9} * (colours[i].x / (i % 3 == 0 ? 0.33 : 0.72)));
    const auto birth = rows_of(colours), goal = rows_of(painted);
    edit::CommonColour common(birth, 3);
    const auto reached = led(common, birth, goal, 75);
    // Half-way between axes as wide as the colours spread, and all alike.
    constexpr double left = 0.08;
    DOCTEST_CHECK(mean_difference(reached, goal) < left * mean_difference(birth, goal));
}

DOCTEST_TEST_CASE("a row that joins late is where it would be had it taken every step") {
    const auto colours = grain();
    std::vector<Vec3> turned;
    for (const auto& colour : colours) turned.push_back({colour.z, colour.x, 0.5 * colour.y + 0.2});
    const auto birth = rows_of(colours), goal = rows_of(turned);
    edit::CommonColour common(birth, 3);
    const auto reached = led(common, birth, goal, 100);
    for (const std::size_t row : {0u, 7u, 299u}) {
        std::vector<float> late(birth.begin() + static_cast<std::ptrdiff_t>(row * 3),
                                birth.begin() + static_cast<std::ptrdiff_t>(row * 3 + 3));
        const auto own = late;
        common.apply(own, late);
        for (std::size_t c = 0; c < 3; ++c)
            DOCTEST_CHECK(late[c] == doctest::Approx(reached[row * 3 + c]).epsilon(SameRow));
    }
}

DOCTEST_TEST_CASE("colours seen from anywhere follow the map of the base colours") {
    // Degree 1: a view adds a colour to the base colour; mapped colours differ by A times that colour.
    Random random(4);
    constexpr std::size_t stride = 12, rows = 40;
    std::vector<float> birth(rows * stride), gradient(rows * stride);
    for (auto& value : birth) value = static_cast<float>(random.uniform(-0.5, 0.5));
    for (auto& value : gradient) value = static_cast<float>(random.normal());
    auto sh = birth;
    edit::CommonColour common(birth, stride);
    for (int step = 0; step < 10; ++step) common.step(gradient, birth, sh, Rate);
    // The map taken from pairs of rows: differences of base colours go through A alone.
    const auto mapped = [&](const Vec3& base, const std::vector<float>& like) {
        std::vector<float> own = like;
        for (int c = 0; c < 3; ++c)
            own[static_cast<std::size_t>(c)] = static_cast<float>(sh_from_colour(base[c]));
        auto after = own;
        common.apply(own, after);
        return Vec3{colour_from_sh(after[0]), colour_from_sh(after[1]), colour_from_sh(after[2])};
    };
    for (std::size_t j = 3; j < stride; j += 3) {
        const std::vector<float> row(birth.begin(), birth.begin() + static_cast<std::ptrdiff_t>(stride));
        const Vec3 seen{ShC0 * row[j], ShC0 * row[j + 1], ShC0 * row[j + 2]};
        // Small enough to stay among the label's colours, beyond which the map is bounded.
        constexpr double part = 0.2;
        const Vec3 grey{0.5, 0.5, 0.5};
        const Vec3 moved = (mapped(grey + seen * part, row) - mapped(grey, row)) / part;
        for (int c = 0; c < 3; ++c)
            DOCTEST_CHECK(ShC0 * sh[j + static_cast<std::size_t>(c)] ==
                          doctest::Approx(moved[c]).epsilon(1e-4));
    }
}

DOCTEST_TEST_CASE("a row of a colour the label never had gets no wild colour") {
    std::vector<Vec3> reds;
    Random random(6);
    for (int i = 0; i < 200; ++i)
        reds.push_back(Vec3{0.8, 0.1 + 0.001 * random.normal(), 0.1} * random.uniform(0.5, 1.1));
    const auto birth = rows_of(reds);
    edit::CommonColour common(birth, 3);
    std::vector<float> sh = birth, gradient(birth.size());
    for (int step = 0; step < 100; ++step) {  // the pull of a model: towards blue, with noise
        for (std::size_t i = 0; i < sh.size(); ++i)
            gradient[i] = sh[i] - static_cast<float>(sh_from_colour(i % 3 == 2 ? 0.9 : 0.1)) +
                          static_cast<float>(random.normal());
        common.step(gradient, birth, sh, Rate);
    }
    auto green = rows_of({{0.1, 0.9, 0.1}});
    const auto own = green;
    common.apply(own, green);
    // A red row moves by less than one; the unbounded map would move green by dozens.
    constexpr double reach = 1.5;
    for (std::size_t c = 0; c < 3; ++c) DOCTEST_CHECK(std::abs(green[c] - own[c]) * ShC0 < reach);
}

DOCTEST_TEST_CASE("grey things with coloured gloss keep a gloss of the same size") {
    Random random(8);
    constexpr std::size_t stride = 12, rows = 200;
    std::vector<float> birth(rows * stride);
    for (std::size_t i = 0; i < birth.size(); i += stride) {
        const auto grey = static_cast<float>(sh_from_colour(random.uniform(0.3, 0.7)));
        for (std::size_t c = 0; c < 3; ++c) birth[i + c] = grey + static_cast<float>(0.02 * random.normal());
        for (std::size_t j = 3; j < stride; ++j) birth[i + j] = static_cast<float>(0.2 * random.normal());
    }
    edit::CommonColour common(birth, stride);
    std::vector<float> sh = birth, gradient(birth.size());
    for (int step = 0; step < 100; ++step) {
        for (std::size_t i = 0; i < sh.size(); ++i) gradient[i] = static_cast<float>(random.normal());
        common.step(gradient, birth, sh, Rate);
    }
    double before = 0, after = 0;
    for (std::size_t i = 0; i < sh.size(); ++i) {
        if (i % stride < 3) continue;
        before += std::pow(birth[i], 2);
        after += std::pow(sh[i], 2);
    }
    // Bound on the growth of the energy under pure noise. It is exceeded where the gloss is no part of the
    // spread.
    constexpr double growth = 10;
    DOCTEST_CHECK(after < growth * before);
}

DOCTEST_TEST_CASE("black, one colour and one row stay finite") {
    for (const auto& colours : {std::vector<Vec3>(5, Vec3{}), std::vector<Vec3>(5, Vec3{0.2, 0.4, 0.6}),
                                std::vector<Vec3>{{1, 0, 0}}}) {
        const auto birth = rows_of(colours);
        const auto goal = rows_of(std::vector<Vec3>(colours.size(), Vec3{0.7, 0.6, 0.1}));
        edit::CommonColour common(birth, 3);
        const auto reached = led(common, birth, goal, 150);
        for (const float value : reached) DOCTEST_CHECK(std::isfinite(value));
        DOCTEST_CHECK(mean_difference(reached, goal) < 0.5 * mean_difference(birth, goal));
    }
}

}  // namespace common_colour_test
