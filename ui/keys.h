// Key numbers as GLFW reports them (printable keys are their US-layout ASCII), and the fixed table of
// shortcuts for Help.
#pragma once

#include <array>

namespace gse::ui {

namespace key {
inline constexpr int Space = 32, LeftBracket = 91, RightBracket = 93, Grave = 96, Escape = 256, Enter = 257,
                     Tab = 258, Backspace = 259, Delete = 261, Right = 262, Left = 263, Down = 264, Up = 265,
                     Home = 268, End = 269, F1 = 290, F5 = 294, F6 = 295, F11 = 300, F12 = 301, KeypadEnter = 335;
}  // namespace key

/// One line of the list of keys.
struct KeyHelp {
    const char* group;
    const char* keys;
    const char* what;
};

/// The fixed set; what the shortcuts and the camera do must agree with it.
inline constexpr std::array<KeyHelp, 52> KeyTable{{
    {"Camera", "Left drag (no tool), middle drag", "Orbit"},
    {"Camera", "Shift + middle drag, right drag", "Pan"},
    {"Camera", "Wheel", "Zoom to the cursor"},
    {"Camera", "Double click", "Turn around what is under the cursor"},
    {"Camera", "W A S D, E up, Q down", "Fly (Shift fast, Alt slow)"},
    {"Camera", "F", "Frame what is labelled, else the scene"},
    {"Camera", "Home", "Home"},
    {"Camera", "Left, Right (nothing has the focus)", "Previous, next view"},
    {"Labels", "B", "Brush"},
    {"Labels", "R", "Rectangle"},
    {"Labels", "L", "Lasso"},
    {"Labels", "C", "Cut out the thing in a box"},
    {"Labels", "Shift", "Add"},
    {"Labels", "Ctrl", "Remove"},
    {"Labels", "Alt, Shift + Ctrl", "Intersect"},
    {"Labels", "[ ], Alt + wheel", "Brush size"},
    {"Labels", "N", "Front only, or all the way through"},
    {"Labels", "Ctrl + I", "Invert the label"},
    {"Labels", "Ctrl + D", "Clear the label"},
    {"Labels", "Ctrl + click on a view of the search", "Leave it out of the vote, or put it back"},
    {"Labels", "H", "Hide what is labelled; the scene keeps it"},
    {"Labels", "I", "Isolate what is labelled: hide all else"},
    {"Labels", "Shift + H", "Show what is hidden"},
    {"Labels", "Delete", "Delete the labelled splats"},
    {"Show", "M", "Chosen view of the search: its attention, its mask, nothing"},
    {"Show", "T", "Tint of what is labelled on, off"},
    {"Show", "V", "Wipe between before and after"},
    {"Show", "hold `", "Flip to the original"},
    {"Show", "Ctrl + Space", "Hide the panels"},
    {"Show", "F11", "Full screen"},
    {"Show", "Ctrl + +, Ctrl + -, Ctrl + 0", "Size of the interface"},
    {"Show", "F1", "This list"},
    {"Keyboard", "Tab, Shift + Tab", "Next, previous control"},
    {"Keyboard", "Arrows", "The control on that side; through a menu or a list"},
    {"Keyboard", "Space, Enter", "Press what has the focus; change a slider"},
    {"Keyboard", "F6, Shift + F6", "Next, previous panel"},
    {"Keyboard", "Alt", "Open the menus"},
    {"Work", "P", "Type in the prompt"},
    {"Work", "Shift + Enter, Ctrl + Enter", "Edit"},
    {"Work", "Ctrl + L", "Locate"},
    {"Work", "Esc", "Leave the control, the tool; cancel the job (asks after 30 s of work)"},
    {"Work", "Ctrl + Z", "Undo"},
    {"Work", "Ctrl + Shift + Z, Ctrl + Y", "Redo"},
    {"Files", "Ctrl + O", "Open"},
    {"Files", "Ctrl + S", "Save the project"},
    {"Files", "Ctrl + Shift + S", "Save the project as"},
    {"Files", "Ctrl + E", "Export the scene"},
    {"Files", "F12", "Screenshot"},
    {"Files", "Shift + F12", "Turntable"},
    {"Files", "Ctrl + Q", "Quit"},
    {"Numbers", "Ctrl + click on a slider", "Type the number"},
    {"Numbers", "Right click on a setting", "Back to its default"},
}};

}  // namespace gse::ui
