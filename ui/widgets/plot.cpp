// Curves over iterations: linear or logarithmic, with a legend to switch them and the values under the
// cursor.
#include "ui/widgets/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ui/widgets/controls.h"

namespace gse::ui {
namespace {

constexpr double SmoothShare = 0.04;  // of the run, over which the drawn mean runs
constexpr double MostDecades = 4;     // shown of a logarithmic axis

/// Data to pixels.
struct Axes {
    ImVec2 low, high;
    double x_end = 1, y_low = 0, y_high = 1;
    bool logarithmic = false;

    double height_of(double value) const { return logarithmic ? std::log10(std::max(value, 1e-12)) : value; }
    ImVec2 at(double iteration, double value) const {
        const double x = iteration / x_end, y = (height_of(value) - y_low) / (y_high - y_low);
        return {low.x + static_cast<float>(x) * (high.x - low.x),
                high.y - static_cast<float>(std::clamp(y, 0.0, 1.0)) * (high.y - low.y)};
    }
};

bool drawable(float value, bool logarithmic) { return std::isfinite(value) && (!logarithmic || value > 0); }

Axes fit(const PlotOptions& options, std::span<const LossPoint> points, std::span<const Curve> curves) {
    Axes axes;
    axes.logarithmic = options.logarithmic;
    double lowest = std::numeric_limits<double>::max(), highest = std::numeric_limits<double>::lowest();
    for (const auto& curve : curves) {
        if (!*curve.shown) continue;
        for (std::size_t at = 0; at < points.size(); ++at) {
            const float value = curve.value(at);
            if (!drawable(value, options.logarithmic)) continue;
            lowest = std::min(lowest, axes.height_of(value));
            highest = std::max(highest, axes.height_of(value));
        }
    }
    if (lowest > highest) lowest = 0, highest = 1;
    // A curve that starts at zero must not squeeze the others.
    lowest = options.logarithmic ? std::max(lowest, highest - MostDecades) : std::min(lowest, 0.0);
    const double margin = std::max((highest - lowest) * 0.08, 1e-9);
    axes.y_low = lowest - (options.logarithmic ? margin : 0);
    axes.y_high = highest + margin;
    const int last = points.empty() ? 1 : points.back().iteration;
    axes.x_end = std::max({1, options.last_iteration, last});
    return axes;
}

void legend(Context& context, const PlotOptions& options, std::span<const Curve> curves) {
    for (std::size_t at = 0; at < curves.size(); ++at) {
        const auto& curve = curves[at];
        const float width = context.em * 1.1f + ImGui::CalcTextSize(curve.label).x;
        if (at > 0) flow(width);
        const ImVec2 low = ImGui::GetCursorScreenPos();
        const std::string name = fmt::format("{}.{}", options.name, curve.label);
        if (ImGui::InvisibleButton(name.c_str(), {width, context.em * 1.15f})) *curve.shown = !*curve.shown;
        note(context, name);
        tooltip(*curve.shown ? "Click to hide this curve" : "Click to show this curve");
        ImDrawList* list = ImGui::GetWindowDrawList();
        const ImU32 colour = *curve.shown ? curve.colour : with_alpha(palette::TextDim, 0.4f);
        list->AddRectFilled({low.x, low.y + context.em * 0.4f},
                            {low.x + context.em * 0.7f, low.y + context.em * 0.62f}, colour);
        list->AddText({low.x + context.em, low.y}, *curve.shown ? palette::Text : palette::TextDim,
                      curve.label);
    }
}

void draw_grid(Context& context, const Axes& axes) {
    ImDrawList* list = ImGui::GetWindowDrawList();
    ImFont* font = context.fonts.small != nullptr ? context.fonts.small : ImGui::GetFont();
    for (int line = 0; line <= 3; ++line) {
        const float share = static_cast<float>(line) / 3;
        const float y = std::round(axes.high.y - share * (axes.high.y - axes.low.y));
        list->AddLine({axes.low.x, y}, {axes.high.x, y}, IM_COL32(255, 255, 255, 16));
        const double height = axes.y_low + share * (axes.y_high - axes.y_low);
        const std::string text = fmt::format("{:.2g}", axes.logarithmic ? std::pow(10.0, height) : height);
        const float text_y = line == 3 ? y : y - font->FontSize;
        list->AddText(font, font->FontSize, {axes.low.x + context.em * 0.25f, text_y}, palette::TextDim,
                      text.c_str());
    }
}

/// At most two points per pixel column: lowest and highest, so that spikes stay.
void draw_raw(const Axes& axes, std::span<const LossPoint> points, const Curve& curve, float width) {
    ImDrawList* list = ImGui::GetWindowDrawList();
    const auto columns = static_cast<std::size_t>(std::max(1.0f, axes.high.x - axes.low.x));
    const std::size_t stride = std::max<std::size_t>(1, points.size() / columns);
    for (std::size_t begin = 0; begin < points.size(); begin += stride) {
        const std::size_t end = std::min(points.size(), begin + stride);
        std::size_t lowest = begin, highest = begin;
        for (std::size_t at = begin; at < end; ++at) {
            if (curve.value(at) < curve.value(lowest)) lowest = at;
            if (curve.value(at) > curve.value(highest)) highest = at;
        }
        for (const std::size_t at : {std::min(lowest, highest), std::max(lowest, highest)}) {
            if (!drawable(curve.value(at), axes.logarithmic)) continue;
            list->PathLineTo(axes.at(points[at].iteration, curve.value(at)));
            if (lowest == highest) break;
        }
    }
    list->PathStroke(with_alpha(curve.colour, 0.3f), ImDrawFlags_None, width * 0.7f);
}

/// Running mean in the heights of the axis: the trend without the noise.
void draw_smooth(const Axes& axes, std::span<const LossPoint> points, const Curve& curve, float width) {
    ImDrawList* list = ImGui::GetWindowDrawList();
    const double keep = 1 - 1.0 / std::clamp(static_cast<double>(points.size()) * SmoothShare, 1.0, 100.0);
    const auto columns = static_cast<std::size_t>(std::max(1.0f, axes.high.x - axes.low.x));
    const std::size_t stride = std::max<std::size_t>(1, points.size() / columns);
    double mean = 0, weight = 0;
    for (std::size_t at = 0; at < points.size(); ++at) {
        const float value = curve.value(at);
        if (!drawable(value, axes.logarithmic)) continue;
        mean = keep * mean + (1 - keep) * axes.height_of(value);
        weight = keep * weight + (1 - keep);
        if (weight <= 0 || at % stride != 0) continue;
        const double height = mean / weight;
        list->PathLineTo(axes.at(points[at].iteration, axes.logarithmic ? std::pow(10.0, height) : height));
    }
    list->PathStroke(curve.colour, ImDrawFlags_None, width);
}

void draw_curve(const Axes& axes, std::span<const LossPoint> points, const Curve& curve, float width) {
    draw_raw(axes, points, curve, width);
    draw_smooth(axes, points, curve, width);
}

void readout(const Axes& axes, std::span<const LossPoint> points, std::span<const Curve> curves) {
    const float share = (ImGui::GetIO().MousePos.x - axes.low.x) / std::max(1.0f, axes.high.x - axes.low.x);
    const double iteration = share * axes.x_end;
    const auto found =
        std::lower_bound(points.begin(), points.end(), iteration,
                         [](const LossPoint& point, double wanted) { return point.iteration < wanted; });
    const std::size_t at =
        found == points.end() ? points.size() - 1 : static_cast<std::size_t>(found - points.begin());
    const float x = axes.at(points[at].iteration, 1).x;
    ImGui::GetWindowDrawList()->AddLine({x, axes.low.y}, {x, axes.high.y}, IM_COL32(255, 255, 255, 70));
    std::string text = fmt::format("Iteration {}", points[at].iteration);
    for (const auto& curve : curves)
        if (*curve.shown) text += fmt::format("\n{}: {:.4g}", curve.label, curve.value(at));
    ImGui::SetTooltip("%s", text.c_str());
}

}  // namespace

void plot(Context& context, const PlotOptions& options, std::span<const LossPoint> points,
          std::span<const Curve> curves) {
    const float top = ImGui::GetCursorPosY();
    legend(context, options, curves);
    const float used = ImGui::GetCursorPosY() - top;
    const float width = std::max(1.0f, ImGui::GetContentRegionAvail().x);
    const float height = std::max(context.em * 3, options.height - used);
    const ImVec2 low = ImGui::GetCursorScreenPos();
    ImGui::InvisibleButton(std::string(options.name).c_str(), {width, height});
    note(context, options.name);
    const bool hovered = ImGui::IsItemHovered();
    ImDrawList* list = ImGui::GetWindowDrawList();
    const ImVec2 high(low.x + width, low.y + height);
    list->AddRectFilled(low, high, palette::Sunken, context.em * 0.2f);
    Axes axes = fit(options, points, curves);
    axes.low = low;
    axes.high = high;
    list->PushClipRect(low, high, true);
    draw_grid(context, axes);
    if (points.empty()) {
        list->AddText({low.x + context.em * 3, low.y + height * 0.5f - context.em * 0.5f}, palette::TextDim,
                      "curves appear when an edit runs");
    }
    if (options.marker >= 0) {
        const float x = axes.at(options.marker, 1).x;
        list->AddLine({x, low.y}, {x, high.y}, palette::Warning, std::max(1.0f, context.em * 0.1f));
    }
    for (const auto& curve : curves)
        if (*curve.shown && !points.empty())
            draw_curve(axes, points, curve, std::max(1.2f, context.em * 0.1f));
    list->PopClipRect();
    if (hovered && !points.empty()) readout(axes, points, curves);
}

}  // namespace gse::ui
