// History: the stack of edits that can be switched, and the list of steps to go back to.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/scene/strength.h"
#include "ui/commands/guarded.h"
#include "ui/panels/panels.h"
#include "ui/state/state.h"
#include "ui/widgets/controls.h"
#include "ui/widgets/icons.h"
#include "ui/widgets/tooltips.h"

namespace gse::ui {
namespace {

constexpr float EditPictureEm = 5.2f;  // as high as the controls beside it
constexpr float VariationEm = 4.5f;    // side of a variation's picture

/// `where`: "outside", or in more words.
std::string proof_text(const EditNode& edit, const char* where) {
    if (edit.changed_outside_label > 0)
        return fmt::format("{}: {} splats changed", where, count_text(edit.changed_outside_label));
    const std::string psnr = std::isfinite(edit.psnr_outside_db) && edit.psnr_outside_db > 0
                                 ? fmt::format(", {:.1f} dB", edit.psnr_outside_db)
                                 : "";
    return fmt::format("{}: 0 splats changed{}", where, psnr);
}

void draw_buttons(Context& context, const EditNode& edit, std::size_t place, std::size_t count) {
    const auto id = edit.id;
    const auto name = [id](const char* what) { return fmt::format("history.{}.{}", what, id); };
    if (icon_button(context, {.name = name("up"),
                              .icon = Icon::Up,
                              .tooltip = "Apply later than the next one",
                              .why_off = place + 1 == count ? "It is the last one already" : "",
                              .size_em = 1.5f}))
        context.emit(command::MoveEdit{id, 1});
    ImGui::SameLine(0, 0);
    if (icon_button(context, {.name = name("down"),
                              .icon = Icon::Down,
                              .tooltip = "Apply before the previous one",
                              .why_off = place == 0 ? "It is the first one already" : "",
                              .size_em = 1.5f}))
        context.emit(command::MoveEdit{id, -1});
    ImGui::SameLine(0, 0);
    if (icon_button(context, {.name = name("repeat"),
                              .icon = Icon::Repeat,
                              .tooltip = "Its settings into the prompt, with a new seed",
                              .why_off = edit.recipe.empty() ? "This was not made by a prompt" : "",
                              .size_em = 1.5f})) {
        context.emit(command::RepeatEdit{id});
        show_panel(context.state, PanelId::Prompt);
    }
    ImGui::SameLine(0, 0);
    if (icon_button(context, {.name = name("delete"),
                              .icon = Icon::Trash,
                              .tooltip = "Take it off the stack (undo brings it back)",
                              .size_em = 1.5f}))
        context.emit(command::DeleteEdit{id});
}

/// Strength of the edit; follows the drag.
void draw_strength(Context& context, const EditNode& edit) {
    constexpr double least = 0;
    double strength = edit.strength;
    ImGui::SetNextItemWidth(std::min(ImGui::GetContentRegionAvail().x, context.em * 12));
    const bool changed = ImGui::SliderScalar("##strength", ImGuiDataType_Double, &strength, &least,
                                             &MostStrength, "Strength %.2f");
    note(context, fmt::format("history.strength.{}", edit.id));
    tooltip("1 is the edit as it was applied. Less: between before and after. More: colours go beyond it.");
    const bool ends = ImGui::IsItemDeactivatedAfterEdit();
    if (changed || ends) context.emit(command::SetEditStrength{edit.id, strength, ends});
}

/// Results of the edit beside each other. A click puts one in the place of the applied one.
void draw_variations(Context& context, std::uint64_t id) {
    const auto& all = context.model.variations;
    const auto kept = std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.edit == id; });
    if (kept == all.end()) return;
    dim_text("Its variations: click one to exchange it");
    const float side = context.em * VariationEm, round = context.em * 0.2f;
    for (std::size_t i = 0; i < kept->results.size(); ++i) {
        if (i > 0) flow(side);
        ImGui::PushID(static_cast<int>(i));
        const ImVec2 low = ImGui::GetCursorScreenPos(), high(low.x + side, low.y + side);
        const bool applied = i == kept->applied;
        if (ImGui::InvisibleButton("variation", {side, side}) && !applied)
            context.emit(command::ExchangeVariation{id, i});
        note(context, fmt::format("history.variation.{}.{}", id, i));
        tooltip(fmt::format("Variation {} of {}, seed {}{}", i + 1, kept->results.size(),
                            kept->results[i].seed, applied ? ": this one is applied" : ""));
        ImDrawList* list = ImGui::GetWindowDrawList();
        list->AddRectFilled(low, high, palette::Sunken, round);
        if (kept->results[i].thumbnail != nullptr)
            list->AddImageRounded(imgui_texture(context.textures.texture(kept->results[i].thumbnail)), low,
                                  high, {0, 0}, {1, 1}, IM_COL32_WHITE, round);
        if (applied || ImGui::IsItemHovered() || ImGui::IsItemFocused())
            list->AddRect(low, high, applied ? palette::Accent : palette::TextDim, round, 0,
                          std::max(2.0f, context.em * 0.14f));
        ImGui::PopID();
    }
}

