// The menu bar: all commands of the window with their keys, and reasons for those that are off.
#include "ui/frame/menu.h"

#include <fmt/format.h>

#include <algorithm>

#include "ui/commands/guarded.h"
#include "ui/keys/keyboard.h"
#include "ui/state/state.h"
#include "ui/widgets/controls.h"
#include "ui/widgets/tooltips.h"

namespace gse::ui {
namespace {

struct Item {
    const char* name;  // widget map
    const char* text;
    std::string keys = {};
    std::string why_off = {};
    bool checked = false;
};

bool item(Context& context, const Item& options) {
    const bool pressed =
        ImGui::MenuItem(options.text, options.keys.c_str(), options.checked, options.why_off.empty());
    note(context, options.name);
    tooltip(options.why_off);
    return pressed;
}

bool begin_menu(Context& context, const char* name) {
    const bool open = ImGui::BeginMenu(name);
    if (!open) open_menu_by_key(context, name);
    note(context, fmt::format("menu.{}", name));
    return open;
}

void file_menu(Context& context) {
    const std::string why = why_not_save(context);
    if (item(context, {"menu.open", "Open...", keys_of(context, Shortcut::Open)})) ask_open(context);
    if (item(context, {"menu.sample", "Open sample"})) open_sample(context);
    if (item(context, {"menu.put_in", "Put in a scene...", "", why_not_put_in(context)})) ask_put_in(context);
    if (ImGui::BeginMenu("Open recent", !context.model.recent.empty())) {
        const auto& pictures = context.model.recent_pictures;
        for (std::size_t index = 0; index < context.model.recent.size(); ++index) {
            const auto& path = context.model.recent[index];
            if (ImGui::MenuItem(shortened(path, context.em * 30).c_str())) open_path(context, path);
            if (index < pictures.size()) large_picture(context, pictures[index], path);
        }
        ImGui::EndMenu();
    }
    ImGui::Separator();
    if (item(context, {"menu.save", "Save project", keys_of(context, Shortcut::Save), why})) save(context);
    if (item(context, {"menu.save_as", "Save project as...", keys_of(context, Shortcut::SaveAs), why}))
        save_as(context);
    const auto& model = context.model;
    const std::string why_embed = !why.empty()                    ? why
                                  : !model.linked && model.embeds ? "Only the project holds this scene"
                                                                  : "";
    if (item(context, {"menu.embed", "Hold the scene in the project", "", why_embed, model.embeds}))
        context.emit(command::EmbedScene{!model.embeds});
    if (item(context, {"menu.export", "Export...", keys_of(context, Shortcut::Export), why}))
        show_panel(context.state, PanelId::Export);
    ImGui::Separator();
    if (item(context, {"menu.quit", "Quit", keys_of(context, Shortcut::Quit)})) quit(context);
}

void edit_menu(Context& context) {
    const Document* document = context.scene_open() ? context.model.document : nullptr;
    const auto names = document != nullptr ? document->names() : std::vector<std::string>();
    const auto named = [&](const char* what, std::size_t at, bool possible) {
        return possible && at < names.size() && !names[at].empty()
                   ? fmt::format("{} {}", what, shortened(names[at], context.em * 16))
                   : std::string(what);
    };
    const bool undo = document != nullptr && document->can_undo(),
               redo = document != nullptr && document->can_redo();
    const std::string undo_text = named("Undo", document != nullptr ? document->position() : 0, undo);
    const std::string redo_text = named("Redo", document != nullptr ? document->position() + 1 : 0, redo);
    if (item(context, {"menu.undo", undo_text.c_str(), keys_of(context, Shortcut::Undo),
                       undo ? "" : "There is nothing to undo"}))
        context.emit(command::Undo{});
    if (item(context, {"menu.redo", redo_text.c_str(), keys_of(context, Shortcut::Redo),
                       redo ? "" : "There is nothing to redo"}))
        context.emit(command::Redo{});
    ImGui::Separator();
    std::string why = why_not_label(context);
    if (why.empty() && label_count(context) == 0) why = "Nothing is labelled";
    if (item(context, {"menu.delete", "Delete labelled splats", keys_of(context, Shortcut::Delete), why}))
        context.emit(command::DeleteLabelledSplats{});
    if (item(context, {"menu.heal", "Delete and heal", keys_of(context, Shortcut::Heal), why}))
        context.emit(command::HealLabelledSplats{});
    if (item(context, {"menu.repair", "Drop what cannot be drawn", "",
                       document != nullptr ? "" : "Open a scene first"}))
        context.emit(command::RepairScene{});
    ImGui::Separator();
    if (item(context, {"menu.settings", "Settings"})) show_panel(context.state, PanelId::Settings);
}

void select_menu(Context& context) {
    const std::string open = why_not_save(context), label = why_not_label(context);
    const Tool tool = context.state.viewport.tool;
    if (item(context, {"menu.brush", "Brush", keys_of(context, Shortcut::Brush), open, tool == Tool::Brush}))
        set_tool(context, Tool::Brush);
    if (item(context, {"menu.rectangle", "Rectangle", keys_of(context, Shortcut::Rectangle), open,
                       tool == Tool::Rectangle}))
        set_tool(context, Tool::Rectangle);
    if (item(context, {"menu.lasso", "Lasso", keys_of(context, Shortcut::Lasso), open, tool == Tool::Lasso}))
        set_tool(context, Tool::Lasso);
    if (item(context,
             {"menu.cut_out", "Cut out", keys_of(context, Shortcut::CutOut), open, tool == Tool::CutOut}))
        set_tool(context, Tool::CutOut);
    if (item(context, {"menu.place", "Move, turn, resize", keys_of(context, Shortcut::Place), open,
                       tool == Tool::Place}))
        set_tool(context, Tool::Place);
    if (item(context, {"menu.heal_brush", "Heal brush", keys_of(context, Shortcut::HealBrush), open,
                       tool == Tool::Heal}))
        set_tool(context, Tool::Heal);
    if (item(context, {"menu.front", "Front only", keys_of(context, Shortcut::FrontOnly), "",
                       context.view.front_only})) {
        context.view.front_only = !context.view.front_only;
        context.view_changed = true;
    }
    ImGui::Separator();
    if (item(context, {"menu.grow", "Grow", "", label})) context.emit(command::GrowLabel{1});
    if (item(context, {"menu.shrink", "Shrink", "", label})) context.emit(command::GrowLabel{-1});
    if (item(context, {"menu.invert", "Invert", keys_of(context, Shortcut::Invert), label}))
        context.emit(command::InvertLabel{});
    if (item(context, {"menu.clear", "Clear", keys_of(context, Shortcut::Clear), label}))
        context.emit(command::ClearLabel{});
    ImGui::Separator();
    const std::string shown = why_not_hide(context);
    if (item(context, {"menu.hide_label", "Hide", keys_of(context, Shortcut::Hide), shown}))
        hide_label(context);
    if (item(context, {"menu.isolate", "Isolate", keys_of(context, Shortcut::Isolate), shown}))
        isolate_label(context);
    if (item(context, {"menu.show_hidden", "Show all", keys_of(context, Shortcut::ShowHidden),
                       context.model.hidden > 0 ? "" : "Nothing is hidden"}))
        context.emit(command::ShowHidden{});
    ImGui::Separator();
    if (item(context, {"menu.new_label", "New label", "", open})) add_label(context);
}

void flag(Context& context, const char* name, const char* text, bool& value, const std::string& keys = {}) {
    if (!item(context, {name, text, keys, "", value})) return;
    value = !value;
    context.view_changed = true;
}

void view_menu(Context& context) {
    const std::string why = why_not_save(context);
    if (ImGui::BeginMenu("Show")) {
        for (int mode = 0; mode < static_cast<int>(DisplayModeNames.size()); ++mode)
            if (ImGui::MenuItem(DisplayModeNames[static_cast<std::size_t>(mode)], nullptr,
                                context.view.mode == mode)) {
                context.view.mode = mode;
                context.view_changed = true;
            }
        ImGui::EndMenu();
    }
    if (ImGui::BeginMenu("Colour detail")) {
        for (int degree = 0; degree <= 3; ++degree)
            if (ImGui::MenuItem(fmt::format("SH degree {}", degree).c_str(), nullptr,
                                context.view.sh_degree == degree)) {
                context.view.sh_degree = degree;
                context.view_changed = true;
            }
        ImGui::EndMenu();
    }
    ImGui::Separator();
    if (item(context, {"menu.frame", "Frame what is labelled", "F", why})) frame_selection(context);
    if (item(context, {"menu.home", "Home", "Home", why})) go_home(context);
    if (item(context, {"menu.previous", "Previous view", "Left", why})) step_view(context, -1);
    if (item(context, {"menu.next", "Next view", "Right", why})) step_view(context, 1);
    if (item(context, {"menu.add_view", "Add this view", "", why})) context.emit(command::AddView{});
    ImGui::Separator();
    if (item(context, {"menu.wipe", "Wipe before and after", keys_of(context, Shortcut::Wipe), why,
                       context.model.comparison == Comparison::Wipe}))
        toggle_wipe(context);
    flag(context, "menu.tint", "Tint what is labelled", context.view.tint_labels,
         keys_of(context, Shortcut::Tint));
    flag(context, "menu.axes", "Axes", context.view.show_axes);
    flag(context, "menu.bounds", "Bounds", context.view.show_bounds);
    flag(context, "menu.cameras", "Cameras", context.view.show_views);
    flag(context, "menu.hud", "Numbers", context.view.show_hud);
}

void prompt_menu(Context& context) {
    const auto& job = context.model.job;
    const std::string why_waiting = context.model.result_waiting ? "" : "No finished edit waits";
    if (item(context, {"menu.locate", "Locate", keys_of(context, Shortcut::Locate), why_not_locate(context)}))
        run_locate(context);
    if (item(context, {"menu.edit", "Edit", "Shift + Enter", why_not_edit(context)})) run_edit(context);
    ImGui::Separator();
    if (item(context, {"menu.pause", job.paused ? "Resume" : "Pause", "",
                       job.running && job.can_pause ? "" : "Nothing runs that can be paused"}))
        context.emit(command::Pause{!job.paused});
    if (item(context, {"menu.cancel", "Cancel", "Esc", job.running ? "" : "Nothing runs"}))
        cancel_job(context);
    ImGui::Separator();
    if (item(context, {"menu.apply", "Apply the result", "", why_waiting}))
        context.emit(command::ApplyResult{});
    if (item(context, {"menu.discard", "Discard the result", "", why_waiting}))
        context.emit(command::DiscardResult{});
    if (item(context, {"menu.another", "Another result, with another seed", "", why_waiting}))
        context.emit(command::AnotherResult{});
    ImGui::Separator();
    if (item(context, {"menu.seed", "Another seed"})) roll_seed(context);
    if (item(context, {"menu.models", "Models"})) show_panel(context.state, PanelId::Models);
}

void render_menu(Context& context) {
    if (item(context, {"menu.screenshot", "Save screenshot", keys_of(context, Shortcut::Screenshot),
                       why_not_export(context, context.exports.picture_path)}))
        export_picture(context);
    if (item(context, {"menu.turntable", "Write turntable", keys_of(context, Shortcut::Turntable),
                       why_not_export(context, context.exports.film_path)}))
        context.emit(command::ExportTurntable{});
    if (item(context, {"menu.key", "Add a camera key", "", why_not_save(context)}))
        context.emit(command::AddCameraKey{});
    ImGui::Separator();
    if (item(context, {"menu.export_settings", "Sizes and files..."}))
        show_panel(context.state, PanelId::Export);
}

void window_menu(Context& context) {
    auto& layout = context.state.layout;
    for (std::size_t index = 0; index < PanelCount; ++index) {
        const auto panel = static_cast<PanelId>(index);
        const bool open = layout.place(panel).open;
        if (!item(context, {fmt::format("menu.panel.{}", PanelTable[index].name).c_str(),
                            PanelTable[index].name, "", "", open}))
            continue;
        if (open) layout.close(panel);
        else show_panel(context.state, panel);
    }
    ImGui::Separator();
    if (item(context,
             {"menu.hide", "Hide the panels", keys_of(context, Shortcut::Panels), "", layout.panels_hidden}))
        layout.panels_hidden = !layout.panels_hidden;
    if (item(context, {"menu.fullscreen", "Full screen", keys_of(context, Shortcut::Fullscreen)}))
        context.emit(command::ToggleFullscreen{});
    if (item(context, {"menu.larger", "Larger", "Ctrl + +"})) scale_ui(context, 1.1f);
    if (item(context, {"menu.smaller", "Smaller", "Ctrl + -"})) scale_ui(context, 1 / 1.1f);
    ImGui::Separator();
    if (item(context, {"menu.reset_layout", "Reset layout"})) {
        layout = Layout::standard();
        context.state.front_changed = {true, true, true};
    }
}

/// Name of the open document and whether it is saved, at the right end of the bar.
void draw_title(Context& context) {
    if (!context.scene_open()) return;
    const auto& model = context.model;
    const std::string& path = model.project_path.empty() ? model.scene_path : model.project_path;
    std::string name = path.empty() ? "untitled" : utf8_of(path_of(path).filename());
    if (model.unsaved) name += " *";
    const float room = ImGui::GetWindowContentRegionMax().x - ImGui::GetCursorPosX() - context.em * 2;
    std::string text = model.saved_at.empty() ? name : fmt::format("{}   {}", name, model.saved_at);
    if (ImGui::CalcTextSize(text.c_str()).x > room) text = shortened(name, room);
    if (room < context.em * 4) return;
    ImGui::SetCursorPosX(ImGui::GetWindowContentRegionMax().x - ImGui::CalcTextSize(text.c_str()).x -
                         context.em * 0.5f);
    ImGui::PushStyleColor(ImGuiCol_Text, model.unsaved ? palette::Text : palette::TextDim);
    plain_text(text);
    ImGui::PopStyleColor();
    note(context, "menu.title");
    tooltip(path);
}

}  // namespace

void draw_menu_bar(Context& context) {
    if (!ImGui::BeginMenuBar()) return;
    using Draw = void (*)(Context&);
    constexpr std::array<std::pair<const char*, Draw>, 7> Menus{{{"File", file_menu},
                                                                 {"Edit", edit_menu},
                                                                 {"Select", select_menu},
                                                                 {"View", view_menu},
                                                                 {"Prompt", prompt_menu},
                                                                 {"Render", render_menu},
                                                                 {"Window", window_menu}}};
    for (const auto& [name, draw] : Menus) {
        if (!begin_menu(context, name)) continue;
        draw(context);
        ImGui::EndMenu();
    }
    if (begin_menu(context, "Help")) {
        if (item(context, {"menu.guide", "Guide", "F1"})) context.emit(command::OpenGuide{});
        if (item(context, {"menu.keys", "Keys", "Shift + F1"})) context.state.help_open = true;
        if (item(context, {"menu.log", "Log"})) show_panel(context.state, PanelId::Log);
        if (item(context, {"menu.about", "About"})) context.state.about_open = true;
        ImGui::EndMenu();
    }
    draw_title(context);
    ImGui::EndMenuBar();
}

}  // namespace gse::ui
