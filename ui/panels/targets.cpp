// Targets: the views that the model has redrawn, as a contact sheet. The scene is fitted to them, and the
// artist may keep or drop each.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/remote/api/server_settings.h"
#include "ui/panels/panels.h"
#include "ui/state/own_pictures.h"
#include "ui/state/state.h"
#include "ui/widgets/controls.h"
#include "ui/widgets/sheet.h"
#include "ui/widgets/tooltips.h"

namespace gse::ui {
namespace {

using edit::TargetChoice;

constexpr float LargestEm = 24;  // side of a picture

/// The shown round.
const TargetRound& shown_round(Context& context) {
    const auto& rounds = context.model.target_rounds;
    auto& chosen = context.state.targets.chosen;
    const auto found = std::find_if(rounds.begin(), rounds.end(),
                                    [&](const TargetRound& round) { return round.round == chosen; });
    if (found == rounds.end()) chosen = -1;
    return found == rounds.end() ? rounds.back() : *found;
}

std::string why_not_change(const Context& context, const TargetRound& round) {
    if (!context.model.edit_running)
        return "The edit is over: branch from a snapshot to go on with other views";
    if (round.round != context.model.target_rounds.back().round) return "This round is over";
    return {};
}

void draw_picture(Context& context, const std::shared_ptr<const Image>& picture, float side, bool dropped) {
    const ImVec2 low = ImGui::GetCursorScreenPos();
    const ImVec2 high(low.x + side, low.y + side);
    ImDrawList* list = ImGui::GetWindowDrawList();
    ImGui::Dummy({side, side});
    list->AddRectFilled(low, high, palette::Sunken, context.em * 0.2f);
    if (picture == nullptr || !ImGui::IsItemVisible()) return;
    list->AddImage(imgui_texture(context.textures.texture(picture)), low, high, {0, 0}, {1, 1},
                   dropped ? IM_COL32(255, 255, 255, 70) : IM_COL32_WHITE);
}

/// Render and target beside each other, larger while the mouse is on them.
void draw_pair(Context& context, const TargetView& target, const std::string& name, float side) {
    ImGui::BeginGroup();
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(1, 1));
    draw_picture(context, target.before, side, target.dropped);
    ImGui::SameLine();
    draw_picture(context, target.after, side, target.dropped);
    ImGui::PopStyleVar();
    ImGui::EndGroup();
    note(context, name);
    const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
    const bool selected = context.model.server.on && context.state.targets.view == target.name;
    if (context.model.server.on && ImGui::IsItemClicked())
        context.state.targets.view = selected ? std::string() : target.name;
    if (selected)
        ImGui::GetWindowDrawList()->AddRect(low, high, palette::Good, context.em * 0.2f, 0,
                                            std::max(2.0f, context.em * 0.2f));
    if (target.ordered || target.dropped)
        ImGui::GetWindowDrawList()->AddRect(low, high, target.ordered ? palette::Accent : palette::Warning,
                                            context.em * 0.2f, 0, std::max(1.0f, context.em * 0.1f));
    if (!ImGui::IsItemHovered() || target.after == nullptr || target.before == nullptr) return;
    if (ImGui::IsMouseDoubleClicked(0)) return context.emit(command::SetCamera{target.camera});
    if (ImGui::IsAnyMouseDown()) return;
    const float large = std::min(context.em * 15, ImGui::GetIO().DisplaySize.x * 0.3f);
    const auto& style = ImGui::GetStyle();
    constexpr const char* Help = "Left the scene, right what it is fitted to. Double click: look through it.";
    begin_tooltip({std::max(2 * large + style.ItemSpacing.x, ImGui::CalcTextSize(Help).x),
                   large + style.ItemSpacing.y + ImGui::GetTextLineHeight()});
    for (const auto* picture : {&target.before, &target.after}) {
        if (picture == &target.after) ImGui::SameLine();
        ImGui::Image(imgui_texture(context.textures.texture(*picture)), {large, large});
    }
    plain_text(Help);
    ImGui::EndTooltip();
}

std::string state_text(const Context& context, const TargetView& target) {
    std::string text = target.name;
    if (!own_picture_of(context.model.server.choice, target.name).empty()) text += ", yours next";
    if (target.attempt > 0) text += ", redrawn";
    if (target.missing) text += ", missing";
    else if (target.dropped) text += ", dropped";
    return text;
}

/// Buttons for a view; off when `why` says so.
void draw_choices(Context& context, const TargetRound& round, const TargetView& target,
                  const std::string& name, const std::string& why) {
    const auto order = [&](TargetChoice choice) {
        context.emit(command::OrderTarget{{round.round, target.view, choice}});
    };
    const auto used = std::count_if(round.targets.begin(), round.targets.end(),
                                    [](const TargetView& other) { return !other.dropped; });
    const std::string why_not_now = !why.empty()     ? why
                                    : target.ordered ? "What was said before is being done"
                                                     : "";
    if (target.dropped) {
        if (button(context, {.name = name + ".accept",
                             .text = "Accept",
                             .why_off = target.missing && why_not_now.empty()
                                            ? std::string_view("Nothing was drawn of it: Redo has it drawn")
                                            : why_not_now,
                             .tooltip = "The fit uses it again"}))
            order(TargetChoice::Accept);
    } else if (button(context, {.name = name + ".drop",
                                .text = "Drop",
                                .why_off = why_not_now.empty() && used <= 1
                                               ? std::string_view("The fit needs one view at least")
                                               : why_not_now,
                                .tooltip = "The fit does not use it any more"})) {
        order(TargetChoice::Drop);
    }
    ImGui::SameLine();
    if (button(context, {.name = name + ".redo",
                         .text = "Redo",
                         .why_off = why_not_now,
                         .tooltip = "The model draws it once more, from another seed"}))
        order(TargetChoice::Redo);
}

constexpr const char* UsePicture = "Use my picture...";

/// Asks for a picture of the artist's own, which the view of the next edit shall look like.
void draw_own_choice(Context& context, const TargetView& target, const std::string& name) {
    if (!context.model.server.on) return;
    if (!button(context, {.name = name + ".own",
                          .text = UsePicture,
                          .tooltip = "The next edit takes your picture for this view, and the others follow "
                                     "it. You can also click the view and drop the picture on the window."}))
        return;
    auto& commands = context.commands;
    context.state.files.ask({.title = "A picture of your own for this view, as large as you like, but square",
                             .confirm = "Use",
                             .extensions = {".png", ".jpg", ".jpeg"},
                             .answer = [&commands, choice = context.model.server.choice,
                                        view = target.name](const std::filesystem::path& path) {
                                 commands.push(
                                     command::SetServer{with_own_picture(choice, view, utf8_of(path))});
                             }});
}

/// Pictures for the next edit, each with a way to take it back.
void draw_own_pictures(Context& context) {
    const auto& choice = context.model.server.choice;
    for (std::size_t i = 0; i < choice.target_picture.size(); ++i) {
        const auto own = remote::target_picture_of(choice.target_picture[i]);
        wrapped_text(fmt::format("The next edit draws {} like {}.", own.view, utf8_of(own.file.filename())));
        if (button(context, {.name = fmt::format("targets.own.{}.clear", i), .text = "Without my picture"}))
            context.emit(command::SetServer{with_own_picture(choice, own.view, {})});
    }
}

void draw_target(Context& context, const TargetRound& round, std::size_t index, float side,
                 const std::string& why) {
    const auto& target = round.targets[index];
    const std::string name = fmt::format("targets.{}", index);
    ImGui::PushID(static_cast<int>(index));
    ImGui::BeginGroup();
    draw_pair(context, target, name, side);
    const std::string text = state_text(context, target);
    dim_text(shortened(text, 2 * side));
    draw_choices(context, round, target, name, why);
    draw_own_choice(context, target, name);
    ImGui::EndGroup();
    ImGui::PopID();
}

/// As many pairs beside each other as fit.
void draw_sheet(Context& context, const TargetRound& round) {
    const bool owns = context.model.server.on;
    const float gap = context.em * 0.6f,
                least = std::max(context.em * 4.2f, button_width("Accept") * 0.5f +
                                                        button_width("Redo") * 0.5f + context.em * 0.5f);
    if (ImGui::BeginChild("sheet", {0, 0}, false, ImGuiWindowFlags_NavFlattened)) {
        const ImVec2 room = ImGui::GetContentRegionAvail();
        const float below = ImGui::GetTextLineHeightWithSpacing() +
                            static_cast<float>(owns ? 2 : 1) * ImGui::GetFrameHeightWithSpacing();
        const auto [columns, side] = fitted_sheet({static_cast<int>(round.targets.size()), 2, below, gap},
                                                  room.x - 1, room.y, least, context.em * LargestEm);
        const std::string why = why_not_change(context, round);
        for (std::size_t index = 0; index < round.targets.size(); ++index) {
            if (static_cast<int>(index) % columns != 0) ImGui::SameLine(0, gap);
            draw_target(context, round, index, side, why);
        }
    }
    ImGui::EndChild();
}

void draw_rounds(Context& context) {
    const auto& rounds = context.model.target_rounds;
    if (rounds.size() < 2) return;
    for (const auto& round : rounds) {
        const std::string text = fmt::format("Round {}", round.round + 1);
        if (&round != &rounds.front()) flow(button_width(text));
        const bool shown = &shown_round(context) == &round;
        if (button(context, {.name = fmt::format("targets.round.{}", round.round),
                             .text = text,
                             .look = shown ? Look::Primary : Look::Normal}))
            context.state.targets.chosen = &round == &rounds.back() ? -1 : round.round;
    }
}

/// The edit waits for the artist.
void draw_wait(Context& context) {
    if (!context.model.targets_wait) return;
    begin_notice(context, "targets.wait", palette::Accent);
    wrapped_text("The edit waits for you: drop what is wrong, or have it redrawn.");
    if (button(context, {.name = "targets.fit", .text = "Fit the scene to these", .look = Look::Primary}))
        context.emit(command::FitToTargets{});
    end_notice();
}

/// Suspicious facts of the shown round.
void draw_warnings(Context& context) {
    for (std::size_t i = 0; const auto& warning : shown_round(context).warnings) {
        begin_notice(context, fmt::format("targets.warning.{}", i++), palette::Warning);
        wrapped_text(warning);
        end_notice();
    }
}

std::string summary(const TargetRound& round) {
    const auto dropped = std::count_if(round.targets.begin(), round.targets.end(),
                                       [](const TargetView& target) { return target.dropped; });
    std::string text =
        fmt::format("Round {} of {}: {} views redrawn", round.round + 1, round.rounds, round.targets.size());
    const auto missing = std::count_if(round.targets.begin(), round.targets.end(),
                                       [](const TargetView& target) { return target.missing; });
    if (dropped > missing) text += fmt::format(", {} dropped", dropped - missing);
    if (missing > 0) text += fmt::format(", {} missing", missing);
    text += ". Left the scene, right what it is fitted to.";
    if (!round.sentence.empty())
        text += fmt::format(" Your sentence names no colour: drawn as \"{}\".", round.sentence);
    return text;
}

}  // namespace

void draw_targets_panel(Context& context) {
    const auto review = [&] {
        context.model_settings_changed |=
            checkbox(context, "targets.review", "Wait for me before each fit", context.model_settings.review,
                     "The edit waits when views were redrawn, until you have looked at them.");
    };
    if (context.model.target_rounds.empty()) {
        draw_own_pictures(context);
        dim_text(
            "An edit with method views or auto redraws views here: look at them, drop those that are wrong, "
            "have others redrawn.");
        return review();
    }
    const ImVec2 space = ImGui::GetContentRegionAvail();
    const bool beside = space.x > context.em * 36;  // else the sheet is below
    if (beside)
        ImGui::BeginChild("about", {std::clamp(space.x * 0.27f, context.em * 13, context.em * 20), space.y},
                          false, ImGuiWindowFlags_NavFlattened);
    draw_wait(context);
    draw_own_pictures(context);
    draw_rounds(context);
    dim_text(summary(shown_round(context)));
    draw_warnings(context);
    review();
    if (beside) {
        ImGui::EndChild();
        ImGui::SameLine();
    }
    draw_sheet(context, shown_round(context));
}

}  // namespace gse::ui
