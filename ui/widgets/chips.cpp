// A sentence as chips, one per word, that wrap and can be clicked.
#include "ui/widgets/chips.h"

#include <fmt/format.h>

#include <cmath>

#include "ui/model/glyphs.h"
#include "ui/widgets/controls.h"

namespace gse::ui {
namespace {

/// Wavy line below a word the model does not know.
void squiggle(ImDrawList* list, ImVec2 low, float width, float em) {
    const float step = em * 0.18f;
    bool up = false;
    for (float x = 0; x <= width; x += step, up = !up)
        list->PathLineTo({low.x + x, low.y + (up ? -step * 0.5f : 0)});
    list->PathStroke(palette::Warning, ImDrawFlags_None, std::max(1.0f, em * 0.07f));
}

std::string explained(const Chip& chip) {
    if (!chip.read) return "The model stops reading before this word. Shorten the sentence.";
    if (!chip.known) {
        std::string text = fmt::format("The model does not know \"{}\".", chip.text);
        return chip.suggestion.empty()
                   ? text
                   : fmt::format("{} Nearest word it knows: \"{}\".", text, chip.suggestion);
    }
    if (chip.target && !chip.guessed)
        return "The target: what the edit is about. Click to let it be found again.";
    if (chip.target) return "The target, found by itself. Click to fix it.";
    if (chip.source) return "The source: what is looked for in the scene. Click to make it the target.";
    return "Click to make this word the target of the edit; with Shift, the words up to it.";
}

void draw_chip(Context& context, const Chip& chip, bool unknown, ImVec2 low, ImVec2 high) {
    ImDrawList* list = ImGui::GetWindowDrawList();
    const float round = context.em * 0.32f;
    const bool hovered = ImGui::IsItemHovered();
    const bool filled = chip.target && !chip.guessed;
    list->AddRectFilled(low, high,
                        filled    ? palette::AccentDeep
                        : hovered ? palette::RaisedHover
                                  : palette::Raised,
                        round);
    if (chip.target) list->AddRect(low, high, palette::Accent, round, 0, std::max(1.0f, context.em * 0.08f));
    if (unknown) list->AddRect(low, high, palette::Warning, round, 0, 1);
    const ImVec2 at(low.x + context.em * 0.45f, low.y + context.em * 0.2f);
    const Shown shown(chip.text);
    list->AddText(at,
                  !chip.read ? palette::TextDim
                  : unknown  ? palette::Warning
                             : palette::Text,
                  shown.begin(), shown.end());
    const float width = ImGui::CalcTextSize(shown.begin(), shown.end()).x;
    const float middle = std::round((low.y + high.y) * 0.5f);
    if (!chip.read) list->AddLine({at.x, middle}, {at.x + width, middle}, palette::TextDim, 1);
    if (unknown) squiggle(list, {at.x, high.y - context.em * 0.16f}, width, context.em);
    if (chip.source && !chip.target)
        list->AddLine({at.x, high.y - context.em * 0.18f}, {at.x + width, high.y - context.em * 0.18f},
                      palette::Good, 2);
}

}  // namespace

ChipClick chips(Context& context, std::string_view name, std::span<const Chip> words, bool judged) {
    ChipClick click;
    ImGui::PushID(name.data(), name.data() + name.size());
    for (int index = 0; index < static_cast<int>(words.size()); ++index) {
        const Chip& chip = words[static_cast<std::size_t>(index)];
        const Shown shown(chip.text);
        const float width = ImGui::CalcTextSize(shown.begin(), shown.end()).x + context.em * 0.9f;
        if (index > 0) flow(width);
        ImGui::PushID(index);
        const ImVec2 low = ImGui::GetCursorScreenPos();
        if (ImGui::InvisibleButton("chip", {width, context.em * 1.5f})) {
            click.chosen = index;
            click.extends = ImGui::GetIO().KeyShift;
        }
        note(context, fmt::format("{}.{}", name, index));
        draw_chip(context, chip, judged && !chip.known, low, {low.x + width, low.y + context.em * 1.5f});
        tooltip(explained(chip));
        if (judged && !chip.known && !chip.suggestion.empty()) {
            const std::string text = fmt::format("{}?", chip.suggestion);
            flow(button_width(text));
            if (button(context, {.name = fmt::format("{}.{}.suggestion", name, index),
                                 .text = text,
                                 .tooltip = "Use this word instead",
                                 .look = Look::Quiet}))
                click.replaced = index;
        }
        ImGui::PopID();
    }
    ImGui::PopID();
    return click;
}

}  // namespace gse::ui
