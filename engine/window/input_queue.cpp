// Splits input into portions that one frame can tell apart.
#include "engine/window/input_queue.h"

#include <algorithm>

namespace gse::window {
namespace {

constexpr int Release = 0, Press = 1;
constexpr int FirstPrintable = 32, LastPrintable = 162;  // keys that write something
constexpr int Tab = 258, F6 = 295;                       // keys that move the focus to another field
constexpr int FirstModifier = 340, LastModifier = 347;
constexpr int Commanding = 2 | 4 | 8;     // Control, Alt, Super: with them a letter writes nothing
constexpr std::uint64_t FocusFrames = 3;  // until the field that Tab moves to takes characters
constexpr std::uint64_t ClickFrames = 2;  // until the field, or what a button opens, does after a click

bool is_modifier(int key) { return key >= FirstModifier && key <= LastModifier; }

/// Key that writes its character and commands nothing.
bool writes(const InputQueue::Event& event) {
    return event.key >= FirstPrintable && event.key <= LastPrintable && (event.modifiers & Commanding) == 0;
}

/// Key with an effect of its own, other than its character.
bool acts(const InputQueue::Event& event) {
    if (event.character || event.button >= 0 || event.action != Press || is_modifier(event.key)) return false;
    return !writes(event);
}

}  // namespace

bool InputQueue::fits(const Event& event) const {
    if (event.button >= 0) return !clicked_ && !pressed_ && !other_pressed_ && !typed_;
    if (clicked_) return false;
    if (event.character) return !pressed_ && frame_ >= free_from_;
    if (event.action != Press && event.action != Release) return true;  // a repetition; ImGui makes its own
    if (std::find(changed_.begin(), changed_.end(), event.key) != changed_.end()) return false;
    if (is_modifier(event.key)) return !other_pressed_;  // or the key would be seen with another modifier
    if (!acts(event)) return true;
    return !pressed_ && !typed_ && frame_ >= free_from_;
}

void InputQueue::note(const Event& event) {
    if (event.button >= 0) {
        clicked_ = true;
        free_from_ = frame_ + ClickFrames;
        return;
    }
    if (event.character) {
        typed_ = true;
        return;
    }
    if (typing_ && writes(event)) return;
    if (event.action == Press || event.action == Release) changed_.push_back(event.key);
    other_pressed_ |= event.action == Press && !is_modifier(event.key);
    if (!acts(event)) return;
    pressed_ = true;
    if (event.key == Tab || event.key == F6) free_from_ = frame_ + FocusFrames;
}

bool InputQueue::click_waits() const {
    return std::any_of(waiting_.begin(), waiting_.end(),
                       [](const Event& event) { return event.button >= 0; });
}

std::vector<InputQueue::Event> InputQueue::next_frame(bool typing) {
    ++frame_;
    typing_ = typing;
    changed_.clear();
    pressed_ = other_pressed_ = typed_ = clicked_ = false;
    std::vector<Event> events;
    while (!waiting_.empty() && fits(waiting_.front())) {
        note(waiting_.front());
        events.push_back(waiting_.front());
        waiting_.pop_front();
    }
    return events;
}

}  // namespace gse::window
