// Every key and character arrives, in an order that a frame can tell apart.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <string>

#include "engine/window/input_queue.h"

namespace input_queue_test {

namespace {

using gse::window::InputQueue;

constexpr int Tab = 258, Backspace = 259, ControlKey = 341, Control = 2;

void press(InputQueue& queue, int key, int modifiers = 0) { queue.push({false, key, 0, 1, modifiers, 0}); }
void release(InputQueue& queue, int key, int modifiers = 0) { queue.push({false, key, 0, 0, modifiers, 0}); }
void tap(InputQueue& queue, int key, int modifiers = 0) {
    press(queue, key, modifiers);
    release(queue, key, modifiers);
}
/// As a keyboard does it: the key, its character, the key up.
void type(InputQueue& queue, const std::string& text) {
    for (const char letter : text) {
        const int key = letter >= 'a' ? letter - 'a' + 'A' : letter;
        press(queue, key);
        queue.push({true, 0, 0, 0, 0, static_cast<unsigned>(letter)});
        release(queue, key);
    }
}

/// A field that has what was typed while it had the focus; Tab takes two frames to give it.
struct Reader {
    std::string left, right;
    bool in_right = false;
    int arrives = -1;

    void frame(InputQueue& queue) {
        if (arrives >= 0 && --arrives < 0) in_right = true;
        std::string typed;
        bool tabbed = false, deleted = false;
        int presses = 0;
        for (const auto& event : queue.next_frame()) {
            if (event.character) typed += static_cast<char>(event.codepoint);
            else if (event.action == 1) ++presses;
            tabbed |= !event.character && event.action == 1 && event.key == Tab;
            deleted |= !event.character && event.action == 1 && event.key == Backspace;
        }
        auto& field = in_right ? right : left;
        if (arrives < 0 && !tabbed) field += typed;  // else nobody has the focus
        if (deleted && arrives < 0 && !field.empty()) field.pop_back();
        if (tabbed) arrives = 1;
    }
};

Reader read_all(InputQueue& queue) {
    Reader reader;
    for (int frame = 0; frame < 500 && (queue.waiting() || frame < 5); ++frame) reader.frame(queue);
    DOCTEST_CHECK_FALSE(queue.waiting());
    return reader;
}

}  // namespace

DOCTEST_TEST_CASE("what is typed in one go arrives whole, doubled letters and corrections too") {
    InputQueue queue;
    type(queue, "grass");
    tap(queue, Backspace);
    tap(queue, Backspace);
    type(queue, "nd");
    DOCTEST_CHECK(read_all(queue).left == "grand");
}

DOCTEST_TEST_CASE("letters typed into a field all come with one frame, commands among them with their own") {
    constexpr bool Typing = true;
    constexpr int ShiftKey = 340, Shift = 1;
    InputQueue queue;
    const auto typed_in = [&] {
        std::string typed;
        for (const auto& event : queue.next_frame(Typing))
            if (event.character) typed += static_cast<char>(event.codepoint);
        return typed;
    };
    type(queue, "a bear wearing glass");
    DOCTEST_CHECK(typed_in() == "a bear wearing glass");
    DOCTEST_CHECK_FALSE(queue.waiting());

    press(queue, ShiftKey);
    press(queue, 'A', Shift);
    queue.push({true, 0, 0, 0, 0, 'A'});
    release(queue, 'A', Shift);
    release(queue, ShiftKey);
    type(queue, "b");
    tap(queue, Backspace);
    type(queue, "c");
    press(queue, ControlKey);
    tap(queue, 'A', Control);
    release(queue, ControlKey);
    type(queue, "d");
    std::string all;
    int frames = 0;
    bool control_down = false;
    for (; queue.waiting(); ++frames) {
        DOCTEST_REQUIRE(frames < 20);
        int backspaces = 0, selects = 0;
        for (const auto& event : queue.next_frame(Typing)) {
            if (event.character) all += static_cast<char>(event.codepoint);
            if (event.key == ControlKey) control_down = event.action == 1;
            if (event.key == Backspace) ++backspaces;
            if (event.key == 'A' && (event.modifiers & Control) != 0) {
                ++selects;
                if (event.action == 1) DOCTEST_CHECK(control_down);
            }
        }
        DOCTEST_CHECK(backspaces <= 1);  // down in one frame, up in the next
        DOCTEST_CHECK(selects <= 1);
    }
    DOCTEST_CHECK(all == "Abcd");
}

DOCTEST_TEST_CASE("characters after Tab go to the field that Tab moves to") {
    InputQueue queue;
    type(queue, "bear");
    tap(queue, Tab);
    type(queue, "a blue bear");
    const auto reader = read_all(queue);
    DOCTEST_CHECK(reader.left == "bear");
    DOCTEST_CHECK(reader.right == "a blue bear");
}

DOCTEST_TEST_CASE("a key that goes down and up between two frames is seen down by one and up by the next") {
    InputQueue queue;
    tap(queue, Backspace);
    tap(queue, Backspace);
    for (int i = 0; i < 2; ++i) {
        const auto down = queue.next_frame(), up = queue.next_frame();
        DOCTEST_REQUIRE(down.size() == 1);
        DOCTEST_CHECK(down[0].action == 1);
        DOCTEST_REQUIRE(up.size() == 1);
        DOCTEST_CHECK(up[0].action == 0);
    }
}

DOCTEST_TEST_CASE("a command is seen with its modifier down, and text after it comes later") {
    InputQueue queue;
    press(queue, ControlKey);
    tap(queue, 'A', Control);
    release(queue, ControlKey);
    type(queue, "x");
    const auto first = queue.next_frame();
    DOCTEST_REQUIRE(first.size() == 2);  // down both: the modifier goes up with the next frame
    DOCTEST_CHECK(first[0].key == ControlKey);
    DOCTEST_CHECK(first[1].key == 'A');
    bool typed = false;
    for (int frame = 0; frame < 5; ++frame)
        for (const auto& event : queue.next_frame()) typed |= event.character;
    DOCTEST_CHECK(typed);
    DOCTEST_CHECK_FALSE(queue.waiting());
}

DOCTEST_TEST_CASE("a modifier that goes up before its key is seen down with it all the same") {
    InputQueue queue;
    press(queue, ControlKey);
    press(queue, Tab, Control);
    release(queue, ControlKey);
    release(queue, Tab);
    bool held = false;
    for (int frame = 0; frame < 4; ++frame)
        for (const auto& event : queue.next_frame()) {
            if (event.key == ControlKey) held = event.action == 1;
            if (event.key == Tab && event.action == 1) DOCTEST_CHECK(held);
            if (event.key == ControlKey && event.action == 0) DOCTEST_CHECK(frame > 0);
        }
    DOCTEST_CHECK_FALSE(queue.waiting());
}

DOCTEST_TEST_CASE("keys that are held together are seen together") {
    InputQueue queue;
    press(queue, 'W');
    press(queue, 'D');
    DOCTEST_CHECK(queue.next_frame().size() == 2);
    release(queue, 'W');
    release(queue, 'D');
    DOCTEST_CHECK(queue.next_frame().size() == 2);
}

DOCTEST_TEST_CASE(
    "a click comes after what was typed before it, where it was made, and before what follows") {
    InputQueue queue;
    type(queue, "ab");
    queue.push({false, 0, 0, 1, 0, 0, 0, 10, 20});
    queue.push({false, 0, 0, 0, 0, 0, 0, 10, 20});
    type(queue, "c");
    std::string typed, order;
    int press_frame = -1, release_frame = -1, letter_frame = -1;
    for (int frame = 0; queue.waiting(); ++frame) {
        DOCTEST_REQUIRE(frame < 50);
        for (const auto& event : queue.next_frame()) {
            if (event.character) order += static_cast<char>(event.codepoint);
            if (event.character && event.codepoint == 'c') letter_frame = frame;
            if (event.button < 0) continue;
            order += event.action == 1 ? '[' : ']';
            DOCTEST_CHECK(event.x == 10);
            DOCTEST_CHECK(event.y == 20);
            (event.action == 1 ? press_frame : release_frame) = frame;
        }
    }
    DOCTEST_CHECK(order == "ab[]c");
    DOCTEST_CHECK(release_frame > press_frame);
    DOCTEST_CHECK(letter_frame >= release_frame + 2);  // the focus has moved by then
    DOCTEST_CHECK_FALSE(queue.click_waits());
}

}  // namespace input_queue_test
