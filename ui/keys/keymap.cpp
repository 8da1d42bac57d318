// Presets, and reading and writing keys as text.
#include "ui/keys/keymap.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "engine/base/json.h"

namespace gse::ui {
namespace {

constexpr std::array<std::pair<int, std::string_view>, 16> NamedKeys{{{key::Space, "Space"},
                                                                      {key::Escape, "Esc"},
                                                                      {key::Enter, "Enter"},
                                                                      {key::Tab, "Tab"},
                                                                      {key::Backspace, "Backspace"},
                                                                      {key::Delete, "Delete"},
                                                                      {key::Right, "Right"},
                                                                      {key::Left, "Left"},
                                                                      {key::Down, "Down"},
                                                                      {key::Up, "Up"},
                                                                      {key::Home, "Home"},
                                                                      {key::End, "End"},
                                                                      {260, "Insert"},
                                                                      {266, "Page up"},
                                                                      {267, "Page down"},
                                                                      {330, "Keypad ."}}};
constexpr int LastFunctionKey = key::F1 + 11;

/// Keys that a convention has otherwise; "" = no key.
struct Override {
    KeyPreset preset;
    Shortcut command;
    const char* keys;
};

// Blender: B box, C brush ("circle select"), H hides, Alt + H shows, / isolates ("local view"), keypad .
// frames, Ctrl + I inverts. Maya: its marquee and lasso keys are letters that fly here; H hides with Ctrl,
// Shift + H shows; F frames, A (all) flies, so Home it is.
constexpr std::array<Override, 11> Overrides{{
    {KeyPreset::Blender, Shortcut::Rectangle, "B"},
    {KeyPreset::Blender, Shortcut::Brush, "C"},
    {KeyPreset::Blender, Shortcut::CutOut, "K"},
    {KeyPreset::Blender, Shortcut::Frame, "Keypad ."},
    {KeyPreset::Blender, Shortcut::ShowHidden, "Alt + H"},
    {KeyPreset::Blender, Shortcut::Isolate, "/"},
    {KeyPreset::Blender, Shortcut::Delete, "X"},
    {KeyPreset::Maya, Shortcut::Hide, "Ctrl + H"},
    {KeyPreset::Maya, Shortcut::ShowHidden, "Shift + H"},
    {KeyPreset::Maya, Shortcut::Isolate, "Shift + I"},
    {KeyPreset::Maya, Shortcut::Invert, "Ctrl + Shift + I"},
}};

std::string key_name(int code) {
    for (const auto& [number, name] : NamedKeys)
        if (number == code) return std::string(name);
    if (code >= key::F1 && code <= LastFunctionKey) return "F" + std::to_string(code - key::F1 + 1);
    return code > key::Space && code < 127 ? std::string(1, static_cast<char>(code)) : std::string();
}

int key_named(std::string_view name) {
    for (int code = key::Space; code <= LastFunctionKey + 40; ++code)
        if (key_name(code) == name && !name.empty()) return code;
    return 0;
}

}  // namespace

std::string chord_text(const Chord& chord) {
    if (chord.key == 0) return {};
    return std::string(chord.ctrl ? "Ctrl + " : "") + (chord.alt ? "Alt + " : "") +
           (chord.shift ? "Shift + " : "") + key_name(chord.key);
}

std::optional<Chord> parse_chord(const std::string& text) {
    Chord chord;
    if (text.empty()) return chord;
    std::string_view rest = text;
    for (const auto& [name, member] : {std::pair{std::string_view("Ctrl + "), &Chord::ctrl},
                                       {"Alt + ", &Chord::alt},
                                       {"Shift + ", &Chord::shift}}) {
        if (!rest.starts_with(name)) continue;
        chord.*member = true;
        rest.remove_prefix(name.size());
    }
    chord.key = key_named(rest);
    return chord.key != 0 ? std::optional(chord) : std::nullopt;
}

const KeyHelp& help_of(Shortcut command) {
    return *std::find_if(KeyTable.begin(), KeyTable.end(),
                         [&](const KeyHelp& line) { return line.command == command; });
}

Keymap::Keymap(KeyPreset preset) : preset_(preset) {
    for (const auto& line : KeyTable)
        if (line.command != NoShortcut)
            chords_[static_cast<std::size_t>(line.command)] = parse_chord(line.keys).value_or(Chord{});
    for (const auto& other : Overrides)
        if (other.preset == preset)
            chords_[static_cast<std::size_t>(other.command)] = parse_chord(other.keys).value_or(Chord{});
}

bool Keymap::changed(Shortcut command) const { return of(command) != Keymap(preset_).of(command); }

std::optional<Shortcut> Keymap::user_of(const Chord& chord) const {
    const auto found = std::find(chords_.begin(), chords_.end(), chord);
    return chord.key == 0 || found == chords_.end()
               ? std::nullopt
               : std::optional(static_cast<Shortcut>(found - chords_.begin()));
}

std::string Keymap::why_not(const Chord& chord) {
    constexpr std::string_view Fly = "WASDEQ", Scale = "=+-0";
    constexpr std::array Fixed{key::Escape, key::Enter, key::KeypadEnter, key::Tab, key::Left, key::Right,
                               key::Up,     key::Down,  key::Grave,       key::F1,  key::F6};
    const std::string name = chord_text(chord);
    const char letter = chord.key < 127 ? static_cast<char>(chord.key) : '\0';
    if (key_name(chord.key).empty()) return "That key has no name here";
    if (!chord.ctrl && Fly.find(letter) != std::string_view::npos && letter != '\0') return name + " flies";
    if (chord.key == key::LeftBracket || chord.key == key::RightBracket)
        return name + " is the size of the brush";
    if (chord.ctrl && letter != '\0' && Scale.find(letter) != std::string_view::npos)
        return name + " is the size of the interface";
    if (!chord.ctrl && chord.key == key::Space) return name + " presses what has the focus";
    const bool fixed = std::find(Fixed.begin(), Fixed.end(), chord.key) != Fixed.end();
    return fixed ? name + " has a fixed meaning" : std::string();
}

std::optional<Shortcut> Keymap::bind(Shortcut command, const Chord& chord) {
    const auto had = user_of(chord);
    if (had && *had != command) {
        chords_[static_cast<std::size_t>(*had)] = {};
        chosen_[static_cast<std::size_t>(*had)] = false;
    }
    chords_[static_cast<std::size_t>(command)] = chord;
    chosen_[static_cast<std::size_t>(command)] = chord.key != 0;
    return had && *had != command ? had : std::nullopt;
}

void Keymap::reset(Shortcut command) {
    bind(command, Keymap(preset_).of(command));
    chosen_[static_cast<std::size_t>(command)] = false;
}

Keymap Keymap::in(KeyPreset preset) const {
    Keymap other(preset);
    for (const auto& line : KeyTable)
        if (line.command != NoShortcut && chosen_[static_cast<std::size_t>(line.command)])
            other.bind(line.command, of(line.command));
    return other;
}

std::string Keymap::text() const {
    nlohmann::ordered_json json{{"preset", KeyPresetNames[static_cast<std::size_t>(preset_)]}};
    for (const auto& line : KeyTable)
        if (line.command != NoShortcut &&
            (changed(line.command) || chosen_[static_cast<std::size_t>(line.command)]))
            json["keys"][line.name] = chord_text(of(line.command));
    return json.dump();
}

Keymap Keymap::parse(const std::string& text) {
    const auto json = try_parse_json<nlohmann::ordered_json>(text);
    if (!json.is_object()) return Keymap();
    const auto named = json.contains("preset") && json["preset"].is_string()
                           ? json["preset"].get<std::string>()
                           : std::string();
    const auto preset = std::find(KeyPresetNames.begin(), KeyPresetNames.end(), named);
    Keymap map(preset == KeyPresetNames.end() ? KeyPreset::Splat
                                              : static_cast<KeyPreset>(preset - KeyPresetNames.begin()));
    if (!json.contains("keys") || !json["keys"].is_object()) return map;
    for (const auto& line : KeyTable) {
        if (line.command == NoShortcut || !json["keys"].contains(line.name) ||
            !json["keys"][line.name].is_string())
            continue;
        const auto chord = parse_chord(json["keys"][line.name].get<std::string>());
        if (chord && (chord->key == 0 || why_not(*chord).empty())) map.bind(line.command, *chord);
    }
    return map;
}

}  // namespace gse::ui
