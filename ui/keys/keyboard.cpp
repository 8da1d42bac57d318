// Moving the focus: Tab over the noted controls, F6 over the areas, Alt into the menus.
#include "ui/keys/keyboard.h"

#include <imgui_internal.h>

#include <algorithm>

#include "ui/keys/keys.h"
#include "ui/model/context.h"

namespace gse::ui {
namespace {

constexpr std::string_view FirstStop = "prompt.source";

bool focus_shown() {
    const ImGuiContext& g = *ImGui::GetCurrentContext();
    return g.NavId != 0 && !g.NavDisableHighlight;
}

/// Window that keeps the keyboard to itself: an open dialog or list; null = none.
const ImGuiWindow* keeper() {
    const ImGuiContext& g = *ImGui::GetCurrentContext();
    for (int at = g.OpenPopupStack.Size; at-- > 0;)
        if (g.OpenPopupStack[at].Window != nullptr) return g.OpenPopupStack[at].Window->RootWindow;
    return nullptr;
}

/// Panel, tool bar, viewport...: what lies directly in the host window, or the window itself.
const ImGuiWindow* area_of(const ImGuiWindow* window) {
    while (window->ParentWindow != nullptr && window->ParentWindow->ParentWindow != nullptr)
        window = window->ParentWindow;
    return window;
}

int index_of(const std::vector<FocusStop>& stops, ImGuiID id) {
    const auto found =
        std::find_if(stops.begin(), stops.end(), [id](const FocusStop& stop) { return stop.id == id; });
    return found == stops.end() ? -1 : static_cast<int>(found - stops.begin());
}

void focus(Context& context, const FocusStop& stop) {
    ImGuiContext& g = *ImGui::GetCurrentContext();
    ImGui::ClearActiveID();
    if (g.NavWindow != stop.window) ImGui::FocusWindow(stop.window);
    const ImRect rect(stop.low, stop.high);
    ImGui::SetNavID(stop.id, ImGuiNavLayer_Main, 0, ImGui::WindowRectAbsToRel(stop.window, rect));
    ImGui::ScrollToRect(stop.window, rect,
                        ImGuiScrollFlags_KeepVisibleEdgeX | ImGuiScrollFlags_KeepVisibleEdgeY);
    // Request of a window that has just come up: its first control is not the one that is meant.
    g.NavInitRequest = false;
    g.NavInitResultId = 0;
    g.NavDisableHighlight = false;
    g.NavDisableMouseHover = true;
    if (stop.typed) {
        g.NavNextActivateId = stop.id;
        g.NavNextActivateFlags = ImGuiActivateFlags_PreferInput | ImGuiActivateFlags_TryToPreserveState;
    }
    context.keyboard.on = true;
}

/// Control `step` stops further among those that `wanted` accepts, around the end. Nothing when there is
/// none.
template <class Wanted> void move_focus(Context& context, int from, int step, Wanted&& wanted) {
    const auto& stops = context.keyboard.stops;
    const int count = static_cast<int>(stops.size());
    for (int tried = 1; tried <= count; ++tried) {
        const int at = ((from + step * tried) % count + count) % count;
        if (!wanted(stops[static_cast<std::size_t>(at)])) continue;
        return focus(context, stops[static_cast<std::size_t>(at)]);
    }
}

/// Start of Tab: the control that has the focus or was used last, else just before the prompt.
int start_of(const Context& context, int step) {
    const auto& stops = context.keyboard.stops;
    const ImGuiContext& g = *ImGui::GetCurrentContext();
    const bool used = focus_shown() || g.ActiveId != 0;
    const int here = used ? index_of(stops, g.NavId) : -1;
    if (here >= 0) return here;
    for (std::size_t at = 0; at < stops.size(); ++at)
        if (stops[at].name == FirstStop) return static_cast<int>(at) - (step > 0 ? 1 : 0);
    return step > 0 ? -1 : 0;
}

void tab(Context& context) {
    ImGui::NavMoveRequestCancel();  // ImGui's own only knows the fields of one panel
    const int step = ImGui::GetIO().KeyShift ? -1 : 1;
    const ImGuiWindow* only = keeper();
    move_focus(context, start_of(context, step), step,
               [&](const FocusStop& stop) { return only == nullptr || stop.window->RootWindow == only; });
}

void next_area(Context& context) {
    const auto& stops = context.keyboard.stops;
    if (stops.empty() || keeper() != nullptr) return;
    const int from = start_of(context, 1), step = ImGui::GetIO().KeyShift ? -1 : 1;
    const ImGuiWindow* here =
        from >= 0 && focus_shown() ? area_of(stops[static_cast<std::size_t>(from)].window) : nullptr;
    move_focus(context, from, step, [&](const FocusStop& stop) { return area_of(stop.window) != here; });
}

/// Notes that Alt was pressed and let go with nothing else between.
void watch_alt(Context& context) {
    auto& keyboard = context.keyboard;
    const auto& io = ImGui::GetIO();
    ImGuiContext& g = *ImGui::GetCurrentContext();
    g.NavWindowingToggleLayer = false;  // ImGui would toggle on Alt + wheel and Alt + drag too
    const bool was_down = (io.KeyModsPrev & ImGuiKeyModFlags_Alt) != 0;
    if (io.KeyAlt && !was_down) keyboard.alt_alone = true;
    constexpr int LeftAlt = 342, RightAlt = 346;
    bool other = io.KeyCtrl || io.KeyShift || io.KeySuper || io.MouseWheel != 0 || ImGui::IsAnyMouseDown() ||
                 io.InputQueueCharacters.Size > 0;
    if (keyboard.alt_alone)
        for (int index = 0; index < IM_ARRAYSIZE(io.KeysDown); ++index)
            other |= io.KeysDown[index] && index != LeftAlt && index != RightAlt;
    if (other) keyboard.alt_alone = false;
    if (io.KeyAlt || !was_down || !keyboard.alt_alone) return;
    keyboard.alt_alone = false;
    if (ImGui::GetTopMostPopupModal() != nullptr) return;
    if (keeper() != nullptr) {
        ImGui::ClosePopupToLevel(0, true);
    } else {
        ImGui::ClearActiveID();
        g.NavDisableHighlight = false;
        g.NavDisableMouseHover = true;
        keyboard.menu_asked = "File";
        keyboard.on = true;
    }
}

/// Enter presses what has the focus, as Space does; with Ctrl or Shift both mean something else.
void press_focused(Context& context) {
    ImGuiContext& g = *ImGui::GetCurrentContext();
    const auto& io = ImGui::GetIO();
    const bool held =
        ImGui::IsKeyDown(key::Space) || ImGui::IsKeyDown(key::Enter) || ImGui::IsKeyDown(key::KeypadEnter);
    if (io.KeyCtrl || io.KeyShift || io.KeyAlt) {
        if (held) g.NavActivateId = g.NavActivateDownId = g.NavActivatePressedId = g.NavActivateInputId = 0;
        return;
    }
    const bool enter = pressed(key::Enter) || pressed(key::KeypadEnter);
    if (!enter || !focus_shown() || g.ActiveId != 0) return;
    const int at = index_of(context.keyboard.stops, g.NavId);
    if (at >= 0 && context.keyboard.stops[static_cast<std::size_t>(at)].inputable) return;
    g.NavActivateId = g.NavActivateDownId = g.NavActivatePressedId = g.NavId;
    g.NavActivateInputId = 0;
    g.NavActivateFlags = ImGuiActivateFlags_None;
}

/// Left and Right in a menu lead to its neighbour in the bar, which ImGui leaves closed.
void walk_menus(Context& context) {
    auto& keyboard = context.keyboard;
    const ImGuiContext& g = *ImGui::GetCurrentContext();
    constexpr int Frames = 6;  // until ImGui has moved
    const ImGuiWindow* top = g.OpenPopupStack.Size > 0 ? g.OpenPopupStack.back().Window : nullptr;
    const bool in_menu = top != nullptr && (top->Flags & ImGuiWindowFlags_ChildMenu) != 0;
    if (in_menu && (pressed(key::Left) || pressed(key::Right))) keyboard.menu_walk = Frames;
    else if (keyboard.menu_walk > 0) --keyboard.menu_walk;
    if (pressed(key::Escape)) keyboard.menu_walk = 0;
}

/// Esc closes a menu or list that the mouse opened, which ImGui leaves open without the focus of keys.
/// Dialogs read Esc themselves.
void close_by_escape(const Context& context) {
    const ImGuiContext& g = *ImGui::GetCurrentContext();
    if (context.keyboard.on || !pressed(key::Escape) || g.ActiveId != 0 || keeper() == nullptr) return;
    const ImGuiWindow* top = g.OpenPopupStack.back().Window;
    if (top == nullptr || (top->Flags & ImGuiWindowFlags_Modal) != 0) return;
    ImGui::ClosePopupToLevel(g.OpenPopupStack.Size - 1, true);
}

void leave(Context& context) {
    ImGuiContext& g = *ImGui::GetCurrentContext();
    g.NavId = 0;
    g.NavDisableHighlight = true;
    context.keyboard.on = false;
}

}  // namespace

bool pressed(int index, bool repeats) { return ImGui::IsKeyPressed(index, repeats); }

void begin_keyboard(Context& context) {
    auto& keyboard = context.keyboard;
    const auto& io = ImGui::GetIO();
    const ImGuiContext& g = *ImGui::GetCurrentContext();
    watch_alt(context);
    walk_menus(context);
    if (ImGui::IsMouseClicked(0) || ImGui::IsMouseClicked(1) || ImGui::IsMouseClicked(2)) keyboard.on = false;
    if (!keyboard.on && !io.WantTextInput && (pressed(key::Up) || pressed(key::Down))) {
        // The arrows that mean nothing else bring the focus back; in a dialog they are its own.
        if (ImGui::GetTopMostPopupModal() == nullptr) {
            keyboard.on = true;
            if (keeper() == nullptr)
                move_focus(context, start_of(context, 1), 1, [](const FocusStop&) { return true; });
        }
    }
    const bool field_uses_tab = g.ActiveId != 0 && ImGui::IsActiveIdUsingKey(ImGuiKey_Tab);
    if (pressed(key::Tab, true) && !io.KeyCtrl && !io.KeyAlt && !field_uses_tab && !keyboard.stops.empty())
        tab(context);
    if (pressed(key::F6, true)) next_area(context);
    keyboard.escape_taken = pressed(key::Escape) && keyboard.on && !keyboard.popup_before && g.ActiveId == 0;
    if (keyboard.escape_taken) leave(context);
    close_by_escape(context);
    if (keyboard.on) press_focused(context);
}

void end_keyboard(Context& context) {
    auto& keyboard = context.keyboard;
    auto& asked = context.keyboard.asked;
    for (const auto& stop : keyboard.stops)
        if (!asked.empty() && stop.name == asked) {
            focus(context, stop);
            asked.clear();
        }
    keyboard.popup_before = keeper() != nullptr;
    auto& flags = ImGui::GetIO().ConfigFlags;
    // Without it ImGui leaves arrows, Space and Enter to the editor.
    flags = keyboard.on ? flags | ImGuiConfigFlags_NavEnableKeyboard
                        : flags & ~ImGuiConfigFlags_NavEnableKeyboard;
}

void note_stop(Context& context, std::string_view name) {
    const ImGuiContext& g = *ImGui::GetCurrentContext();
    const auto& item = g.LastItemData;
    if (item.ID == 0 || (item.InFlags & (ImGuiItemFlags_Disabled | ImGuiItemFlags_NoNav)) != 0) return;
    if ((g.CurrentWindow->Flags & ImGuiWindowFlags_ChildMenu) != 0 ||
        g.CurrentWindow->DC.NavLayerCurrent != ImGuiNavLayer_Main)
        return;  // menus have their own way
    context.keyboard.stops.push_back({name, item.ID, g.CurrentWindow, item.Rect.Min, item.Rect.Max,
                                      (item.InFlags & ImGuiItemFlags_Inputable) != 0, false});
    if (!has_focus()) return;
    const float gap = context.em * 0.12f;
    g.CurrentWindow->DrawList->AddRect({item.Rect.Min.x - gap, item.Rect.Min.y - gap},
                                       {item.Rect.Max.x + gap, item.Rect.Max.y + gap}, palette::Accent,
                                       context.em * 0.25f, 0, std::max(2.0f, context.em * 0.12f));
}

void takes_letters(Context& context) {
    auto& stops = context.keyboard.stops;
    if (!stops.empty() && stops.back().id == ImGui::GetItemID()) stops.back().typed = true;
}

void focus_last_item(Context& context) {
    const auto& stops = context.keyboard.stops;
    if (!stops.empty() && stops.back().id == ImGui::GetItemID()) focus(context, stops.back());
}

bool has_focus() { return focus_shown() && ImGui::GetItemID() == ImGui::GetCurrentContext()->NavId; }

bool has_focus(const FocusStop& stop) {
    return focus_shown() && stop.id == ImGui::GetCurrentContext()->NavId;
}

bool has_focus(const Context& context, std::string_view name) {
    const auto& stops = context.keyboard.stops;
    return std::any_of(stops.begin(), stops.end(),
                       [&](const FocusStop& stop) { return stop.name == name && has_focus(stop); });
}

void open_menu_by_key(Context& context, const char* menu) {
    auto& keyboard = context.keyboard;
    const bool asked = keyboard.menu_asked == menu, walked_to = keyboard.menu_walk > 0 && has_focus();
    if (!asked && !walked_to) return;
    keyboard.menu_walk = 0;
    keyboard.menu_asked.clear();
    ImGuiContext& g = *ImGui::GetCurrentContext();
    ImGui::SetFocusID(ImGui::GetItemID(), g.CurrentWindow);  // from there arrows find its neighbours
    g.NavDisableHighlight = false;
    g.NavDisableMouseHover = true;
    ImGui::OpenPopup(menu);
}

int focus_step_sideways() {
    if (!has_focus()) return 0;
    const int step = (pressed(key::Right, true) ? 1 : 0) - (pressed(key::Left, true) ? 1 : 0);
    if (step != 0) keep_focus();
    return step;
}

void keep_focus() { ImGui::NavMoveRequestCancel(); }

}  // namespace gse::ui
