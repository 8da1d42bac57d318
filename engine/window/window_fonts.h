// Fonts of the system for the panels, found by fontconfig.
#pragma once

#include <string>

struct ImFontAtlas;
struct ImGuiStyle;

namespace gse::window {

/// File of the installed font that fits best, for example "DejaVu Sans", "sans-serif:bold", "monospace".
/// Empty if none can be used; only TrueType and OpenType files can.
std::string system_font(const std::string& pattern);

/// Default look: the system's sans-serif font at 15 px times scale, dark colours.
void dress_plainly(ImFontAtlas& atlas, ImGuiStyle& style, float scale);

}  // namespace gse::window
