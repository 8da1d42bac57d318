// Models: where each part was looked for, what was found, what is missing and what to do about it.
#include <fmt/format.h>

#include "ui/commands.h"
#include "ui/panels/panels.h"
#include "ui/state.h"
#include "ui/widgets/controls.h"
#include "ui/widgets/file_browser.h"

namespace gse::ui {
namespace {

void ask_model(Context& context) {
    auto& actions = context.actions;
    context.state.files.ask(
        {.title = "A model: folder in diffusers layout, or a .safetensors file",
         .confirm = "Use",
         .extensions = {".safetensors", "model_index.json"},
         .saves = false,
         .folder_allowed = true,
         .start = context.state.model_path,
         .answer = [&actions](const std::filesystem::path& path) { actions.choose_model(utf8_of(path)); }});
}

void draw_card(Context& context, const ModelView& model, int index) {
    const ImU32 colour =
        model.usable ? (model.problem.empty() ? palette::Good : palette::Warning) : palette::Bad;
    begin_notice(context, fmt::format("models.card.{}", index),
                 model.chosen ? palette::Accent : palette::Border);
    bullet_dot(colour);
    if (context.fonts.bold != nullptr) ImGui::PushFont(context.fonts.bold);
    wrapped_text(model.name.empty() ? "(no name)" : model.name);
    if (context.fonts.bold != nullptr) ImGui::PopFont();
    std::string facts = model.structure;
    if (model.bytes > 0)
        facts += fmt::format("{}{}", facts.empty() ? "" : ", ", bytes_text(static_cast<double>(model.bytes)));
    if (!facts.empty()) dim_text(facts);
    dim_text(shortened(model.path, ImGui::GetContentRegionAvail().x));
    tooltip(model.path);
    if (!model.problem.empty()) coloured_text(model.usable ? palette::Warning : palette::Bad, model.problem);
    if (model.chosen) {
        coloured_text(palette::Accent, "In use");
    } else if (model.checking) {
        dim_text("It is being loaded, to see whether it can be used.");
    } else if (button(
                   context,
                   {.name = fmt::format("models.use.{}", index),
                    .text = "Use",
                    .why_off = model.usable ? "" : "This model cannot be used; the line above says why"})) {
        context.actions.choose_model(model.path);
    }
    end_notice();
}

}  // namespace

void draw_models_panel(Context& context) {
    wrapped_text("Locate and Edit need a text-to-image model. Viewing, labelling by hand and export do not.");
    if (context.model.models.empty()) dim_text("No model was found.");
    for (int index = 0; index < static_cast<int>(context.model.models.size()); ++index)
        draw_card(context, context.model.models[static_cast<std::size_t>(index)], index);
    const auto& words = context.model.known_words;
    if (context.model.words_known)
        dim_text(words.empty() ? "The chosen model takes any word."
                               : fmt::format("The chosen model knows {} words.", words.size()));
    if (!words.empty() && folding(context, "models.words", "Words it knows")) {
        for (const auto& word : words) {
            if (&word != &words.front()) flow(ImGui::CalcTextSize(word.c_str()).x);
            ImGui::TextUnformatted(word.c_str());
        }
    }
    heading(context, "Another model");
    const bool entered = text_input(context, "models.path", context.state.model_path,
                                    "path of a folder or .safetensors", ImGuiInputTextFlags_EnterReturnsTrue);
    if (button(context, {.name = "models.choose",
                         .text = "Use this path",
                         .why_off = context.state.model_path.empty() ? "Type a path first" : ""}) ||
        (entered && !context.state.model_path.empty()))
        context.actions.choose_model(context.state.model_path);
    flow(button_width("Locate..."));
    if (button(context, {.name = "models.browse", .text = "Browse..."})) ask_model(context);
    dim_text("Pickled .ckpt and .pt files are refused: they can run programs. Convert them to .safetensors.");
}

}  // namespace gse::ui
