// Windows in the middle: all keys, about, and questions that wait for an answer.
#include <fmt/format.h>

#include <algorithm>

#include "ui/commands.h"
#include "ui/keys.h"
#include "ui/menu.h"
#include "ui/state.h"
#include "ui/widgets/controls.h"

namespace gse::ui {
namespace {

void centre_next(ImVec2 size) {
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({screen.x * 0.5f, screen.y * 0.5f}, ImGuiCond_Always, {0.5f, 0.5f});
    if (size.x > 0)
        ImGui::SetNextWindowSize({std::min(size.x, screen.x * 0.96f), std::min(size.y, screen.y * 0.92f)});
}

void draw_group(Context& context, const char* group) {
    heading(context, group);
    if (!ImGui::BeginTable(group, 2)) return;
    ImGui::TableSetupColumn("keys", ImGuiTableColumnFlags_WidthStretch, 0.45f);
    ImGui::TableSetupColumn("what", ImGuiTableColumnFlags_WidthStretch, 0.55f);
    for (const auto& line : KeyTable) {
        if (std::string_view(line.group) != group) continue;
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        wrapped_text(line.keys);
        ImGui::TableNextColumn();
        dim_text(line.what);
    }
    ImGui::EndTable();
}

void draw_help(Context& context) {
    bool& open = context.state.help_open;
    if (open && !ImGui::IsPopupOpen("Keys")) ImGui::OpenPopup("Keys");
    if (!open) return;
    centre_next({context.em * 62, context.em * 44});
    if (!ImGui::BeginPopupModal("Keys", &open, ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove)) return;
    const bool wide = ImGui::GetContentRegionAvail().x > context.em * 48;
    if (ImGui::BeginTable("columns", wide ? 2 : 1)) {
        ImGui::TableNextColumn();
        for (const char* group : {"Camera", "Labels"}) draw_group(context, group);
        ImGui::TableNextColumn();
        for (const char* group : {"Show", "Work", "Files", "Numbers"}) draw_group(context, group);
        ImGui::EndTable();
    }
    const bool escaped = ImGui::IsKeyPressed(key::Escape, false) ||
                         (ImGui::IsKeyPressed(key::F1, false) && !ImGui::IsWindowAppearing());
    if (escaped) open = false;
    if (!open) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
}

void draw_about(Context& context) {
    bool& open = context.state.about_open;
    if (open && !ImGui::IsPopupOpen("About GSEditPro")) ImGui::OpenPopup("About GSEditPro");
    if (!open) return;
    centre_next({context.em * 34, context.em * 16});
    if (!ImGui::BeginPopupModal("About GSEditPro", &open,
                                ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove))
        return;
    wrapped_text("GSEditPro edits 3D Gaussian Splatting scenes by words.");
    ImGui::Spacing();
    dim_text(
        "After \"GSEditPro: 3D Gaussian Splatting Editing with Attention-based Progressive Localization\".");
    ImGui::Spacing();
    if (!context.model.renderer.empty()) property(context, "Drawn by", context.model.renderer);
    property(context, "Interface", fmt::format("Dear ImGui {}", ImGui::GetVersion()));
    ImGui::Spacing();
    if (button(context, {.name = "about.close", .text = "Close"}) || ImGui::IsKeyPressed(key::Escape, false))
        open = false;
    if (!open) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
}

void draw_question(Context& context) {
    auto& question = context.state.question;
    if (question.pending) ImGui::OpenPopup("###question");
    question.pending = false;
    centre_next({0, 0});
    ImGui::SetNextWindowSizeConstraints({context.em * 20, 0}, {context.em * 34, context.em * 40});
    if (!ImGui::BeginPopupModal((question.title + "###question").c_str(), nullptr,
                                ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove))
        return;
    ImGui::PushTextWrapPos(context.em * 30);
    ImGui::TextUnformatted(question.text.c_str());
    ImGui::PopTextWrapPos();
    ImGui::Spacing();
    bool done = ImGui::IsKeyPressed(key::Escape, false) && !ImGui::IsWindowAppearing();
    std::function<void()> act;
    for (std::size_t index = 0; index < question.answers.size(); ++index) {
        const auto& answer = question.answers[index];
        if (index > 0) flow(button_width(answer.text));
        if (button(context, {.name = fmt::format("question.{}", index),
                             .text = answer.text,
                             .look = answer.dangerous ? Look::Danger
                                     : index == 0     ? Look::Primary
                                                      : Look::Normal})) {
            act = answer.act;
            done = true;
        }
    }
    if (done) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
    if (act) act();
}

}  // namespace

void draw_dialogs(Context& context) {
    context.state.files.draw(context);
    draw_help(context);
    draw_about(context);
    draw_question(context);
}

}  // namespace gse::ui
