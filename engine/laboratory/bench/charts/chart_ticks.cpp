// Round numbers for axes, and numbers as text.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "engine/laboratory/bench/charts/pareto_chart.h"

namespace gse::bench {
namespace {

constexpr double Slack = 1e-9;  // of a step: rounding must not lose the last tick

std::string grouped_digits(std::string text) {
    const std::size_t sign = text.starts_with('-') ? 1 : 0;
    for (std::size_t at = text.size(); at > sign + 3;) text.insert(at -= 3, 1, ',');
    return text;
}

}  // namespace

std::vector<double> linear_ticks(double low, double high, int count) {
    std::vector<double> ticks;
    if (!(high > low) || !std::isfinite(high - low) || count < 1) return ticks;
    const double rough = (high - low) / count, power = std::pow(10.0, std::floor(std::log10(rough)));
    double step = 10 * power;
    for (const double digit : {5.0, 2.0, 1.0})
        if (digit * power >= rough * (1 - Slack)) step = digit * power;
    for (double k = std::ceil(low / step - Slack); k <= high / step + Slack; k += 1)
        ticks.push_back(k * step + 0.0);  // no -0
    return ticks;
}

std::vector<double> logarithmic_ticks(double low, double high) {
    std::vector<double> ticks;
    if (!(low > 0) || !(high > low) || !std::isfinite(high)) return ticks;
    constexpr double few = 2.2;  // powers of ten
    const double powers = std::log10(high / low);
    for (int power = static_cast<int>(std::floor(std::log10(low))); power <= std::log10(high) + Slack;
         ++power)
        for (const double digit : {1.0, 2.0, 5.0}) {
            const double tick = digit * std::pow(10.0, power);
            if (powers > few && digit > 1) continue;
            if (tick >= low * (1 - Slack) && tick <= high * (1 + Slack)) ticks.push_back(tick);
        }
    return ticks;
}

std::string number_text(double value) {
    if (!std::isfinite(value)) return "-";
    const double size = std::abs(value);
    constexpr double small = 1e-3, thousand = 999.5, large = 1e9;
    if (size >= thousand && size < large) return grouped_digits(fmt::format("{:.0f}", value));
    if (size > 0 && (size < small || size >= large)) {
        std::string text = fmt::format("{:.3g}", value);  // 1e-05 -> 1e-5
        if (const auto at = text.find("e-0"); at != std::string::npos) text.erase(at + 2, 1);
        return text;
    }
    return fmt::format("{:.3g}", value);
}

}  // namespace gse::bench
