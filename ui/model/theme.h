// Look of the window: neutral greys, one accent, fonts of the system, all sizes from the font size.
#pragma once

#include <imgui.h>

#include <string>

#include "ui/model/glyphs.h"

namespace gse::ui {

/// Colours by what they mean (sRGB, IM_COL32 order).
namespace palette {
inline constexpr ImU32 Window = IM_COL32(24, 25, 27, 255);
inline constexpr ImU32 Panel = IM_COL32(33, 34, 37, 255);
inline constexpr ImU32 Raised = IM_COL32(48, 50, 54, 255);
inline constexpr ImU32 RaisedHover = IM_COL32(60, 62, 67, 255);
inline constexpr ImU32 Sunken = IM_COL32(23, 24, 26, 255);
inline constexpr ImU32 Border = IM_COL32(56, 58, 63, 255);
inline constexpr ImU32 Text = IM_COL32(222, 224, 227, 255);
inline constexpr ImU32 TextDim = IM_COL32(150, 154, 161, 255);
inline constexpr ImU32 Hint = IM_COL32(102, 105, 111, 255);  // what could be typed into an empty field
inline constexpr ImU32 Accent = IM_COL32(86, 156, 224, 255);
inline constexpr ImU32 AccentHover = IM_COL32(112, 175, 236, 255);
inline constexpr ImU32 AccentDeep = IM_COL32(44, 92, 142, 255);
inline constexpr ImU32 AccentSoft = IM_COL32(86, 156, 224, 60);
inline constexpr ImU32 OnAccent = IM_COL32(255, 255, 255, 255);
inline constexpr ImU32 Good = IM_COL32(104, 186, 118, 255);
inline constexpr ImU32 Warning = IM_COL32(226, 176, 74, 255);
inline constexpr ImU32 Bad = IM_COL32(229, 103, 96, 255);
inline constexpr ImU32 Shade = IM_COL32(16, 17, 18, 190);  // behind text over pictures
}  // namespace palette

/// Fonts in the order build_fonts() adds them; absent ones fall back to the first.
struct Fonts {
    ImFont* regular = nullptr;
    ImFont* bold = nullptr;
    ImFont* small = nullptr;
    ImFont* mono = nullptr;
};

/// Files of the fonts, empty = ImGui's built-in one.
struct FontFiles {
    std::string regular, bold, mono;
};

/// Size of the text at scale 1, in pixels.
inline constexpr float BaseFontPx = 15.0f;

/// The first present of a list of good interface fonts under the usual folders of a system.
FontFiles find_system_fonts();

/// Adds regular, bold, small and mono at `scale` (clears what was there); the caller uploads the texture.
void build_fonts(ImFontAtlas& atlas, const FontFiles& files, float scale);

/// The fonts that build_fonts() put into the current context.
Fonts current_fonts();

/// Colours and sizes; `em` is the font size in pixels. Overwrites the whole style.
void apply_theme(ImGuiStyle& style, float em);

/// Fonts of the system and the style for a scale. A window calls it when its scale changes.
void dress(ImFontAtlas& atlas, ImGuiStyle& style, float scale);
/// Fonts and style with characters that other fonts have. Builds the atlas.
void dress(ImFontAtlas& atlas, ImGuiStyle& style, float scale, const ForeignGlyphs& glyphs,
           const GlyphPainter& painter);

/// `colour` with another opacity in [0,1].
ImU32 with_alpha(ImU32 colour, float alpha);

}  // namespace gse::ui
