// Progress: stage, time left, curves, and the snapshots of the running or last edit.
#include <fmt/format.h>

#include <algorithm>

#include "engine/edit/request/unchecked_request.h"
#include "ui/commands/guarded.h"
#include "ui/panels/panels.h"
#include "ui/state/state.h"
#include "ui/state/status.h"
#include "ui/widgets/controls.h"
#include "ui/widgets/plot.h"
#include "ui/widgets/tooltips.h"

namespace gse::ui {
namespace {

constexpr float CurvesEm = 11;  // least height of the unfolded curves

void draw_job(Context& context) {
    const auto& job = context.model.job;
    if (job.title.empty()) return dim_text("Nothing has run yet. Locate and Edit report here.");
    if (context.fonts.bold != nullptr) ImGui::PushFont(context.fonts.bold);
    wrapped_text(job.title);
    if (context.fonts.bold != nullptr) ImGui::PopFont();
    if (!job.error.empty()) {
        coloured_text(palette::Bad, job.error);
    } else if (!job.running) {
        coloured_text(palette::TextDim, outcome_text(job));
        return;
    }
    if (!job.running) return;
    const std::string steps =
        job.total > 0 ? fmt::format("{} / {}", job.step, job.total) : fmt::format("{}", job.step);
    const bool paused = job.paused;
    if (button(context, {.name = "progress.pause",
                         .text = paused ? "Resume" : "Pause",
                         .why_off = job.can_pause ? "" : "This stage cannot be paused"}))
        context.emit(command::Pause{!paused});
    flow(button_width("Cancel"));
    if (button(context,
               {.name = "progress.cancel", .text = "Cancel", .tooltip = "Esc", .look = Look::Danger}))
        cancel_job(context);
    property(context, "Stage", job.paused ? job.stage + " (paused)" : job.stage);
    property(context, "Step", steps);
    property(context, "Time", duration_text(job.seconds));
    property(context, "Left of this stage",
             job.eta_seconds >= 1   ? "about " + duration_text(job.eta_seconds)
             : job.eta_seconds >= 0 ? "nearly done"
                                    : "not known yet");
}

/// Picture, larger while the mouse is on it.
void draw_small_picture(Context& context, const std::string& name,
                        const std::shared_ptr<const Image>& picture, float side) {
    ImGui::Image(imgui_texture(context.textures.texture(picture)), {side, side});
    note(context, name);
    if (!ImGui::IsItemHovered()) return;
    const ImVec2 large(context.em * 14, context.em * 14);
    begin_tooltip(large);
    ImGui::Image(imgui_texture(context.textures.texture(picture)), large);
    ImGui::EndTooltip();
}

/// The view that an image server draws, and what there is of its picture.
void draw_preview(Context& context) {
    const auto& drawing = context.model.drawing;
    if (drawing.sent == nullptr || drawing.preview == nullptr) return;
    dim_text("Being drawn at the server: left what was sent, right as it is so far");
    const float gap = ImGui::GetStyle().ItemSpacing.x;
    const float side = std::min(context.em * 8, (ImGui::GetContentRegionAvail().x - gap) * 0.5f);
    draw_small_picture(context, "progress.sent", drawing.sent, side);
    ImGui::SameLine();
    draw_small_picture(context, "progress.preview", drawing.preview, side);
}

/// The gate: the model's own drawing of a few views.
void draw_gate(Context& context) {
    const auto& gate = context.model.gate;
    if (gate.pictures.empty()) return;
    dim_text("What the model makes of it");
    tooltip("Pictures painted by the model alone: when they do not show the edit, it can hardly succeed.");
    const float gap = ImGui::GetStyle().ItemSpacing.x, count = static_cast<float>(gate.pictures.size());
    const float side =
        std::min(context.em * 5, (ImGui::GetContentRegionAvail().x - gap * (count - 1)) / count);
    for (std::size_t i = 0; i < gate.pictures.size(); ++i) {
        if (i > 0) ImGui::SameLine();
        draw_small_picture(context, fmt::format("progress.gate.{}", i), gate.pictures[i], side);
    }
    if (!gate.verdict.empty()) coloured_text(gate.warns ? palette::Warning : palette::TextDim, gate.verdict);
}

/// Requests of the running or last job to the networks.
void draw_cost(Context& context) {
    const auto& cost = context.model.cost;
    property(context, "Networks",
             fmt::format("{} UNet, {} encoder, {} decoder passes", count_text(cost.unet),
                         count_text(cost.encoder), count_text(cost.decoder)));
    note(context, "progress.networks");
    property(context, "Arithmetic", tflop_text(cost.tflop));
}

/// A button that unfolds what few want to see.
void unfolds(Context& context, const char* name, const char* text, const char* help, bool& shown) {
    flow(button_width(text));
    if (button(context,
               {.name = name, .text = text, .tooltip = help, .look = shown ? Look::Primary : Look::Quiet}))
        shown = !shown;
}

/// The way to the outcome of the redrawing, and what is folded away: curves and cost.
void draw_ways(Context& context) {
    auto& state = context.state.progress;
    if (!context.model.target_rounds.empty()) {
        if (button(context, {.name = "progress.targets",
                             .text = "Redrawn views",
                             .tooltip = "What the scene is fitted to, view by view"}))
            show_panel(context.state, PanelId::Targets);
    }
    if (!context.model.losses.empty())
        unfolds(context, "progress.curves", "Curves", "Losses and gradients, step by step", state.curves);
    if (context.model.cost.unet > 0)
        unfolds(context, "progress.cost", "Cost", "What the networks were asked for", state.cost);
    if (state.cost && context.model.cost.unet > 0) draw_cost(context);
}

std::string why_not_branch(const Context& context, int iteration) {
    if (const int steps = edit::planned_steps(as_planned(context)); steps <= iteration)
        return fmt::format("The edit has {} iterations: set more than {} to go on from here", steps,
                           iteration);
    return {};
}

/// Asks before going on from a snapshot gives up any work.
void ask_branch(Context& context, int iteration) {
    auto& commands = context.commands;
    const auto branch = [&commands, iteration] { commands.push(command::BranchFromSnapshot{iteration}); };
    const bool running = context.model.job.running;
    if (!running && !context.model.result_waiting) return branch();
    auto& question = context.state.question;
    question.title = running ? "Stop the edit and branch?" : "Give up the result and branch?";
    question.text = fmt::format(
        "{} What came after iteration {} is given up; from there the edit goes on to iteration {} "
        "with the settings as they are now.",
        running ? "The running edit is stopped." : "The finished edit has not been applied.", iteration,
        edit::planned_steps(as_planned(context)));
    question.answers = {{running ? "Stop and branch" : "Branch", true, branch},
                        {running ? "Let it work" : "Keep the result", false, {}}};
    question.pending = true;
}

void draw_snapshots(Context& context) {
    const auto& snapshots = context.model.snapshots;
    if (snapshots.empty()) return;
    const bool waits = context.model.result_waiting;  // the result lies behind the last snapshot
    const int count = static_cast<int>(snapshots.size()), last = waits ? count : count - 1;
    int shown = context.model.shown_snapshot < 0 || context.model.shown_snapshot > last
                    ? last
                    : context.model.shown_snapshot;
    const bool newest = shown == last, result = waits && newest;
    const auto& snapshot = snapshots[static_cast<std::size_t>(std::min(shown, count - 1))];
    dim_text(result ? fmt::format("The result, {} splats", count_text(context.model.result_splats))
                    : fmt::format("Snapshot of iteration {}, {} splats{}", snapshot.iteration,
                                  count_text(snapshot.splats), newest ? " (newest)" : ""));
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
    if (ImGui::SliderInt("##progress.snapshot", &shown, 0, std::max(0, last), "",
                         ImGuiSliderFlags_AlwaysClamp))
        context.emit(command::ShowSnapshot{shown == last ? -1 : shown});
    note(context, "progress.snapshot");
    tooltip(waits ? "Drag back to look at an earlier state."
                  : "Drag back to look at an earlier state; the edit goes on meanwhile.");
    if (button(context, {.name = "progress.newest",
                         .text = waits ? "Result" : "Newest",
                         .why_off = result   ? "The result is shown"
                                    : newest ? "The newest is shown"
                                             : ""}))
        context.emit(command::ShowSnapshot{-1});
    flow(button_width("Take this state"));
    if (button(context, {.name = "progress.take",
                         .text = "Take this state",
                         .why_off = !waits   ? "No finished edit waits"
                                    : result ? "It is the result: apply it, or drag back to an earlier state"
                                             : "",
                         .tooltip = "It is the result then, to be applied or discarded."}))
        context.emit(command::TakeSnapshot{snapshot.iteration});
    flow(button_width("Branch from here"));
    const std::string why = why_not_branch(context, snapshot.iteration);
    const std::string help = fmt::format("Goes on from iteration {} to {} with the settings as they are now.",
                                         snapshot.iteration, edit::planned_steps(as_planned(context)));
    if (button(context,
               {.name = "progress.branch", .text = "Branch from here", .why_off = why, .tooltip = help}))
        ask_branch(context, snapshot.iteration);
}

void draw_curves(Context& context, float height) {
    auto& state = context.state.progress;
    const auto& points = context.model.losses;
    const std::array<Curve, 3> losses{
        {{"guidance", palette::Accent, [&points](std::size_t i) { return points[i].guidance_loss; },
          &state.losses[0]},
         {"preservation", palette::Good, [&points](std::size_t i) { return points[i].preservation; },
          &state.losses[1]},
         {"anchor", palette::Warning, [&points](std::size_t i) { return points[i].anchor; },
          &state.losses[2]}}};
    const std::array<Curve, 2> norms{
        {{"guidance gradient", palette::Accent, [&points](std::size_t i) { return points[i].guidance_norm; },
          &state.norms[0]},
         {"preservation gradient", palette::Good,
          [&points](std::size_t i) { return points[i].preservation_norm; }, &state.norms[1]}}};
    int marker = -1;
    const int shown = context.model.shown_snapshot;
    if (shown >= 0 && shown < static_cast<int>(context.model.snapshots.size()))
        marker = context.model.snapshots[static_cast<std::size_t>(shown)].iteration;
    const bool running_edit =
        context.model.job.running && context.model.job.stage != "render" && !points.empty();
    const int last = running_edit ? context.model.job.total : 0;
    const bool beside = ImGui::GetContentRegionAvail().x > context.em * 36;
    const float gap = ImGui::GetStyle().ItemSpacing.x;
    const float width =
        beside ? (ImGui::GetContentRegionAvail().x - gap) * 0.5f : ImGui::GetContentRegionAvail().x;
    const float each = beside ? height : std::max(context.em * 6, (height - gap) * 0.5f);
    if (ImGui::BeginChild("losses", {width, each}, false, ImGuiWindowFlags_NavFlattened)) {
        checkbox(context, "progress.log", "log", state.logarithmic, "Logarithmic heights");
        ImGui::SameLine();
        plot(context,
             {.name = "progress.losses",
              .height = ImGui::GetContentRegionAvail().y,
              .logarithmic = state.logarithmic,
              .last_iteration = last,
              .marker = marker},
             points, losses);
    }
    ImGui::EndChild();
    if (beside) ImGui::SameLine();
    if (ImGui::BeginChild("norms", {width, each}, false, ImGuiWindowFlags_NavFlattened))
        plot(context,
             {.name = "progress.norms",
              .height = ImGui::GetContentRegionAvail().y,
              .logarithmic = state.logarithmic,
              .last_iteration = last,
              .marker = marker},
             points, norms);
    ImGui::EndChild();
}

}  // namespace

void draw_progress_panel(Context& context) {
    const float width = ImGui::GetContentRegionAvail().x, height = ImGui::GetContentRegionAvail().y;
    const bool beside = width > context.em * 38;
    const float left = std::clamp(width * 0.42f, context.em * 14, context.em * 34);
    if (beside) ImGui::BeginChild("job", {left, height}, false, ImGuiWindowFlags_NavFlattened);
    draw_result_notice(context, "progress");
    draw_job(context);
    if (beside) {
        ImGui::EndChild();
        ImGui::SameLine();
        ImGui::BeginChild("states", {0, height}, false, ImGuiWindowFlags_NavFlattened);
    }
    draw_preview(context);
    draw_ways(context);
    if (context.state.progress.curves && !context.model.losses.empty())
        draw_curves(context, std::max(context.em * CurvesEm, ImGui::GetContentRegionAvail().y));
    draw_snapshots(context);
    draw_gate(context);
    if (beside) ImGui::EndChild();
}

}  // namespace gse::ui
