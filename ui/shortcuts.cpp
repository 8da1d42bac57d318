// The fixed set of keys (KeyTable lists them for Help).
#include "ui/commands.h"
#include "ui/keys.h"
#include "ui/menu.h"
#include "ui/state.h"
#include "ui/viewport/viewport.h"

namespace gse::ui {
namespace {

bool pressed(int index) { return ImGui::IsKeyPressed(index, false); }

bool enter_pressed() { return pressed(key::Enter) || pressed(key::KeypadEnter); }

/// Keys with Ctrl; they work while text is typed, but for those that text fields use themselves.
void control_keys(Context& context, bool typing) {
    const bool shift = ImGui::GetIO().KeyShift;
    if (enter_pressed()) run_edit(context);
    if (pressed('O')) ask_open(context);
    if (pressed('S')) shift ? save_as(context) : save(context);
    if (pressed('E')) show_panel(context.state, PanelId::Export);
    if (pressed('L')) run_locate(context);
    if (pressed('Q')) quit(context);
    if (pressed('=')) scale_ui(context, 1.1f);
    if (pressed('-')) scale_ui(context, 1 / 1.1f);
    if (pressed('0')) scale_ui(context, 0);
    if (typing) return;
    const bool labelled = context.active_label() != nullptr;
    if (pressed('Z')) shift ? context.actions.redo() : context.actions.undo();
    if (pressed('Y')) context.actions.redo();
    if (pressed('I') && labelled) context.actions.invert_label();
    if (pressed('D') && labelled) context.actions.clear_label();
    if (pressed(key::Space)) context.state.layout.panels_hidden = !context.state.layout.panels_hidden;
}

void toggle(Context& context, bool ViewSettings::*member) {
    context.view.*member = !(context.view.*member);
    context.view_changed = true;
}

void resize_brush(Context& context, float factor) {
    context.view.brush_px = std::min(500.0f, std::max(1.0f, context.view.brush_px * factor));
    context.view_changed = true;
}

/// To another view: of the search while one of them is looked through, else of the scene.
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

void plain_keys(Context& context) {
    if (pressed('P')) {
        show_panel(context.state, PanelId::Prompt);
        context.state.focus = "prompt.sentence";
    }
    if (!context.scene_open()) return;
    if (pressed('B')) set_tool(context, Tool::Brush);
    if (pressed('R')) set_tool(context, Tool::Rectangle);
    if (pressed('L')) set_tool(context, Tool::Lasso);
    if (pressed('C')) set_tool(context, Tool::CutOut);
    if (pressed('F')) frame_selection(context);
    if (pressed(key::Home)) go_home(context);
    if (pressed('H')) ImGui::GetIO().KeyShift ? context.actions.show_hidden() : hide_label(context);
    if (pressed('I')) isolate_label(context);
    if (pressed('N')) toggle(context, &ViewSettings::front_only);
    if (pressed('T')) toggle(context, &ViewSettings::tint_labels);
    if (pressed('V')) toggle_wipe(context);
    if (pressed('M')) step_evidence(context);
    const bool arrows_free = !context.state.keyboard.on || has_focus(context, "viewport");
    if (arrows_free && pressed(key::Left)) step(context, -1);
    if (arrows_free && pressed(key::Right)) step(context, 1);
    if (ImGui::IsKeyPressed(key::LeftBracket)) resize_brush(context, 1 / 1.15f);
    if (ImGui::IsKeyPressed(key::RightBracket)) resize_brush(context, 1.15f);
    if (pressed(key::Delete) && context.active_label() != nullptr && label_count(context) > 0)
        context.actions.delete_labelled_splats();
}

void hold_to_flip(Context& context, bool free) {
    auto& state = context.state.viewport;
    const bool held = free && context.scene_open() && ImGui::IsKeyDown(key::Grave);
    if (held == state.flipped) return;
    if (held) state.before_flip = context.model.comparison;
    state.flipped = held;
    context.actions.set_comparison(held ? Comparison::Original : state.before_flip);
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
    const bool dialog = context.state.keyboard.popup_before || context.state.files.is_open() || context.state.help_open ||
                        context.state.about_open ||
                        ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
    const bool typing = io.WantTextInput;
    hold_to_flip(context, !dialog && !typing && !io.KeyCtrl);
    if (dialog) return;
    if (pressed(key::F1)) context.state.help_open = true;
    if (pressed(key::F11)) context.actions.toggle_fullscreen();
    if (pressed(key::F12)) {
        const auto& path = io.KeyShift ? context.exports.film_path : context.exports.picture_path;
        if (why_not_export(context, path).empty())
            io.KeyShift ? context.actions.export_turntable() : context.actions.export_picture();
    }
    if (io.KeyCtrl && !io.KeyAlt) return control_keys(context, typing);
    if (io.KeyShift && enter_pressed()) return run_edit(context);
    if (typing) return;
    if (pressed(key::Escape) && !context.state.keyboard.escape_taken) escape(context);
    if (!io.KeyAlt && !io.KeySuper) plain_keys(context);
}

}  // namespace gse::ui
