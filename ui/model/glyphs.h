// Characters that the fonts of the panels do not have (Chinese, Japanese, Korean, emoji, ...). Keeps the
// asked characters, and codes for those that do not fit into ImGui's 16 bits.
#pragma once

#include <imgui.h>

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gse::ui {

/// A character as a picture, found in some other font.
struct PaintedGlyph {
    int width = 0, height = 0;
    float left = 0, top = 0;  // of the picture, from the pen and up from the base line
    float advance = 0;
    bool coloured = false;
    std::vector<std::uint8_t> rgba;  // [height,width,4]; white where it takes the text's colour
};

/// Paints a character for text of a size; nothing when no font has it.
using GlyphPainter = std::function<std::optional<PaintedGlyph>(char32_t character, float size_px)>;

class ForeignGlyphs {
public:
    /// The text as ImGui takes it. Characters that the present font lacks are remembered.
    std::string shown(std::string_view text);
    /// Original text of a text from there.
    std::string meant(std::string_view text) const;
    /// Original character of one code.
    ImWchar shown(char32_t character);

    /// All asked characters with their codes in ImGui; grows only.
    const std::vector<std::pair<char32_t, ImWchar>>& all() const { return all_; }

private:
    void want(char32_t character, ImWchar code);

    std::vector<std::pair<char32_t, ImWchar>> all_;
    std::map<char32_t, ImWchar> codes_;  // of `all_`
    std::map<ImWchar, char32_t> large_;  // what stands for characters beyond 16 bits
};

/// Table of the present ImGui context; null = none: texts are shown as they are.
ForeignGlyphs* foreign_glyphs();
void set_foreign_glyphs(ForeignGlyphs* glyphs);

/// A text on its way to ImGui; costs nothing for plain ones.
class Shown {
public:
    explicit Shown(std::string_view text);
    const char* begin() const { return text_.data(); }
    const char* end() const { return text_.data() + text_.size(); }
    std::string_view text() const { return text_; }

private:
    std::string own_;
    std::string_view text_;
};

/// Adds the characters to the atlas's fonts and paints them; builds the atlas.
void add_foreign_glyphs(ImFontAtlas& atlas, const ForeignGlyphs& glyphs, const GlyphPainter& painter);

}  // namespace gse::ui
