// The table of foreign characters, and their pictures in the atlas.
#include "ui/model/glyphs.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace gse::ui {
namespace {

constexpr ImWchar FirstCode = 0xE000, LastCode = 0xF8FF;  // for private use
constexpr char32_t LargestShort = 0xFFFF, Broken = 0xFFFD;

bool plain(std::string_view text) {
    return std::all_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80; });
}

/// The character at `at`, which moves behind it; bytes that are no UTF-8 give U+FFFD.
char32_t next_character(std::string_view text, std::size_t& at) {
    const auto first = static_cast<unsigned char>(text[at++]);
    if (first < 0x80) return first;
    const int more = first >= 0xF0 ? 3 : first >= 0xE0 ? 2 : first >= 0xC2 ? 1 : 0;
    if (more == 0 || first > 0xF4) return Broken;
    char32_t character = first & (0x3F >> more);
    for (int i = 0; i < more; ++i) {
        if (at >= text.size() || (static_cast<unsigned char>(text[at]) & 0xC0) != 0x80) return Broken;
        character = character << 6 | (static_cast<unsigned char>(text[at++]) & 0x3F);
    }
    return character;
}

void append(std::string& text, char32_t c) {
    const auto tail = [&](int shift) { text += static_cast<char>(0x80 | (c >> shift & 0x3F)); };
    if (c < 0x80) {
        text += static_cast<char>(c);
    } else if (c < 0x800) {
        text += static_cast<char>(0xC0 | c >> 6), tail(0);
    } else if (c < 0x10000) {
        text += static_cast<char>(0xE0 | c >> 12), tail(6), tail(0);
    } else {
        text += static_cast<char>(0xF0 | c >> 18), tail(12), tail(6), tail(0);
    }
}

/// Changes the look of the character before it, or joins two; nothing to be seen of its own.
bool invisible(char32_t c) {
    return c == 0x200D || (c >= 0xFE00 && c <= 0xFE0F) || (c >= 0x1F3FB && c <= 0x1F3FF);
}

void paint(unsigned char* pixels, int width, const ImFontAtlasCustomRect& rect, const PaintedGlyph& glyph) {
    for (int y = 0; y < glyph.height; ++y)
        std::memcpy(
            pixels + (static_cast<std::size_t>(rect.Y + y) * static_cast<std::size_t>(width) + rect.X) * 4,
            glyph.rgba.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(glyph.width) * 4,
            static_cast<std::size_t>(glyph.width) * 4);
}

}  // namespace

ImWchar ForeignGlyphs::shown(char32_t character) {
    const auto known = codes_.find(character);
    if (known != codes_.end()) return known->second;
    if (character <= LargestShort) {
        const auto code = static_cast<ImWchar>(character);
        const ImFont* font = ImGui::GetCurrentContext() != nullptr ? ImGui::GetFont() : nullptr;
        if (character > 0x7F && font != nullptr && font->FindGlyphNoFallback(code) == nullptr)
            want(character, code);
        return code;
    }
    if (large_.size() > static_cast<std::size_t>(LastCode - FirstCode)) return static_cast<ImWchar>(Broken);
    const auto code = static_cast<ImWchar>(FirstCode + large_.size());
    large_[code] = character;
    want(character, code);
    return code;
}

void ForeignGlyphs::want(char32_t character, ImWchar code) {
    codes_[character] = code;
    all_.emplace_back(character, code);
}

std::string ForeignGlyphs::shown(std::string_view text) {
    std::string result;
    for (std::size_t at = 0; at < text.size();) append(result, shown(next_character(text, at)));
    return result;
}

std::string ForeignGlyphs::meant(std::string_view text) const {
    std::string result;
    for (std::size_t at = 0; at < text.size();) {
        const char32_t character = next_character(text, at);
        const auto large =
            character <= LargestShort ? large_.find(static_cast<ImWchar>(character)) : large_.end();
        append(result, large == large_.end() ? character : large->second);
    }
    return result;
}

ForeignGlyphs* foreign_glyphs() {
    return ImGui::GetCurrentContext() == nullptr ? nullptr
                                                 : static_cast<ForeignGlyphs*>(ImGui::GetIO().UserData);
}

void set_foreign_glyphs(ForeignGlyphs* glyphs) { ImGui::GetIO().UserData = glyphs; }

Shown::Shown(std::string_view text) : text_(text) {
    ForeignGlyphs* glyphs = plain(text) ? nullptr : foreign_glyphs();
    if (glyphs == nullptr) return;
    own_ = glyphs->shown(text);
    text_ = own_;
}

void add_foreign_glyphs(ImFontAtlas& atlas, const ForeignGlyphs& glyphs, const GlyphPainter& painter) {
    struct Place {
        int rect;
        ImFont* font;
        ImWchar code;
        PaintedGlyph glyph;
    };
    std::vector<Place> places;
    for (const auto& [character, code] : glyphs.all())
        for (const auto& config : atlas.ConfigData) {
            if (invisible(character)) {
                atlas.AddCustomRectFontGlyph(config.DstFont, code, 1, 1, 0);
                continue;
            }
            auto glyph = painter(character, config.SizePixels);
            if (!glyph) continue;
            const int rect = atlas.AddCustomRectFontGlyph(config.DstFont, code, std::max(1, glyph->width),
                                                          std::max(1, glyph->height), glyph->advance);
            places.push_back({rect, config.DstFont, code, std::move(*glyph)});
        }
    atlas.Build();
    unsigned char* pixels = nullptr;
    int width = 0, height = 0;
    atlas.GetTexDataAsRGBA32(&pixels, &width, &height);
    for (const auto& [rect, font, code, glyph] : places) {
        paint(pixels, width, *atlas.GetCustomRectByIndex(rect), glyph);
        auto* entry = const_cast<ImFontGlyph*>(font->FindGlyphNoFallback(code));
        if (entry == nullptr) continue;
        entry->Colored = glyph.coloured ? 1 : 0;
        entry->X0 = glyph.left;
        entry->Y0 = std::round(font->Ascent) - glyph.top;  // known only now
        entry->X1 = entry->X0 + static_cast<float>(glyph.width);
        entry->Y1 = entry->Y0 + static_cast<float>(glyph.height);
    }
}

}  // namespace gse::ui
