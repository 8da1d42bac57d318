// Use of the window without a mouse: the focus, and the keys that move it. Tab goes through all controls in
// the order they are drawn, arrows to the nearest one (ImGui's own navigation). Space and Enter press; Alt
// opens the menus.
#pragma once

#include <imgui.h>

#include <string>
#include <string_view>
#include <vector>

struct ImGuiWindow;

namespace gse::ui {

struct Context;

/// A control that Tab stops at, as it was drawn in the last frame.
struct FocusStop {
    std::string_view name;  // in the widget map
    ImGuiID id = 0;
    ImGuiWindow* window = nullptr;
    ImVec2 low, high;
    bool inputable = false;  // a slider or a field: Enter is its own
    bool typed = false;      // a field of text: it takes letters as soon as it has the focus
};

struct KeyboardState {
    std::vector<FocusStop> stops;
    bool on = false;            // the focus is shown and the arrows move it
    bool popup_before = false;  // a popup was open when the last frame ended
    bool alt_alone = false;     // Alt is down and nothing else happened since
    int menu_walk = 0;          // frames in which a menu that gets the focus opens
    bool escape_taken = false;  // by leaving the focus, in this frame
    std::string asked;          // widget that takes the keyboard next frame
    std::string menu_asked;     // to be opened with the next menu bar; empty = none
};

/// Reads the keys that move the focus. Call it before anything is drawn, with the stops of the frame before.
void begin_keyboard(Context& context);
/// Says whether ImGui's navigation works in the next frame.
void end_keyboard(Context& context);

/// Adds the last item to the stops and shows its focus; note() calls it.
void note_stop(Context& context, std::string_view name);
/// The last item takes letters: Tab begins typing in it.
void takes_letters(Context& context);
/// Gives the last item the focus.
void focus_last_item(Context& context);

/// True when a key went down in this frame.
bool pressed(int index, bool repeats = false);
/// True when the last item has the focus and shows it.
bool has_focus();
/// True when a control of the last frame, by its name, has the focus.
bool has_focus(const FocusStop& stop);
bool has_focus(const Context& context, std::string_view name);
/// Opens the last item, a closed menu of the bar, when Alt asked for it or arrows came from another one.
void open_menu_by_key(Context& context, const char* menu);
/// Arrow pressed while the last item has the focus: -1, 1 or 0. The focus stays.
int focus_step_sideways();
/// Keeps the arrows of this frame from moving the focus.
void keep_focus();

}  // namespace gse::ui
