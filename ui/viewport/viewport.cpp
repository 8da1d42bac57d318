// The picture in the middle: its header, the picture itself, and the receiver of the mouse over it.
#include "ui/viewport/viewport.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ui/commands/guarded.h"
#include "ui/keys/keys.h"
#include "ui/model/glyphs.h"
#include "ui/state/state.h"
#include "ui/widgets/controls.h"
#include "ui/widgets/icons.h"

namespace gse::ui {
namespace {

constexpr float ViewListEm = 11.5f;

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
                                 : views_text(context);
    ImGui::SetNextItemWidth(context.em * ViewListEm);
    const bool open =
        ImGui::BeginCombo("##viewport.views", shortened(text, context.em * (ViewListEm - 2)).c_str(),
                          ImGuiComboFlags_HeightLarge);
    note(context, "viewport.views");
    if (!open)
        return tooltip(views.empty()
                           ? "The scene came without cameras: an edit looks from views of its own around it"
                           : "Look through a camera of the scene (Left, Right)");
    if (views.empty()) dim_text("The scene came without cameras. \"Add this view\" in Views makes one.");
    for (std::size_t index = 0; index < views.size(); ++index) {
        ImGui::PushID(static_cast<int>(index));
        if (ImGui::Selectable(std::string(Shown(views[index].name).text()).c_str(),
                              static_cast<int>(index) == selected)) {
            context.state.viewport.selected_view = static_cast<int>(index);
            context.emit(command::LookThrough{index});
        }
        ImGui::PopID();
    }
    ImGui::EndCombo();
}

void toggle(Context& context, const char* name, Icon icon, bool& value, const std::string& what) {
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
                              .tooltip = with_key(context, "Wipe between before and after", Shortcut::Wipe),
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
        context.emit(command::SetComparison{original ? Comparison::None : Comparison::Original});
    toggle(context, "viewport.tint", Icon::Tag, context.view.tint_labels,
           with_key(context, "Tint what is labelled", Shortcut::Tint));
    toggle(context, "viewport.axes", Icon::Axes, context.view.show_axes, "World axes");
    toggle(context, "viewport.bounds", Icon::Box, context.view.show_bounds, "Box around the scene");
    toggle(context, "viewport.cameras", Icon::Camera, context.view.show_views, "Cameras of the views");
    if (context.scene_open()) {
        flow(context.em * ViewListEm);
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
    list->PushClipRect(state.low, state.high, true);
    draw_evidence(context, list);
    list->PopClipRect();
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

/// While a colour is picked, no tint lies over the colours.
void bare_colours(Context& context) {
    auto& state = context.state.viewport;
    const bool picks = state.tool == Tool::PickColour;
    if (picks == state.tint_before.has_value()) return;
    const bool before = state.tint_before.value_or(context.view.tint_labels);
    if (picks) state.tint_before = before;
    else state.tint_before.reset();
    context.view.tint_labels = before && !picks;
    context.view_changed = true;
}

}  // namespace

void draw_viewport(Context& context) {
    bare_colours(context);
    auto& state = context.state.viewport;
    draw_header(context);
    const ImVec2 space = ImGui::GetContentRegionAvail();
    const ImVec2 size(std::max(16.0f, std::floor(space.x)), std::max(16.0f, std::floor(space.y)));
    // Whole pixels, so that the picture is not resampled.
    const ImVec2 cursor = ImGui::GetCursorScreenPos();
    state.low = {std::floor(cursor.x), std::floor(cursor.y)};
    state.high = {state.low.x + size.x, state.low.y + size.y};
    ImGui::SetCursorScreenPos(state.low);
    if (context.scene_open()) {
        draw_picture(context, size);
        draw_toasts(context, state.bars_bottom);
        return;
    }
    state.stroke = false;
    state.drag_button = -1;
    update_camera(context, false);
    ImGui::GetWindowDrawList()->AddRectFilled(state.low, state.high, palette::Window);
    // The page gives way to the toasts: they never lie over its buttons.
    const float room = draw_toasts(context, state.low.y + size.y * 0.4f);
    ImGui::SetCursorScreenPos(state.low);
    if (ImGui::BeginChild("start", {size.x, size.y - room}, false, ImGuiWindowFlags_NavFlattened))
        draw_start_page(context);
    ImGui::EndChild();
    note(context, "start.page");
    note_rect(context, "viewport", state.low, state.high);
}

}  // namespace gse::ui
