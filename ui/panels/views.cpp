// Views: the cameras of the scene, looked through by a click.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/scene/viewpoints.h"
#include "ui/commands/guarded.h"
#include "ui/panels/panels.h"
#include "ui/state/state.h"
#include "ui/widgets/controls.h"
#include "ui/widgets/icons.h"
#include "ui/widgets/sheet.h"

namespace gse::ui {
namespace {

constexpr float CardEm = 9;           // least width of a view's picture
constexpr float PictureShare = 0.5f;  // of its width, its height
constexpr float IconEm = 1.5f;

std::string name_of(const View& view, int index) {
    return view.name.empty() ? fmt::format("view {}", index + 1) : view.name;
}

void begin_rename(Context& context, int index) {
    context.state.views.renamed = index;
    context.state.views.name = name_of(context.document().views[static_cast<std::size_t>(index)], index);
    context.state.views.focus_name = true;
}

/// Field for the name of the view.
void rename_view(Context& context, int index, float width) {
    auto& views = context.state.views;
    if (views.focus_name) ImGui::SetKeyboardFocusHere();
    views.focus_name = false;
    ImGui::BeginChild("name", {width, context.em * IconEm}, false, ImGuiWindowFlags_NavFlattened);
    const bool entered = text_input(context, "views.name", views.name, "name of the view",
                                    ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
    const bool over = entered || ImGui::IsItemDeactivated();
    ImGui::EndChild();
    if (!over) return;
    const bool escaped = ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape), false);
    const auto& name = context.document().views[static_cast<std::size_t>(index)].name;
    if (!escaped && !views.name.empty() && views.name != name)
        context.emit(command::RenameView{static_cast<std::size_t>(index), views.name});
    views.renamed = -1;
}

/// Asks once for each view of the document as it is.
void ask_for_picture(Context& context, std::size_t view) {
    auto& views = context.state.views;
    const auto revision = context.model.document->revision();
    if (std::exchange(views.asked_at, revision) != revision) views.asked.clear();
    if (std::find(views.asked.begin(), views.asked.end(), view) != views.asked.end()) return;
    views.asked.push_back(view);
    context.emit(command::DrawView{view});
}

/// Picture of the scene from there, which looks through it when it is clicked.
void draw_view_picture(Context& context, int index, ImVec2 size) {
    const View& view = context.document().views[static_cast<std::size_t>(index)];
    auto& selected = context.state.viewport.selected_view;
    const ImVec2 low = ImGui::GetCursorScreenPos(), high(low.x + size.x, low.y + size.y);
    if (ImGui::InvisibleButton("picture", size)) {
        selected = index;
        context.emit(command::LookThrough{static_cast<std::size_t>(index)});
    }
    note(context, fmt::format("views.row.{}", index));
    const auto& pictures = context.model.view_pictures;
    const auto at = static_cast<std::size_t>(index);
    const auto picture = at < pictures.size() ? pictures[at] : nullptr;
    ImDrawList* list = ImGui::GetWindowDrawList();
    const float round = context.em * 0.2f;
    list->AddRectFilled(low, high, palette::Sunken, round);
    if (picture != nullptr) add_filling_picture(context, picture, low, high, round);
    else if (ImGui::IsItemVisible()) ask_for_picture(context, at);
    if (index == selected || ImGui::IsItemHovered() || ImGui::IsItemFocused())
        list->AddRect(low, high, index == selected ? palette::Accent : palette::TextDim, round, 0,
                      std::max(2.0f, context.em * 0.14f));
    const std::string text =
        fmt::format("{}\n{} x {} pixels{}", name_of(view, index), view.camera.width, view.camera.height,
                    view.distorted ? "; its lens was distorted: a viewpoint only" : "");
    tooltip(text);
}

/// A view's picture, its name, and what can be done with it.
void draw_view_card(Context& context, int index, float width) {
    ImGui::PushID(index);
    ImGui::BeginGroup();
    draw_view_picture(context, index, {width, std::floor(width * PictureShare)});
    const float icon = context.em * IconEm, spacing = ImGui::GetStyle().ItemSpacing.x;
    if (context.state.views.renamed == index) {
        rename_view(context, index, width);
    } else {
        const float room = width - 2 * (icon + spacing);
        const View& view = context.document().views[static_cast<std::size_t>(index)];
        ImGui::AlignTextToFramePadding();
        plain_text(shortened(name_of(view, index), room));
        ImGui::SameLine(room + spacing);  // from the card's left edge
        if (icon_button(context, {.name = fmt::format("views.rename.{}", index),
                                  .icon = Icon::Pencil,
                                  .tooltip = "Rename",
                                  .size_em = IconEm}))
            begin_rename(context, index);
        ImGui::SameLine();
        if (icon_button(context, {.name = fmt::format("views.delete.{}", index),
                                  .icon = Icon::Trash,
                                  .tooltip = "Delete this view (undo brings it back)",
                                  .size_em = IconEm}))
            context.emit(command::DeleteView{static_cast<std::size_t>(index)});
    }
    ImGui::EndGroup();
    ImGui::PopID();
}

/// All views, as many beside each other as fit.
void draw_view_cards(Context& context) {
    const auto count = static_cast<int>(context.document().views.size());
    const float width = ImGui::GetContentRegionAvail().x, gap = ImGui::GetStyle().ItemSpacing.x * 2;
    const int columns = std::max(1, static_cast<int>((width + gap) / (context.em * CardEm + gap)));
    const float card = std::floor((width + gap) / static_cast<float>(columns) - gap);
    const float spacing = ImGui::GetStyle().ItemSpacing.y;
    const float height = std::floor(card * PictureShare) + context.em * IconEm + 2 * spacing;
    ImGuiListClipper clipper;
    clipper.Begin((count + columns - 1) / columns, height);
    while (clipper.Step())
        for (int row = clipper.DisplayStart; row < clipper.DisplayEnd; ++row) {
            const float top = ImGui::GetCursorPosY();
            for (int index = row * columns; index < std::min(count, (row + 1) * columns); ++index) {
                if (index % columns != 0) ImGui::SameLine(0, gap);
                draw_view_card(context, index, card);
            }
            ImGui::SetCursorPosY(top + height);
        }
}

/// Adds the present camera; the new view is named at once.
void add_view(Context& context) {
    context.state.views.names_from = static_cast<int>(context.document().views.size());
    context.emit(command::AddView{});
}

}  // namespace

void draw_views_panel(Context& context) {
    const bool open = context.scene_open();
    const char* why = open ? "" : "Open a scene first";
    if (button(context, {.name = "views.add",
                         .text = "Add this view",
                         .why_off = why,
                         .tooltip = "The present camera becomes a view; type its name"}))
        add_view(context);
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
    auto& naming = context.state.views.names_from;
    if (naming >= 0 && naming < static_cast<int>(views.size()))
        begin_rename(context, std::exchange(naming, -1));
    draw_view_cards(context);
}

}  // namespace gse::ui
