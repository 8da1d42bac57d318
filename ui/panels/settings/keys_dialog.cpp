// Conventions, and one button per command that waits for keys.
#include "ui/panels/settings/keys_dialog.h"

#include <fmt/format.h>

#include <algorithm>

#include "ui/commands/guarded.h"
#include "ui/state/state.h"
#include "ui/widgets/controls.h"

namespace gse::ui {
namespace {

void send(Context& context) { context.emit(command::SetKeymap{context.state.keymap.text()}); }

/// Gives the pressed keys to the command that waits for them. Esc leaves it as it was.
void choose_keys(Context& context) {
    auto& keys = context.state.keys;
    const auto& io = ImGui::GetIO();
    constexpr int FirstModifier = 340, LastModifier = 347;
    for (int code = key::Space; code < IM_ARRAYSIZE(io.KeysDown); ++code) {
        if ((code >= FirstModifier && code <= LastModifier) || !ImGui::IsKeyPressed(code, false)) continue;
        const Shortcut command = *keys.choosing;
        if (code == key::Escape) return keys.choosing.reset();
        const Chord chord{code, io.KeyCtrl, io.KeyShift, io.KeyAlt};
        keys.note = Keymap::why_not(chord);
        if (!keys.note.empty()) return;  // it waits for others
        keys.choosing.reset();
        if (const auto had = context.state.keymap.bind(command, chord))
            keys.note =
                fmt::format("{} was \"{}\", which has no key now", chord_text(chord), help_of(*had).what);
        return send(context);
    }
}

void draw_command_key(Context& context, const KeyHelp& line) {
    auto& keys = context.state.keys;
    const bool chooses = keys.choosing == line.command;
    const std::string chord = keys_of(context, line.command);
    if (button(context,
               {.name = fmt::format("keys.{}", line.name),
                .text = chooses         ? "Press the keys"
                        : chord.empty() ? "none"
                                        : chord,
                .tooltip =
                    "Click, then press other keys (Esc leaves it). Right click: back to the convention's.",
                .look = chooses ? Look::Primary : Look::Normal})) {
        keys.choosing = chooses ? std::nullopt : std::optional(line.command);
        keys.note.clear();
    }
    if (!context.state.keymap.changed(line.command) || !ImGui::IsItemClicked(ImGuiMouseButton_Right)) return;
    context.state.keymap.reset(line.command);
    send(context);
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
        if (line.command == NoShortcut) wrapped_text(line.keys);
        else draw_command_key(context, line);
        ImGui::TableNextColumn();
        const bool changed = line.command != NoShortcut && context.state.keymap.changed(line.command);
        dim_text(fmt::format("{}{}", changed ? "* " : "", line.what));
    }
    ImGui::EndTable();
}

}  // namespace

void centre_next(ImVec2 size) {
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({screen.x * 0.5f, screen.y * 0.5f}, ImGuiCond_Always, {0.5f, 0.5f});
    if (size.x > 0)
        ImGui::SetNextWindowSize({std::min(size.x, screen.x * 0.96f), std::min(size.y, screen.y * 0.92f)});
}

void draw_key_preset(Context& context, const char* name) {
    row_label(context, "As in",
              "Splat: as splat editors have them. Blender: its letters. Maya: Alt and the mouse buttons move "
              "the camera, with a tool in hand, too. Keys that you chose stay.");
    int preset = static_cast<int>(context.state.keymap.preset());
    ImGui::BeginGroup();
    if (segmented(context, name, KeyPresetNames, preset)) {
        context.state.keymap = context.state.keymap.in(static_cast<KeyPreset>(preset));
        context.state.keys.choosing.reset();
        context.state.keys.note.clear();
        send(context);
    }
    ImGui::EndGroup();
}

void draw_keys_dialog(Context& context) {
    bool& open = context.state.help_open;
    auto& keys = context.state.keys;
    if (open && !ImGui::IsPopupOpen("Keys")) ImGui::OpenPopup("Keys");
    if (!open) return;
    centre_next({context.em * 66, context.em * 48});
    if (!ImGui::BeginPopupModal("Keys", &open, ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove)) return;
    const bool chose = keys.choosing.has_value();
    if (ImGui::IsMouseClicked(0)) keys.choosing.reset();
    if (keys.choosing) choose_keys(context);
    draw_key_preset(context, "keys.preset");
    if (keys.note.empty()) dim_text("Click on a key to choose another.");
    else coloured_text(palette::Warning, keys.note + ".");
    note(context, "keys.note");
    const bool wide = ImGui::GetContentRegionAvail().x > context.em * 48;
    if (ImGui::BeginTable("columns", wide ? 2 : 1)) {
        ImGui::TableNextColumn();
        for (const char* group : {"Camera", "Labels", "Keyboard"}) draw_group(context, group);
        ImGui::TableNextColumn();
        for (const char* group : {"Show", "Work", "Files", "Numbers"}) draw_group(context, group);
        ImGui::EndTable();
    }
    const bool escaped = !chose && (ImGui::IsKeyPressed(key::Escape, false) ||
                                    (ImGui::IsKeyPressed(key::F1, false) && !ImGui::IsWindowAppearing()));
    if (escaped) open = false;
    if (!open) {
        keys.choosing.reset();
        keys.note.clear();
        ImGui::CloseCurrentPopup();
    }
    ImGui::EndPopup();
}

}  // namespace gse::ui
