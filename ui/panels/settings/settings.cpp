// Settings: display of the scene, size of the interface, and the keys.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "ui/commands/guarded.h"
#include "ui/panels/panels.h"
#include "ui/panels/settings/keys_dialog.h"
#include "ui/state/state.h"
#include "ui/widgets/controls.h"
#include "ui/widgets/fields.h"

namespace gse::ui {
namespace {

constexpr std::array<float, 6> Scales{0.8f, 1.0f, 1.25f, 1.5f, 2.0f, 3.0f};

void draw_scale(Context& context) {
    heading(context, "Interface");
    std::array<std::string, Scales.size()> texts;
    std::array<const char*, Scales.size()> names{};
    int chosen = -1;
    for (std::size_t at = 0; at < Scales.size(); ++at) {
        texts[at] = fmt::format("{:.0f} %", Scales[at] * 100);
        names[at] = texts[at].c_str();
        if (std::abs(Scales[at] - context.model.ui_scale) < 0.01f) chosen = static_cast<int>(at);
    }
    row_label(context, "Size", "Ctrl + +, Ctrl + -, Ctrl + 0");
    ImGui::BeginGroup();
    if (segmented(context, "settings.scale", names, chosen))
        context.emit(command::SetUiScale{Scales[static_cast<std::size_t>(chosen)]});
    ImGui::EndGroup();
    row_label(context, "Panels");
    if (button(context, {.name = "settings.reset_layout", .text = "Reset layout"})) {
        context.state.layout = Layout::standard();
        context.state.front_changed = {true, true, true};
    }
}

void draw_background(Context& context) {
    unsigned red = 0, green = 0, blue = 0;
    std::sscanf(context.view.background.c_str(), "#%2x%2x%2x", &red, &green, &blue);
    float colour[3] = {static_cast<float>(red) / 255, static_cast<float>(green) / 255,
                       static_cast<float>(blue) / 255};
    row_label(context, "Background", "Colour behind the scene");
    if (ImGui::ColorEdit3("##settings.background", colour,
                          ImGuiColorEditFlags_NoInputs | ImGuiColorEditFlags_NoLabel)) {
        const auto byte = [](float value) {
            return static_cast<int>(std::lround(std::clamp(value, 0.0f, 1.0f) * 255));
        };
        context.view.background =
            fmt::format("#{:02x}{:02x}{:02x}", byte(colour[0]), byte(colour[1]), byte(colour[2]));
        context.view_changed = true;
    }
    note(context, "settings.background");
    for (const char* preset : {"#000000", "#1d1f24", "#808080", "#ffffff"}) {
        ImGui::SameLine();
        unsigned value = 0;
        std::sscanf(preset, "#%x", &value);
        const ImVec4 swatch(static_cast<float>(value >> 16) / 255, static_cast<float>(value >> 8 & 255) / 255,
                            static_cast<float>(value & 255) / 255, 1);
        if (ImGui::ColorButton(preset, swatch, ImGuiColorEditFlags_NoTooltip)) {
            context.view.background = preset;
            context.view_changed = true;
        }
    }
}

struct CacheSize {
    int megabytes;
    const char* name;
};
constexpr std::array CacheSizes{CacheSize{0, "Off"}, CacheSize{128, "128 MB"}, CacheSize{512, "512 MB"},
                                CacheSize{2048, "2 GB"}, CacheSize{8192, "8 GB"}};

void draw_cache(Context& context) {
    heading(context, "Answers kept on the disk");
    dim_text(
        "What the networks answered about a scene (attention maps, pictures of the class, what they learned) "
        "is not asked again, "
        "also after a restart.");
    std::array<const char*, CacheSizes.size()> names{};
    int chosen = -1;
    for (std::size_t at = 0; at < CacheSizes.size(); ++at) {
        names[at] = CacheSizes[at].name;
        if (CacheSizes[at].megabytes == context.model.cache_mb) chosen = static_cast<int>(at);
    }
    row_label(context, "At most", "What was used least recently goes first");
    ImGui::BeginGroup();
    if (segmented(context, "settings.cache", names, chosen))
        context.emit(command::SetCacheMb{CacheSizes[static_cast<std::size_t>(chosen)].megabytes});
    ImGui::EndGroup();
    const auto held = static_cast<double>(context.model.cache_bytes);
    row_label(context, "In use");
    plain_text(held > 0 ? bytes_text(held) : "nothing");
    ImGui::SameLine();
    if (button(context, {.name = "settings.clear_cache",
                         .text = "Clear",
                         .why_off = held > 0 ? "" : "There is nothing to clear.",
                         .tooltip = "Removes all of it; the next search asks the networks again"}))
        context.emit(command::ClearCache{});
}

void draw_keys(Context& context) {
    heading(context, "Keys");
    draw_key_preset(context, "settings.preset");
    if (button(context, {.name = "settings.keys",
                         .text = "Choose keys...",
                         .tooltip = "All keys, each to be chosen (Shift + F1)"}))
        context.state.help_open = true;
}

}  // namespace

void draw_settings_panel(Context& context) {
    draw_scale(context);
    heading(context, "Picture");
    int mode = context.view.mode;
    row_label(context, "Show");
    if (combo(context, "settings.mode", DisplayModeNames, mode)) {
        context.view.mode = mode;
        context.view_changed = true;
    }
    draw_background(context);
    // The mode and the background have controls of their own; the wipe is dragged in the picture.
    const auto wanted = [](const char* name, const char*) {
        const std::string_view field(name);
        return field != "mode" && field != "background" && field != "wipe";
    };
    context.view_changed |= field_rows(context, "settings", context.view, wanted, [](const char*, bool&) {});
    if (!context.model.renderer.empty()) property(context, "Drawn by", context.model.renderer);
    draw_cache(context);
    draw_keys(context);
}

}  // namespace gse::ui
