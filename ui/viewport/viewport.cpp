// The picture in the middle: its header, the picture itself, and who gets the mouse over it.
#include "ui/viewport/viewport.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ui/commands.h"
#include "ui/keys.h"
#include "ui/state.h"
#include "ui/widgets/controls.h"
#include "ui/widgets/icons.h"

namespace gse::ui {
namespace {

void draw_mode(Context& context) {
    int mode = context.view.mode;
    if (combo(context, "viewport.mode", DisplayModeNames, mode, context.em * 9)) {
        context.view.mode = mode;
        context.view_changed = true;
    }
    tooltip("How splats are shown");
}

void draw_view_list(Context& context) {
    const auto& views = context.document().views;
    const int selected = context.state.viewport.selected_view;
    const std::string text = selected >= 0 && selected < static_cast<int>(views.size())
                                 ? views[static_cast<std::size_t>(selected)].name
                                 : fmt::format("{} views", views.size());
    ImGui::SetNextItemWidth(context.em * 9);
    const bool open = ImGui::BeginCombo("##viewport.views", shortened(text, context.em * 7).c_str(),
                                        ImGuiComboFlags_HeightLarge);
    note(context, "viewport.views");
    if (!open) return tooltip("Look through a camera of the scene (Left, Right)");
    for (std::size_t index = 0; index < views.size(); ++index) {
        ImGui::PushID(static_cast<int>(index));
        if (ImGui::Selectable(views[index].name.c_str(), static_cast<int>(index) == selected)) {
            context.state.viewport.selected_view = static_cast<int>(index);
            context.actions.look_through(index);
        }
        ImGui::PopID();
    }
    ImGui::EndCombo();
}

void toggle(Context& context, const char* name, Icon icon, bool& value, const char* what) {
    flow(context.em * 1.75f);
    if (!icon_button(context, {.name = name, .icon = icon, .tooltip = what, .active = value})) return;
    value = !value;
    context.view_changed = true;
}

void draw_header(Context& context) {
    const std::string why = context.scene_open() ? "" : "Open a scene first";
    if (!why.empty()) ImGui::BeginDisabled();
    draw_mode(context);
    flow(context.em * 1.75f);
    if (icon_button(context, {.name = "viewport.compare",
                              .icon = Icon::Wipe,
                              .tooltip = "Wipe between before and after (V)",
                              .active = context.model.comparison == Comparison::Wipe,
                              .why_off = why}))
        toggle_wipe(context);
    flow(context.em * 1.75f);
    const bool original = context.model.comparison == Comparison::Original;
    if (icon_button(context, {.name = "viewport.original",
                              .icon = Icon::Flip,
                              .tooltip = "Show the original (hold `)",
                              .active = original,
                              .why_off = why}))
        context.actions.set_comparison(original ? Comparison::None : Comparison::Original);
    toggle(context, "viewport.tint", Icon::Tag, context.view.tint_labels, "Tint what is labelled (Tab)");
    toggle(context, "viewport.axes", Icon::Axes, context.view.show_axes, "World axes");
    toggle(context, "viewport.bounds", Icon::Box, context.view.show_bounds, "Box around the scene");
    toggle(context, "viewport.cameras", Icon::Camera, context.view.show_views, "Cameras of the views");
    if (context.scene_open()) {
        flow(context.em * 9);
        draw_view_list(context);
    }
    if (!why.empty()) ImGui::EndDisabled();
}

void draw_picture(Context& context, ImVec2 size) {
    auto& state = context.state.viewport;
    ImDrawList* list = ImGui::GetWindowDrawList();
    list->AddRectFilled(state.low, state.high, palette::Window);
    ImGui::InvisibleButton("viewport", size,
                           ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                               ImGuiButtonFlags_MouseButtonMiddle);
    note(context, "viewport");
    const bool hovered = ImGui::IsItemHovered();
    if (context.model.viewport != 0)
        list->AddImage(imgui_texture(context.model.viewport), state.low, state.high);
    if (context.model.viewport_original != 0 && context.model.comparison == Comparison::Wipe) {
        const float share = context.view.wipe;
        list->AddImage(imgui_texture(context.model.viewport_original), state.low,
                       {state.low.x + share * (state.high.x - state.low.x), state.high.y}, {0, 0},
                       {share, 1});
    }
    navigate(context, hovered);
    const bool keys_free =
        !ImGui::GetIO().WantTextInput && !context.state.files.is_open() &&
        !ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
    update_camera(context, keys_free);
    draw_overlays(context, list);
    list->PushClipRect(state.low, state.high, true);
    draw_tool_cursor(context, list, hovered);
    list->PopClipRect();
}

/// A small window over the picture that sizes itself; false when there is nothing to draw in it.
void begin_floating(const char* name, ImVec2 at, ImVec2 pivot) {
    ImGui::SetNextWindowPos(at, ImGuiCond_Always, pivot);
    ImGui::SetNextWindowBgAlpha(0.96f);
    ImGui::Begin(name, nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing |
                     ImGuiWindowFlags_NoNav);
}

}  // namespace

void draw_result_bar(Context& context) {
    if (!context.model.result_waiting || !context.scene_open()) return;
    const auto& state = context.state.viewport;
    begin_floating("result bar", {(state.low.x + state.high.x) * 0.5f, state.low.y + context.em * 2.6f},
                   {0.5f, 0});
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted("Edit done");
    ImGui::SameLine();
    const bool wipes = context.model.comparison == Comparison::Wipe;
    if (button(context, {.name = "result.compare",
                         .text = wipes ? "Stop comparing" : "Compare",
                         .tooltip = "Wipe between before and after (V)"}))
        toggle_wipe(context);
    ImGui::SameLine();
    if (button(context, {.name = "result.apply",
                         .text = "Apply",
                         .tooltip = "Keep it as an entry of the edit stack",
                         .look = Look::Primary}))
        context.actions.apply_result();
    ImGui::SameLine();
    if (button(context,
               {.name = "result.discard", .text = "Discard", .tooltip = "Leave the scene as it was"}))
        context.actions.discard_result();
    ImGui::End();
}

void draw_toasts(Context& context) {
    const auto& state = context.state.viewport;
    float bottom = state.high.y - context.em;
    for (std::size_t index = context.model.toasts.size(); index-- > 0;) {
        const auto& toast = context.model.toasts[index];
        const float width =
            std::min(context.em * 26, std::max(context.em * 8, state.high.x - state.low.x - context.em * 2));
        ImGui::PushStyleColor(ImGuiCol_Border, toast.is_error ? palette::Bad : palette::Border);
        begin_floating(fmt::format("toast {}", index).c_str(), {state.high.x - context.em, bottom}, {1, 1});
        const float text_width = std::min(width, ImGui::CalcTextSize(toast.text.c_str()).x + 1);
        ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + text_width);
        ImGui::TextUnformatted(toast.text.c_str());
        ImGui::PopTextWrapPos();
        note(context, fmt::format("toast.{}", index));
        if (!toast.button.empty() &&
            button(context, {.name = fmt::format("toast.{}.button", index), .text = toast.button}))
            context.actions.press_toast(index);
        if (!toast.button.empty()) ImGui::SameLine();
        if (button(context,
                   {.name = fmt::format("toast.{}.close", index), .text = "Close", .look = Look::Quiet}))
            context.actions.dismiss_toast(index);
        bottom -= ImGui::GetWindowHeight() + context.em * 0.4f;
        ImGui::End();
        ImGui::PopStyleColor();
    }
}

void draw_viewport(Context& context) {
    auto& state = context.state.viewport;
    draw_header(context);
    const ImVec2 space = ImGui::GetContentRegionAvail();
    const ImVec2 size(std::max(16.0f, std::floor(space.x)), std::max(16.0f, std::floor(space.y)));
    // Whole pixels, so that the picture is not resampled.
    const ImVec2 cursor = ImGui::GetCursorScreenPos();
    state.low = {std::floor(cursor.x), std::floor(cursor.y)};
    state.high = {state.low.x + size.x, state.low.y + size.y};
    ImGui::SetCursorScreenPos(state.low);
    if (context.scene_open()) return draw_picture(context, size);
    state.stroke = false;
    state.drag_button = -1;
    update_camera(context, false);
    ImGui::GetWindowDrawList()->AddRectFilled(state.low, state.high, palette::Window);
    if (ImGui::BeginChild("start", size, false)) draw_start_page(context);
    ImGui::EndChild();
    note(context, "viewport");
}

}  // namespace gse::ui
