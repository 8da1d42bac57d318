// Pictures, films, scenes and camera paths, all on the file thread.
#include <fmt/format.h>

#include <algorithm>

#include "app/cli/engine_names.h"
#include "app/session/application.h"
#include "engine/base/desktop.h"
#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/base/path_text.h"
#include "engine/io/cameras/camera_json.h"
#include "engine/io/cameras/cameras.h"
#include "engine/io/files/free_path.h"
#include "engine/io/image/image_file.h"
#include "engine/io/scene/scene_file.h"
#include "engine/pipeline/report/film.h"
#include "engine/pipeline/report/picture_text.h"
#include "engine/pipeline/run/scene_tools.h"
#include "engine/scene/viewpoints.h"

namespace gse::app {
namespace {

/// Relative names go beside the scene or project, where an artist looks for them.
std::filesystem::path place_for(const std::string& name, const std::string& project,
                                const std::string& scene) {
    const std::filesystem::path path(name);
    if (path.is_absolute()) return path;
    const auto base = std::filesystem::path(!project.empty() ? project : scene).parent_path();
    const bool bundled =
        base.string().rfind(assets_path().string(), 0) == 0;  // not a place for an artist's files
    return base.empty() || bundled ? std::filesystem::absolute(path) : base / path;
}

raster::Settings settings_of(const ui::ViewSettings& view, bool antialiased) {
    raster::Settings settings;
    settings.background = parse_colour(view.background);
    settings.antialiased = antialiased;
    settings.sh_degree = view.sh_degree;
    return settings;
}

}  // namespace

/// The first name of "shot.png", "shot-2.png", ... that is free: an export never writes over what is there.
std::filesystem::path Application::free_place(const std::string& name) const {
    return first_free(place_for(name, project_path_, scene_path_));
}

/// What is shown is written, which need not be what the document holds.
std::string Application::said_of_export() const {
    const int snapshot = model_.shown_snapshot;
    if (shows_snapshot() && (snapshot >= 0 || !pending_))
        return fmt::format(
            ", as the edit was at iteration {}: it is not applied",
            (snapshot >= 0 ? snapshots_[static_cast<std::size_t>(snapshot)] : snapshots_.back()).iteration);
    if (pending_) return ", with the edit that is not applied yet";
    if (model_.hidden == 0) return {};
    return model_.exports.visible_only
               ? ", without what is hidden"
               : fmt::format(", with the {} splats that are hidden in the window", model_.hidden);
}

void Application::start_export(const char* what, const std::filesystem::path& path,
                               std::function<void(const JobControl&)> work, const std::string& said,
                               bool can_pause) {
    auto done = [this, path, said](const Error* error) {
        if (error != nullptr) return error->code() == ErrorCode::Cancelled ? void() : report_error(*error);
        toast(fmt::format("Wrote {}{}", path.string(), said), false, "Show", [this, path] {
            try {
                show_folder_of(path);
            } catch (const Error& failure) { report_error(failure); }
        });
    };
    if (!files_.start(
            {fmt::format("{} {}", what, path.filename().string()), std::move(work), done, can_pause}))
        toast("Another file is being read or written; wait for it.");
}

void Application::set_exports(const ui::ExportSettings& settings) { model_.exports = settings; }

void Application::export_picture() {
    if (!something_to_export()) return;
    const auto exports = model_.exports;
    const auto path = free_place(exports.picture_path);
    auto settings = settings_of(model_.view, document_.state().info.antialiased);
    if (exports.transparent) settings.background = {0, 0, 0};
    const Camera camera = fitted(model_.camera, exports.width, exports.height);
    const auto recipe = current_recipe();
    auto recipe_json = recipe_to_json(recipe);
    recipe_json["camera"] = camera_to_json(model_.camera);
    auto work = [=, set = exported(set_on_screen())](const JobControl& control) {
        control.report("rendering", 0, 1);
        Painter painter;
        const auto& painted = painter.paint(set.spans(), camera, settings);
        control.report("writing", 1, 1);
        write_png(path, exports.transparent ? transparent_picture(painted) : painted.colour,
                  picture_text(recipe, recipe_json));
    };
    start_export("Screenshot", path, work, said_of_export());
}

void Application::export_turntable() {
    if (!something_to_export()) return;
    const auto& exports = model_.exports;
    const auto path = free_place(exports.film_path);
    auto film = std::make_shared<FilmRequest>();
    film->first = exported(set_on_screen());
    if (exports.before_after) {
        film->second = std::make_shared<const GaussianSet>(film->first);
        film->first = exported(before_on_screen());
    }
    film->settings = settings_of(model_.view, document_.state().info.antialiased);
    film->transparent = exports.transparent;
    film->fps = exports.fps;
    film->cameras = turn_cameras(export_orbit(), {exports.frames, exports.fps, exports.degrees, exports.ease},
                                 exports.start_degrees, exports.width, exports.height);
    start_export(
        "Turntable", path, [film, path](const JobControl& control) { write_film(path, *film, control); },
        said_of_export(), true);
}

void Application::export_scene() {
    if (!something_to_export()) return;
    const auto path = place_for(model_.exports.scene_path, project_path_, scene_path_),
               other = free_place(model_.exports.scene_path);
    if (path == other) return write_scene(path);
    std::error_code ignored;
    const bool own = std::filesystem::equivalent(path, scene_path_, ignored);
    std::vector<AskedAnswer> answers;
    answers.push_back(
        {{fmt::format("Write {}", other.filename().string())}, [this, other] { write_scene(other); }});
    if (!own) answers.push_back({{"Replace it", "", true}, [this, path] { write_scene(path); }});
    answers.push_back({{"Cancel"}, {}});
    ask("The file exists",
        own ? fmt::format("{} is the scene that is open, on which its edits build: it stays.",
                          path.filename().string())
            : fmt::format("There is a {} already. Replacing it cannot be undone.", path.filename().string()),
        std::move(answers));
}

void Application::write_scene(const std::filesystem::path& path) {
    auto scene = std::make_shared<Scene>();
    const GaussianSet shown = set_on_screen();
    scene->gaussians = exported(shown);
    scene->info = document_.state().info;
    auto label = std::make_shared<Label>();
    if (const NamedLabel* named = active_label(); named != nullptr && model_.exports.with_labels) {
        const bool all = scene->gaussians.shares_all_with(shown);
        const auto rest = [&](const auto& values) {
            const auto there = on_screen(values, shown);
            return there && !all
                       ? std::make_shared<const std::vector<float>>(seen_values(*there, hidden_rows(shown)))
                       : there;
        };
        const auto bits =
            rest(std::make_shared<const std::vector<float>>(named->bits->begin(), named->bits->end()));
        const auto weight = rest(named->weight);  // one made by hand has none
        if (bits)
            *label = {named->name, weight ? weight : bits,
                      std::make_shared<const std::vector<std::uint8_t>>(bits->begin(), bits->end())};
    }
    auto work = [=, choices = model_.exports.format_choices](const JobControl& control) {
        control.report("writing", 0, 0);
        SaveOptions save{.choices = choices};
        if (label->bits) save.from_label = label.get();
        save_scene(path, *scene, save);
    };
    start_export("Export", path, work, said_of_export());
}

void Application::export_viewpoints() {
    if (!require_scene()) return;
    if (document_.state().views.empty()) return toast("Add viewpoints first.");
    const auto path = free_place(model_.exports.viewpoints_path);
    start_export("Viewpoints", path,
                 [path, views = document_.state().views](const JobControl&) { save_cameras(path, views); },
                 {});
}

void Application::add_camera_key() {
    if (!require_scene()) return;
    constexpr double seconds_between = 2;
    const double time = model_.camera_keys.empty() ? 0 : model_.camera_keys.back().time + seconds_between;
    model_.camera_keys.push_back({time, model_.camera});
    note_keys();
}

void Application::delete_camera_key(std::size_t index) {
    if (index >= model_.camera_keys.size()) return;
    model_.camera_keys.erase(model_.camera_keys.begin() + static_cast<std::ptrdiff_t>(index));
    note_keys();
}

/// The path is part of the project: work to be saved.
void Application::note_keys() {
    keys_unsaved_ = true;
    autosaved_revision_ = ~std::uint64_t{0};
}

void Application::export_camera_path(bool as_film) {
    if (!something_to_export()) return;
    if (model_.camera_keys.empty()) return toast("Add cameras to the path first.");
    const auto& exports = model_.exports;
    const auto keys = model_.camera_keys;
    const auto path = free_place(as_film ? exports.film_path : exports.camera_path_path);
    auto film = std::make_shared<FilmRequest>();
    if (as_film) {
        film->first = exported(set_on_screen());
        film->settings = settings_of(model_.view, document_.state().info.antialiased);
        film->fps = exports.fps;
        film->cameras = path_cameras(keys, exports.fps, exports.width, exports.height);
    }
    auto work = [=](const JobControl& control) {
        if (as_film) write_film(path, *film, control);
        else save_camera_path(path, keys);
    };
    start_export("Camera path", path, work, as_film ? said_of_export() : std::string(), as_film);
}

}  // namespace gse::app
