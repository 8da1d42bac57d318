// Windows in the middle: about, and questions that wait for an answer.
#include <fmt/format.h>

#include <algorithm>

#include "ui/commands/guarded.h"
#include "ui/frame/menu.h"
#include "ui/keys/keyboard.h"
#include "ui/keys/keys.h"
#include "ui/panels/settings/keys_dialog.h"
#include "ui/state/state.h"
#include "ui/widgets/controls.h"

namespace gse::ui {
namespace {

constexpr float AnswersEm = 30;  // a line of a question

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

/// Index of the chosen answer, -1 = nothing yet. A list first, the buttons below it.
int draw_answers(Context& context, const std::vector<Question::Answer>& answers) {
    constexpr std::size_t most_rows = 10;
    int chosen = -1;
    const auto listed = static_cast<std::size_t>(
        std::count_if(answers.begin(), answers.end(), [](const auto& answer) { return answer.listed; }));
    if (listed > 0) {
        const float rows = static_cast<float>(std::min(listed, most_rows)) + 0.5f;
        ImGui::BeginChild("list", {context.em * 30, ImGui::GetFrameHeightWithSpacing() * rows}, true,
                          ImGuiWindowFlags_NavFlattened);
        for (std::size_t index = 0; index < answers.size(); ++index) {
            if (!answers[index].listed) continue;
            ImGui::PushID(static_cast<int>(index));
            if (ImGui::Selectable(shortened(answers[index].text, context.em * 20).c_str()))
                chosen = static_cast<int>(index);
            note(context, fmt::format("question.{}", index));
            ImGui::SameLine(context.em * 22);
            ImGui::TextDisabled("%s", answers[index].detail.c_str());
            ImGui::PopID();
        }
        ImGui::EndChild();
    }
    const bool appears = ImGui::IsWindowAppearing();
    const auto harmless = std::find_if(answers.begin(), answers.end(), [](const auto& answer) {
        return !answer.dangerous && !answer.listed;
    });
    bool first = true;
    for (std::size_t index = 0; index < answers.size(); ++index) {
        const auto& answer = answers[index];
        if (answer.listed) continue;
        // Not by the room there is: a dialog takes its size from what is in it, one frame later.
        if (!first) flow(button_width(answer.text), context.em * AnswersEm);
        if (button(context, {.name = fmt::format("question.{}", index),
                             .text = answer.text,
                             .look = answer.dangerous       ? Look::Danger
                                     : first && listed == 0 ? Look::Primary
                                                            : Look::Normal}))
            chosen = static_cast<int>(index);
        if (appears && harmless == answers.begin() + static_cast<std::ptrdiff_t>(index))
            focus_last_item(context);  // Enter chooses what loses nothing
        first = false;
    }
    return chosen;
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
    ImGui::PushTextWrapPos(context.em * AnswersEm);
    plain_text(broken_at_spaces(question.text, context.em * AnswersEm - ImGui::GetCursorPosX()));
    ImGui::PopTextWrapPos();
    ImGui::Spacing();
    const bool done = ImGui::IsKeyPressed(key::Escape, false) && !ImGui::IsWindowAppearing();
    const int chosen = draw_answers(context, question.answers);
    const auto act =
        chosen >= 0 ? question.answers[static_cast<std::size_t>(chosen)].act : std::function<void()>();
    const bool gone = question.answers.empty();  // its scene was closed
    if (done || chosen >= 0 || gone) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
    if (act) act();
}

}  // namespace

void draw_dialogs(Context& context) {
    context.state.files.draw(context);
    draw_keys_dialog(context);
    draw_about(context);
    draw_question(context);
}

}  // namespace gse::ui
