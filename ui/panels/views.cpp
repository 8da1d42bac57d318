// Views: the cameras of the scene, looked through by a click.
#include <fmt/format.h>

#include "engine/scene/viewpoints.h"
#include "ui/commands/guarded.h"
#include "ui/panels/panels.h"
#include "ui/state.h"
#include "ui/widgets/controls.h"
#include "ui/widgets/icons.h"

namespace gse::ui {
namespace {

void draw_row(Context& context, int index) {
    const View& view = context.document().views[static_cast<std::size_t>(index)];
    auto& selected = context.state.viewport.selected_view;
    const float icon = context.em * 1.5f;
    ImGui::PushID(index);
    const float width = ImGui::GetContentRegionAvail().x - icon - ImGui::GetStyle().ItemSpacing.x;
    const std::string name = view.name.empty() ? fmt::format("view {}", index + 1) : view.name;
    const std::string text = fmt::format("{}  {}x{}", name, view.camera.width, view.camera.height);
    if (ImGui::Selectable(shortened(text, width - context.em).c_str(), index == selected, 0, {width, icon})) {
        selected = index;
        context.emit(command::LookThrough{static_cast<std::size_t>(index)});
    }
    note(context, fmt::format("views.row.{}", index));
    tooltip(view.distorted ? text + "\nIts lens was distorted: a viewpoint only." : text);
    ImGui::SameLine();
    if (icon_button(context, {.name = fmt::format("views.delete.{}", index),
                              .icon = Icon::Trash,
                              .tooltip = "Delete this view",
                              .size_em = 1.5f}))
        context.emit(command::DeleteView{static_cast<std::size_t>(index)});
    ImGui::PopID();
}

}  // namespace

void draw_views_panel(Context& context) {
    const bool open = context.scene_open();
    const char* why = open ? "" : "Open a scene first";
    if (button(context, {.name = "views.add",
                         .text = "Add this view",
                         .why_off = why,
                         .tooltip = "The present camera becomes a view"}))
        context.emit(command::AddView{});
    flow(button_width("Previous"));
    const char* why_step = !open ? why : context.document().views.empty() ? "There are no views" : "";
    if (button(context,
               {.name = "views.previous", .text = "Previous", .why_off = why_step, .tooltip = "Left"}))
        step_view(context, -1);
    flow(button_width("Next"));
    if (button(context, {.name = "views.next", .text = "Next", .why_off = why_step, .tooltip = "Right"}))
        step_view(context, 1);
    if (!open) return dim_text("The cameras that came with a scene are listed here.");
    if (checkbox(context, "views.show", "Show the cameras in the picture", context.view.show_views))
        context.view_changed = true;
    const auto& views = context.document().views;
    if (views.empty())
        return dim_text(fmt::format("The scene came without cameras. An edit looks from {} around it.",
                                    views_text(context)));
    if (views.size() < LeastViewpoints)
        dim_text(
            fmt::format("Bookmarks so far: an edit looks from {} around the scene. From {} stored views on, "
                        "it looks from those instead.",
                        views_text(context), LeastViewpoints));
    else if (static_cast<int>(views.size()) > context.request.views)
        dim_text(fmt::format("An edit looks from {}, spread over all of them.", views_text(context)));
    ImGuiListClipper clipper;
    clipper.Begin(static_cast<int>(views.size()), context.em * 1.5f + ImGui::GetStyle().ItemSpacing.y);
    while (clipper.Step())
        for (int index = clipper.DisplayStart; index < clipper.DisplayEnd; ++index)
            if (index < static_cast<int>(context.document().views.size())) draw_row(context, index);
}

}  // namespace gse::ui
