// The search for a free place, among the edges of the controls.
#include "ui/widgets/tooltips.h"
#include "ui/keys/keyboard.h"

#include <imgui_internal.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "ui/widgets/controls.h"

namespace gse::ui {
namespace {

constexpr float GapEm = 0.25f;        // between the tooltip and what is beside it
constexpr float SidewaysCost = 2;     // of a pixel beside the item, against one below or above it
constexpr float MiddleShare = 1e-3f;  // of the way between the middles: of equal places the more central one

constexpr float LargePictureEm = 22;  // longer side of a picture that is looked at

/// Controls of the last frame.
std::vector<Rect>& kept_controls() {
    static std::vector<Rect> controls;
    return controls;
}

bool& awaited() {
    static bool waits = false;
    return waits;
}

bool covers(ImVec2 at, ImVec2 size, const Rect& rect) {
    return at.x < rect.x + rect.width && rect.x < at.x + size.x && at.y < rect.y + rect.height &&
           rect.y < at.y + size.y;
}

/// Free way between two stretches of a line; 0 where they overlap.
float way(float low, float size, float other_low, float other_size) {
    return std::max({0.0f, other_low - (low + size), low - (other_low + other_size)});
}

float cost_of(ImVec2 at, ImVec2 size, const Rect& item) {
    const float middle = std::hypot(at.x + size.x * 0.5f - item.x - item.width * 0.5f,
                                    at.y + size.y * 0.5f - item.y - item.height * 0.5f);
    return SidewaysCost * way(at.x, size.x, item.x, item.width) + way(at.y, size.y, item.y, item.height) +
           MiddleShare * middle;
}

}  // namespace

ImVec2 tooltip_place(ImVec2 size, const Rect& item, std::span<const Rect> controls, ImVec2 screen) {
    const float gap = std::round(ImGui::GetFontSize() * GapEm);
    const ImVec2 most(std::max(0.0f, screen.x - size.x), std::max(0.0f, screen.y - size.y));
    std::vector<float> lefts{item.x, item.x + item.width - size.x,
                             item.x + item.width * 0.5f - size.x * 0.5f},
        tops{item.y};
    const auto add = [&](const Rect& rect) {
        lefts.insert(lefts.end(), {rect.x + rect.width + gap, rect.x - size.x - gap});
        tops.insert(tops.end(), {rect.y + rect.height + gap, rect.y - size.y - gap});
    };
    add(item);
    for (const auto& rect : controls) add(rect);
    const ImVec2 below(std::clamp(item.x, 0.0f, most.x),
                       std::clamp(item.y + item.height + gap, 0.0f, most.y));
    ImVec2 best = below;
    float least = HUGE_VALF;
    for (const float top : tops)
        for (const float left : lefts) {
            const ImVec2 at(std::round(std::clamp(left, 0.0f, most.x)),
                            std::round(std::clamp(top, 0.0f, most.y)));
            const float cost = cost_of(at, size, item);
            if (cost >= least || covers(at, size, item)) continue;
            if (std::any_of(controls.begin(), controls.end(),
                            [&](const Rect& rect) { return covers(at, size, rect); }))
                continue;
            least = cost;
            best = at;
        }
    return best;
}

void keep_controls(Context& context) {
    awaited() = false;
    auto& controls = kept_controls();
    controls.clear();
    for (const auto& stop : context.keyboard.stops) {
        const auto found = context.widgets.find(stop.name);
        if (stop.name == "viewport" || found == context.widgets.end() || !found->second.visible) continue;
        controls.push_back(found->second);
    }
    for (const auto& [name, rect] : context.widgets)
        if (rect.visible && (!rect.enabled || name.starts_with("menu."))) controls.push_back(rect);
}

void await_tooltip() { awaited() = true; }
bool awaits_tooltip() { return awaited(); }

void begin_tooltip(ImVec2 contents) {
    const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
    const ImVec2 padding = ImGui::GetStyle().WindowPadding;
    const ImVec2 size(std::ceil(contents.x + 2 * padding.x), std::ceil(contents.y + 2 * padding.y));
    ImGui::SetNextWindowPos(tooltip_place(size, {low.x, low.y, high.x - low.x, high.y - low.y},
                                          kept_controls(), ImGui::GetIO().DisplaySize));
    ImGui::BeginTooltip();
}

void large_picture(Context& context, const std::shared_ptr<const Image>& picture, std::string_view text) {
    if (picture == nullptr || picture->width <= 0 || picture->height <= 0) return;
    if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled) || ImGui::IsAnyMouseDown()) return;
    const auto& screen = ImGui::GetIO().DisplaySize;
    const float side = std::min({context.em * LargePictureEm, screen.x * 0.4f, screen.y * 0.4f});
    const float scale = side / static_cast<float>(std::max(picture->width, picture->height));
    const ImVec2 size(static_cast<float>(picture->width) * scale,
                      static_cast<float>(picture->height) * scale);
    begin_tooltip({size.x, size.y + ImGui::GetTextLineHeightWithSpacing()});
    ImGui::Image(imgui_texture(context.textures.texture(picture)), size);
    plain_text(shortened(text, size.x));
    ImGui::EndTooltip();
}

}  // namespace gse::ui
