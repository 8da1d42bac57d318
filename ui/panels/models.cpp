// Models: the places searched for each part, the parts found, and advice for those that are missing.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "ui/commands/guarded.h"
#include "ui/keys/keyboard.h"
#include "ui/panels/panels.h"
#include "ui/state/state.h"
#include "ui/widgets/controls.h"
#include "ui/widgets/file_browser.h"
#include "ui/widgets/icons.h"

namespace gse::ui {
namespace {

void ask_model(Context& context) {
    auto& commands = context.commands;
    context.state.files.ask({.title = "A model: folder in diffusers layout, or a .safetensors file",
                             .confirm = "Use",
                             .extensions = {".safetensors", ".sft", "model_index.json"},
                             .saves = false,
                             .folder_allowed = true,
                             .start = context.state.models.model_path,
                             .answer = [&commands](const std::filesystem::path& path) {
                                 commands.push(command::ChooseModel{utf8_of(path)});
                             }});
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
    if (!model.prediction.empty()) dim_text(model.prediction);
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
        context.emit(command::ChooseModel{model.path});
    }
    end_notice();
}

void ask_lora(Context& context) {
    auto& commands = context.commands;
    context.state.files.ask({.title = "A LoRA: .safetensors of kohya, LyCORIS, PEFT or diffusers",
                             .confirm = "Add",
                             .extensions = {".safetensors", ".sft"},
                             .saves = false,
                             .folder_allowed = false,
                             .start = context.state.models.lora_text,
                             .answer = [&commands](const std::filesystem::path& path) {
                                 commands.push(command::AddLora{utf8_of(path)});
                             }});
}

void draw_lora(Context& context, const LoraView& lora, std::size_t index) {
    row_label(context, shortened(lora.name, context.em * 10), lora.path);
    const float button_space = context.em * 1.75f + ImGui::GetStyle().ItemSpacing.x;
    ImGui::SetNextItemWidth(std::max(context.em * 3, ImGui::GetContentRegionAvail().x - button_space));
    double strength = lora.strength;
    const auto name = fmt::format("models.lora.strength.{}", index);
    if (ImGui::InputScalar(fmt::format("##{}", name).c_str(), ImGuiDataType_Double, &strength, nullptr,
                           nullptr, "%.2f", ImGuiInputTextFlags_EnterReturnsTrue) &&
        std::isfinite(strength) && strength != lora.strength)
        context.emit(command::SetLoraStrength{index, strength});
    note(context, name);
    tooltip(
        "How strongly it counts: 1 = as it was trained, 0 = not at all, below 0 = the opposite. Enter "
        "applies it.");
    takes_letters(context);
    ImGui::SameLine();
    if (icon_button(context, {.name = fmt::format("models.lora.remove.{}", index),
                              .icon = Icon::Trash,
                              .tooltip = "Take it off"}))
        context.emit(command::RemoveLora{index});
}

/// LoRAs that are merged into the model in use.
void draw_loras(Context& context) {
    heading(context, "LoRAs");
    const auto& loras = context.model.loras;
    if (loras.empty())
        dim_text("None. A LoRA changes what the model draws, or lets it draw in few steps (LCM, TCD).");
    for (std::size_t index = 0; index < loras.size(); ++index) draw_lora(context, loras[index], index);
    if (context.model.loras_checking)
        dim_text("The model is being loaded with them, to see whether they fit.");
    auto& text = context.state.models.lora_text;
    const bool entered =
        text_input(context, "models.lora.path", text, "file.safetensors, or file.safetensors:0.8",
                   ImGuiInputTextFlags_EnterReturnsTrue);
    if (button(
            context,
            {.name = "models.lora.add", .text = "Add", .why_off = text.empty() ? "Type a path first" : ""}) ||
        (entered && !text.empty())) {
        context.emit(command::AddLora{text});
        text.clear();
    }
    flow(button_width("Browse..."));
    if (button(context, {.name = "models.lora.browse", .text = "Browse..."})) ask_lora(context);
}

/// Line about a segmenter.
struct SegmenterTexts {
    SegmenterRole role;
    const char* name;  // of its widgets
    const char* none;  // where there is none
    const char* used;  // before the path
    const char* back;  // button that does without
    const char* hint;
    const char* question;
    std::vector<std::string> extensions;  // none = a folder
};

const SegmenterTexts& segmenter_texts(SegmenterRole role) {
    static const SegmenterTexts clicks{SegmenterRole::Clicks,
                                       "models.segmenter",
                                       "GrabCut cuts out what the attention finds. SAM or MobileSAM does it "
                                       "instead where you have the weights.",
                                       "Cut out by",
                                       "Back to GrabCut",
                                       "sam_vit_b.pth, mobile_sam.pt, ...",
                                       "Weights of SAM or MobileSAM",
                                       {".safetensors", ".sft", ".pth", ".pt"}};
    static const SegmenterTexts words{
        SegmenterRole::Words,
        "models.words_segmenter",
        "The attention alone says where a word is. CLIPSeg is asked too where you have its folder.",
        "Words are looked for by",
        "Without it",
        "folder of CLIPSeg",
        "A folder of CLIPSeg: config.json, merges.txt and weights",
        {}};
    return role == SegmenterRole::Clicks ? clicks : words;
}

void ask_segmenter(Context& context, const SegmenterTexts& texts) {
    auto& commands = context.commands;
    context.state.files.ask(
        {.title = texts.question,
         .confirm = "Use",
         .extensions = texts.extensions,
         .saves = false,
         .folder_allowed = true,
         .start = context.state.models.segmenter_paths[static_cast<std::size_t>(texts.role)],
         .answer = [&commands, role = texts.role](const std::filesystem::path& path) {
             commands.push(command::ChooseSegmenter{role, utf8_of(path)});
         }});
}

void draw_segmenter(Context& context, const SegmenterTexts& texts) {
    const auto& segmenter = context.model.segmenters[static_cast<std::size_t>(texts.role)];
    const std::string name = texts.name;
    if (segmenter.path.empty()) {
        dim_text(texts.none);
    } else {
        dim_text(texts.used);
        ImGui::TextUnformatted(shortened(segmenter.path, ImGui::GetContentRegionAvail().x).c_str());
        tooltip(segmenter.path);
        if (button(context, {.name = name + ".none", .text = texts.back}))
            context.emit(command::ChooseSegmenter{texts.role, {}});
    }
    if (segmenter.checking) dim_text("The weights are being loaded, to see whether they can be used.");
    auto& text = context.state.models.segmenter_paths[static_cast<std::size_t>(texts.role)];
    const bool entered =
        text_input(context, name + ".path", text, texts.hint, ImGuiInputTextFlags_EnterReturnsTrue);
    if (button(context,
               {.name = name + ".use", .text = "Use", .why_off = text.empty() ? "Type a path first" : ""}) ||
        (entered && !text.empty())) {
        context.emit(command::ChooseSegmenter{texts.role, text});
        text.clear();
    }
    flow(button_width("Browse..."));
    if (button(context, {.name = name + ".browse", .text = "Browse..."})) ask_segmenter(context, texts);
}

void draw_words(const std::vector<std::string>& words) {
    for (const auto& word : words) {
        if (&word != &words.front()) flow(ImGui::CalcTextSize(word.c_str()).x);
        ImGui::TextUnformatted(word.c_str());
    }
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
        draw_words(words);
        if (!context.model.generated_vocabulary.empty()) {
            dim_text("It draws these besides, but does not find them:");
            draw_words(context.model.generated_vocabulary);
        }
    }
    draw_loras(context);
    heading(context, "Masks");
    draw_segmenter(context, segmenter_texts(SegmenterRole::Clicks));
    draw_segmenter(context, segmenter_texts(SegmenterRole::Words));
    draw_image_server(context);
    heading(context, "Another model");
    const bool entered = text_input(context, "models.path", context.state.models.model_path,
                                    "path of a folder or .safetensors", ImGuiInputTextFlags_EnterReturnsTrue);
    if (button(context, {.name = "models.choose",
                         .text = "Use this path",
                         .why_off = context.state.models.model_path.empty() ? "Type a path first" : ""}) ||
        (entered && !context.state.models.model_path.empty()))
        context.emit(command::ChooseModel{context.state.models.model_path});
    flow(button_width("Locate..."));
    if (button(context, {.name = "models.browse", .text = "Browse..."})) ask_model(context);
    dim_text(
        "Pickled .ckpt and .pt models are refused: they can run programs. Convert them to .safetensors.");
}

}  // namespace gse::ui
