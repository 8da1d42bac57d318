// Keys, characters and mouse buttons in the order in which they came, handed on frame by frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

namespace gse::window {

/// Queue of input, handed on in portions that one frame can tell apart. ImGui 1.86 sees the keys that are
/// down and the characters since the last frame, not their order. In a slow frame a key may go down and up
/// unseen. Characters typed after Tab would go to the field that was left, those typed before a click to
/// nobody.
class InputQueue {
public:
    /// Numbers of GLFW.
    struct Event {
        bool character = false;
        int key = 0, code = 0, action = 0, modifiers = 0;  // of a key
        unsigned codepoint = 0;                            // of a character
        int button = -1;                                   // of the mouse, with `action`; -1 = none
        float x = 0, y = 0;                                // of the cursor then, in window coordinates
    };

    void push(const Event& event) { waiting_.push_back(event); }
    bool waiting() const { return !waiting_.empty(); }
    /// True while a button's press or release waits: the cursor is still where the last one was.
    bool click_waits() const;
    /// Input of the frame that begins, in its order. `typing`: a text field has the focus. A frame then takes
    /// all letters that wait, as their keys mean nothing but their characters.
    std::vector<Event> next_frame(bool typing = false);

private:
    bool fits(const Event& event) const;
    void note(const Event& event);

    std::deque<Event> waiting_;
    std::uint64_t frame_ = 0,
                  free_from_ = 0;  // presses and characters wait for that frame: the focus is still moving
    std::vector<int> changed_;     // keys that went down or up in this frame
    bool clicked_ = false;         // a button went down or up in this frame
    bool typing_ = false;          // a text field has the focus in this frame
    bool pressed_ = false, other_pressed_ = false,
         typed_ = false;  // in this frame: a key that does something, any but a
                          // modifier, a character
};

}  // namespace gse::window
