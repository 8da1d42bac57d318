// Look of the window: neutral greys, one accent, fonts of the system, all sizes from the font size.
#include "ui/model/theme.h"

#include <array>
#include <cmath>
#include <filesystem>

namespace gse::ui {
namespace {

ImVec4 vector_of(ImU32 colour) { return ImGui::ColorConvertU32ToFloat4(colour); }

/// Latin with extensions, Greek, Cyrillic, punctuation, arrows, mathematical operators, box and geometric
/// shapes.
constexpr std::array<ImWchar, 17> GlyphRanges{0x0020, 0x024F, 0x0370, 0x03FF, 0x0400, 0x052F,
                                              0x1E00, 0x1EFF, 0x2010, 0x205E, 0x20A0, 0x20BF,
                                              0x2190, 0x22FF, 0x25A0, 0x25FF, 0};

std::string first_present(std::initializer_list<const char*> names) {
    constexpr std::array<const char*, 4> Folders{"/usr/share/fonts/truetype", "/usr/share/fonts",
                                                 "/usr/local/share/fonts", "/usr/share/fonts/opentype"};
    std::error_code ignored;
    for (const char* name : names)
        for (const char* folder : Folders) {
            const auto path = std::filesystem::path(folder) / name;
            if (std::filesystem::exists(path, ignored)) return path.string();
        }
    return {};
}

ImFont* add_font(ImFontAtlas& atlas, const std::string& file, float size_px) {
    ImFontConfig config;
    config.OversampleH = 2;
    config.OversampleV = 1;
    config.PixelSnapH = true;
    if (!file.empty()) {
        ImFont* font = atlas.AddFontFromFileTTF(file.c_str(), size_px, &config, GlyphRanges.data());
        if (font != nullptr) return font;
    }
    ImFontConfig built_in;
    built_in.SizePixels = size_px;
    return atlas.AddFontDefault(&built_in);
}

void set_sizes(ImGuiStyle& style, float em) {
    const auto px = [em](float share) { return std::round(em * share); };
    style.WindowPadding = {px(0.6f), px(0.5f)};
    style.FramePadding = {px(0.5f), px(0.27f)};
    style.ItemSpacing = {px(0.5f), px(0.4f)};
    style.ItemInnerSpacing = {px(0.4f), px(0.3f)};
    style.CellPadding = {px(0.35f), px(0.2f)};
    style.IndentSpacing = px(1.0f);
    style.ScrollbarSize = px(0.75f);
    style.GrabMinSize = px(0.7f);
    style.WindowRounding = px(0.3f);
    style.ChildRounding = px(0.2f);
    style.FrameRounding = px(0.22f);
    style.PopupRounding = px(0.3f);
    style.ScrollbarRounding = px(0.4f);
    style.GrabRounding = px(0.2f);
    style.TabRounding = px(0.25f);
    style.SelectableTextAlign = {0, 0.5f};
    style.WindowBorderSize = 1;
    style.ChildBorderSize = 1;
    style.PopupBorderSize = 1;
    style.FrameBorderSize = 0;
    style.TabBorderSize = 0;
    style.DisabledAlpha = 0.45f;
    style.WindowMinSize = {px(4), px(2)};
}

void set_surface_colours(ImVec4* colours) {
    colours[ImGuiCol_Text] = vector_of(palette::Text);
    colours[ImGuiCol_TextDisabled] = vector_of(palette::TextDim);
    colours[ImGuiCol_WindowBg] = vector_of(palette::Panel);
    colours[ImGuiCol_ChildBg] = {0, 0, 0, 0};
    colours[ImGuiCol_PopupBg] = vector_of(IM_COL32(40, 41, 45, 252));
    colours[ImGuiCol_Border] = vector_of(palette::Border);
    colours[ImGuiCol_BorderShadow] = {0, 0, 0, 0};
    colours[ImGuiCol_TitleBg] = vector_of(palette::Window);
    colours[ImGuiCol_TitleBgActive] = vector_of(palette::Raised);
    colours[ImGuiCol_MenuBarBg] = vector_of(palette::Window);
    colours[ImGuiCol_ScrollbarBg] = {0, 0, 0, 0};
    colours[ImGuiCol_ScrollbarGrab] = vector_of(palette::Raised);
    colours[ImGuiCol_ScrollbarGrabHovered] = vector_of(palette::RaisedHover);
    colours[ImGuiCol_ScrollbarGrabActive] = vector_of(palette::TextDim);
    colours[ImGuiCol_Separator] = vector_of(palette::Border);
    colours[ImGuiCol_TableHeaderBg] = vector_of(palette::Raised);
    colours[ImGuiCol_TableBorderStrong] = vector_of(palette::Border);
    colours[ImGuiCol_TableBorderLight] = vector_of(palette::Border);
    colours[ImGuiCol_TableRowBgAlt] = {1, 1, 1, 0.02f};
    colours[ImGuiCol_ModalWindowDimBg] = {0, 0, 0, 0.5f};
    colours[ImGuiCol_NavWindowingDimBg] = {0, 0, 0, 0.5f};
}

void set_control_colours(ImVec4* colours) {
    const ImVec4 accent = vector_of(palette::Accent);
    colours[ImGuiCol_FrameBg] = vector_of(palette::Sunken);
    colours[ImGuiCol_FrameBgHovered] = vector_of(IM_COL32(41, 43, 47, 255));
    colours[ImGuiCol_FrameBgActive] = vector_of(IM_COL32(44, 46, 51, 255));
    colours[ImGuiCol_CheckMark] = accent;
    colours[ImGuiCol_SliderGrab] = vector_of(IM_COL32(62, 118, 176, 255));  // text over it stays readable
    colours[ImGuiCol_SliderGrabActive] = accent;
    colours[ImGuiCol_Button] = vector_of(palette::Raised);
    colours[ImGuiCol_ButtonHovered] = vector_of(palette::RaisedHover);
    colours[ImGuiCol_ButtonActive] = vector_of(palette::AccentDeep);
    colours[ImGuiCol_Header] = vector_of(palette::AccentSoft);
    colours[ImGuiCol_HeaderHovered] = vector_of(with_alpha(palette::Accent, 0.32f));
    colours[ImGuiCol_HeaderActive] = vector_of(with_alpha(palette::Accent, 0.45f));
    colours[ImGuiCol_SeparatorHovered] = accent;
    colours[ImGuiCol_SeparatorActive] = accent;
    colours[ImGuiCol_Tab] = {0, 0, 0, 0};
    colours[ImGuiCol_TabHovered] = vector_of(palette::RaisedHover);
    colours[ImGuiCol_TabActive] = vector_of(palette::Raised);
    colours[ImGuiCol_TabUnfocused] = {0, 0, 0, 0};
    colours[ImGuiCol_TabUnfocusedActive] = vector_of(palette::Raised);
    colours[ImGuiCol_PlotLines] = accent;
    colours[ImGuiCol_PlotHistogram] = accent;
    colours[ImGuiCol_TextSelectedBg] = vector_of(with_alpha(palette::Accent, 0.4f));
    colours[ImGuiCol_DragDropTarget] = accent;
    colours[ImGuiCol_NavHighlight] = accent;
}

}  // namespace

FontFiles find_system_fonts() {
    FontFiles files;
    files.regular = first_present({"noto/NotoSans-Regular.ttf", "inter/Inter-Regular.ttf",
                                   "ubuntu/Ubuntu-R.ttf", "open-sans/OpenSans-Regular.ttf",
                                   "dejavu/DejaVuSans.ttf", "liberation/LiberationSans-Regular.ttf"});
    files.bold = first_present({"noto/NotoSans-Bold.ttf", "inter/Inter-Bold.ttf", "ubuntu/Ubuntu-B.ttf",
                                "open-sans/OpenSans-Bold.ttf", "dejavu/DejaVuSans-Bold.ttf",
                                "liberation/LiberationSans-Bold.ttf"});
    files.mono = first_present({"dejavu/DejaVuSansMono.ttf", "noto/NotoSansMono-Regular.ttf",
                                "liberation/LiberationMono-Regular.ttf"});
    return files;
}

void build_fonts(ImFontAtlas& atlas, const FontFiles& files, float scale) {
    atlas.Clear();
    const float size_px = std::round(BaseFontPx * scale);
    add_font(atlas, files.regular, size_px);
    add_font(atlas, files.bold.empty() ? files.regular : files.bold, size_px);
    add_font(atlas, files.regular, std::round(size_px * 0.86f));
    add_font(atlas, files.mono.empty() ? files.regular : files.mono, std::round(size_px * 0.9f));
}

Fonts current_fonts() {
    const auto& all = ImGui::GetIO().Fonts->Fonts;
    const auto font = [&all](int index) {
        return all.Size == 0 ? nullptr : all[index < all.Size ? index : 0];
    };
    return {font(0), font(1), font(2), font(3)};
}

void apply_theme(ImGuiStyle& style, float em) {
    style = ImGuiStyle();
    ImGui::StyleColorsDark(&style);
    set_sizes(style, em);
    set_surface_colours(style.Colors);
    set_control_colours(style.Colors);
}

void dress(ImFontAtlas& atlas, ImGuiStyle& style, float scale) {
    build_fonts(atlas, find_system_fonts(), scale);
    apply_theme(style, std::round(BaseFontPx * scale));
}

void dress(ImFontAtlas& atlas, ImGuiStyle& style, float scale, const ForeignGlyphs& glyphs,
           const GlyphPainter& painter) {
    dress(atlas, style, scale);
    if (!glyphs.all().empty()) add_foreign_glyphs(atlas, glyphs, painter);
}

ImU32 with_alpha(ImU32 colour, float alpha) {
    const auto byte = static_cast<ImU32>(std::lround(255.0f * (alpha < 0 ? 0 : alpha > 1 ? 1 : alpha)));
    return (colour & ~IM_COL32_A_MASK) | (byte << IM_COL32_A_SHIFT);
}

}  // namespace gse::ui
