// Characters from other fonts: fontconfig finds the font, FreeType paints.
#include "ui/model/foreign_fonts.h"

#include <fontconfig/fontconfig.h>
#include <ft2build.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include FT_FREETYPE_H

namespace gse::ui {
namespace {

constexpr char32_t FirstEmoji = 0x1F000;
constexpr float EmShare = 0.86f;  // of the line's height, as in the panels' own fonts
constexpr float EmojiShare = 1.0f;

using Fonts = std::unique_ptr<FcFontSet, void (*)(FcFontSet*)>;

/// Installed fonts, the best ones for the pattern first.
Fonts sorted_fonts(const char* name) {
    const std::unique_ptr<FcPattern, void (*)(FcPattern*)> wanted(
        FcNameParse(reinterpret_cast<const FcChar8*>(name)), FcPatternDestroy);
    if (!wanted) return {nullptr, FcFontSetDestroy};
    FcConfigSubstitute(nullptr, wanted.get(), FcMatchPattern);
    FcDefaultSubstitute(wanted.get());
    FcResult result = FcResultNoMatch;
    return {FcFontSort(nullptr, wanted.get(), FcTrue, nullptr, &result), FcFontSetDestroy};
}

/// Wide and narrow ones of other scripts.
bool is_space(char32_t c) { return c == 0x3000 || c == 0x1680 || (c >= 0x2000 && c <= 0x200A); }

/// A bitmap of FreeType as straight RGBA.
ui::PaintedGlyph picture_of(const FT_Bitmap& bitmap) {
    ui::PaintedGlyph glyph;
    glyph.width = static_cast<int>(bitmap.width);
    glyph.height = static_cast<int>(bitmap.rows);
    glyph.coloured = bitmap.pixel_mode == FT_PIXEL_MODE_BGRA;
    glyph.rgba.assign(static_cast<std::size_t>(glyph.width) * static_cast<std::size_t>(glyph.height) * 4,
                      255);
    for (int y = 0; y < glyph.height; ++y) {
        const unsigned char* row = bitmap.buffer + static_cast<std::ptrdiff_t>(y) * bitmap.pitch;
        for (int x = 0; x < glyph.width; ++x) {
            std::uint8_t* to =
                glyph.rgba.data() + (static_cast<std::size_t>(y) * static_cast<std::size_t>(glyph.width) +
                                     static_cast<std::size_t>(x)) *
                                        4;
            if (bitmap.pixel_mode == FT_PIXEL_MODE_MONO) {
                to[3] = (row[x / 8] >> (7 - x % 8) & 1) != 0 ? 255 : 0;
            } else if (!glyph.coloured) {
                to[3] = row[x];
            } else {
                const unsigned char* from = row + x * 4;  // premultiplied
                for (int c = 0; c < 3; ++c)
                    to[c] = from[3] == 0
                                ? 0
                                : static_cast<std::uint8_t>(std::min(255, from[2 - c] * 255 / from[3]));
                to[3] = from[3];
            }
        }
    }
    return glyph;
}

/// The mean of the pixels that fall into each of a smaller picture.
ui::PaintedGlyph scaled(const ui::PaintedGlyph& large, float factor) {
    ui::PaintedGlyph small = large;
    small.width = std::max(1, static_cast<int>(std::lround(static_cast<float>(large.width) * factor)));
    small.height = std::max(1, static_cast<int>(std::lround(static_cast<float>(large.height) * factor)));
    small.left *= factor, small.top *= factor, small.advance *= factor;
    small.rgba.assign(static_cast<std::size_t>(small.width) * static_cast<std::size_t>(small.height) * 4, 0);
    const auto span = [](int at, int count, int whole) {
        return std::pair{at * whole / count, std::max((at + 1) * whole / count, at * whole / count + 1)};
    };
    for (int y = 0; y < small.height; ++y)
        for (int x = 0; x < small.width; ++x) {
            const auto [y0, y1] = span(y, small.height, large.height);
            const auto [x0, x1] = span(x, small.width, large.width);
            int sum[4] = {};
            for (int v = y0; v < y1; ++v)
                for (int u = x0; u < x1; ++u) {
                    const std::uint8_t* from =
                        large.rgba.data() +
                        (static_cast<std::size_t>(v) * static_cast<std::size_t>(large.width) +
                         static_cast<std::size_t>(u)) *
                            4;
                    for (int c = 0; c < 3; ++c) sum[c] += from[c] * from[3];
                    sum[3] += from[3];
                }
            std::uint8_t* to =
                small.rgba.data() + (static_cast<std::size_t>(y) * static_cast<std::size_t>(small.width) +
                                     static_cast<std::size_t>(x)) *
                                        4;
            for (int c = 0; c < 3; ++c) to[c] = sum[3] == 0 ? 0 : static_cast<std::uint8_t>(sum[c] / sum[3]);
            to[3] = static_cast<std::uint8_t>(sum[3] / ((y1 - y0) * (x1 - x0)));
        }
    return small;
}

}  // namespace

struct ForeignFonts::State {
    FT_Library library = nullptr;
    Fonts text = sorted_fonts("sans-serif"), emoji = sorted_fonts("emoji");
    std::map<std::pair<std::string, int>, FT_Face> faces;  // null = cannot be read

