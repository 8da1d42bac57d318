// Colours adjusted by hand: what each control leaves as it is, from every side.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "engine/base/error.h"
#include "engine/base/random.h"
#include "engine/scene/colour_adjustment.h"
#include "engine/scene/stack_edits.h"

namespace colour_adjustment_test {

using namespace gse;

namespace {

constexpr double Rounding = 1e-5;  // of single precision, at coefficients of a few units
const Vec3 Luma{0.213, 0.715, 0.072};

Vec3 base_colour(const GaussianSet& set, std::size_t row) {
    const auto sh =
        set.sh().subspan(row * static_cast<std::size_t>(sh_coefficient_count(set.sh_degree())) * 3, 3);
    return {colour_from_sh(sh[0]), colour_from_sh(sh[1]), colour_from_sh(sh[2])};
}

GaussianSet one_row(const Vec3& colour, float logit = 0) {
    GaussianData data;
    data.resize(1);
    data.rotation[0] = 1;
    for (std::size_t c = 0; c < 3; ++c)
        data.sh[c] = static_cast<float>(sh_from_colour(colour[static_cast<int>(c)]));
    data.opacity_logit[0] = logit;
    return GaussianSet(std::move(data));
}

GaussianSet plain_set(std::size_t count, int degree, std::uint64_t seed) {
    Random random(seed);
    GaussianData data;
    data.sh_degree = degree;
    data.resize(count);
    for (auto* values : {&data.position, &data.rotation, &data.opacity_logit, &data.sh})
        for (float& value : *values) value = static_cast<float>(random.normal());
    return GaussianSet(std::move(data));
}

Vec3 colour_after(const Vec3& colour, const ColourAdjustment& adjustment) {
    return base_colour(adjusted(one_row(colour), std::vector<std::uint8_t>{1}, adjustment), 0);
}

double opacity_after(double opacity, double density) {
    ColourAdjustment adjustment;
    adjustment.density = density;
    const auto set = adjusted(one_row({0, 0, 0}, static_cast<float>(std::log(opacity / (1 - opacity)))),
                              std::vector<std::uint8_t>{1}, adjustment);
    return 1 / (1 + std::exp(-static_cast<double>(set.opacity_logit()[0])));
}

void check_near(const Vec3& a, const Vec3& b) {
    for (int c = 0; c < 3; ++c) DOCTEST_CHECK(a[c] == doctest::Approx(b[c]).epsilon(Rounding));
}

}  // namespace

DOCTEST_TEST_CASE("each control does what it says, and leaves the rest") {
    const Vec3 red{0.8, 0.2, 0.1}, grey{0.5, 0.5, 0.5};
    ColourAdjustment adjustment;
    adjustment.saturation = 0;
    const double luma = dot(red, Luma);
    check_near(colour_after(red, adjustment), {luma, luma, luma});
    adjustment = {};
    adjustment.hue = 120;
    const Vec3 turned = colour_after(red, adjustment);
    DOCTEST_CHECK(turned.y > turned.x);
    // The matrix is given to three digits.
    DOCTEST_CHECK(dot(turned, Luma) == doctest::Approx(luma).epsilon(2e-3));
    check_near(colour_after(grey, adjustment), grey);
    adjustment = {};
    adjustment.brightness = 0.5;
    check_near(colour_after(red, adjustment), red * 0.5);
    adjustment = {};
    adjustment.contrast = 2;
    check_near(colour_after(grey, adjustment), grey);
    check_near(colour_after({0.6, 0.4, 0.5}, adjustment), {0.7, 0.3, 0.5});
    adjustment = {};
    adjustment.temperature = 1;
    const Vec3 warm = colour_after(grey, adjustment);
    DOCTEST_CHECK(warm.x > 0.5);
    DOCTEST_CHECK(warm.y == doctest::Approx(0.5));
    DOCTEST_CHECK(warm.z < 0.5);
}

DOCTEST_TEST_CASE("density is optical depth: twice of it is two splats behind each other") {
    DOCTEST_CHECK(opacity_after(0.5, 2) == doctest::Approx(0.75));
    DOCTEST_CHECK(opacity_after(0.75, 0.5) == doctest::Approx(0.5));
    DOCTEST_CHECK(opacity_after(1e-14, 2) == doctest::Approx(2e-14).epsilon(1e-5));
    ColourAdjustment most;
    most.density = 3;
    for (const float logit :
         {-std::numeric_limits<float>::max(), -90.0f, 90.0f, std::numeric_limits<float>::max()})
        DOCTEST_CHECK(std::isfinite(
            adjusted(one_row({0, 0, 0}, logit), std::vector<std::uint8_t>{1}, most).opacity_logit()[0]));
}

DOCTEST_TEST_CASE("an adjustment holds for the colour from every side, and only for its rows") {
    Random random(7);
    const GaussianSet set = plain_set(40, 3, 7);
    std::vector<std::uint8_t> rows(40);
    for (std::size_t row = 0; row < rows.size(); ++row) rows[row] = row % 3 == 0 ? 1 : 0;
    const ColourAdjustment adjustment{40, 1.5, 0.8, 1.2, -0.5, 1};
    const auto after = adjusted(set, rows, adjustment);
    const auto map = colour_map(adjustment);
    constexpr std::size_t Coefficients = 16;
    for (std::size_t row = 0; row < rows.size(); ++row) {
        const auto a = set.sh().subspan(row * Coefficients * 3, Coefficients * 3),
                   b = after.sh().subspan(row * Coefficients * 3, Coefficients * 3);
        if (rows[row] == 0) {
            DOCTEST_CHECK(same_row(set.spans(), row, after.spans(), row));
            continue;
        }
        // Any weights of the higher coefficients are a colour of some side, more or less.
        Vec3 side_before = base_colour(set, row), side_after = base_colour(after, row);
        for (std::size_t k = 1; k < Coefficients; ++k) {
            const double weight = random.uniform(-1, 1);
            side_before = side_before + Vec3{a[k * 3], a[k * 3 + 1], a[k * 3 + 2]} * weight;
            side_after = side_after + Vec3{b[k * 3], b[k * 3 + 1], b[k * 3 + 2]} * weight;
        }
        check_near(side_after, map.linear * side_before + map.offset);
    }
    DOCTEST_CHECK(std::equal(set.position().begin(), set.position().end(), after.position().begin()));
    DOCTEST_CHECK(
        std::equal(set.opacity_logit().begin(), set.opacity_logit().end(), after.opacity_logit().begin()));
}

DOCTEST_TEST_CASE("what is not finite stays as it is, and numbers out of range are refused by name") {
    GaussianData data = one_row({0.5, 0.5, 0.5}).to_data();
    data.sh[1] = std::numeric_limits<float>::quiet_NaN();
    const GaussianSet broken(std::move(data));
    const std::vector<std::uint8_t> all{1};
    DOCTEST_CHECK(same_row(broken.spans(), 0, adjusted(broken, all, {90, 2, 2, 2, 1, 2}).spans(), 0));
    ColourAdjustment wrong;
    wrong.saturation = 9;
    DOCTEST_CHECK_THROWS_AS(adjusted(broken, all, wrong), Error);
    DOCTEST_CHECK(adjustment_text({30, 1.2, 1, 1, 0, 1}) == "hue 30, saturation 1.2");
    DOCTEST_CHECK(adjustment_text({}).empty());
}

DOCTEST_TEST_CASE(
    "an adjustment is an edit of the stack: it can be switched off, and one that changes nothing is none") {
    Scene scene;
    scene.gaussians = plain_set(6, 1, 9);
    const DocumentState state = initial_state(scene, {});
    const std::vector<std::uint8_t> rows{0, 1, 0, 0, 1, 0};
    const auto after = with_adjustment(state, rows, {0, 0.5, 1, 1, 0, 1}, 4);
    DOCTEST_REQUIRE(after.stack.size() == 1);
    DOCTEST_CHECK(after.stack[0].name == "Colours: saturation 0.5");
    DOCTEST_CHECK(after.stack[0].delta->changed == std::vector<RowId>{1, 4});
    auto off = after.stack;
    off[0].enabled = false;
    DOCTEST_CHECK(with_stack(after, off).current.shares_all_with(state.current));
    DOCTEST_CHECK(with_adjustment(state, rows, {}, 4).stack.empty());
}

}  // namespace colour_adjustment_test
