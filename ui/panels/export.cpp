// Export: picture, turntable, camera path and scene. Says in words what will be written before it is.
#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>

#include "engine/io/cameras/cameras.h"
#include "engine/io/formats/scene_formats.h"
#include "ui/commands/guarded.h"
#include "ui/panels/panels.h"
#include "ui/state/state.h"
#include "ui/widgets/controls.h"
#include "ui/widgets/fields.h"
#include "ui/widgets/icons.h"

namespace gse::ui {
namespace {

struct Size {
    const char* name;
    int width, height;  // 0 = as the viewport
};
constexpr std::array<Size, 5> Sizes{
    {{"Current", 0, 0}, {"HD", 1920, 1080}, {"QHD", 2560, 1440}, {"4K", 3840, 2160}, {"Square", 1024, 1024}}};
constexpr double LargestPixels = 16384.0 * 8192.0;

/// One of the paths to write, with a button that asks for it.
void path_row(Context& context, const char* name, std::string ExportSettings::*member,
              std::vector<std::string> endings) {
    std::string& path = context.exports.*member;
    const float icon = context.em * 1.75f;
    ImGui::SetNextItemWidth(
        std::max(context.em * 4, ImGui::GetContentRegionAvail().x - icon - ImGui::GetStyle().ItemSpacing.x));
    context.exports_changed |=
        ImGui::InputTextWithHint(fmt::format("##{}", name).c_str(), "path of the file", &path);
    note(context, name);
    tooltip(path);
    ImGui::SameLine();
    if (!icon_button(context,
                     {.name = fmt::format("{}.browse", name), .icon = Icon::Folder, .tooltip = "Choose..."}))
        return;
    auto& commands = context.commands;
    const ExportSettings settings = context.exports;
    context.state.files.ask({.title = "Where to write",
                             .confirm = "Choose",
                             .extensions = std::move(endings),
                             .saves = true,
                             .replaces = false,
                             .folder_allowed = false,
                             .start = path,
                             .answer = [&commands, settings, member](const std::filesystem::path& chosen) {
                                 ExportSettings next = settings;
                                 next.*member = utf8_of(chosen);
                                 commands.push(command::SetExports{next});
                             }});
}

std::string endings_text(const std::vector<std::string>& endings) {
    std::string text;
    for (const auto& ending : endings) text += (text.empty() ? "" : ", ") + ending;
    return text;
}

/// Reason to be off: the scene, the path or its ending.
std::string why_not_write(const Context& context, const std::string& path,
                          const std::vector<std::string>& endings) {
    const std::string why = why_not_export(context, path);
    if (!why.empty() || has_extension(path, endings)) return why;
    return fmt::format("The name must end in {}", endings_text(endings));
}

/// Sentence about the coming file, or in amber why there is none. It takes the room of the longer one: while
/// a file is written, nothing below moves.
void say(const std::string& why, const std::string& what) {
    const float width = ImGui::GetContentRegionAvail().x, top = ImGui::GetCursorPosY();
    const auto height = [width](const std::string& text) {
        return ImGui::CalcTextSize(broken_at_spaces(text, width).c_str()).y + ImGui::GetStyle().ItemSpacing.y;
    };
    const float room = std::max(height(what), height(why));
    if (why.empty()) dim_text(what);
    else coloured_text(palette::Warning, why.ends_with('.') ? why : fmt::format("{}.", why));
    if (ImGui::GetCursorPosY() < top + room) ImGui::SetCursorPosY(top + room);
}

void draw_size(Context& context) {
    int chosen = -1;
    for (int at = 0; at < static_cast<int>(Sizes.size()); ++at) {
        const auto& size = Sizes[static_cast<std::size_t>(at)];
        const int width = size.width > 0 ? size.width : context.model.viewport_width;
        const int height = size.height > 0 ? size.height : context.model.viewport_height;
        if (chosen < 0 && context.exports.width == width && context.exports.height == height) chosen = at;
    }
    std::array<const char*, Sizes.size()> names{};
    for (std::size_t at = 0; at < Sizes.size(); ++at) names[at] = Sizes[at].name;
    if (segmented(context, "export.size", names, chosen)) {
        const auto& size = Sizes[static_cast<std::size_t>(chosen)];
        context.exports.width = size.width > 0 ? size.width : std::max(16, context.model.viewport_width);
        context.exports.height = size.height > 0 ? size.height : std::max(16, context.model.viewport_height);
        context.exports_changed = true;
    }
    row_label(context, "Pixels");
    const float width = (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x) * 0.5f;
    for (int* side : {&context.exports.width, &context.exports.height}) {
        const bool first = side == &context.exports.width;
        ImGui::SetNextItemWidth(width);
        if (ImGui::DragInt(first ? "##export.width" : "##export.height", side, 4, 16, 16384, "%d",
                           ImGuiSliderFlags_AlwaysClamp))
            context.exports_changed = true;
        note(context, first ? "export.width" : "export.height");
        if (first) ImGui::SameLine();
    }
}

/// "1280 x 720 pixels as the viewport shows them, with alpha".
std::string picture_words(const Context& context) {
    const bool shown = context.exports.as_shown;
    return fmt::format("{} x {} pixels{}{}", shown ? context.model.viewport_width : context.exports.width,
                       shown ? context.model.viewport_height : context.exports.height,
                       shown ? " as the viewport shows them" : "",
                       context.exports.transparent ? ", with alpha" : "");
}

void draw_picture(Context& context) {
    heading(context, "Screenshot");
    if (checkbox(context, "export.as_shown", "As the viewport shows it", context.exports.as_shown,
                 "Its size, crop, tint, display and comparison. Unticked, the scene alone in the size "
                 "below."))
        context.exports_changed = true;
    if (!context.exports.as_shown) draw_size(context);
    if (checkbox(context, "export.transparent", "Transparent background", context.exports.transparent))
        context.exports_changed = true;
    path_row(context, "export.picture_path", &ExportSettings::picture_path, {".png"});
    std::string why = why_not_write(context, context.exports.picture_path, {".png"});
    const double pixels = static_cast<double>(context.exports.width) * context.exports.height;
    if (why.empty() && !context.exports.as_shown && pixels > LargestPixels)
        why = "That many pixels cannot be written";
    say(why, fmt::format("Writes a PNG of {} with the recipe inside: opening it again brings back prompt, "
                         "seed and camera. Files that exist stay: the next name is numbered.",
                         picture_words(context)));
    if (button(context, {.name = "export.screenshot",
                         .text = "Save screenshot",
                         .why_off = why,
                         .tooltip = "F12",
                         .look = Look::Primary}))
        export_picture(context);
}

std::string film_text(const ExportSettings& settings) {
    const double seconds = settings.fps > 0 ? settings.frames / settings.fps : 0;
    const bool film = has_extension(settings.film_path, film_extensions());
    const std::string what = film ? "a film" : "a folder of PNG pictures";
    return fmt::format(
        "Writes {}: {} frames of {} x {}, {:.1f} s at {:g} frames a second, turning {:g} degrees around "
        "{}{}.",
        what, settings.frames, settings.before_after ? settings.width * 2 : settings.width, settings.height,
        seconds, settings.fps, settings.degrees, settings.around_label ? "what is labelled" : "the scene",
        settings.before_after ? ", before and after side by side" : "");
}

/// Reason to refuse a film's name. A film has a known ending; without an ending the name is a folder.
std::string why_not_film(const Context& context) {
    const std::string why = why_not_export(context, context.exports.film_path);
    if (!why.empty()) return why;
    const auto ending = utf8_of(path_of(context.exports.film_path).extension());
    if (ending.empty() || has_extension(ending, film_extensions())) return {};
    return fmt::format("\"{}\" is no film: end the name in {}, or in nothing for a folder of PNG pictures",
                       ending, endings_text(film_extensions()));
}

void draw_turntable(Context& context) {
    heading(context, "Turntable");
    if (context.exports.as_shown) draw_size(context);
    const auto wanted = [](const char* name, const char*) {
        for (const char* field : {"frames", "fps", "degrees", "start_degrees", "ease", "radius_factor",
                                  "elevation_degrees", "around_label", "before_after"})
            if (std::string_view(field) == name) return true;
        return false;
    };
    context.exports_changed |=
        field_rows(context, "export", context.exports, wanted, [](const char*, bool&) {});
    path_row(context, "export.film_path", &ExportSettings::film_path, film_extensions());
    const std::string why = why_not_film(context);
    say(why, film_text(context.exports));
    if (button(context, {.name = "export.turntable",
                         .text = "Write turntable",
                         .why_off = why,
                         .tooltip = "Shift + F12; works in the background",
                         .look = Look::Primary}))
        context.emit(command::ExportTurntable{});
}

void draw_camera_path(Context& context) {
    heading(context, "Camera path");
    const auto& keys = context.model.camera_keys;
    if (button(context, {.name = "export.key.add",
                         .text = "Add key",
                         .why_off = context.scene_open() ? "" : "Open a scene first",
                         .tooltip = "The present camera, two seconds after the last key"}))
        context.emit(command::AddCameraKey{});
    if (keys.empty()) dim_text("Keys are cameras the path goes through.");
    for (std::size_t at = 0; at < keys.size(); ++at) {
        ImGui::PushID(static_cast<int>(at));
        ImGui::AlignTextToFramePadding();
        ImGui::Text("Key %d   %.1f s", static_cast<int>(at) + 1, keys[at].time);
        ImGui::SameLine(ImGui::GetContentRegionAvail().x - context.em * 1.5f);
        if (icon_button(context, {.name = fmt::format("export.key.delete.{}", at),
                                  .icon = Icon::Trash,
                                  .tooltip = "Delete this key",
                                  .size_em = 1.5f}))
            context.emit(command::DeleteCameraKey{at});
        ImGui::PopID();
    }
    path_row(context, "export.camera_path_path", &ExportSettings::camera_path_path, {".json"});
    std::string why = why_not_write(context, context.exports.camera_path_path, {".json"});
    if (why.empty() && keys.empty()) why = "Add a key first";
    std::string why_film = why_not_film(context);
    if (why_film.empty() && keys.size() < 2) why_film = "A film needs two keys";
    if (button(context, {.name = "export.path", .text = "Save path", .why_off = why}))
        context.emit(command::ExportCameraPath{false});
    flow(button_width("Film along it"));
    if (button(context, {.name = "export.path.film",
                         .text = "Film along it",
                         .why_off = why_film,
                         .tooltip = "To the file of the turntable above"}))
        context.emit(command::ExportCameraPath{true});
}

/// The options of the format that the scene is written in.
void draw_format_options(Context& context, const io::SceneFormat& format) {
    for (const io::FormatOption& option : format.options) {
        std::vector<const char*> labels;
        for (const auto& value : option.values) labels.push_back(value.label.c_str());
        const int first = option.values.front().value;
        int& value = context.exports.format_choices[option.name];
        int chosen = std::clamp(value - first, 0, static_cast<int>(labels.size()) - 1);
        if (segmented(context, ("export." + option.name), labels, chosen)) {
            value = first + chosen;
            context.exports_changed = true;
        }
        dim_text(option.values[static_cast<std::size_t>(chosen)].note);
    }
}

/// Titles of the formats that can be written and for which `keeps` is true.
std::string titles_that_keep(bool io::SceneFormat::*keeps) {
    std::vector<std::string> titles;
    for (const io::SceneFormat& format : scene_formats())
        if (format.writable() && format.*keeps) titles.push_back(format.title);
    return in_words(titles, "or");
}

/// "PLY (.ply)"
std::string format_name(const io::SceneFormat& format) {
    const auto& ending = format.extensions.front();
    return format.title == ending ? format.title : fmt::format("{} ({})", format.title, ending);
}

/// Menu of the formats, each with what it keeps. The file's name follows.
void draw_formats(Context& context) {
    auto& path = context.exports.scene_path;
    const io::SceneFormat* now = format_written_to(path_of(path));
    row_label(context, "Format", "The file's name follows: its ending says the format.");
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
    const bool open = ImGui::BeginCombo("##export.format", now != nullptr ? format_name(*now).c_str() : "",
                                        ImGuiComboFlags_HeightLargest);
    note(context, "export.format");
    for (const io::SceneFormat& format : scene_formats()) {
        if (!open || !format.writable()) continue;
        const bool chosen = ImGui::Selectable(fmt::format("{}##{}", format_name(format), format.name).c_str(),
                                              &format == now);
        note(context, fmt::format("export.format.{}", format.name));
        ImGui::TextDisabled("    %s", kept_text(format).c_str());
        if (!chosen || &format == now) continue;
        path = utf8_of(with_ending(path_of(path), format));
        context.exports_changed = true;
    }
    if (open) ImGui::EndCombo();
    if (now == nullptr) return;
    dim_text(kept_text(*now));
    note(context, "export.kept");
}

void draw_scene_file(Context& context) {
    heading(context, "Scene");
    draw_formats(context);
    path_row(context, "export.scene_path", &ExportSettings::scene_path, writable_extensions());
    const io::SceneFormat* format = format_written_to(path_of(context.exports.scene_path));
    const bool exact = format != nullptr && format->exact;
    const bool labels = format != nullptr && format->keeps_labels;
    if (checkbox(context, "export.with_labels", "With the label as a column", context.exports.with_labels,
                 fmt::format("A float per splat; plain {} only",
                             titles_that_keep(&io::SceneFormat::keeps_labels))))
        context.exports_changed = true;
    if (format != nullptr) draw_format_options(context, *format);
    const std::string why = why_not_write(context, context.exports.scene_path, writable_extensions());
    std::string what = context.model.result_waiting ? "Writes the scene" : "Writes the edited scene";
    if (context.scene_open())
        what +=
            fmt::format("{}, {} splats", context.model.result_waiting ? " with the result that waits" : "",
                        count_text(context.model.result_waiting ? context.model.result_splats
                                                                : context.document().current.size()));
    if (!exact) what += fmt::format(". {} keeps every bit", titles_that_keep(&io::SceneFormat::exact));
    if (context.exports.with_labels && !labels) what += "; labels are left out";
    say(why, what + ".");
    if (button(context,
               {.name = "export.scene", .text = "Save scene", .why_off = why, .look = Look::Primary}))
        context.emit(command::ExportScene{});
}

/// The viewpoints of the project, for other programs.
void draw_viewpoints(Context& context) {
    heading(context, "Viewpoints");
    path_row(context, "export.viewpoints_path", &ExportSettings::viewpoints_path, {".json"});
    std::string why = why_not_write(context, context.exports.viewpoints_path, {".json"});
    const std::size_t count = context.scene_open() ? context.document().views.size() : 0;
    if (why.empty() && count == 0) why = "The scene has no viewpoints: add some in the Views panel";
    const bool nerfstudio = names_transforms(path_of(context.exports.viewpoints_path));
    say(why, fmt::format("Writes {} viewpoint{} as {}.", count, count == 1 ? "" : "s",
                         nerfstudio ? "nerfstudio's transforms.json"
                                    : "the cameras.json of 3DGS; a name that begins with transforms "
                                      "gives nerfstudio's form"));
    if (button(context, {.name = "export.viewpoints", .text = "Save viewpoints", .why_off = why}))
        context.emit(command::ExportViewpoints{});
}

}  // namespace

void draw_export_panel(Context& context) {
    if (context.model.hidden > 0 &&
        checkbox(context, "export.visible_only",
                 fmt::format("Leave out the {} hidden splats", count_text(context.model.hidden)),
                 context.exports.visible_only,
                 "Of everything that is written from here. Unticked, what is hidden is written too."))
        context.exports_changed = true;
    draw_picture(context);
    draw_turntable(context);
    draw_scene_file(context);
    draw_viewpoints(context);
    draw_camera_path(context);
}

}  // namespace gse::ui
