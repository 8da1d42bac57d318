// Asks fontconfig for fonts and fills ImGui's atlas.
#include "engine/window/window_fonts.h"

#include <fontconfig/fontconfig.h>
#include <imgui.h>

#include <memory>

namespace gse::window {
namespace {

constexpr float BaseFontPx = 15.0f;

bool readable_by_imgui(const std::string& file) {
    return file.ends_with(".ttf") || file.ends_with(".otf") || file.ends_with(".TTF") ||
           file.ends_with(".OTF");
}

}  // namespace

std::string system_font(const std::string& pattern) {
    const std::unique_ptr<FcPattern, void (*)(FcPattern*)> wanted(
        FcNameParse(reinterpret_cast<const FcChar8*>(pattern.c_str())), FcPatternDestroy);
    if (!wanted) return {};
    FcConfigSubstitute(nullptr, wanted.get(), FcMatchPattern);
    FcDefaultSubstitute(wanted.get());
    FcResult result = FcResultNoMatch;
    const std::unique_ptr<FcFontSet, void (*)(FcFontSet*)> found(
        FcFontSort(nullptr, wanted.get(), FcTrue, nullptr, &result), FcFontSetDestroy);
    if (!found) return {};
    for (int i = 0; i < found->nfont; ++i) {
        FcChar8* file = nullptr;
        if (FcPatternGetString(found->fonts[i], FC_FILE, 0, &file) != FcResultMatch) continue;
        std::string name = reinterpret_cast<const char*>(file);
        if (readable_by_imgui(name)) return name;
    }
    return {};
}

void dress_plainly(ImFontAtlas& atlas, ImGuiStyle& style, float scale) {
    // Latin with accents, Greek, Cyrillic, punctuation, arrows, mathematics, box drawing, symbols, ticks.
    static const ImWchar ranges[] = {0x0020, 0x024F, 0x0370, 0x03FF, 0x0400, 0x04FF, 0x2010,
                                     0x205E, 0x2190, 0x21FF, 0x2200, 0x22FF, 0x2500, 0x25FF,
                                     0x2600, 0x26FF, 0x2700, 0x27BF, 0};
    static const std::string file = system_font("sans-serif");
    atlas.Clear();
    if (file.empty() ||
        atlas.AddFontFromFileTTF(file.c_str(), BaseFontPx * scale, nullptr, ranges) == nullptr)
        atlas.AddFontDefault();
    style = ImGuiStyle();
    ImGui::StyleColorsDark(&style);
    style.ScaleAllSizes(scale);
}

}  // namespace gse::window
