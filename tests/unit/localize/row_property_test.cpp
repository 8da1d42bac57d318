// Rows by opacity, size, colour and isolation.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/base/random.h"
#include "engine/localize/row_picking.h"
#include "engine/localize/row_property.h"
#include "engine/math/sh.h"

namespace row_property_test {

using namespace gse;
using localize::RowProperty;

namespace {

constexpr std::array<RowProperty, 4> All{RowProperty::Opacity, RowProperty::Size, RowProperty::Colour,
                                         RowProperty::Isolation};
constexpr std::array<float, 3> Black{0, 0, 0};
constexpr double Rounding = 1e-5;  // floats that went through a logarithm

/// Rows in a unit cube, the last one far away from it.
GaussianData cloud(std::size_t count, double scale = 1) {
    GaussianData data;
    data.resize(count);
    Random random(5);
    for (std::size_t row = 0; row < count; ++row) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            data.position[row * 3 + axis] =
                static_cast<float>((random.uniform() + (row + 1 == count ? 3 : 0)) * scale);
            data.log_scale[row * 3 + axis] =
                static_cast<float>(std::log(0.01 * scale * (1 + static_cast<double>(axis))));
            data.sh[row * data.sh_stride() + axis] = static_cast<float>(sh_from_colour(random.uniform()));
        }
        data.rotation[row * 4] = 1;
        data.opacity_logit[row] = static_cast<float>(random.uniform(-6, 6));
    }
    return data;
}

std::vector<float> values_of(const GaussianData& data, RowProperty property, ThreadPool* threads = nullptr) {
    return localize::row_values(GaussianSet(GaussianData(data)), property, Black, threads);
}

}  // namespace

DOCTEST_TEST_CASE("every property lies in [0,1] and its amounts go back to its values") {
    const auto data = cloud(300);
    for (const auto property : All) {
        for (const float value : values_of(data, property)) DOCTEST_CHECK((value >= 0 && value <= 1));
        for (const double value : {0.0, 0.2, 0.5, 0.99, 1.0})
            DOCTEST_CHECK(localize::property_value(property, localize::property_amount(property, value)) ==
                          doctest::Approx(value));
    }
}

DOCTEST_TEST_CASE("opacity: what a logit stands for, infinite ones too") {
    auto data = cloud(4);
    data.opacity_logit = {0, std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
                          std::numeric_limits<float>::quiet_NaN()};
    const auto values = values_of(data, RowProperty::Opacity);
    DOCTEST_CHECK(values[0] == 0.5f);
    DOCTEST_CHECK(values[1] == 1);
    DOCTEST_CHECK(values[2] == 0);
    DOCTEST_CHECK(std::isnan(values[3]));
    DOCTEST_CHECK(localize::rows_between(values, 0, 1) == std::vector<std::uint8_t>{1, 1, 1, 0});
}

DOCTEST_TEST_CASE("size and isolation are relative to the scene: a larger world gives the same") {
    for (const auto property : {RowProperty::Size, RowProperty::Isolation}) {
        const auto small = values_of(cloud(200), property), large = values_of(cloud(200, 1000), property);
        for (std::size_t row = 0; row < small.size(); ++row)
            DOCTEST_CHECK(small[row] == doctest::Approx(large[row]).epsilon(1e-4));
    }
    auto data = cloud(200);
    data.log_scale[30] += std::log(2.0f);  // of row 10; its largest is 32
    data.log_scale[32] += std::log(2.0f);
    const auto before = values_of(cloud(200), RowProperty::Size), after = values_of(data, RowProperty::Size);
    const auto amount = [](float value) {
        return localize::property_amount(RowProperty::Size, static_cast<double>(value));
    };
    DOCTEST_CHECK(amount(after[10]) == doctest::Approx(2 * amount(before[10])).epsilon(1e-3));
    DOCTEST_CHECK(after[11] == before[11]);
}

DOCTEST_TEST_CASE("colour difference: that of CIE L*a*b*") {
    auto data = cloud(3);
    const std::array<double, 3> grey{0.5, 0.5, 0.5}, white{1, 1, 1}, black{0, 0, 0};
    std::size_t row = 0;
    for (const auto& colour : {black, grey, white}) {
        for (std::size_t c = 0; c < 3; ++c)
            data.sh[row * data.sh_stride() + c] = static_cast<float>(sh_from_colour(colour[c]));
        ++row;
    }
    const auto values = values_of(data, RowProperty::Colour);
    DOCTEST_CHECK(values[0] == doctest::Approx(0).epsilon(1e-3));
    DOCTEST_CHECK(values[1] == doctest::Approx(0.53389).epsilon(1e-3));  // L* of sRGB 0.5 is 53.389
    DOCTEST_CHECK(values[2] == doctest::Approx(1.0).epsilon(1e-3));
    const GaussianSet set{GaussianData(data)};
    DOCTEST_CHECK(localize::mean_colour(set, std::vector<std::uint8_t>{1, 0, 1})[1] == doctest::Approx(0.5));
    DOCTEST_CHECK(localize::mean_colour(set, std::vector<std::uint8_t>{0, 0, 1})[2] == doctest::Approx(1.0));
    DOCTEST_CHECK(localize::mean_colour(set, std::vector<std::uint8_t>{0, 0, 0})[0] == 0.5f);
}

