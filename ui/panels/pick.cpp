// Splats by a property (faint, large, of one colour, alone): seen while the line moves, then labelled or
// deleted.
#include <fmt/format.h>

#include "ui/commands/guarded.h"
#include "ui/panels/panels.h"
#include "ui/state/state.h"
#include "ui/widgets/controls.h"

namespace gse::ui {
namespace {

using localize::RowProperty;

constexpr std::array<const char*, 4> PropertyNames{"Opacity", "Size", "Colour", "Floaters"};
constexpr std::array<const char*, 2> SideNames{"Below", "Above"};
constexpr std::array<const char*, 4> PropertyHelp{
    "Faint splats: haze and fog around things.",
    "By the largest standard deviation, as a share of the scene's extent: spikes and blobs, or dust.",
    "By the difference of the base colour to the one picked (CIE L*a*b*: 2 can just be seen, 100 is black to "
    "white).",
    "By the mean distance to the 8 nearest splats, compared with the usual one: what floats alone in the "
    "air."};

constexpr float HistogramEm = 3.5f;

localize::RowChoice& choice_of(PickState& pick) {
    return pick.choices[static_cast<std::size_t>(pick.property)];
}

/// Begins, or leaves. While a colour is picked nothing is tinted: what is seen is what is taken.
void pick_from_picture(Context& context, Tool& tool) {
    tool = tool == Tool::PickColour ? Tool::Orbit : Tool::PickColour;
    if (tool == Tool::PickColour) context.emit(command::DropPicked{});
}

/// Takes the colour that was clicked on. True when there is a new one.
bool take_seen_colour(Context& context, localize::RowChoice& choice) {
    const auto& seen = context.model.seen_colour;
    auto& taken = context.state.pick.colour_taken;
    if (seen.number == taken) return false;
    taken = seen.number;
    if (choice.property != RowProperty::Colour) return false;
    choice.colour = seen.colour;
    return true;
}

void draw_colour(Context& context, localize::RowChoice& choice, bool& changed) {
    if (choice.property != RowProperty::Colour) return;
    row_label(context, "Near to", "The colour that is looked for");
    changed |= ImGui::ColorEdit3("##pick.colour", choice.colour.data(),
                                 ImGuiColorEditFlags_NoLabel | ImGuiColorEditFlags_NoInputs);
    note(context, "pick.colour");
    ImGui::SameLine();
    auto& tool = context.state.viewport.tool;
    const std::string why_no_drop =
        context.model.result_waiting ? "The picture shows an edit that is not applied yet" : "";
    if (button(context, {.name = "pick.colour.drop",
                         .text = "From the picture",
                         .why_off = why_no_drop,
                         .tooltip = "Click a colour in the picture: it is taken as it is seen there"}))
        pick_from_picture(context, tool);
    flow(button_width("That of the label"));
    std::string why = why_not_label(context);
    if (why.empty() && label_count(context) == 0) why = "Nothing is labelled";
    if (button(context, {.name = "pick.colour.label",
                         .text = "That of the label",
                         .why_off = why,
                         .tooltip = "The mean base colour of what is labelled"})) {
        choice.colour = localize::mean_colour(context.document().current, *context.active_label()->bits);
        changed = true;
    }
}

/// Histogram with the line, or a note that it is being measured.
void draw_values(Context& context, PickState& pick, localize::RowChoice& choice, bool& changed) {
    const auto& picked = context.model.picked;
    if (picked.working || picked.values == nullptr) {
        const float top = ImGui::GetCursorPosY();
        dim_text("Measuring the splats...");
        ImGui::SetCursorPosY(top + context.em * HistogramEm +
                             ImGui::GetStyle().ItemSpacing.y);  // what is below stays where it is
        context.state.animating = true;
        return;
    }
    pick.histogram.update(picked.values);
    changed |= histogram(context, "pick.threshold", pick.histogram, context.em * HistogramEm,
                         choice.threshold, !choice.above)
                   .changed;
    tooltip(fmt::format("{}\nDrag the line: splats on the blue side are chosen.",
                        PropertyHelp[static_cast<std::size_t>(pick.property)]));
}

void draw_uses(Context& context) {
    const std::size_t count = context.model.picked.count;
    const std::string none = context.model.picked.working ? "The splats are being measured"
                             : count == 0                 ? "No splat is chosen"
                                                          : "";
    const auto use = [&](const char* name, const char* text, const std::string& why, const char* help,
                         PickedUse what, Look look = Look::Normal) {
        if (button(context, {.name = name, .text = text, .why_off = why, .tooltip = help, .look = look}))
            context.emit(command::UsePicked{what});
    };
    const std::string label = none.empty() ? why_not_label(context) : none;
    use("pick.new", "New label", none, "A label of these splats", PickedUse::NewLabel);
    flow(button_width("Add"));
    use("pick.add", "Add", label, "To the active label", PickedUse::Add);
    flow(button_width("Remove"));
    use("pick.remove", "Remove", label, "From the active label", PickedUse::Remove);
    flow(button_width("Delete splats"));
    std::string why_delete = none;
    if (why_delete.empty() && count == context.document().current.size()) why_delete = "That is every splat";
    if (why_delete.empty() && (context.model.job.running || context.model.result_waiting))
        why_delete = why_not_work(context);
    use("pick.delete", "Delete splats", why_delete, "Takes them off the scene (undo brings them back)",
        PickedUse::Delete, Look::Danger);
}

}  // namespace

void draw_pick(Context& context) {
    auto& pick = context.state.pick;
    pick.seen = folding(context, "pick.open", "Select by property");
    tooltip(
        "Splats by opacity, size, colour, or how alone they are: seen while you choose, then labelled or "
        "deleted");
    auto& tool = context.state.viewport.tool;
    const bool to_drop =
        pick.seen && choice_of(pick).property == RowProperty::Colour && !context.model.result_waiting;
    if (tool == Tool::PickColour && !to_drop) tool = Tool::Orbit;
    if (!pick.seen) {
        pick.frames_to_bring = FramesToBring;
        return;
    }
    bool changed = !context.model.picked.shown && tool != Tool::PickColour;
    if (segmented(context, "pick.property", PropertyNames, pick.property)) {
        changed = true;
        pick.frames_to_bring = FramesToBring;
    }
    auto& choice = choice_of(pick);
    changed |= take_seen_colour(context, choice);
    draw_colour(context, choice, changed);
    draw_values(context, pick, choice, changed);
    int side = choice.above ? 1 : 0;
    changed |= segmented(context, "pick.side", SideNames, side);
    choice.above = side == 1;
    flow(context.em * 9);
    changed |= checkbox(context, "pick.within", "Within the label", pick.within,
                        "Of what is labelled only, else of the whole scene");
    choice.within_label = pick.within;
    wrapped_text(fmt::format("{} of {}: {}", count_text(context.model.picked.count),
                             count_text(context.document().current.size()), localize::choice_text(choice)));
    note(context, "pick.count");
    if (changed) context.emit(command::PickRows{choice});
    draw_uses(context);
    if (pick.frames_to_bring <= 0 || context.model.picked.working || context.model.picked.values == nullptr)
        return;
    --pick.frames_to_bring;
    ImGui::SetScrollHereY(1);  // what has unfolded comes into view
    context.state.animating = true;
}

}  // namespace gse::ui
