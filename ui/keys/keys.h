// Key numbers as GLFW reports them, and the table of all keys. Printable keys are their US-layout ASCII. Keys
// of commands can be chosen (keymap.h); others are fixed.
#pragma once

#include <array>
#include <cstddef>

namespace gse::ui {

namespace key {
inline constexpr int Space = 32, LeftBracket = 91, RightBracket = 93, Grave = 96, Escape = 256, Enter = 257,
                     Tab = 258, Backspace = 259, Delete = 261, Right = 262, Left = 263, Down = 264, Up = 265,
                     Home = 268, End = 269, F1 = 290, F5 = 294, F6 = 295, F11 = 300, F12 = 301,
                     KeypadEnter = 335;
}  // namespace key

/// Commands that keys can be chosen for (keymap.h).
enum class Shortcut {
    Frame,
    Home,
    Brush,
    Rectangle,
    Lasso,
    CutOut,
    FrontOnly,
    Invert,
    Clear,
    Hide,
    Isolate,
    ShowHidden,
    Delete,
    Heal,
    Place,
    HealBrush,
    Evidence,
    Tint,
    Wipe,
    Panels,
    Fullscreen,
    Prompt,
    Locate,
    Undo,
    Redo,
    Open,
    Save,
    SaveAs,
    Export,
    Screenshot,
    Turntable,
    Quit
};
inline constexpr std::size_t ShortcutCount = 32;
inline constexpr Shortcut NoShortcut = static_cast<Shortcut>(-1);

/// One line of the list of keys.
struct KeyHelp {
    const char* group;
    const char* keys;  // of a command: those that it has by default
    const char* what;
    Shortcut command = NoShortcut;  // those without one are fixed
    const char* name = nullptr;     // of the command, in the settings
};

/// All keys. Shortcuts and camera must agree with it.
inline constexpr std::array<KeyHelp, 56> KeyTable{{
    {"Camera", "Left drag (no tool), middle drag", "Orbit"},
    {"Camera", "Shift + middle drag, right drag", "Pan"},
    {"Camera", "Wheel", "Zoom to the cursor"},
    {"Camera", "Double click", "Turn around what is under the cursor"},
    {"Camera", "W A S D, E up, Q down", "Fly (Shift fast, Alt slow)"},
    {"Camera", "F", "Frame what is labelled, else the scene", Shortcut::Frame, "frame"},
    {"Camera", "Home", "Home: what is labelled, else what stands on the ground", Shortcut::Home, "home"},
    {"Camera", "Left, Right (nothing has the focus)", "Previous, next view"},
    {"Labels", "B", "Brush", Shortcut::Brush, "brush"},
    {"Labels", "R", "Rectangle", Shortcut::Rectangle, "rectangle"},
    {"Labels", "L", "Lasso", Shortcut::Lasso, "lasso"},
    {"Labels", "C", "Cut out the thing under a click or in a box", Shortcut::CutOut, "cut_out"},
    {"Labels", "J", "Heal brush: paint over a hole or a blemish", Shortcut::HealBrush, "heal_brush"},
    {"Labels", "G", "Handles that move, turn and resize what is labelled", Shortcut::Place, "place"},
    {"Labels", "Shift", "Add"},
    {"Labels", "Ctrl", "Remove"},
    {"Labels", "Alt, Shift + Ctrl", "Intersect"},
    {"Labels", "[ ], Alt + wheel", "Brush size"},
    {"Labels", "N", "Front only, or all the way through", Shortcut::FrontOnly, "front_only"},
    {"Labels", "Ctrl + I", "Invert the label", Shortcut::Invert, "invert"},
    {"Labels", "Ctrl + D", "Clear the label", Shortcut::Clear, "clear"},
    {"Labels", "Ctrl + click on a view of the search", "Leave it out of the vote, or put it back"},
    {"Labels", "H", "Hide what is labelled; the scene keeps it", Shortcut::Hide, "hide"},
    {"Labels", "I", "Isolate what is labelled: hide all else", Shortcut::Isolate, "isolate"},
    {"Labels", "Shift + H", "Show what is hidden", Shortcut::ShowHidden, "show_hidden"},
    {"Labels", "Delete", "Delete the labelled splats", Shortcut::Delete, "delete"},
    {"Labels", "Ctrl + Delete", "Delete them and heal the hole", Shortcut::Heal, "heal"},
    {"Show", "M", "Chosen view of the search: its attention, its mask, nothing", Shortcut::Evidence,
     "evidence"},
    {"Show", "T", "Tint of what is labelled on, off", Shortcut::Tint, "tint"},
    {"Show", "V", "Wipe between before and after", Shortcut::Wipe, "wipe"},
    {"Show", "hold `", "Flip to the original"},
    {"Show", "Ctrl + Space", "Hide the panels", Shortcut::Panels, "panels"},
    {"Show", "F11", "Full screen", Shortcut::Fullscreen, "fullscreen"},
    {"Show", "Ctrl + +, Ctrl + -, Ctrl + 0", "Size of the interface"},
    {"Show", "F1", "The guide"},
    {"Show", "Shift + F1", "This list"},
    {"Keyboard", "Tab, Shift + Tab", "Next, previous control"},
    {"Keyboard", "Arrows", "The control on that side; through a menu or a list"},
    {"Keyboard", "Space, Enter", "Press what has the focus; change a slider"},
    {"Keyboard", "F6, Shift + F6", "Next, previous panel"},
    {"Keyboard", "Alt", "Open the menus"},
    {"Work", "P", "Type in the prompt", Shortcut::Prompt, "prompt"},
    {"Work", "Shift + Enter, Ctrl + Enter", "Edit"},
    {"Work", "Ctrl + L", "Locate", Shortcut::Locate, "locate"},
    {"Work", "Esc", "Leave the control, the tool; cancel the job (asks after 30 s of work)"},
    {"Work", "Ctrl + Z", "Undo", Shortcut::Undo, "undo"},
    {"Work", "Ctrl + Shift + Z", "Redo (Ctrl + Y, too, where that is free)", Shortcut::Redo, "redo"},
    {"Files", "Ctrl + O", "Open", Shortcut::Open, "open"},
    {"Files", "Ctrl + S", "Save the project", Shortcut::Save, "save"},
    {"Files", "Ctrl + Shift + S", "Save the project as", Shortcut::SaveAs, "save_as"},
    {"Files", "Ctrl + E", "Export the scene", Shortcut::Export, "export"},
    {"Files", "F12", "Screenshot", Shortcut::Screenshot, "screenshot"},
    {"Files", "Shift + F12", "Turntable", Shortcut::Turntable, "turntable"},
    {"Files", "Ctrl + Q", "Quit", Shortcut::Quit, "quit"},
    {"Numbers", "Ctrl + click on a slider", "Type the number"},
    {"Numbers", "Right click on a setting", "Back to its default"},
}};

}  // namespace gse::ui