    State() {
        if (FT_Init_FreeType(&library) != 0) library = nullptr;
    }
    ~State() {
        if (library != nullptr) FT_Done_FreeType(library);  // with its faces
    }
    State(const State&) = delete;
    State& operator=(const State&) = delete;

    FT_Face face(const FcPattern* font) {
        FcChar8* file = nullptr;
        int index = 0;
        if (FcPatternGetString(font, FC_FILE, 0, &file) != FcResultMatch) return nullptr;
        FcPatternGetInteger(font, FC_INDEX, 0, &index);
        const std::pair key{std::string(reinterpret_cast<const char*>(file)), index};
        const auto known = faces.find(key);
        if (known != faces.end()) return known->second;
        FT_Face opened = nullptr;
        if (FT_New_Face(library, key.first.c_str(), index, &opened) != 0) opened = nullptr;
        return faces[key] = opened;
    }

    std::optional<ui::PaintedGlyph> paint_with(FT_Face font, char32_t character, float size_px) const {
        const FT_UInt index = FT_Get_Char_Index(font, character);
        if (index == 0) return std::nullopt;
        float factor = 1;
        if (FT_IS_SCALABLE(font)) {
            FT_Set_Pixel_Sizes(font, 0, static_cast<FT_UInt>(std::max(4L, std::lround(size_px * EmShare))));
        } else {  // pictures of one size
            if (font->num_fixed_sizes == 0 || FT_Select_Size(font, 0) != 0) return std::nullopt;
            factor = size_px * EmojiShare /
                     static_cast<float>(std::max<FT_Short>(1, font->available_sizes[0].height));
        }
        if (FT_Load_Glyph(font, index, FT_LOAD_RENDER | FT_LOAD_COLOR) != 0) return std::nullopt;
        const FT_GlyphSlot slot = font->glyph;
        const bool drawn = slot->bitmap.width > 0 && slot->bitmap.rows > 0 && slot->bitmap.buffer != nullptr;
        if (!drawn && !is_space(character))
            return std::nullopt;  // colours in a form that FreeType does not paint
        ui::PaintedGlyph glyph = picture_of(slot->bitmap);
        glyph.left = static_cast<float>(slot->bitmap_left);
        glyph.top = static_cast<float>(slot->bitmap_top);
        glyph.advance = static_cast<float>(slot->advance.x) / 64;
        return factor == 1 ? glyph : scaled(glyph, factor);
    }

    std::optional<ui::PaintedGlyph> paint_from(const Fonts& fonts, char32_t character, float size_px) {
        for (int i = 0; fonts && i < fonts->nfont; ++i) {
            FcCharSet* has = nullptr;
            if (FcPatternGetCharSet(fonts->fonts[i], FC_CHARSET, 0, &has) != FcResultMatch) continue;
            if (FcCharSetHasChar(has, character) != FcTrue) continue;
            const FT_Face font = face(fonts->fonts[i]);
            if (font == nullptr) continue;
            if (auto glyph = paint_with(font, character, size_px)) return glyph;
        }
        return std::nullopt;
    }
};

ForeignFonts::ForeignFonts() = default;
ForeignFonts::~ForeignFonts() = default;

std::optional<ui::PaintedGlyph> ForeignFonts::paint(char32_t character, float size_px) {
    if (!state_) state_ = std::make_unique<State>();
    if (state_->library == nullptr) return std::nullopt;
    const bool emoji = character >= FirstEmoji;
    if (auto glyph = state_->paint_from(emoji ? state_->emoji : state_->text, character, size_px))
        return glyph;
    return state_->paint_from(emoji ? state_->text : state_->emoji, character, size_px);
}

}  // namespace gse::ui
