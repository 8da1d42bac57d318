// Opacity, size, colour difference and isolation of rows, each on a scale of 0 to 1.
#include "engine/localize/row_property.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"
#include "engine/localize/row_tree.h"
#include "engine/math/quantile.h"
#include "engine/math/sh.h"
#include "engine/scene/scene.h"

namespace gse::localize {
namespace {

constexpr std::size_t Neighbours = 8;
constexpr float NoValue = std::numeric_limits<float>::quiet_NaN();

double to_log_scale(double amount, double least, double most) {
    return amount > 0 ? std::clamp(std::log(amount / least) / std::log(most / least), 0.0, 1.0) : 0;
}

double from_log_scale(double value, double least, double most) {
    return least * std::pow(most / least, value);
}

/// CIE L*a*b* of an sRGB colour under D65.
std::array<double, 3> lab_of(const std::array<double, 3>& srgb) {
    const auto linear = [](double c) {
        return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
    };
    const auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116; };
    const double r = linear(srgb[0]), g = linear(srgb[1]), b = linear(srgb[2]);
    const double x = f((0.4124564 * r + 0.3575761 * g + 0.1804375 * b) / 0.95047);
    const double y = f(0.2126729 * r + 0.7151522 * g + 0.0721750 * b);
    const double z = f((0.0193339 * r + 0.1191920 * g + 0.9503041 * b) / 1.08883);
    return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

std::vector<float> opacities(const GaussianSet& set) {
    std::vector<float> values(set.size());
    for (std::size_t row = 0; row < values.size(); ++row)
        values[row] = 1 / (1 + std::exp(-set.opacity_logit()[row]));
    return values;
}

std::vector<float> sizes(const GaussianSet& set) {
    const auto statistics = compute_statistics(set);
    const double extent = length(statistics.robust_high - statistics.robust_low);
    std::vector<float> values(set.size(), NoValue);
    for (std::size_t row = 0; row < values.size(); ++row) {
        const auto* scale = &set.log_scale()[row * 3];
        if (std::isnan(scale[0]) || std::isnan(scale[1]) || std::isnan(scale[2])) continue;
        const double share = std::exp(static_cast<double>(std::max({scale[0], scale[1], scale[2]}))) /
                             (extent > 0 ? extent : 1);
        values[row] = static_cast<float>(property_value(RowProperty::Size, share));
    }
    return values;
}

std::vector<float> differences(const GaussianSet& set, const std::array<float, 3>& colour) {
    const auto wanted = lab_of({colour[0], colour[1], colour[2]});
    const std::size_t stride = set.empty() ? 0 : set.sh().size() / set.size();
    std::vector<float> values(set.size(), NoValue);
    for (std::size_t row = 0; row < values.size(); ++row) {
        std::array<double, 3> base{};
        for (std::size_t c = 0; c < 3; ++c)
            base[c] = colour_from_sh(static_cast<double>(set.sh()[row * stride + c]));
        if (!std::isfinite(base[0] + base[1] + base[2])) continue;
        for (auto& channel : base) channel = std::clamp(channel, 0.0, 1.0);
        const auto lab = lab_of(base);
        const double far = std::hypot(lab[0] - wanted[0], lab[1] - wanted[1], lab[2] - wanted[2]);
        values[row] = static_cast<float>(property_value(RowProperty::Colour, far));
    }
    return values;
}

std::vector<float> isolations(const GaussianSet& set, ThreadPool* threads) {
    std::vector<float> values(set.size(), NoValue);
    const auto gaussians = set.spans();
    RowPoints points;
    for (std::size_t row = 0; row < set.size(); ++row)
        if (finite_position(gaussians, row)) points.add(gaussians, row);
    if (points.row.size() < 2) return values;
    points = along_curve(gaussians, points);
    const RowTree tree(3, points, nanoflann::KDTreeSingleIndexAdaptorParams(RowTreeLeaf));
    std::vector<float> distance(points.row.size());
    nearest_of_all(tree, points.position, Neighbours + 1, threads,  // the nearest is the row itself
                   [&](std::size_t point, std::span<const std::uint32_t>, std::span<const float> squared) {
                       double sum = 0;
                       for (const float d : squared) sum += std::sqrt(static_cast<double>(d));
                       distance[point] = static_cast<float>(
                           sum / static_cast<double>(std::max<std::size_t>(1, squared.size() - 1)));
                   });
    auto sorted = distance;
    const auto median = static_cast<double>(upper_median(sorted));
    const double usual = median > 0 ? median : 1;
    for (std::size_t i = 0; i < distance.size(); ++i)
        values[points.row[i]] =
            static_cast<float>(property_value(RowProperty::Isolation, distance[i] / usual));
    return values;
}

}  // namespace

double property_amount(RowProperty property, double value) {
    switch (property) {
        case RowProperty::Opacity: return value;
        case RowProperty::Size: return from_log_scale(value, LeastSize, MostSize);
        case RowProperty::Colour: return value * MostDifference;
        case RowProperty::Isolation: return from_log_scale(value, LeastIsolation, MostIsolation);
    }
    return value;
}

double property_value(RowProperty property, double amount) {
    switch (property) {
        case RowProperty::Opacity: return std::clamp(amount, 0.0, 1.0);
        case RowProperty::Size: return to_log_scale(amount, LeastSize, MostSize);
        case RowProperty::Colour: return std::clamp(amount / MostDifference, 0.0, 1.0);
        case RowProperty::Isolation: return to_log_scale(amount, LeastIsolation, MostIsolation);
    }
    return amount;
}

std::array<float, 3> mean_colour(const GaussianSet& set, std::span<const std::uint8_t> rows) {
    GSE_CHECK_EQ(rows.size(), set.size());
    const std::size_t stride = set.empty() ? 0 : set.sh().size() / set.size();
    std::array<double, 3> sum{};
    std::size_t count = 0;
    for (std::size_t row = 0; row < rows.size(); ++row) {
        const float* base = &set.sh()[row * stride];
        if (rows[row] == 0 || !std::isfinite(base[0] + base[1] + base[2])) continue;
        for (std::size_t c = 0; c < 3; ++c)
            sum[c] += std::clamp(colour_from_sh(static_cast<double>(base[c])), 0.0, 1.0);
        ++count;
    }
    std::array<float, 3> mean{0.5f, 0.5f, 0.5f};
    for (std::size_t c = 0; count > 0 && c < 3; ++c)
        mean[c] = static_cast<float>(sum[c] / static_cast<double>(count));
    return mean;
}

std::vector<float> row_values(const GaussianSet& set, RowProperty property,
                              const std::array<float, 3>& colour, ThreadPool* threads) {
    switch (property) {
        case RowProperty::Opacity: return opacities(set);
        case RowProperty::Size: return sizes(set);
        case RowProperty::Colour: return differences(set, colour);
        case RowProperty::Isolation: return isolations(set, threads);
    }
    return {};
}

std::vector<std::uint8_t> rows_between(std::span<const float> values, float least, float most,
                                       std::span<const std::uint8_t> within) {
    GSE_CHECK(within.empty() || within.size() == values.size());
    std::vector<std::uint8_t> rows(values.size());
    for (std::size_t row = 0; row < rows.size(); ++row)  // NaN is between nothing
        rows[row] =
            values[row] >= least && values[row] <= most && (within.empty() || within[row] != 0) ? 1 : 0;
    return rows;
}

std::vector<std::uint8_t> chosen_rows(const RowChoice& choice, std::span<const float> values,
                                      std::span<const std::uint8_t> within) {
    return choice.above ? rows_between(values, choice.threshold, 1, within)
                        : rows_between(values, 0, choice.threshold, within);
}

std::string choice_text(const RowChoice& choice) {
    const double amount = property_amount(choice.property, static_cast<double>(choice.threshold));
    const char* side = choice.above ? "above" : "below";
    switch (choice.property) {
        case RowProperty::Opacity: return fmt::format("opacity {} {:.2f}", side, amount);
        case RowProperty::Size: return fmt::format("size {} {:.2g} %", side, 100 * amount);
        case RowProperty::Colour:
            return fmt::format("colour {} {:.0f}", choice.above ? "beyond" : "within", amount);
        case RowProperty::Isolation: return fmt::format("{} {:.1f} times the usual distance", side, amount);
    }
    return {};
}

}  // namespace gse::localize