DOCTEST_TEST_CASE("isolation: the tree agrees with all distances, and finds what is far from the rest") {
    const auto data = cloud(150);
    std::vector<double> distance;
    for (std::size_t a = 0; a < 150; ++a) {
        std::vector<double> all;
        for (std::size_t b = 0; b < 150; ++b)
            if (a != b)
                all.push_back(
                    std::hypot(static_cast<double>(data.position[a * 3]) - data.position[b * 3],
                               static_cast<double>(data.position[a * 3 + 1]) - data.position[b * 3 + 1],
                               static_cast<double>(data.position[a * 3 + 2]) - data.position[b * 3 + 2]));
        std::sort(all.begin(), all.end());
        double sum = 0;
        for (std::size_t k = 0; k < 8; ++k) sum += all[k];
        distance.push_back(sum / 8);
    }
    auto sorted = distance;
    std::sort(sorted.begin(), sorted.end());
    ThreadPool threads(2);
    const auto values = values_of(data, RowProperty::Isolation),
               side_by_side = values_of(data, RowProperty::Isolation, &threads);
    DOCTEST_CHECK(values == side_by_side);
    for (std::size_t row = 0; row < 150; ++row)
        DOCTEST_CHECK(values[row] == doctest::Approx(localize::property_value(RowProperty::Isolation,
                                                                              distance[row] / sorted[75]))
                                         .epsilon(Rounding * 10));
    DOCTEST_CHECK(std::max_element(values.begin(), values.end()) == values.end() - 1);
    const auto far = localize::rows_between(
        values, static_cast<float>(localize::property_value(RowProperty::Isolation, 4)), 1);
    DOCTEST_CHECK(std::count(far.begin(), far.end(), 1) == 1);
    DOCTEST_CHECK(far.back() == 1);
}

DOCTEST_TEST_CASE("rows between two values, within others") {
    const std::vector<float> values{0.1f, 0.2f, 0.3f, std::numeric_limits<float>::quiet_NaN()};
    DOCTEST_CHECK(localize::rows_between(values, 0.2f, 1) == std::vector<std::uint8_t>{0, 1, 1, 0});
    DOCTEST_CHECK(localize::rows_between(values, 0.2f, 1, std::vector<std::uint8_t>{1, 0, 1, 1}) ==
                  std::vector<std::uint8_t>{0, 0, 1, 0});
    for (const auto property : All)
        DOCTEST_CHECK(localize::row_values(GaussianSet(), property, Black, nullptr).empty());
}

DOCTEST_TEST_CASE(
    "picking measures once for each property, and chooses anew only where something has changed") {
    const GaussianSet set(cloud(60)), other(cloud(60));
    localize::RowPicking picking;
    localize::RowChoice choice{RowProperty::Opacity, {}, 0.5f, false, false};
    picking.choose(choice);
    DOCTEST_CHECK(picking.wants_values(set));
    picking.take(set, choice,
                 std::make_shared<const std::vector<float>>(values_of(set.to_data(), RowProperty::Opacity)));
    DOCTEST_CHECK_FALSE(picking.wants_values(set));
    DOCTEST_CHECK(picking.wants_values(other));  // the same values, but other arrays
    DOCTEST_CHECK(picking.update(nullptr, {}));
    DOCTEST_CHECK_FALSE(picking.update(nullptr, {}));
    const auto all = *picking.rows();
    DOCTEST_CHECK(all == localize::rows_between(*picking.values(), 0, 0.5f));
    choice.threshold = 0.7f;
    picking.choose(choice);
    DOCTEST_CHECK_FALSE(picking.wants_values(set));  // a moved line needs no measuring
    DOCTEST_CHECK(picking.update(nullptr, {}));
    DOCTEST_CHECK(picking.chosen() == choice);
    choice.within_label = true;
    picking.choose(choice);
    std::vector<std::uint8_t> label(60, 0), hidden(60, 0);
    std::fill(label.begin(), label.begin() + 30, std::uint8_t{1});
    std::fill(hidden.begin(), hidden.begin() + 10, std::uint8_t{1});
    const auto shared = std::make_shared<const std::vector<std::uint8_t>>(label);
    DOCTEST_CHECK(picking.update(shared, hidden));
    for (std::size_t row = 0; row < 60; ++row)
        DOCTEST_CHECK((*picking.rows())[row] ==
                      ((*picking.values())[row] <= 0.7f && row >= 10 && row < 30 ? 1 : 0));
    DOCTEST_CHECK_FALSE(picking.update(shared, hidden));
    picking.forget_rows();
    DOCTEST_CHECK(picking.update(shared, {}));
    choice.property = RowProperty::Colour;
    picking.choose(choice);
    DOCTEST_CHECK(picking.wants_values(set));
    picking.take(set, choice, std::make_shared<const std::vector<float>>(60, 0.1f));
    choice.colour = {1, 0, 0};
    picking.choose(choice);
    DOCTEST_CHECK(picking.wants_values(set));  // differences are to another colour now
    DOCTEST_CHECK(localize::choice_text(choice) == "colour within 70");
}

}  // namespace row_property_test
