// Keys of the commands: one of a few conventions, and the artist's choices on top of it.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "ui/keys/keys.h"

namespace gse::ui {

/// A key with the modifiers that are held with it.
struct Chord {
    int key = 0;  // GLFW; 0 = none
    bool ctrl = false, shift = false, alt = false;
    bool operator==(const Chord&) const = default;
};

/// Text of a chord: "Ctrl + Shift + Z", empty for none. And back: nothing for a text that is no chord.
std::string chord_text(const Chord& chord);
std::optional<Chord> parse_chord(const std::string& text);

enum class KeyPreset { Splat, Blender, Maya };
inline constexpr std::array<const char*, 3> KeyPresetNames{"Splat", "Blender", "Maya"};

class Keymap {
public:
    explicit Keymap(KeyPreset preset = KeyPreset::Splat);
    /// Reads a text of text(). Unreadable entries keep their defaults.
    static Keymap parse(const std::string& json);
    /// The keys of another convention, with the artist's own on top of it.
    Keymap in(KeyPreset preset) const;
    /// Preset and its differences, as JSON.
    std::string text() const;

    KeyPreset preset() const { return preset_; }
    /// Alt with the left, middle and right button orbits, pans and zooms, with a tool in hand, too.
    bool alt_navigates() const { return preset_ == KeyPreset::Maya; }
    Chord of(Shortcut command) const { return chords_[static_cast<std::size_t>(command)]; }
    bool changed(Shortcut command) const;
    /// The command that has these keys.
    std::optional<Shortcut> user_of(const Chord& chord) const;
    /// Gives a command its keys. The command that had them loses them, and is returned. Keys with a fixed
    /// meaning are refused: `why_not`.
    std::optional<Shortcut> bind(Shortcut command, const Chord& chord);
    /// Gives a command the convention's keys again.
    void reset(Shortcut command);
    /// Reason why these keys cannot be chosen: "W flies"; empty = they can.
    static std::string why_not(const Chord& chord);

private:
    KeyPreset preset_;
    std::array<Chord, ShortcutCount> chords_{};
    std::array<bool, ShortcutCount> chosen_{};  // by the artist, though a convention may have the same
};

/// The line of KeyTable of a command.
const KeyHelp& help_of(Shortcut command);

}  // namespace gse::ui
