// Short messages at the lower right of the picture. No control lies below them.
#include <fmt/format.h>

#include <algorithm>

#include "ui/state/state.h"
#include "ui/viewport/viewport.h"
#include "ui/widgets/controls.h"

namespace gse::ui {
namespace {

constexpr float WidestEm = 26, NarrowestEm = 9;
constexpr float AxesCornerEm = 6;  // the corner of the axes, which turn the view when they are pressed

/// Area for toasts.
struct Space {
    float left = 0, right = 0, top = 0, bottom = 0;
};

Space space_of(const Context& context, float top) {
    const auto& state = context.state.viewport;
    const float em = context.em;
    Space space{state.low.x + em, state.high.x - em, top, state.high.y - em};
    if (!context.scene_open()) return space;
    space.bottom = std::min(space.bottom, state.foot_low.y - em * 0.4f);
    const float beside_axes = space.right - (state.low.x + AxesCornerEm * em);
    if (context.view.show_axes && beside_axes < WidestEm * em) {
        if (beside_axes >= NarrowestEm * 2 * em) space.left = space.right - beside_axes;
        else space.bottom = std::min(space.bottom, state.foot_low.y) - AxesCornerEm * em;
    }
    if (context.model.comparison == Comparison::Wipe) {  // its handle stays free
        const float handle = state.low.x + context.view.wipe * (state.high.x - state.low.x);
        if (handle > space.right - WidestEm * em - em)
            space.top = std::max(space.top, (state.low.y + state.high.y) * 0.5f + em);
    }
    return space;
}

/// One message laid out for a width.
struct ToastPlan {
    std::string text;
    ImVec2 text_size;
    float buttons = 0;  // width of them
    bool one_line = false;
    ImVec2 size;
};

ToastPlan plan_of(const Context& context, const Toast& toast, float width, float height) {
    const ImGuiStyle& style = ImGui::GetStyle();
    const float inner = width - style.WindowPadding.x * 2;
    ToastPlan plan{broken_at_spaces(toast.text, inner), {}, 0, false, {}};
    plan.text_size = ImGui::CalcTextSize(plan.text.c_str(), nullptr, false, inner);
    plan.buttons = button_width("Close");
    if (!toast.button.empty()) plan.buttons += button_width(toast.button) + style.ItemSpacing.x;
    plan.size = {
        std::min(inner, std::max(plan.text_size.x + 1, plan.buttons)) + style.WindowPadding.x * 2,
        plan.text_size.y + style.ItemSpacing.y + ImGui::GetFrameHeight() + style.WindowPadding.y * 2};
    if (plan.size.y <= height) return plan;
    plan.one_line = true;  // what is left out stands in the log
    plan.text = shortened(toast.text, inner - plan.buttons - style.ItemSpacing.x);
    plan.size = {width, ImGui::GetFrameHeight() + style.WindowPadding.y * 2};
    return plan;
}

void draw_toast(Context& context, std::size_t index, const ToastPlan& plan, ImVec2 low) {
    const auto& toast = context.model.toasts[index];
    ImGui::SetCursorScreenPos(low);
    ImGui::PushStyleColor(ImGuiCol_Border, toast.is_error ? palette::Bad : palette::Border);
    ImGui::PushStyleColor(ImGuiCol_ChildBg, palette::Panel);
    ImGui::BeginChild(fmt::format("toast {}", index).c_str(), plan.size, true,
                      ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse);
    if (plan.one_line) ImGui::AlignTextToFramePadding();
    ImGui::PushTextWrapPos(plan.one_line ? -1.0f : 0.0f);
    plain_text(plan.text);
    ImGui::PopTextWrapPos();
    if (plan.one_line) {
        tooltip(toast.text);
        ImGui::SameLine(plan.size.x - plan.buttons - ImGui::GetStyle().WindowPadding.x);
    }
    if (!toast.button.empty()) {
        if (button(context, {.name = fmt::format("toast.{}.button", index), .text = toast.button}))
            context.emit(command::PressToast{index});
        ImGui::SameLine();
    }
    if (button(context, {.name = fmt::format("toast.{}.close", index), .text = "Close", .look = Look::Quiet}))
        context.emit(command::DismissToast{index});
    ImGui::EndChild();
    note(context, fmt::format("toast.{}", index));
    ImGui::PopStyleColor(2);
}

}  // namespace

float draw_toasts(Context& context, float top) {
    const Space space = space_of(context, top);
    const float width = std::min(context.em * WidestEm, space.right - space.left);
    if (width < context.em * NarrowestEm) return 0;
    float bottom = space.bottom;
    for (std::size_t index = context.model.toasts.size(); index-- > 0;) {
        const ToastPlan plan = plan_of(context, context.model.toasts[index], width, bottom - space.top);
        if (bottom - plan.size.y < space.top) break;  // older ones wait for room
        draw_toast(context, index, plan, {space.right - plan.size.x, bottom - plan.size.y});
        bottom -= plan.size.y + context.em * 0.4f;
    }
    return bottom < space.bottom ? context.state.viewport.high.y - bottom : 0;
}

}  // namespace gse::ui
