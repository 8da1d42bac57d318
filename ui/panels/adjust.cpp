// Colours of the labelled splats, by hand: seen while the controls move, one edit of the stack.
#include <fmt/format.h>

#include "ui/commands/guarded.h"
#include "ui/panels/panels.h"
#include "ui/state/state.h"
#include "ui/widgets/controls.h"
#include "ui/widgets/fields.h"

namespace gse::ui {
namespace {

/// True while it changes. A right click brings the default back.
bool slider_row(Context& context, const char* name, double& value, const char* help, const Range& range,
                double standard) {
    const std::string text = fmt::format("{}\nRight click: back to {}.", help, standard);
    row_label(context, field_label(name), text);
    bool changed = ImGui::SliderScalar(fmt::format("##adjust.{}", name).c_str(), ImGuiDataType_Double, &value,
                                       &range.low, &range.high, range.high - range.low > 10 ? "%.0f" : "%.2f",
                                       ImGuiSliderFlags_AlwaysClamp);
    note(context, fmt::format("adjust.{}", name));
    tooltip(text);
    if (value != standard && ImGui::IsItemClicked(ImGuiMouseButton_Right)) {
        value = standard;
        changed = true;
    }
    return changed;
}

}  // namespace

void draw_adjust(Context& context) {
    auto& adjust = context.state.by_hand.adjust;
    // Another step: the next one begins from there.
    const bool went_on = adjust.adjusting && !context.model.adjusting;
    adjust.adjusting = context.model.adjusting;
    if (went_on) adjust.values = {};
    if (!folding(context, "adjust.open", "Adjust colours")) {
        adjust.frames_to_bring = FramesToBring;
        return;
    }
    const std::string why = why_not_work(context);
    if (!why.empty()) return dim_text(why + ".");
    const NamedLabel* label = context.active_label();
    const std::size_t count = label_count(context);
    wrapped_text(count > 0
                     ? fmt::format("Changes what \"{}\" labels: {} splats.", label->name, count_text(count))
                     : fmt::format("Nothing is labelled: changes all {} splats.",
                                   count_text(context.document().current.size())));
    note(context, "adjust.scope");
    bool changed = false;
    const ColourAdjustment standard;
    ColourAdjustment::visit_fields(
        adjust.values, [&](const char* name, double& value, const char* help, const Range& range) {
            changed |= slider_row(context, name, value, help, range, value_named<double>(standard, name));
        });
    const bool neutral = adjust.values == standard;
    if (button(context, {.name = "adjust.reset",
                         .text = "As it was",
                         .why_off = neutral && !changed ? "Nothing is adjusted" : "",
                         .tooltip = "Takes the adjustment back"})) {
        adjust.values = {};
        changed = true;
    }
    if (changed) context.emit(command::AdjustColours{adjust.values});
    if (adjust.frames_to_bring <= 0) return;
    --adjust.frames_to_bring;
    ImGui::SetScrollHereY(1);  // what has unfolded comes into view
    context.state.animating = true;
}

}  // namespace gse::ui
