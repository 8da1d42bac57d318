// Context of every panel in a frame: the view model, the commands, the window's own state, and the map of
// widgets.
#pragma once

#include <imgui.h>

#include <map>
#include <string>
#include <string_view>

#include "ui/model/command.h"
#include "ui/model/theme.h"
#include "ui/model/view_model.h"

namespace gse::ui {

struct UiState;
struct KeyboardState;

/// A widget's place on the screen, in the coordinates of the window.
struct Rect {
    float x = 0, y = 0, width = 0, height = 0;
    bool visible = false;  // its middle is not scrolled or clipped away
    bool enabled = true;
    float text_width = 0;  // what its text needs; 0 = not told
};

using WidgetMap = std::map<std::string, Rect, std::less<>>;

/// Copies of settings that panels change. The shell hands them on at the end of the frame when `..._changed`.
struct Context {
    const ViewModel& model;
    CommandSink& commands;
    Textures& textures;
    UiState& state;
    KeyboardState& keyboard;  // of `state`: all that keys and widgets need of it
    WidgetMap& widgets;
    Fonts fonts;
    float em = 15;  // font size in pixels
    ViewSettings view;
    edit::EditRequest request;
    ExportSettings exports;
    ModelSettings model_settings;
    bool view_changed = false, request_changed = false, exports_changed = false,
         model_settings_changed = false;

    void emit(Command command) { commands.push(std::move(command)); }
    bool scene_open() const { return model.document != nullptr && !model.document->empty(); }
    const DocumentState& document() const { return model.document->state(); }
    /// The label being shown and corrected; null when there is none.
    const NamedLabel* active_label() const {
        if (!scene_open()) return nullptr;
        const auto& labels = document().labels;
        const int index = document().active_label;
        return index >= 0 && index < static_cast<int>(labels.size())
                   ? &labels[static_cast<std::size_t>(index)]
                   : nullptr;
    }
};

/// Notes the place of the last ImGui item, under a name that tests and scripts find it by.
void note(Context& context, std::string_view name, float text_width = 0);
/// Notes the place of a rectangle that is no item.
void note_rect(Context& context, std::string_view name, ImVec2 low, ImVec2 high);

inline ImTextureID imgui_texture(TextureId id) {
    return reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(id));
}

}  // namespace gse::ui
