// Log: messages of the program, filtered by level and text, to be copied.
#include <fmt/format.h>

#include <algorithm>

#include "ui/panels/panels.h"
#include "ui/state/state.h"
#include "ui/widgets/controls.h"

namespace gse::ui {
namespace {

constexpr std::array<const char*, 4> LevelNames{"Debug", "Info", "Warning", "Error"};
constexpr std::array<ImU32, 4> LevelColours{palette::TextDim, palette::Text, palette::Warning, palette::Bad};

std::size_t level_of(const LogLine& line) {
    return std::min<std::size_t>(static_cast<std::size_t>(line.level), LevelNames.size() - 1);
}

bool shown(const LogState& state, const LogLine& line) {
    return state.shown[level_of(line)] &&
           (state.filter.empty() || line.text.find(state.filter) != std::string::npos);
}

void copy(Context& context) {
    std::string text;
    for (const auto& line : context.model.log)
        if (shown(context.state.log, line))
            text += fmt::format("{} {} {}\n", line.time, LevelNames[level_of(line)], line.text);
    ImGui::SetClipboardText(text.c_str());
}

void draw_bar(Context& context) {
    auto& state = context.state.log;
    for (std::size_t level = 0; level < LevelNames.size(); ++level) {
        const auto count = std::count_if(context.model.log.begin(), context.model.log.end(),
                                         [level](const LogLine& line) { return level_of(line) == level; });
        const std::string text = fmt::format("{} {}", LevelNames[level], count);
        if (level > 0) flow(button_width(text) + context.em * 1.5f);
        checkbox(context, fmt::format("log.{}", LevelNames[level]), text, state.shown[level]);
    }
    flow(button_width("Copy"));
    if (button(context, {.name = "log.copy",
                         .text = "Copy",
                         .why_off = context.model.log.empty() ? "There is nothing to copy" : "",
                         .tooltip = "What is shown, to the clipboard"}))
        copy(context);
    flow(context.em * 8);
    text_input(context, "log.filter", state.filter, "find");
}

}  // namespace

void draw_log_panel(Context& context) {
    auto& state = context.state.log;
    draw_bar(context);
    if (ImGui::BeginChild("lines", {0, 0}, false, ImGuiWindowFlags_NavFlattened)) {
        if (context.fonts.mono != nullptr) ImGui::PushFont(context.fonts.mono);
        for (const auto& line : context.model.log) {
            if (!shown(state, line)) continue;
            ImGui::PushStyleColor(ImGuiCol_Text, palette::TextDim);
            ImGui::TextUnformatted(line.time.c_str());
            ImGui::PopStyleColor();
            ImGui::SameLine();
            coloured_text(LevelColours[level_of(line)], line.text);
        }
        if (context.fonts.mono != nullptr) ImGui::PopFont();
        // Follows the newest line until somebody scrolls up.
        state.follow = ImGui::GetScrollY() >= ImGui::GetScrollMaxY() - 1;
        if (state.follow && context.model.log.size() != state.lines_seen) ImGui::SetScrollHereY(1);
        state.lines_seen = context.model.log.size();
    }
    ImGui::EndChild();
    note(context, "log.lines");
}

}  // namespace gse::ui