void draw_edit(Context& context, std::size_t place, std::size_t count) {
    const EditNode& edit = context.document().stack[place];
    ImGui::PushID(static_cast<int>(edit.id));
    const ImVec2 low = ImGui::GetCursorScreenPos();
    const float side = context.em * EditPictureEm;
    if (edit.thumbnail != nullptr && edit.thumbnail->width > 0) {
        ImGui::Image(imgui_texture(context.textures.texture(edit.thumbnail)), {side, side});
        note(context, fmt::format("history.picture.{}", edit.id));
        large_picture(context, edit.thumbnail, edit.name);
    } else {
        ImGui::GetWindowDrawList()->AddRectFilled(low, {low.x + side, low.y + side}, palette::Raised,
                                                  context.em * 0.2f);
        draw_icon(ImGui::GetWindowDrawList(), Icon::Tag, {low.x + side * 0.5f, low.y + side * 0.5f},
                  side * 0.4f, palette::TextDim);
        ImGui::Dummy({side, side});
    }
    ImGui::SameLine();
    ImGui::BeginGroup();
    bool enabled = edit.enabled;
    if (checkbox(context, fmt::format("history.enabled.{}", edit.id),
                 shortened(edit.name, ImGui::GetContentRegionAvail().x - context.em * 2), enabled,
                 fmt::format("{}\nOn or off; the others stay as they are.", edit.name)))
        context.emit(command::SetEditEnabled{edit.id, enabled});
    const bool clean = edit.changed_outside_label == 0;
    ImGui::PushStyleColor(ImGuiCol_Text, clean ? palette::Good : palette::Warning);
    ImGui::TextUnformatted(shortened(proof_text(edit, "outside"), ImGui::GetContentRegionAvail().x).c_str());
    ImGui::PopStyleColor();
    tooltip(proof_text(edit, "outside the label"));
    draw_strength(context, edit);
    draw_buttons(context, edit, place, count);
    if (edit.seconds > 0) {
        ImGui::SameLine();
        dim_text(duration_text(edit.seconds));
    }
    draw_variations(context, edit.id);
    ImGui::EndGroup();
    ImGui::PopID();
}

/// Wipe between this step and the shown scene.
void draw_compare(Context& context, std::size_t at, float side) {
    const bool compared = context.model.document->revision_at(at) == context.model.compared_revision;
    ImGui::SameLine();
    if (icon_button(
            context,
            {.name = fmt::format("history.compare.{}", at),
             .icon = Icon::Wipe,
             .tooltip = compared ? "Compare with the original again"
                                 : with_key(context, "Compare with this: wipe between this step and now",
                                            Shortcut::Wipe),
             .active = compared,
             .why_off = !compared && at == context.model.document->position() ? "This is what is shown" : "",
             .size_em = side / context.em}))
        context.emit(command::CompareWith{at});
}

void draw_steps(Context& context) {
    const auto& document = *context.model.document;
    const auto names = document.names();
    heading(context, "Undo");
    if (button(context, {.name = "history.undo",
                         .text = "Undo",
                         .why_off = document.can_undo() ? "" : "There is nothing to undo",
                         .tooltip = keys_of(context, Shortcut::Undo)}))
        context.emit(command::Undo{});
    flow(button_width("Redo"));
    if (button(context, {.name = "history.redo",
                         .text = "Redo",
                         .why_off = document.can_redo() ? "" : "There is nothing to redo",
                         .tooltip = keys_of(context, Shortcut::Redo)}))
        context.emit(command::Redo{});
    flow(context.em * 8);
    dim_text(bytes_text(static_cast<double>(document.undo_bytes())) + " held");
    for (std::size_t at = names.size(); at-- > 0;) {
        ImGui::PushID(static_cast<int>(at));
        const bool later = at > document.position();
        if (later) ImGui::PushStyleColor(ImGuiCol_Text, palette::TextDim);
        const float side = context.em * 1.5f,
                    width = ImGui::GetContentRegionAvail().x - side - ImGui::GetStyle().ItemSpacing.x;
        const std::string text = shortened(names[at].empty() ? "Opened" : names[at], width);
        if (ImGui::Selectable(text.c_str(), at == document.position(), ImGuiSelectableFlags_None,
                              {width, side}) &&
            at != document.position())
            context.emit(command::GoTo{at});
        if (later) ImGui::PopStyleColor();
        note(context, fmt::format("history.step.{}", at));
        draw_compare(context, at, side);
        ImGui::PopID();
    }
}

}  // namespace

void draw_history_panel(Context& context) {
    if (!context.scene_open()) return dim_text("Edits and steps of undo appear here.");
    heading(context, "Edits");
    const auto& stack = context.document().stack;
    for (std::size_t place = stack.size(); place-- > 0;) {
        if (place >= context.document().stack.size()) break;  // the action changed it
        draw_edit(context, place, stack.size());
    }
    dim_text(fmt::format("Original: {} splats", count_text(context.document().base.size())));
    draw_steps(context);
}

}  // namespace gse::ui
