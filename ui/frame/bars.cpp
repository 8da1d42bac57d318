// Tool bar at the left and job bar at the bottom.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ui/commands/guarded.h"
#include "ui/frame/menu.h"
#include "ui/state/state.h"
#include "ui/state/status.h"
#include "ui/widgets/controls.h"
#include "ui/widgets/icons.h"

namespace gse::ui {
namespace {

void gap(Context& context) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float width = ImGui::GetContentRegionAvail().x;
    ImGui::GetWindowDrawList()->AddLine({at.x, at.y + context.em * 0.2f},
                                        {at.x + width, at.y + context.em * 0.2f}, palette::Border);
    ImGui::Dummy({0, context.em * 0.3f});
}

void draw_tools(Context& context) {
    const std::string why = context.scene_open() ? "" : "Open a scene first";
    const Tool tool = context.state.viewport.tool;
    const auto tool_button = [&](const char* name, Icon icon, Tool which, const std::string& text) {
        if (icon_button(
                context,
                {.name = name, .icon = icon, .tooltip = text, .active = tool == which, .why_off = why}) &&
            tool != which)
            set_tool(context, which);
    };
    tool_button("tool.orbit", Icon::Pointer, Tool::Orbit, "Orbit: left drag turns the view (Esc)");
    tool_button("tool.brush", Icon::Brush, Tool::Brush,
                with_key(context, "Brush: paint the label", Shortcut::Brush));
    tool_button("tool.rectangle", Icon::Rectangle, Tool::Rectangle,
                with_key(context, "Rectangle: label what is inside", Shortcut::Rectangle));
    tool_button("tool.lasso", Icon::Lasso, Tool::Lasso,
                with_key(context, "Lasso: label what is inside", Shortcut::Lasso));
    tool_button("tool.cut_out", Icon::CutOut, Tool::CutOut,
                with_key(context, "Cut out: label the thing under a click or in a box, all its sides",
                         Shortcut::CutOut));
    tool_button("tool.place", Icon::Place, Tool::Place,
                with_key(context, "Move, turn and resize what is labelled", Shortcut::Place));
    tool_button("tool.heal", Icon::Heal, Tool::Heal,
                with_key(context, "Heal brush: paint over a hole or a blemish", Shortcut::HealBrush));
    gap(context);
    const bool front = context.view.front_only;
    if (icon_button(context,
                    {.name = "tool.front",
                     .icon = front ? Icon::FrontOnly : Icon::Through,
                     .tooltip = with_key(
                         context, front ? "Front only: what is behind is not touched" : "All the way through",
                         Shortcut::FrontOnly),
                     .active = front})) {
        context.view.front_only = !front;
        context.view_changed = true;
    }
}

/// Line with step, share and time left.
std::string job_text(const JobStatus& job) {
    std::string text = job.stage;
    if (job.total > 0) text += fmt::format("  {} / {}", job.step, job.total);
    if (job.paused) return text + "  paused";
    if (job.eta_seconds >= 1) text += fmt::format("  {} left", duration_text(job.eta_seconds));
    return text;
}

void draw_bar(Context& context, const JobStatus& job, const char* name, float width) {
    const ImVec2 low = ImGui::GetCursorScreenPos();
    const float height = ImGui::GetFrameHeight();
    ImGui::Dummy({width, height});
    note(context, name);
    ImDrawList* list = ImGui::GetWindowDrawList();
    const ImVec2 high(low.x + width, low.y + height);
    list->AddRectFilled(low, high, palette::Raised, context.em * 0.2f);
    if (job.total > 0) {
        const float share =
            std::clamp(static_cast<float>(job.step) / static_cast<float>(job.total), 0.0f, 1.0f);
        list->AddRectFilled(low, {low.x + width * share, high.y},
                            job.paused ? palette::RaisedHover : palette::AccentDeep, context.em * 0.2f);
    }
    const std::string text = shortened(job_text(job), width - context.em);
    list->AddText({low.x + context.em * 0.5f, low.y + (height - ImGui::GetFontSize()) * 0.5f}, palette::Text,
                  text.c_str());
}

void draw_running(Context& context) {
    const auto& job = context.model.job;
    const float room = ImGui::GetContentRegionAvail().x;
    bullet_dot(job.paused ? palette::Warning : palette::Accent);
    ImGui::TextUnformatted(shortened(job.title, room * 0.3f).c_str());
    note(context, "job.title");
    ImGui::SameLine();
    const float buttons =
        (job.can_pause ? button_width("Resume") + context.em : 0) + button_width("Cancel") + context.em;
    const float file = context.model.file_job.running ? room * 0.25f : 0;
    draw_bar(context, job, "job.bar",
             std::max(context.em * 4, ImGui::GetContentRegionAvail().x - buttons - file));
    ImGui::SameLine();
    if (job.can_pause) {
        if (button(context, {.name = "job.pause",
                             .text = job.paused ? "Resume" : "Pause",
                             .width = button_width("Resume")}))
            context.emit(command::Pause{!job.paused});
        ImGui::SameLine();
    }
    if (button(context, {.name = "job.cancel", .text = "Cancel", .tooltip = "Esc"})) cancel_job(context);
}

void draw_idle(Context& context) {
    const auto& job = context.model.job;
    const float file = context.model.file_job.running ? context.em * 18 : 0;
    const float room = ImGui::GetContentRegionAvail().x - file - context.em * 2;
    if (!job.error.empty()) {
        bullet_dot(palette::Bad);
        ImGui::TextUnformatted(shortened(job.error, room).c_str());
        note(context, "job.error");
        return tooltip(job.error);
    }
    const auto& verdict = context.model.verdict;
    const bool waits = context.model.result_waiting;
    bullet_dot(waits && verdict.warns ? palette::Warning : waits ? palette::Accent : palette::Good);
    const std::string text = job_line(context.model);
    ImGui::TextUnformatted(shortened(text, room).c_str());
    note(context, "job.outcome");
    tooltip(text);
}

void draw_file_job(Context& context) {
    const auto& job = context.model.file_job;
    if (!job.running) {
        if (!job.error.empty() && !context.model.job.running) {
            ImGui::SameLine();
            coloured_text(palette::Bad, shortened(job.error, ImGui::GetContentRegionAvail().x));
            tooltip(job.error);
        }
        return;
    }
    ImGui::SameLine();
    const float cancel = button_width("Stop") + context.em * 0.5f;
    const float width =
        std::clamp(ImGui::GetContentRegionAvail().x - cancel, context.em * 3, context.em * 16);
    JobStatus shown = job;
    shown.stage = job.title.empty() ? job.stage : job.title;
    draw_bar(context, shown, "job.file", width);
    ImGui::SameLine();
    if (button(context, {.name = "job.file.cancel", .text = "Stop"})) context.emit(command::CancelFileJob{});
}

}  // namespace

