// Changes that a sentence asks for: a list with ticks, obstacles and times.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "ui/commands/guarded.h"
#include "ui/panels/prompt/parts.h"
#include "ui/state/state.h"
#include "ui/widgets/controls.h"

namespace gse::ui {
namespace {

/// Seconds of a step; negative = not known.
double seconds_of(const Context& context, std::size_t index) {
    const auto& seconds = context.model.estimate.step_seconds;
    return index < seconds.size() ? seconds[index] : -1;
}

void draw_step(Context& context, std::size_t index) {
    auto& prompt = context.state.prompt;
    const StepFacts& step = prompt.steps[index];
    const bool possible = step.problem.empty();
    bool made = possible && !is_left_out(context, step);
    ImGui::BeginDisabled(!possible);
    const bool changed =
        checkbox(context, fmt::format("prompt.step.{}", index + 1), "", made, "Leave it out, or make it");
    ImGui::EndDisabled();
    ImGui::SameLine();
    ImGui::BeginGroup();
    ImGui::AlignTextToFramePadding();
    const std::string text =
        fmt::format("{}  {}{}", index + 1, step.text, step.may_be_shown ? " (unless it is so)" : "");
    if (made) wrapped_text(text);
    else dim_text(text);
    if (!possible) coloured_text(palette::Warning, fmt::format("{}.", step.problem));
    if (const double seconds = seconds_of(context, index); made && seconds >= 0)
        dim_text(fmt::format("About {}.", duration_text(seconds)));
    ImGui::EndGroup();
    if (!changed) return;
    if (made) std::erase(prompt.left_out, step.notation);
    else prompt.left_out.push_back(step.notation);
}

}  // namespace

void draw_plan(Context& context) {
    const auto& steps = context.state.prompt.steps;
    if (steps.empty()) return;
    if (steps.size() == 1) {
        dim_text(fmt::format("Plan: {}", steps.front().text));
        return note(context, "prompt.plan");
    }
    dim_text(fmt::format("{} changes, one after another:", steps.size()));
    note(context, "prompt.plan");
    for (std::size_t i = 0; i < steps.size(); ++i) draw_step(context, i);
}

}  // namespace gse::ui
