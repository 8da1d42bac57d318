// Effects of keys: those of commands, by the keymap, and fixed ones (KeyTable lists them for Help).
#include <array>
#include <utility>

#include "ui/commands/guarded.h"
#include "ui/frame/menu.h"
#include "ui/keys/keyboard.h"
#include "ui/keys/keys.h"
#include "ui/state/state.h"
#include "ui/viewport/viewport.h"

namespace gse::ui {
namespace {

bool enter_pressed() { return pressed(key::Enter) || pressed(key::KeypadEnter); }

/// True when the keys of a command were pressed in this frame, with just these modifiers.
bool hit(const Context& context, Shortcut command) {
    const Chord chord = context.state.keymap.of(command);
    const auto& io = ImGui::GetIO();
    return chord.key != 0 && io.KeyCtrl == chord.ctrl && io.KeyShift == chord.shift &&
           io.KeyAlt == chord.alt && pressed(chord.key);
}

void export_shot(Context& context) {
    if (why_not_export(context, context.exports.picture_path).empty()) export_picture(context);
}

void export_turn(Context& context) {
    if (why_not_export(context, context.exports.film_path).empty()) context.emit(command::ExportTurntable{});
}

/// Commands that do no harm to text that is typed, if their keys do not type.
void file_keys(Context& context, bool typing) {
    const auto free = [&](Shortcut command) {
        const Chord chord = context.state.keymap.of(command);
        const bool types = !chord.ctrl && (chord.key < key::F1 || chord.key > key::F12);
        return hit(context, command) && !(typing && types);
    };
    if (free(Shortcut::Open)) ask_open(context);
    if (free(Shortcut::Save)) save(context);
    if (free(Shortcut::SaveAs)) save_as(context);
    if (free(Shortcut::Export)) show_panel(context.state, PanelId::Export);
    if (free(Shortcut::Locate)) run_locate(context);
    if (free(Shortcut::Quit)) quit(context);
    if (free(Shortcut::Fullscreen)) context.emit(command::ToggleFullscreen{});
    if (free(Shortcut::Screenshot)) export_shot(context);
    if (free(Shortcut::Turntable)) export_turn(context);
}

/// Fixed ones; they work while text is typed.
void control_keys(Context& context) {
    if (enter_pressed()) run_edit(context);
    if (pressed('=')) scale_ui(context, 1.1f);
    if (pressed('-')) scale_ui(context, 1 / 1.1f);
    if (pressed('0')) scale_ui(context, 0);
}

bool redo_hit(const Context& context) {
    const bool other = !context.state.keymap.user_of({'Y', true});
    const auto& io = ImGui::GetIO();
    return hit(context, Shortcut::Redo) || (other && io.KeyCtrl && !io.KeyAlt && pressed('Y'));
}

void toggle(Context& context, bool ViewSettings::*member) {
    context.view.*member = !(context.view.*member);
    context.view_changed = true;
}

void resize_brush(Context& context, float factor) {
    context.view.brush_px = std::min(500.0f, std::max(1.0f, context.view.brush_px * factor));
    context.view_changed = true;
}

/// Goes to another view: of the search while one of them is looked through, else of the scene.
void step(Context& context, int by) {
    const int count = static_cast<int>(context.model.attention.size());
    if (view_looked_through(context) == nullptr) return step_view(context, by);
    look_through_attention(context, (context.state.attention.chosen + by + count) % count);
}

/// Over the picture: attention of the chosen view, its mask, nothing.
void step_evidence(Context& context) {
    auto& state = context.state.attention;
    if (view_looked_through(context) == nullptr) return look_through_attention(context, state.chosen);
    state.over = state.over == Over::Attention ? Over::Mask : Over::Nothing;
}

void tool_keys(Context& context) {
    constexpr std::array<std::pair<Shortcut, Tool>, 6> Tools{{{Shortcut::Brush, Tool::Brush},
                                                              {Shortcut::Rectangle, Tool::Rectangle},
                                                              {Shortcut::Lasso, Tool::Lasso},
                                                              {Shortcut::CutOut, Tool::CutOut},
                                                              {Shortcut::Place, Tool::Place},
                                                              {Shortcut::HealBrush, Tool::Heal}}};
    for (const auto& [command, tool] : Tools)
        if (hit(context, command)) set_tool(context, tool);
    if (ImGui::GetIO().KeyCtrl || ImGui::GetIO().KeyAlt) return;
    if (ImGui::IsKeyPressed(key::LeftBracket)) resize_brush(context, 1 / 1.15f);
    if (ImGui::IsKeyPressed(key::RightBracket)) resize_brush(context, 1.15f);
}

void label_keys(Context& context) {
    const bool labelled = context.active_label() != nullptr;
    if (hit(context, Shortcut::Invert) && labelled) context.emit(command::InvertLabel{});
    if (hit(context, Shortcut::Clear) && labelled) context.emit(command::ClearLabel{});
    if (hit(context, Shortcut::Hide)) hide_label(context);
    if (hit(context, Shortcut::ShowHidden)) context.emit(command::ShowHidden{});
    if (hit(context, Shortcut::Isolate)) isolate_label(context);
    if (hit(context, Shortcut::Delete) && labelled && label_count(context) > 0)
        context.emit(command::DeleteLabelledSplats{});
    if (hit(context, Shortcut::Heal) && labelled && label_count(context) > 0)
        context.emit(command::HealLabelledSplats{});
}

void view_keys(Context& context) {
    if (hit(context, Shortcut::Frame)) frame_selection(context);
    if (hit(context, Shortcut::Home)) go_home(context);
    if (hit(context, Shortcut::FrontOnly)) toggle(context, &ViewSettings::front_only);
    if (hit(context, Shortcut::Tint)) toggle(context, &ViewSettings::tint_labels);
    if (hit(context, Shortcut::Wipe)) toggle_wipe(context);
    if (hit(context, Shortcut::Evidence)) step_evidence(context);
    const bool arrows_free = !context.keyboard.on || has_focus(context, "viewport");
    if (ImGui::GetIO().KeyCtrl || ImGui::GetIO().KeyAlt) return;
    if (arrows_free && pressed(key::Left)) step(context, -1);
    if (arrows_free && pressed(key::Right)) step(context, 1);
}

/// Commands whose keys mean something else while text is typed.
void free_keys(Context& context) {
    if (hit(context, Shortcut::Prompt)) {
        show_panel(context.state, PanelId::Prompt);
        context.keyboard.asked = "prompt.sentence";
    }
    if (hit(context, Shortcut::Undo)) context.emit(command::Undo{});
    if (redo_hit(context)) context.emit(command::Redo{});
    if (hit(context, Shortcut::Panels))
        context.state.layout.panels_hidden = !context.state.layout.panels_hidden;
    if (!context.scene_open()) return;
    tool_keys(context);
    label_keys(context);
    view_keys(context);
}

void hold_to_flip(Context& context, bool free) {
    auto& state = context.state.viewport;
    const bool held = free && context.scene_open() && ImGui::IsKeyDown(key::Grave);
    if (held == state.flipped) return;
    if (held) state.before_flip = context.model.comparison;
    state.flipped = held;
    context.emit(command::SetComparison{held ? Comparison::Original : state.before_flip});
}

void escape(Context& context) {
    auto& viewport = context.state.viewport;
    if (viewport.stroke) {
        viewport.stroke = false;
    } else if (viewport.tool != Tool::Orbit) {
        viewport.tool = Tool::Orbit;
    } else if (view_looked_through(context) != nullptr) {
        context.state.attention.over = Over::Nothing;
    } else if (context.model.job.running || context.model.file_job.running) {
        cancel_job(context);
    }
}

}  // namespace

void handle_keys(Context& context) {
    const auto& io = ImGui::GetIO();
    const bool dialog = context.keyboard.popup_before || context.state.files.is_open() ||
                        context.state.help_open || context.state.about_open ||
                        ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
    const bool typing = io.WantTextInput;
    hold_to_flip(context, !dialog && !typing && !io.KeyCtrl);
    if (dialog) return;
    if (pressed(key::F1)) {
        if (!io.KeyShift) return context.emit(command::OpenGuide{});
        context.state.help_open = true;
    }
    file_keys(context, typing);
    if (io.KeyCtrl && !io.KeyAlt) control_keys(context);
    if (io.KeyShift && !io.KeyCtrl && enter_pressed()) return run_edit(context);
    if (typing) return;
    if (pressed(key::Escape) && !io.KeyCtrl && !context.keyboard.escape_taken) escape(context);
    if (!io.KeySuper) free_keys(context);
}

}  // namespace gse::ui
