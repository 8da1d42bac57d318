// Histogram of values in [0,1] with a threshold to drag, and the count above it at once.
#include "ui/widgets/histogram.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ui/keys/keyboard.h"
#include "ui/widgets/controls.h"

namespace gse::ui {
namespace {

int bin_of(float value) {
    return std::clamp(static_cast<int>(value * WeightHistogram::Bins), 0, WeightHistogram::Bins - 1);
}

struct Frame {
    ImVec2 low, high;
    float width() const { return high.x - low.x; }
    float height() const { return high.y - low.y; }
};

/// One bar per few pixels; heights are logarithmic, because most splats weigh next to nothing.
void draw_bars(Context& context, const WeightHistogram& data, const Frame& frame, float threshold,
               bool below) {
    const float bar_px = std::max(2.0f, std::round(context.em * 0.18f));
    const int bars = std::max(1, static_cast<int>(frame.width() / bar_px));
    std::vector<double> heights(static_cast<std::size_t>(bars), 0.0);
    for (int bin = 0; bin < WeightHistogram::Bins; ++bin)
        heights[static_cast<std::size_t>(bin * bars / WeightHistogram::Bins)] +=
            data.counts()[static_cast<std::size_t>(bin)];
    double most = 1;
    for (auto& height : heights) most = std::max(most, height = std::log1p(height));
    ImDrawList* list = ImGui::GetWindowDrawList();
    for (int bar = 0; bar < bars; ++bar) {
        const float left = frame.low.x + frame.width() * static_cast<float>(bar) / static_cast<float>(bars);
        const float share = static_cast<float>(heights[static_cast<std::size_t>(bar)] / most) * 0.94f;
        const bool inside = (static_cast<float>(bar) + 0.5f) / static_cast<float>(bars) > threshold;
        const bool counts = inside != below;
        list->AddRectFilled({left, frame.high.y - share * frame.height()}, {left + bar_px - 1, frame.high.y},
                            counts ? palette::Accent : IM_COL32(92, 95, 101, 255));
    }
}

void draw_handle(Context& context, const Frame& frame, float threshold, bool hot, bool below) {
    ImDrawList* list = ImGui::GetWindowDrawList();
    const float x = std::round(frame.low.x + threshold * frame.width());
    const ImU32 colour = hot ? palette::OnAccent : palette::Text;
    list->AddRectFilled({below ? x : frame.low.x, frame.low.y}, {below ? frame.high.x : x, frame.high.y},
                        IM_COL32(0, 0, 0, 60));
    list->AddLine({x, frame.low.y}, {x, frame.high.y}, colour, std::max(1.0f, context.em * 0.1f));
    const float r = context.em * 0.35f;
    list->AddTriangleFilled({x - r, frame.low.y}, {x + r, frame.low.y}, {x, frame.low.y + r * 1.3f}, colour);
}

}  // namespace

void WeightHistogram::update(const std::shared_ptr<const std::vector<float>>& weight) {
    if (weight == weight_) return;
    weight_ = weight;
    std::fill(counts_.begin(), counts_.end(), 0u);
    if (weight_ != nullptr)
        for (const float value : *weight_)
            if (value == value) ++counts_[static_cast<std::size_t>(bin_of(value))];
    above_[Bins] = 0;
    for (int bin = Bins; bin-- > 0;)
        above_[static_cast<std::size_t>(bin)] =
            above_[static_cast<std::size_t>(bin) + 1] + counts_[static_cast<std::size_t>(bin)];
}

std::size_t WeightHistogram::above(float threshold) const {
    const int bin = std::clamp(static_cast<int>(std::lround(threshold * Bins)), 0, Bins);
    return above_[static_cast<std::size_t>(bin)];
}

ThresholdDrag histogram(Context& context, std::string_view name, const WeightHistogram& data, float height,
                        float& threshold, bool below) {
    const float width = std::max(1.0f, ImGui::GetContentRegionAvail().x);
    const ImVec2 low = ImGui::GetCursorScreenPos();
    const Frame frame{low, {low.x + width, low.y + height}};
    ImGui::InvisibleButton(std::string(name).c_str(), {width, height});
    note(context, name);
    ThresholdDrag drag;
    constexpr float KeyStep = 0.01f;
    const int step = focus_step_sideways();
    if (step != 0) {
        const float wanted = std::clamp(threshold + KeyStep * static_cast<float>(step), 0.0f, 1.0f);
        drag.changed = wanted != threshold;
        threshold = wanted;
    } else if (ImGui::IsItemActive() && ImGui::IsMouseDown(ImGuiMouseButton_Left)) {
        const float wanted = std::clamp((ImGui::GetIO().MousePos.x - low.x) / width, 0.0f, 1.0f);
        drag.changed = wanted != threshold;
        threshold = wanted;
    }
    drag.released = ImGui::IsItemDeactivated() || (drag.changed && step != 0);
    ImDrawList* list = ImGui::GetWindowDrawList();
    list->AddRectFilled(frame.low, frame.high, palette::Sunken, context.em * 0.2f);
    list->PushClipRect(frame.low, frame.high, true);
    draw_bars(context, data, frame, threshold, below);
    draw_handle(context, frame, threshold, ImGui::IsItemActive() || ImGui::IsItemHovered(), below);
    list->PopClipRect();
    if (ImGui::IsItemHovered() || ImGui::IsItemActive()) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    return drag;
}

}  // namespace gse::ui
