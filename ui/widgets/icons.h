// Icons drawn with lines, so that they are sharp at every scale, and buttons that carry one.
#pragma once

#include <string_view>

#include "ui/model/context.h"

namespace gse::ui {

enum class Icon {
    Pointer,
    Pencil,
    Brush,
    Rectangle,
    Lasso,
    CutOut,
    Place,
    Heal,
    FrontOnly,
    Through,
    Undo,
    Redo,
    Frame,
    Home,
    Wipe,
    Flip,
    Eye,
    EyeOff,
    Camera,
    Trash,
    Repeat,
    Up,
    Down,
    Plus,
    Lock,
    Unlock,
    Dice,
    Pause,
    Play,
    Stop,
    Tag,
    Axes,
    Box,
    Folder,
    File,
    Close,
    Check,
    Warning
};

/// Draws the icon centred in a square of `size` pixels.
void draw_icon(ImDrawList* list, Icon icon, ImVec2 centre, float size, ImU32 colour);

struct IconButton {
    std::string_view name;
    Icon icon;
    std::string_view tooltip;
    bool active = false;
    std::string_view why_off = {};
    float size_em = 1.75f;
};

bool icon_button(Context& context, const IconButton& options);

}  // namespace gse::ui
