// Exports: pictures, films, scenes, viewpoints and camera paths, all on the file thread.
#include "app/session/export_controller.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <utility>

#include "app/engine_names.h"
#include "app/session/shown_picture.h"
#include "app/session/state/json_values.h"
#include "engine/base/desktop.h"
#include "engine/base/error.h"
#include "engine/io/cameras/camera_json.h"
#include "engine/io/cameras/cameras.h"
#include "engine/io/files/free_path.h"
#include "engine/io/image/image_file.h"
#include "engine/io/scene/scene_file.h"
#include "engine/localize/focus.h"
#include "engine/pipeline/models/installed.h"
#include "engine/pipeline/report/film.h"
#include "engine/pipeline/report/picture_marks.h"
#include "engine/pipeline/report/picture_text.h"
#include "engine/pipeline/run/views.h"
#include "engine/pipeline/scene/scene_tools.h"
#include "engine/scene/origin/world_offset.h"
#include "engine/scene/row_values.h"
#include "engine/scene/viewpoints.h"
#include "ui/viewport/scene_lines.h"

namespace gse::app {
namespace {

namespace command = ui::command;

constexpr double RoomAroundLabel = 1.3;  // of the radius that just shows it

}  // namespace

// Places and settings

/// Relative names go beside the scene or project, where an artist looks for them.
std::filesystem::path ExportController::place_for(const std::string& name) const {
    const std::filesystem::path path(name);
    if (path.is_absolute()) return path;
    const auto& beside = workspace_.project_path.empty() ? workspace_.scene_path : workspace_.project_path;
    const auto base = std::filesystem::path(beside).parent_path();
    // Not a place for an artist's files.
    const bool bundled = base.string().rfind(assets_path().string(), 0) == 0;
    return base.empty() || bundled ? std::filesystem::absolute(path) : base / path;
}

/// The first name of "shot.png", "shot-2.png", ... that is free: an export never writes over what is there.
std::filesystem::path ExportController::free_place(const std::string& name) const {
    return first_free(place_for(name));
}

bool ExportController::something_to_export() {
    if (!workspace_.require_scene()) return false;
    if (!settings_.visible_only || view_.hidden().count() < workspace_.document.state().current.size())
        return true;
    workspace_.notices.toast(
        "Every splat is hidden: show some of them (Shift + H), or export what is hidden too.", true);
    return false;
}

/// Part of a set that an export writes: all of it unless the artist said otherwise.
GaussianSet ExportController::exported(const GaussianSet& set, const Stage& stage) const {
    if (!settings_.visible_only || !view_.hidden().any()) return set;
    return without_hidden(set, view_.hidden_rows(set, stage));
}

/// Columns of the scene's file for the rows that exported() gives.
ExtraColumns ExportController::exported_columns(const Stage& stage) const {
    const auto& state = workspace_.document.state();
    ExtraColumns columns = current_columns(state);
    if (columns.empty()) return columns;
    if (!stage.set.shares_all_with(state.current)) {
        auto places = stage.new_rows();
        if (places.size() != state.current.size()) places.assign(state.current.size(), -1);
        columns = gathered(columns, sources_of(places, stage.set.size()));
    }
    if (!settings_.visible_only || !view_.hidden().any()) return columns;
    auto seen = view_.hidden_rows(stage.set, stage);
    for (auto& row : seen) row = row == 0 ? 1 : 0;
    return filtered(columns, seen);
}

/// Tells that an export writes the shown splats, which may differ from the document's.
std::string ExportController::said_of_export() const {
    if (const auto said = edits_.said_of_stage(); !said.empty()) return said;
    if (!view_.hidden().any()) return {};
    return settings_.visible_only
               ? ", without what is hidden"
               : fmt::format(", with the {} splats that are hidden in the window", view_.hidden().count());
}

raster::Settings ExportController::render_settings() const {
    raster::Settings settings;
    settings.background = parse_colour(view_.settings().background);
    settings.antialiased = workspace_.document.state().info.antialiased;
    settings.sh_degree = view_.settings().sh_degree;
    return settings;
}

/// Orbit of a turntable of those splats: all of them are in every frame, or what is labelled.
OrbitParameters ExportController::orbit(const GaussianSet& shown) const {
    RenderParameters frame;
    frame.width = settings_.width, frame.height = settings_.height;
    frame.elevation = settings_.elevation_degrees;
    frame.fov = view_.orbit().fov_x / Degree;
    Scene scene;
    scene.gaussians = shown;
    scene.info = workspace_.document.state().info;
    OrbitParameters orbit = whole_orbit(scene, frame);
    const NamedLabel* label = workspace_.active_label();
    if (settings_.around_label && label != nullptr && label->bits) {
        const auto& bits = *label->bits;
        if (std::any_of(bits.begin(), bits.end(), [](auto bit) { return bit != 0; })) {
            orbit = localize::focus_orbit(workspace_.document.state().current, bits, orbit);
            orbit.radius *= RoomAroundLabel;
        }
    }
    orbit.radius *= settings_.radius_factor;
    return orbit;
}

void ExportController::start(const char* what, const std::filesystem::path& path,
                             std::function<void(const JobControl&)> work, const std::string& said,
                             bool can_pause) {
    auto& notices = workspace_.notices;
    auto done = [this, &notices, path, said](const Error* error) {
        if (error != nullptr) {
            if (error->code() != ErrorCode::Cancelled) notices.report(*error);
            return;
        }
        notices.toast(fmt::format("Wrote {}{}", path.string(), said), false, "Show", [&notices, path] {
            try {
                show_folder_of(path);
            } catch (const Error& failure) { notices.report(failure); }
        });
    };
    if (!workspace_.jobs->files.start(
            {fmt::format("{} {}", what, path.filename().string()), std::move(work), done, can_pause}))
        notices.toast("Another file is being read or written; wait for it.");
}

// Pictures and films

template <> void ExportController::on(const command::SetExports& one) { settings_ = one.settings; }

template <> void ExportController::on(const command::ExportPicture& one) {
    if (settings_.as_shown) return export_as_shown(one.em_px);
    if (!something_to_export()) return;
    const auto path = free_place(settings_.picture_path);
    auto settings = render_settings();
    const bool transparent = settings_.transparent;
    if (transparent) settings.background = {0, 0, 0};
    const Camera camera = fitted(view_.shown_camera(), settings_.width, settings_.height);
    const auto recipe = search_.recipe();
    auto recipe_json = recipe_to_json(recipe);
    recipe_json["camera"] = camera_to_json(view_.shown_camera());
    const Stage stage = edits_.stage();
    auto work = [=, set = exported(stage.set, stage)](const JobControl& control) {
        control.report("rendering", 0, 1);
        Painter painter;
        const auto& painted = painter.paint(set.spans(), camera, settings);
        control.report("writing", 1, 1);
        write_png(path, transparent ? transparent_picture(painted) : painted.colour,
                  picture_text(recipe, recipe_json));
    };
    start("Screenshot", path, work, said_of_export());
}

void ExportController::export_as_shown(float em_px) {
    PictureRequest request = view_.wanted();
    if (!workspace_.require_scene() || request.camera.width <= 0) return;
    const auto path = free_place(settings_.picture_path);
    request.transparent = settings_.transparent;
    const auto recipe = search_.recipe();
    auto recipe_json = recipe_to_json(recipe);
    recipe_json["camera"] = camera_to_json(view_.shown_camera());
    const auto& state = workspace_.document.state();
    auto work = [=, views = state.views, set = state.current,
                 radius = view_.orbit().radius](const JobControl& control) {
        control.report("rendering", 0, 1);
        Image picture = shown_picture(request);
        ui::ShownLines lines{request.camera, request.settings, {}, {}, views, radius, em_px};
        if (request.settings.show_bounds) {
            const auto statistics = compute_statistics(set);
            lines.low = statistics.robust_low, lines.high = statistics.robust_high;
        }
        draw_marks(picture, ui::marks_of(lines));
        control.report("writing", 1, 1);
        write_png(path, picture, picture_text(recipe, recipe_json));
    };
    const auto mode = static_cast<ui::DisplayMode>(request.settings.mode);
    const bool shapes = mode == ui::DisplayMode::Centres || mode == ui::DisplayMode::Rings ||
                        mode == ui::DisplayMode::Ellipsoids;
    start("Screenshot", path, work,
          shapes ? fmt::format(", with splats for {}", ui::DisplayModeNames[static_cast<std::size_t>(mode)])
                 : edits_.said_of_stage());
}

template <> void ExportController::on(const command::ExportTurntable&) {
    if (!something_to_export()) return;
    const auto path = free_place(settings_.film_path);
    const Stage stage = edits_.stage();
    auto film = std::make_shared<FilmRequest>();
    film->first = exported(stage.set, stage);
    if (settings_.before_after) {
        film->second = std::make_shared<const GaussianSet>(film->first);
        film->first = exported(view_.before_on_screen(stage), stage);
    }
    film->settings = render_settings();
    film->transparent = settings_.transparent;
    film->fps = settings_.fps;
    const auto around = orbit(film->first);
    const double seen_from = azimuth_of(view_.camera(), around) / Degree;
    film->cameras = turn_cameras(around, {settings_.frames, settings_.fps, settings_.degrees, settings_.ease},
                                 seen_from + settings_.start_degrees, settings_.width, settings_.height);
    start(
        "Turntable", path, [film, path](const JobControl& control) { write_film(path, *film, control); },
        said_of_export(), true);
}

// Scenes

template <> void ExportController::on(const command::ExportScene&) {
    if (!something_to_export()) return;
    const auto path = place_for(settings_.scene_path), other = free_place(settings_.scene_path);
    if (path == other) return write_scene(path);
    std::error_code ignored;
    const bool own = std::filesystem::equivalent(path, workspace_.scene_path, ignored);
    std::vector<AskedAnswer> answers;
    answers.push_back(
        {{fmt::format("Write {}", other.filename().string())}, [this, other] { write_scene(other); }});
    if (!own) answers.push_back({{"Replace it", "", true}, [this, path] { write_scene(path); }});
    answers.push_back({{"Cancel"}, {}});
    const auto name = path.filename().string();
    workspace_.notices.ask(
        "The file exists",
        own ? fmt::format("{} is the scene that is open, on which its edits build: it stays.", name)
            : fmt::format("There is a {} already. Replacing it cannot be undone.", name),
        std::move(answers));
}

void ExportController::write_scene(const std::filesystem::path& path) {
    auto scene = std::make_shared<Scene>();
    const Stage stage = edits_.stage();
    scene->gaussians = exported(stage.set, stage);
    scene->info = workspace_.document.state().info;
    scene->extra = exported_columns(stage);
    auto label = std::make_shared<Label>();
    if (const NamedLabel* named = workspace_.active_label(); named != nullptr && settings_.with_labels) {
        const bool all = scene->gaussians.shares_all_with(stage.set);
        const auto rest = [&](const RowValues& values) {
            const auto there = view_.on_screen(values, stage.set, stage);
            return there && !all ? std::make_shared<const std::vector<float>>(
                                       seen_values(*there, view_.hidden_rows(stage.set, stage)))
                                 : there;
        };
        const auto bits =
            rest(std::make_shared<const std::vector<float>>(named->bits->begin(), named->bits->end()));
        const auto weight = rest(named->weight);  // one made by hand has none
        if (bits)
            *label = {named->name, weight ? weight : bits,
                      std::make_shared<const std::vector<std::uint8_t>>(bits->begin(), bits->end())};
    }
    auto work = [=, choices = settings_.format_choices](const JobControl& control) {
        control.report("writing", 0, 0);
        SaveOptions save{.choices = choices};
        if (label->bits) save.from_label = label.get();
        save_scene(path, *scene, save);
    };
    start("Export", path, work, said_of_export());
}

template <> void ExportController::on(const command::ExportViewpoints&) {
    if (!workspace_.require_scene()) return;
    const auto& state = workspace_.document.state();
    if (state.views.empty()) return workspace_.notices.toast("Add viewpoints first.");
    const auto views = moved(state.views, state.info.offset);
    const auto path = free_place(settings_.viewpoints_path);
    start("Viewpoints", path, [path, views](const JobControl&) { save_cameras(path, views); }, {});
}

// Camera paths

template <> void ExportController::on(const command::AddCameraKey&) {
    if (!workspace_.require_scene()) return;
    constexpr double seconds_between = 2;
    keys_.push_back({keys_.empty() ? 0 : keys_.back().time + seconds_between, view_.shown_camera()});
    ++keys_number_;
}

template <> void ExportController::on(const command::DeleteCameraKey& one) {
    if (one.index >= keys_.size()) return;
    keys_.erase(keys_.begin() + static_cast<std::ptrdiff_t>(one.index));
    ++keys_number_;
}

template <> void ExportController::on(const command::ExportCameraPath& one) {
    if (!something_to_export()) return;
    if (keys_.empty()) return workspace_.notices.toast("Add cameras to the path first.");
    const bool as_film = one.as_film;
    const auto path = free_place(as_film ? settings_.film_path : settings_.camera_path_path);
    auto film = std::make_shared<FilmRequest>();
    if (as_film) {
        const Stage stage = edits_.stage();
        film->first = exported(stage.set, stage);
        film->settings = render_settings();
        film->fps = settings_.fps;
        film->cameras = path_cameras(keys_, settings_.fps, settings_.width, settings_.height);
    }
    const Vec3 offset = workspace_.document.state().info.offset;
    auto work = [=, keys = keys_](const JobControl& control) {
        if (as_film) write_film(path, *film, control);
        else save_camera_path(path, moved(keys, offset));
    };
    start("Camera path", path, work, as_film ? said_of_export() : std::string(), as_film);
}

// Frames and projects

void ExportController::refresh() {
    if (std::exchange(hidden_seen_, view_.hidden().number()) == view_.hidden().number()) return;
    if (!view_.hidden().any()) settings_.visible_only = false;  // a choice for what is hidden now
}

void ExportController::show(ui::ExportPart& model) const {
    model.exports = settings_;
    model.camera_keys = keys_;
}

void ExportController::take_document() {
    settings_ = for_another_scene(settings_);
    keys_.clear();
    hidden_seen_ = view_.hidden().number();
    ++keys_number_;
}

void ExportController::to_json(nlohmann::json& json) const {
    json["exports"] = fields_to_json(settings_);
    json["camera_keys"] = camera_keys_to_json(keys_);
}

void ExportController::from_json(const nlohmann::json& json) {
    if (json.contains("exports")) fields_from_json(settings_, json["exports"]);
    if (json.contains("camera_keys")) keys_ = camera_keys_from_json(json["camera_keys"]);
}

void ExportController::run(const ui::ExportCommand& command) {
    std::visit([this](const auto& one) { on(one); }, command);
}

}  // namespace gse::app