void draw_tool_bar(Context& context) {
    draw_tools(context);
    gap(context);
    const bool open = context.scene_open();
    const std::string why = open ? "" : "Open a scene first";
    if (icon_button(context,
                    {.name = "tool.frame",
                     .icon = Icon::Frame,
                     .tooltip = with_key(context, "Frame what is labelled, else the scene", Shortcut::Frame),
                     .why_off = why}))
        frame_selection(context);
    if (icon_button(context,
                    {.name = "tool.home",
                     .icon = Icon::Home,
                     .tooltip = with_key(context, "Home: what is labelled, else what stands on the ground",
                                         Shortcut::Home),
                     .why_off = why}))
        go_home(context);
    gap(context);
    const bool undo = open && context.model.document->can_undo(),
               redo = open && context.model.document->can_redo();
    if (icon_button(context, {.name = "tool.undo",
                              .icon = Icon::Undo,
                              .tooltip = with_key(context, "Undo", Shortcut::Undo),
                              .why_off = undo ? "" : "There is nothing to undo"}))
        context.emit(command::Undo{});
    if (icon_button(context, {.name = "tool.redo",
                              .icon = Icon::Redo,
                              .tooltip = with_key(context, "Redo", Shortcut::Redo),
                              .why_off = redo ? "" : "There is nothing to redo"}))
        context.emit(command::Redo{});
    gap(context);
    if (icon_button(context, {.name = "tool.screenshot",
                              .icon = Icon::Camera,
                              .tooltip = with_key(context, "Save screenshot", Shortcut::Screenshot),
                              .why_off = why_not_export(context, context.exports.picture_path)}))
        export_picture(context);
}

void draw_job_bar(Context& context) {
    ImGui::AlignTextToFramePadding();
    if (context.model.job.running) draw_running(context);
    else draw_idle(context);
    draw_file_job(context);
}

}  // namespace gse::ui
