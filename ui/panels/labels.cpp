// Labels: named selections of splats, their weights, and corrections by hand.
#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>

#include "engine/scene/label_ops.h"
#include "ui/commands/guarded.h"
#include "ui/panels/panels.h"
#include "ui/state/state.h"
#include "ui/widgets/controls.h"
#include "ui/widgets/icons.h"

namespace gse::ui {
namespace {

constexpr std::array<const char*, 4> ToolNames{"Brush", "Rectangle", "Lasso", "Cut out"};
constexpr std::array<const char*, 4> OperationNames{"Add", "Remove", "Intersect", "Replace"};

void draw_rename(Context& context, int index) {
    auto& labels = context.state.labels;
    if (labels.focus_name) ImGui::SetKeyboardFocusHere();
    labels.focus_name = false;
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
    const bool entered = text_input(context, "labels.name", labels.name, {},
                                    ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
    if (entered || ImGui::IsItemDeactivated()) {
        const bool escaped = ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape), false);
        const auto& name = context.document().labels[static_cast<std::size_t>(index)].name;
        if (!escaped && !labels.name.empty() && labels.name != name)
            context.emit(command::RenameLabel{index, labels.name});
        labels.renamed = -1;
    }
}

void draw_label_row(Context& context, int index) {
    const auto& label = context.document().labels[static_cast<std::size_t>(index)];
    auto& labels = context.state.labels;
    ImGui::PushID(index);
    if (labels.renamed == index) {
        draw_rename(context, index);
        ImGui::PopID();
        return;
    }
    const bool active = index == context.document().active_label;
    const float icon = context.em * 1.5f, spacing = ImGui::GetStyle().ItemSpacing.x;
    const float width = ImGui::GetContentRegionAvail().x - 2 * (icon + spacing);
    const std::string name =
        "  " + shortened(label.name.empty() ? "(no name)" : label.name, width - context.em);
    if (ImGui::Selectable(name.c_str(), active, ImGuiSelectableFlags_AllowDoubleClick, {width, icon})) {
        if (!active) context.emit(command::SetActiveLabel{index});
        if (ImGui::IsMouseDoubleClicked(0)) {
            labels.renamed = index;
            labels.name = label.name;
            labels.focus_name = true;
        }
    }
    note(context, fmt::format("labels.row.{}", index));
    tooltip("Click: show and correct this label. Double click: rename.");
    ImGui::SameLine();
    if (icon_button(context, {.name = fmt::format("labels.rename.{}", index),
                              .icon = Icon::Pencil,
                              .tooltip = "Rename",
                              .size_em = 1.5f})) {
        labels.renamed = index;
        labels.name = label.name;
        labels.focus_name = true;
    }
    ImGui::SameLine();
    if (icon_button(context, {.name = fmt::format("labels.delete.{}", index),
                              .icon = Icon::Trash,
                              .tooltip = "Delete the label (its splats stay; undo brings it back)",
                              .size_em = 1.5f}))
        context.emit(command::DeleteLabel{index});
    ImGui::PopID();
}

void draw_threshold(Context& context, const NamedLabel& label) {
    auto& labels = context.state.labels;
    const std::size_t total = context.document().current.size();
    if (label.weight == nullptr || label.weight->empty()) {
        property(context, "Threshold", "none");
        tooltip("A search gives every splat a weight; what was made by hand, or by an edit, has none.");
    } else {
        labels.histogram.update(view_probability(label));
        float threshold = labels.threshold >= 0 ? labels.threshold : label.threshold;
        const auto drag = histogram(context, "labels.threshold", labels.histogram, context.em * 4, threshold);
        tooltip(
            "How sure the views are about each splat. Drag the line: splats right of it belong to the "
            "label.");
        if (drag.changed) {
            labels.threshold = threshold;
            context.emit(command::SetLabelThreshold{threshold, false});
        }
        if (drag.released) {
            if (labels.threshold >= 0) context.emit(command::SetLabelThreshold{labels.threshold, true});
            labels.threshold = -1;
        }
        const std::size_t above = labels.histogram.above(threshold);
        property(context, "Threshold", fmt::format("{:.3f}   ({} by weight)", threshold, count_text(above)));
    }
    const std::size_t count = label_count(context);
    property(context, "Labelled",
             fmt::format("{} of {} ({:.1f} %)", count_text(count), count_text(total),
                         total > 0 ? 100.0 * static_cast<double>(count) / static_cast<double>(total) : 0));
}

void draw_tools(Context& context, const std::string& why) {
    auto& viewport = context.state.viewport;
    constexpr std::array<Icon, 4> Icons{Icon::Brush, Icon::Rectangle, Icon::Lasso, Icon::CutOut};
    constexpr std::array<Tool, 4> Tools{Tool::Brush, Tool::Rectangle, Tool::Lasso, Tool::CutOut};
    constexpr std::array<Shortcut, 4> Keys{Shortcut::Brush, Shortcut::Rectangle, Shortcut::Lasso,
                                           Shortcut::CutOut};
    for (std::size_t at = 0; at < Tools.size(); ++at) {
        if (at > 0) ImGui::SameLine();
        if (icon_button(context, {.name = fmt::format("labels.tool.{}", ToolNames[at]),
                                  .icon = Icons[at],
                                  .tooltip = with_key(context, ToolNames[at], Keys[at]),
                                  .active = viewport.tool == Tools[at],
                                  .why_off = why}))
            set_tool(context, Tools[at]);
    }
    ImGui::SameLine();
    if (icon_button(context,
                    {.name = "labels.front",
                     .icon = context.view.front_only ? Icon::FrontOnly : Icon::Through,
                     .tooltip = with_key(context,
                                         context.view.front_only ? "Front only: what is behind is not touched"
                                                                 : "All the way through",
                                         Shortcut::FrontOnly),
                     .active = context.view.front_only})) {
        context.view.front_only = !context.view.front_only;
        context.view_changed = true;
    }
    int operation = static_cast<int>(viewport.operation);
    if (segmented(context, "labels.operation", OperationNames, operation))
        viewport.operation = static_cast<SetOperation>(operation);
    row_label(context, "Brush radius", "Also [ and ], or Alt + wheel over the picture");
    float radius = context.view.brush_px;
    if (ImGui::SliderFloat("##labels.radius", &radius, 1, 300, "%.0f px",
                           ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp)) {
        context.view.brush_px = std::max(1.0f, radius);
        context.view_changed = true;
    }
    note(context, "labels.radius");
}

void draw_operations(Context& context, const std::string& why) {
    const auto act = [&](const char* name, const char* text, const std::string& help) {
        const bool pressed = button(context, {.name = name, .text = text, .why_off = why, .tooltip = help});
        return pressed;
    };
    if (act("labels.grow", "Grow", "Take in the splats next to the label"))
        context.emit(command::GrowLabel{context.state.labels.steps});
    flow(button_width("Shrink"));
    if (act("labels.shrink", "Shrink", "Drop the splats at its rim"))
        context.emit(command::GrowLabel{-context.state.labels.steps});
    flow(button_width("Invert"));
    if (act("labels.invert", "Invert", keys_of(context, Shortcut::Invert)))
        context.emit(command::InvertLabel{});
    flow(button_width("Clear"));
    if (act("labels.clear", "Clear", with_key(context, "Nothing is labelled any more", Shortcut::Clear)))
        context.emit(command::ClearLabel{});
    const std::string why_hide = why_not_hide(context);
    flow(button_width("Hide"));
    if (button(context, {.name = "labels.hide",
                         .text = "Hide",
                         .why_off = why_hide,
                         .tooltip = with_key(
                             context, "Not seen and not picked until it is shown again; the scene keeps it",
                             Shortcut::Hide)}))
        hide_label(context);
    flow(button_width("Isolate"));
    if (button(context, {.name = "labels.isolate",
                         .text = "Isolate",
                         .why_off = why_hide,
                         .tooltip = with_key(context, "Hides all else", Shortcut::Isolate)}))
        isolate_label(context);
    flow(button_width("Delete splats"));
    std::string why_delete = why;
    if (why_delete.empty() && label_count(context) == 0) why_delete = "Nothing is labelled";
    if (button(context, {.name = "labels.delete_splats",
                         .text = "Delete splats",
                         .why_off = why_delete,
                         .tooltip = with_key(
                             context, "Removes the labelled splats from the scene; undo brings them back",
                             Shortcut::Delete),
                         .look = Look::Danger}))
        context.emit(command::DeleteLabelledSplats{});
    flow(button_width("Delete and heal"));
    if (button(context, {.name = "labels.heal",
                         .text = "Delete and heal",
                         .why_off = why_delete,
                         .tooltip = with_key(context,
                                             "Removes the labelled splats, what only they held and their "
                                             "shadow, and fills the hole with what is around it",
                                             Shortcut::Heal),
                         .look = Look::Danger}))
        context.emit(command::HealLabelledSplats{});
}

}  // namespace

void draw_labels_panel(Context& context) {
    const bool open = context.scene_open();
    if (button(context, {.name = "labels.add",
                         .text = "New label",
                         .why_off = open ? "" : "Open a scene first",
                         .tooltip = "An empty label, to be painted by hand"}))
        add_label(context);
    if (!open) return dim_text("Labels say which splats an edit may change. Open a scene first.");
    const auto& list = context.document().labels;
    if (list.empty()) dim_text("No labels yet. Locate makes one from words; a new one can be painted.");
    for (int index = 0; index < static_cast<int>(context.document().labels.size()); ++index)
        draw_label_row(context, index);
    const NamedLabel* label = context.active_label();
    const std::string why = why_not_label(context);
    if (label != nullptr) {
        heading(context, "Weights");
        draw_threshold(context, *label);
    }
    heading(context, "Correct by hand");
    draw_tools(context, why);
    draw_operations(context, why);
    draw_pick(context);
    draw_adjust(context);
    draw_place(context);
}

}  // namespace gse::ui
