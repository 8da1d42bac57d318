// Settings of what an image server draws: numbers with their origin, its LoRAs, its own options, files.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/error.h"
#include "engine/remote/api/server_lora.h"
#include "engine/remote/api/server_option.h"
#include "engine/remote/api/server_settings.h"
#include "ui/keys/keyboard.h"
#include "ui/panels/server/parts.h"
#include "ui/state/state.h"
#include "ui/widgets/controls.h"
#include "ui/widgets/fields.h"
#include "ui/widgets/file_browser.h"
#include "ui/widgets/icons.h"

namespace gse::ui {
namespace {

using remote::ServerSettings;

/// Row of a number that is the family's while the setting is 0; its origin stands below.
template <class Number> void draw_number(Context& context, const FieldRow& row, Number& value, Number usual) {
    Number shown = value > 0 ? value : usual;
    if (field_row(context, row, shown, usual)) value = shown == usual ? Number{} : shown;
    dim_text(value > 0 ? fmt::format("yours; the family has {}", usual) : "of the family");
    note(context, fmt::format("{}.{}.origin", row.prefix, row.name));
}

/// All numbers of the settings' list of fields.
void draw_numbers(Context& context, ServerSettings& choice) {
    const auto& usual = context.model.server.usual;
    ServerSettings::visit_fields(choice,
                                 [&](const char* name, auto& value, const char* help, const auto&... range) {
                                     using Value = std::remove_cvref_t<decltype(value)>;
                                     if constexpr (is_number_field<Value>) {
                                         FieldRow row{"models.server", name, help, std::nullopt};
                                         ((row.range = range), ...);
                                         draw_number(context, row, value, value_named<Value>(usual, name));
                                     }
                                 });
}

const char* help_of(const char* wanted) {
    const char* found = "";
    ServerSettings::visit_fields(program_defaults<ServerSettings>(),
                                 [&](const char* name, const auto&, const char* help, auto...) {
                                     if (std::string_view(name) == wanted) found = help;
                                 });
    return found;
}

/// Row that ends with a button which takes it off. True where that was pressed.
bool takes_off(Context& context, const std::string& name) {
    ImGui::SameLine();
    return icon_button(context, {.name = name, .icon = Icon::Trash, .tooltip = "Take it off"});
}

void draw_lora(Context& context, std::vector<std::string>& loras, std::size_t index) {
    const auto lora = remote::parse_server_lora(loras[index]);
    const auto name = fmt::format("models.server.lora.{}", index);
    row_label(context, shortened(lora.name, context.em * 10), lora.name);
    const float button_space = context.em * 1.75f + ImGui::GetStyle().ItemSpacing.x;
    ImGui::SetNextItemWidth(std::max(context.em * 3, ImGui::GetContentRegionAvail().x - button_space));
    double weight = lora.weight;
    const bool entered = ImGui::InputScalar(fmt::format("##{}", name).c_str(), ImGuiDataType_Double, &weight,
                                            nullptr, nullptr, "%.2f", ImGuiInputTextFlags_EnterReturnsTrue);
    note(context, name + ".weight");
    tooltip("How strongly it counts, -10 to 10: 1 = as it was trained. Enter applies it.");
    takes_letters(context);
    if (takes_off(context, name + ".remove")) loras.erase(loras.begin() + static_cast<std::ptrdiff_t>(index));
    else if (entered && std::isfinite(weight))
        loras[index] = fmt::format("{}:{}", lora.name, std::clamp(weight, -10.0, 10.0));
}

/// Why a text is no LoRA that can be added; empty = it is one.
std::string lora_problem(const std::string& text, const std::vector<std::string>& loras) {
    if (text.empty()) return "Type the name of a LoRA first";
    try {
        const auto lora = remote::parse_server_lora(text);
        const bool used = std::any_of(loras.begin(), loras.end(), [&](const auto& other) {
            return remote::parse_server_lora(other).name == lora.name;
        });
        return used ? fmt::format("\"{}\" is used already: change its weight above", lora.name) : "";
    } catch (const Error& error) { return fmt::format("{}; {}", error.message(), error.hint()); }
}

/// Field for a LoRA of a server that has no list.
void draw_typed_lora(Context& context, ServerSettings& choice) {
    auto& typed = context.state.models.server_lora;
    dim_text("The server does not list its LoRAs: type a name, or a path at the server.");
    const bool entered = text_input(context, "models.server.lora", typed, "name, or name:0.8",
                                    ImGuiInputTextFlags_EnterReturnsTrue);
    const auto problem = lora_problem(typed, choice.lora);
    if (!typed.empty() && !problem.empty()) coloured_text(palette::Warning, problem);
    const bool pressed =
        button(context, {.name = "models.server.lora.add", .text = "Add LoRA", .why_off = problem});
    if (!problem.empty() || !(pressed || entered)) return;
    const auto lora = remote::parse_server_lora(std::exchange(typed, {}));
    choice.lora.push_back(fmt::format("{}:{}", lora.name, lora.weight));
}

/// List of the server's LoRAs that are not used yet.
void draw_listed_loras(Context& context, ServerSettings& choice) {
    std::vector<const char*> names;
    for (const auto& name : context.model.server.loras)
        if (std::none_of(choice.lora.begin(), choice.lora.end(), [&](const std::string& text) {
                return remote::parse_server_lora(text).name == name;
            }))
            names.push_back(name.c_str());
    if (names.empty()) return;
    row_label(context, "Add a LoRA", help_of("lora"));
    int chosen = -1;
    if (combo(context, "models.server.lora", names, chosen))
        choice.lora.push_back(fmt::format("{}:1", names[static_cast<std::size_t>(chosen)]));
}

/// LoRAs in use, and those that the server has besides.
void draw_loras(Context& context, ServerSettings& choice) {
    const auto& server = context.model.server;
    if (!choice.lora.empty()) {
        row_label(context, "LoRA of the server", help_of("lora"));
        note(context, "models.server.loras");
        dim_text("Weight");
    }
    for (std::size_t index = 0; index < choice.lora.size(); ++index) draw_lora(context, choice.lora, index);
    switch (server.lora_names) {
        case remote::LoraNames::None: return dim_text("The server takes no LoRAs.");
        case remote::LoraNames::Any: return draw_typed_lora(context, choice);
        case remote::LoraNames::Listed: break;
    }
    if (server.loras.empty()) return dim_text("The server has no LoRAs.");
    draw_listed_loras(context, choice);
}

/// Why a text is no option that can be added; empty = it is one.
std::string option_problem(const std::string& text, const std::vector<std::string>& options) {
    if (text.empty()) return "Type NAME=VALUE first";
    auto all = options;
    all.push_back(text);
    try {
        remote::parse_server_options(all);
    } catch (const Error& error) { return fmt::format("{}; {}", error.message(), error.hint()); }
    return {};
}

void draw_options(Context& context, ServerSettings& choice) {
    dim_text("Options of the server");
    tooltip(help_of("option"));
    for (std::size_t index = 0; index < choice.option.size(); ++index) {
        ImGui::AlignTextToFramePadding();
        ImGui::TextUnformatted(
            shortened(choice.option[index], ImGui::GetContentRegionAvail().x - context.em * 2.5f).c_str());
        tooltip(choice.option[index]);
        if (!takes_off(context, fmt::format("models.server.option.{}.remove", index))) continue;
        choice.option.erase(choice.option.begin() + static_cast<std::ptrdiff_t>(index));
        return;
    }
    auto& typed = context.state.models.server_option;
    const bool entered = text_input(context, "models.server.option", typed, "scheduler=karras",
                                    ImGuiInputTextFlags_EnterReturnsTrue);
    const auto problem = option_problem(typed, choice.option);
    if (!typed.empty() && !problem.empty()) coloured_text(palette::Warning, problem);
    const bool pressed =
        button(context, {.name = "models.server.option.add", .text = "Add option", .why_off = problem});
    if (!problem.empty() || !(pressed || entered)) return;
    choice.option.push_back(typed);
    typed.clear();
}

/// Setting that is a file.
struct FileRow {
    const char* name;  // of the field
    const char* text;
    const char* none;      // where there is none
    const char* question;  // title of the dialog
    std::vector<std::string> extensions;
    std::string ServerSettings::*file;
};

void ask_file(Context& context, const FileRow& row) {
    auto& commands = context.commands;
    auto choice = context.model.server.choice;
    context.state.files.ask({.title = row.question,
                             .confirm = "Use",
                             .extensions = row.extensions,
                             .start = choice.*row.file,
                             .answer = [&commands, choice, file = row.file](const auto& path) mutable {
                                 choice.*file = utf8_of(path);
                                 commands.push(command::SetServer{choice});
                             }});
}

void draw_file(Context& context, const FileRow& row, std::string& typed, ServerSettings& choice) {
    auto& file = choice.*row.file;
    const std::string name = fmt::format("models.server.{}", row.name);
    row_label(context, row.text, help_of(row.name));
    ImGui::TextUnformatted(
        file.empty() ? row.none : shortened(file, ImGui::GetContentRegionAvail().x - context.em).c_str());
    if (!file.empty()) tooltip(file);
    const bool entered =
        text_input(context, name, typed, "path of a file", ImGuiInputTextFlags_EnterReturnsTrue);
    const bool pressed = button(
        context, {.name = name + ".use", .text = "Use", .why_off = typed.empty() ? "Type a path first" : ""});
    if ((pressed || entered) && !typed.empty()) file = std::exchange(typed, {});
    flow(button_width("Browse..."));
    if (button(context, {.name = name + ".browse", .text = "Browse..."})) ask_file(context, row);
    if (file.empty()) return;
    flow(button_width("Without it"));
    if (button(context, {.name = name + ".none", .text = "Without it"})) file.clear();
}

void draw_files(Context& context, ServerSettings& choice) {
    auto& typed = context.state.models;
    const bool comfy = context.model.server.is_comfy || !choice.workflow.empty();
    if (comfy)
        draw_file(context,
                  {"workflow",
                   "Workflow",
                   "a bundled one that fits",
                   "A workflow of ComfyUI in API format",
                   {".json"},
                   &ServerSettings::workflow},
                  typed.server_workflow, choice);
    if (comfy)
        checkbox(context, "models.server.paid_nodes", "Allow nodes that cost money", choice.paid_nodes,
                 help_of("paid_nodes"));
    draw_file(context,
              {"ca",
               "Certificates",
               "those of the system",
               "A file of certificates",
               {".pem", ".crt", ".cer"},
               &ServerSettings::ca},
              typed.server_ca, choice);
}

}  // namespace

void draw_drawing_settings(Context& context) {
    const auto& server = context.model.server;
    if (server.usual.side == 0 && server.problem.empty()) return;  // it was not asked yet
    if (!folding(context, "models.server.drawing", "Drawing settings")) return;
    auto choice = server.choice;
    const auto before = fields_to_json(choice);
    if (server.usual.side > 0) draw_numbers(context, choice);
    draw_loras(context, choice);
    draw_options(context, choice);
    draw_files(context, choice);
    if (fields_to_json(choice) != before) context.emit(command::SetServer{choice});
}

}  // namespace gse::ui
