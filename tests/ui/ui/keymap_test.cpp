// Keys as text, conventions, and what cannot be chosen.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <set>
#include <string>

#include "ui/keys/keymap.h"

namespace gse::test::keymap_test {

using namespace ui;

DOCTEST_TEST_CASE("every convention gives every command keys of its own that can be chosen") {
    for (const auto preset : {KeyPreset::Splat, KeyPreset::Blender, KeyPreset::Maya}) {
        const Keymap map(preset);
        std::set<std::string> seen;
        std::size_t commands = 0;
        for (const auto& line : KeyTable) {
            if (line.command == NoShortcut) continue;
            ++commands;
            DOCTEST_REQUIRE(line.name != nullptr);
            const std::string keys = chord_text(map.of(line.command));
            DOCTEST_CHECK_MESSAGE(!keys.empty(), line.name);
            DOCTEST_CHECK_MESSAGE(seen.insert(keys).second, keys);
            DOCTEST_CHECK_MESSAGE(Keymap::why_not(map.of(line.command)).empty(),
                                  Keymap::why_not(map.of(line.command)));
            DOCTEST_CHECK(parse_chord(keys) == map.of(line.command));
            DOCTEST_CHECK(map.user_of(map.of(line.command)) == line.command);
            if (preset == KeyPreset::Splat) DOCTEST_CHECK(keys == line.keys);  // what the table says
        }
        DOCTEST_CHECK(commands == ShortcutCount);
    }
}

DOCTEST_TEST_CASE("a chosen key is taken from the command that had it, and comes back from text") {
    Keymap map(KeyPreset::Blender);
    DOCTEST_CHECK(map.bind(Shortcut::Lasso, *parse_chord("Ctrl + Shift + K")) == std::nullopt);
    DOCTEST_CHECK(map.bind(Shortcut::Wipe, *parse_chord("B")) == Shortcut::Rectangle);
    DOCTEST_CHECK(map.of(Shortcut::Rectangle) == Chord{});
    const Keymap again = Keymap::parse(map.text());
    DOCTEST_CHECK(again.preset() == KeyPreset::Blender);
    for (const auto& line : KeyTable)
        if (line.command != NoShortcut) DOCTEST_CHECK(again.of(line.command) == map.of(line.command));
}

DOCTEST_TEST_CASE("keys that were chosen survive a change of the convention, there and back") {
    Keymap map(KeyPreset::Splat);
    map.bind(Shortcut::Lasso, *parse_chord("J"));
    map.bind(Shortcut::CutOut, *parse_chord("K"));  // as Blender has it anyway
    map.bind(Shortcut::Wipe, *parse_chord("B"));    // Blender's box
    const Keymap blender = Keymap::parse(map.in(KeyPreset::Blender).text());
    DOCTEST_CHECK(blender.preset() == KeyPreset::Blender);
    DOCTEST_CHECK(chord_text(blender.of(Shortcut::Lasso)) == "J");
    DOCTEST_CHECK(chord_text(blender.of(Shortcut::Wipe)) == "B");
    DOCTEST_CHECK(chord_text(blender.of(Shortcut::Brush)) == "C");  // not chosen: the convention's
    DOCTEST_CHECK(blender.of(Shortcut::Rectangle) == Chord{});      // its key was chosen for another
    Keymap back = Keymap::parse(blender.in(KeyPreset::Splat).text());
    for (const auto command : {Shortcut::Lasso, Shortcut::CutOut, Shortcut::Wipe})
        DOCTEST_CHECK(back.of(command) == map.of(command));
    DOCTEST_CHECK(back.of(Shortcut::Rectangle) == Keymap().of(Shortcut::Rectangle));
    back.reset(Shortcut::Lasso);
    DOCTEST_CHECK(chord_text(back.in(KeyPreset::Blender).of(Shortcut::Lasso)) == "L");
}

DOCTEST_TEST_CASE("text that is no keymap changes nothing; keys with a fixed meaning are refused by name") {
    for (const char* text :
         {"", "{", "[]", "{\"preset\":7}",
          "{\"keys\":{\"brush\":\"Hyper + 9\",\"lasso\":\"W\",\"wipe\":3,\"what\":\"B\"}}"})
        DOCTEST_CHECK(Keymap::parse(text).text() == Keymap().text());
    for (const char* keys : {"W", "Shift + E", "Ctrl + -", "Esc", "Tab", "Left", "[", "F1", "`", "Space"}) {
        DOCTEST_REQUIRE(parse_chord(keys));
        DOCTEST_CHECK_MESSAGE(!Keymap::why_not(*parse_chord(keys)).empty(), keys);
    }
    DOCTEST_CHECK(Keymap::why_not(*parse_chord("Ctrl + W")).empty());
    DOCTEST_CHECK_FALSE(parse_chord("Ctrl + "));
    DOCTEST_CHECK(chord_text({}) == "");
}

}  // namespace gse::test::keymap_test
