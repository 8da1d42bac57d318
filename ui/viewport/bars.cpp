// Bars at the picture's foot and top: the result that waits, and notes on hidden, viewed or recoverable work.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "ui/commands/guarded.h"
#include "ui/state/state.h"
#include "ui/state/status.h"
#include "ui/viewport/viewport.h"
#include "ui/widgets/controls.h"
#include "ui/widgets/icons.h"
#include "ui/widgets/tooltips.h"

namespace gse::ui {
namespace {

constexpr float PictureEm = 7.5f;  // width of a thumbnail

/// Small window over the picture that sizes itself. With `below`, its lower edge is at that place, else its
/// upper one.
void begin_floating(const char* name, ImVec2 at, bool below = false) {
    ImGui::SetNextWindowPos(at, ImGuiCond_Always, {0.5f, below ? 1.0f : 0.0f});
    ImGui::SetNextWindowBgAlpha(0.96f);
    ImGui::Begin(name, nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing);
}

/// Closes it and notes where it ends.
void end_floating(Context& context) {
    float& bottom = context.state.viewport.bars_bottom;
    bottom = std::max(bottom, ImGui::GetWindowPos().y + ImGui::GetWindowHeight() + context.em * 0.4f);
    ImGui::End();
}

/// Closes a bar at the foot and notes where it ends.
void end_foot(Context& context) {
    ImVec2& low = context.state.viewport.foot_low;
    const ImVec2 at = ImGui::GetWindowPos();
    low = {std::min(low.x, at.x), std::min(low.y, at.y)};
    ImGui::End();
}

constexpr float ResultEm = 6;  // width of one of several results

/// All results that can be applied, small, above the bar. A click shows one.
void draw_results(Context& context) {
    const auto& results = context.model.results;
    const auto& state = context.state.viewport;
    begin_floating("results", {(state.low.x + state.high.x) * 0.5f, state.foot_low.y - context.em * 0.4f},
                   true);
    const float room = (state.high.x - state.low.x) / static_cast<float>(results.size()) - context.em;
    const float side = std::clamp(room, context.em, context.em * ResultEm);
    for (std::size_t i = 0; i < results.size(); ++i) {
        if (i > 0) ImGui::SameLine();
        ImGui::PushID(static_cast<int>(i));
        const ImVec2 low = ImGui::GetCursorScreenPos(), high(low.x + side, low.y + side);
        if (ImGui::InvisibleButton("result", {side, side})) context.emit(command::ShowResult{i});
        note(context, fmt::format("result.{}", i));
        const auto said = fmt::format("Result {} of {}, seed {}", i + 1, results.size(), results[i].seed);
        if (results[i].thumbnail != nullptr) large_picture(context, results[i].thumbnail, said);
        else tooltip(said);
        ImDrawList* list = ImGui::GetWindowDrawList();
        list->AddRectFilled(low, high, palette::Sunken, context.em * 0.2f);
        if (results[i].thumbnail != nullptr)
            list->AddImageRounded(imgui_texture(context.textures.texture(results[i].thumbnail)), low, high,
                                  {0, 0}, {1, 1}, IM_COL32_WHITE, context.em * 0.2f);
        const bool shown = i == context.model.shown_result;
        if (shown || ImGui::IsItemHovered() || ImGui::IsItemFocused())
            list->AddRect(low, high, shown ? palette::Accent : palette::TextDim, context.em * 0.2f, 0,
                          std::max(2.0f, context.em * 0.14f));
        ImGui::PopID();
    }
    end_foot(context);
}

/// A line of text that is not wrapped: the bar is as wide as its lines.
void coloured_line(ImU32 colour, const std::string& text) {
    ImGui::PushStyleColor(ImGuiCol_Text, colour);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopStyleColor();
}

/// Verdict on the result in its colour; where it warns, with what to try.
void draw_verdict(Context& context) {
    const auto& verdict = context.model.verdict;
    const ImU32 colour = verdict.warns          ? palette::Warning
                         : verdict.text.empty() ? palette::TextDim
                                                : palette::Good;
    bullet_dot(colour);
    coloured_line(verdict.warns ? colour : palette::Text,
                  verdict.text.empty()
                      ? "The model cannot judge these words: look at the result from all sides."
                      : verdict.text);
    note(context, "result.verdict");
    if (verdict.warns)
        coloured_line(palette::TextDim,
                      "Try another seed, mark the place by Cut out, or only adjust its colours (Labels).");
}

void draw_result_buttons(Context& context) {
    const bool wipes = context.model.comparison == Comparison::Wipe, warns = context.model.verdict.warns;
    if (button(context, {.name = "result.compare",
                         .text = wipes ? "Stop comparing" : "Compare",
                         .tooltip = with_key(context, "Wipe between before and after", Shortcut::Wipe)}))
        toggle_wipe(context);
    ImGui::SameLine();
    if (button(context, {.name = "result.another",
                         .text = "Another",
                         .tooltip = "The same once more with another seed; this result is kept beside it",
                         .look = warns ? Look::Primary : Look::Normal}))
        context.emit(command::AnotherResult{});
    ImGui::SameLine();
    if (button(context, {.name = "result.apply",
                         .text = warns ? "Apply anyway" : "Apply",
                         .tooltip = "Keep it as an entry of the edit stack",
                         .look = warns ? Look::Normal : Look::Primary}))
        context.emit(command::ApplyResult{});
    ImGui::SameLine();
    if (button(context,
               {.name = "result.discard", .text = "Discard", .tooltip = "Leave the scene as it was"}))
        context.emit(command::DiscardResult{});
}

/// At the foot: what is worn is at the top.
void draw_result_bar(Context& context) {
    const auto& state = context.state.viewport;
    begin_floating("result bar", {(state.low.x + state.high.x) * 0.5f, state.high.y - context.em * 0.4f},
                   true);
    const auto& model = context.model;
    const std::size_t changed = model.result_changed_outside;
    const auto time = result_line(model);
    const auto proof =
        fmt::format("{} splat{} outside the label changed", count_text(changed), changed == 1 ? "" : "s");
    const float words =
        ImGui::CalcTextSize(time.c_str()).x + ImGui::CalcTextSize(proof.c_str()).x + context.em * 3;
    const float buttons = button_width("Stop comparing") + button_width("Apply anyway") +
                          button_width("Discard") + button_width("Another") + context.em * 2.5f;
    const bool one_line =
        words + buttons < context.state.viewport.high.x - context.state.viewport.low.x - context.em * 2;
    draw_verdict(context);
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(time.c_str());
    note(context, "result.time");
    ImGui::SameLine();
    // What Apply is decided by stands beside it.
    bullet_dot(changed == 0 ? palette::Good : palette::Bad);
    ImGui::TextUnformatted(proof.c_str());
    note(context, "result.proof");
    tooltip(fmt::format("PSNR outside the label: {:.1f} dB", model.result_psnr_outside_db));
    if (one_line) ImGui::SameLine();
    draw_result_buttons(context);
    end_foot(context);
    if (model.results.size() > 1) draw_results(context);
}

/// Note that something is hidden.
void draw_hidden_bar(Context& context, ImVec2 at) {
    begin_floating("hidden bar", at);
    ImGui::AlignTextToFramePadding();
    bullet_dot(palette::Warning);
    const std::size_t hidden = context.model.hidden;
    ImGui::TextUnformatted(
        fmt::format("{} splat{} hidden", count_text(hidden), hidden == 1 ? " is" : "s are").c_str());
    note(context, "hidden.note");
    tooltip(
        "They are still part of the scene: edits, saving and exports go on with them. Export has a choice to "
        "leave them out.");
    ImGui::SameLine();
    if (button(
            context,
            {.name = "hidden.show", .text = "Show all", .tooltip = keys_of(context, Shortcut::ShowHidden)}))
        context.emit(command::ShowHidden{});
    end_floating(context);
}

/// Layer of the search over the picture, and the view's vote.
void draw_evidence_bar(Context& context, ImVec2 at, const AttentionView& view) {
    auto& state = context.state.attention;
    begin_floating("evidence bar", at);
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(shortened(view.name, context.em * 9).c_str());
    note(context, "evidence.view");
    ImGui::SameLine();
    constexpr std::array<const char*, 2> Kinds{"Attention", "Mask"};
    int kind = state.over == Over::Mask ? 1 : 0;
    ImGui::BeginGroup();
    if (segmented(context, "evidence.kind", Kinds, kind))
        state.over = kind == 1 ? Over::Mask : Over::Attention;
    ImGui::EndGroup();
    tooltip(with_key(context, "What of this view lies over the picture", Shortcut::Evidence));
    ImGui::SameLine();
    draw_vote(context, "evidence.votes", state.chosen);
    ImGui::SameLine();
    if (icon_button(context, {.name = "evidence.close",
                              .icon = Icon::Close,
                              .tooltip = "Takes it off the picture (Esc)",
                              .size_em = 1.6f}))
        state.over = Over::Nothing;
    end_floating(context);
}

/// Arrow of a world direction as the picture shows it; a dot where it points along the view.
void draw_arrow(Context& context, const Vec3& direction) {
    constexpr float LeastLength = 0.2f;  // of the arrow, where the direction is seen from the side
    constexpr float HeadEm = 0.28f;
    const float side = ImGui::GetFrameHeight();
    const ImVec2 low = ImGui::GetCursorScreenPos(), middle(low.x + side * 0.5f, low.y + side * 0.5f);
    ImGui::Dummy({side, side});
    const Vec3 seen = context.model.camera.rotation * direction;
    const float x = static_cast<float>(seen.x), y = static_cast<float>(seen.y), flat = std::hypot(x, y);
    ImDrawList* list = ImGui::GetWindowDrawList();
    const float thick = std::max(1.5f, context.em * 0.12f);
    if (flat < LeastLength) return list->AddCircleFilled(middle, thick * 1.5f, palette::TextDim);
    const float reach = side * 0.4f, head = context.em * HeadEm;
    const ImVec2 tip(middle.x + x * reach, middle.y + y * reach);
    const ImVec2 along(x / flat * head, y / flat * head);
    list->AddLine({middle.x - x * reach, middle.y - y * reach}, tip, palette::Text, thick);
    for (const float turn : {-1.0f, 1.0f})
        list->AddLine(tip, {tip.x - along.x + turn * along.y, tip.y - along.y - turn * along.x},
                      palette::Text, thick);
}

/// Question which way is up, with an answer per axis.
void draw_up_bar(Context& context, ImVec2 at) {
    constexpr std::array<std::pair<const char*, Vec3>, 6> Axes{{{"y", {0, 1, 0}},
                                                                {"-y", {0, -1, 0}},
                                                                {"z", {0, 0, 1}},
                                                                {"-z", {0, 0, -1}},
                                                                {"x", {1, 0, 0}},
                                                                {"-x", {-1, 0, 0}}}};
    begin_floating("up bar", at);
    ImGui::AlignTextToFramePadding();
    bullet_dot(palette::Warning);
    ImGui::TextUnformatted("Which way is up is not sure. Up is:");
    note(context, "up.note");
    tooltip(
        "Neither the file nor what stands in the scene says it surely. The arrows show where each axis "
        "points "
        "in the picture. The choice can be undone.");
    for (const auto& [name, direction] : Axes) {
        flow(ImGui::GetFrameHeight() + button_width("-y") + context.em);
        draw_arrow(context, direction);
        ImGui::SameLine(0, 0);
        const bool taken = context.document().info.up == direction;
        if (button(context, {.name = fmt::format("up.{}", name),
                             .text = name,
                             .tooltip = taken ? "Keep it as it is" : "Turn the scene so that this is up"}))
            context.emit(command::SetUpAxis{name});
    }
    end_floating(context);
}

/// Note that the scene of a project is not where it was, with the way to it.
void draw_lost_bar(Context& context, ImVec2 at) {
    const auto& lost = context.model.lost;
    begin_floating("lost bar", at);
    bullet_dot(palette::Warning);
    ImGui::TextUnformatted(
        fmt::format("{} cannot be opened: its scene is not there any more.", lost.name).c_str());
    note(context, "lost.note");
    dim_text(shortened(lost.scene, context.em * 30));
    tooltip(lost.scene);
    if (button(context, {.name = "lost.find",
                         .text = "Find it...",
                         .why_off = context.model.file_job.running ? "A file is being read" : "",
                         .tooltip = "Choose the file where it is now. The edits are kept.",
                         .look = Look::Primary}))
        ask_lost_scene(context);
    ImGui::SameLine();
    if (button(context, {.name = "lost.close", .text = "Close", .tooltip = "The project stays as it is"}))
        context.emit(command::ForgetLostScene{});
    end_floating(context);
}

void draw_thumbnail(Context& context, const Image& picture, TextureId texture) {
    const float width = context.em * PictureEm;
    const float height = std::min(
        width, width * static_cast<float>(picture.height) / static_cast<float>(std::max(1, picture.width)));
    ImGui::Image(imgui_texture(texture), {width, height});
}

}  // namespace

void draw_recovery(Context& context, const char* prefix, std::size_t index, bool can_wait) {
    const auto& found = context.model.recoverable[index];
    const auto named = [&](const char* what) { return fmt::format("{}.{}.{}", prefix, what, index); };
    if (const TextureId texture = context.textures.texture(found.thumbnail); texture != 0) {
        draw_thumbnail(context, *found.thumbnail, texture);
        note(context, named("thumbnail"));
        ImGui::SameLine();
    }
    ImGui::BeginGroup();
    wrapped_text(fmt::format("Unsaved work in {}", found.name));
    note(context, named("name"));
    tooltip(found.place);
    dim_text(found.facts);
    if (!found.running.empty()) wrapped_text(found.running);
    const std::string file = found.file;
    if (button(context, {.name = named("recover"), .text = "Recover", .look = Look::Primary}))
        recover(context, file);
    flow(button_width("Discard"));
    if (button(context,
               {.name = named("discard"), .text = "Discard", .tooltip = "The unsaved work is deleted"}))
        discard_recovery(context, found);
    if (can_wait) {
        flow(button_width("Later"));
        if (button(context,
                   {.name = named("later"),
                    .text = "Later",
                    .tooltip = "It is offered again when the scene is opened or the program starts"}))
            context.emit(command::PostponeRecovery{file});
    }
    ImGui::EndGroup();
}

void draw_bars(Context& context) {
    auto& state = context.state.viewport;
    const float top = state.low.y + context.em * 2.6f, middle = (state.low.x + state.high.x) * 0.5f;
    state.bars_bottom = state.low.y;
    state.foot_low = state.high;
    if (!context.model.lost.project.empty()) draw_lost_bar(context, {middle, top});
    if (!context.scene_open()) return;
    if (context.model.result_waiting) draw_result_bar(context);
    if (context.model.hidden > 0) draw_hidden_bar(context, {middle, std::max(top, state.bars_bottom)});
    if (context.document().info.up_unsure) draw_up_bar(context, {middle, std::max(top, state.bars_bottom)});
    if (const auto* view = view_looked_through(context))
        draw_evidence_bar(context, {middle, std::max(top, state.bars_bottom)}, *view);
    const auto& found = context.model.recoverable;
    const auto offer = std::find_if(found.begin(), found.end(), [](const auto& one) { return one.offered; });
    if (offer == found.end()) return;  // one at a time: the next comes when this one is answered
    const float width = std::min(context.em * 30, state.high.x - state.low.x - context.em * 2);
    ImGui::SetNextWindowContentSize({width, 0});
    begin_floating("recovery", {middle, std::max(top, state.bars_bottom)});
    draw_recovery(context, "recovery", static_cast<std::size_t>(offer - found.begin()), true);
    end_floating(context);
}

}  // namespace gse::ui
