// Place, size and number of the labelled thing, by hand: seen while the numbers change, one edit of the
// stack.
#include <fmt/format.h>

#include <string_view>

#include "ui/commands/guarded.h"
#include "ui/panels/panels.h"
#include "ui/state/state.h"
#include "ui/widgets/controls.h"
#include "ui/widgets/fields.h"

namespace gse::ui {

void follow_placing(Context& context) {
    auto& place = context.state.by_hand.place;
    // Another step: the next one begins from there.
    if (place.placing && !context.model.placing) place.values = {}, place.ends = false;
    place.placing = context.model.placing;
    if (place.ends && !place.dragged && !ImGui::IsMouseDown(0) && !ImGui::IsAnyItemActive()) {
        context.emit(command::PlaceThing{place.values});
        place.ends = false;
    }
    const bool wanted = context.state.viewport.tool == Tool::Place;
    if (wanted != place.used) context.emit(command::UsePlacing{place.used = wanted});
}

void draw_place(Context& context) {
    auto& place = context.state.by_hand.place;
    if (!folding(context, "place.open", "Move, turn, resize")) {
        place.frames_to_bring = FramesToBring;
        return;
    }
    std::string why = why_not_work(context);
    if (why.empty() && label_count(context) == 0) why = "Label a thing first";
    if (!why.empty()) return dim_text(why + ".");
    const bool shown = context.state.viewport.tool == Tool::Place;
    if (button(context,
               {.name = "place.handles",
                .text = shown ? "Hide the handles" : "Show the handles",
                .tooltip = with_key(context, "Arrows, a ring and a knob over the picture", Shortcut::Place)}))
        set_tool(context, Tool::Place);
    if (!shown) return dim_text("The numbers are shown with the handles.");
    bool changed = field_rows(
        context, "place", place.values,
        [](const char* name, const FieldHelp&) { return std::string_view(name) != "change"; },
        [](const char*, bool&) {});
    const bool neutral = place.values == edit::RearrangeSettings{};
    if (button(context, {.name = "place.reset",
                         .text = "As it was",
                         .why_off = neutral && !changed ? "Nothing is placed" : "",
                         .tooltip = "Takes the placement back"})) {
        place.values = {};
        changed = true;
    }
    flow(button_width("Heal the place"));
    if (button(context, {.name = "place.heal",
                         .text = "Heal the place",
                         .why_off = context.model.placing ? "" : "Place the thing first",
                         .tooltip = "Fills the hole where the thing stood with what is around it"}))
        context.emit(command::HealPlace{});
    if (changed) {
        context.emit(command::PlaceThing{place.values, false});
        place.ends = place.values != edit::RearrangeSettings{};
        context.state.animating = true;  // the end is seen in the frame after
    }
    if (place.frames_to_bring <= 0) return;
    --place.frames_to_bring;
    ImGui::SetScrollHereY(1);  // what has unfolded comes into view
    context.state.animating = true;
}

}  // namespace gse::ui
