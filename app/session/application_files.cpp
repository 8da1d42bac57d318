// Opening, saving, autosave and recovery.
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>

#include "app/cli/engine_names.h"
#include "app/session/application.h"
#include "app/session/application_loaded.h"
#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/io/cameras/camera_json.h"
#include "engine/io/cameras/cameras.h"
#include "engine/io/files/user_files.h"
#include "engine/io/project/autosave.h"
#include "engine/io/project/project_file.h"
#include "engine/io/scene/scene_file.h"
#include "engine/pipeline/run/scene_loading.h"
#include "engine/pipeline/run/scene_tools.h"
#include "engine/scene/framing.h"
#include "engine/scene/stack_edits.h"
#include "engine/scene/viewpoints.h"

namespace gse::app {
namespace {

bool contains_word(const std::vector<std::string>& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

std::string clock_now() { return fmt::format("{:%H:%M}", fmt::localtime(std::time(nullptr))); }

/// What can be opened of a folder that is no scene by itself.
std::vector<std::filesystem::path> files_of_folder(const std::filesystem::path& folder) {
    auto files = scenes_in_folder(folder);
    if (files.empty()) return files;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.is_regular_file() && entry.path().extension() == ".gsep") files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

}  // namespace

void Application::open_recipe(const std::filesystem::path& picture) {
    try {
        const auto json = read_recipe_json(picture);
        const EditRecipe recipe = recipe_from_json(json, picture.parent_path());
        const bool here = !document_.empty() && std::filesystem::path(recipe.job.scene) == scene_path_;
        take_recipe(recipe);
        if (here && json.contains("camera"))
            set_camera(fitted(camera_from_json(json["camera"]), viewport_width_, viewport_height_));
        toast(here ? "The prompt, its settings and the camera come from the picture."
                   : "The prompt and its settings come from the picture; it shows another scene, so the "
                     "camera stays.");
    } catch (const Error& error) { report_error(error); } catch (const nlohmann::json::exception&) {
        report_error(Error(ErrorCode::Malformed, "the recipe in this picture cannot be read", "", picture));
    }
}

/// What the command line takes of --recipe, but for the files that are open already.
void Application::take_recipe(const EditRecipe& recipe) {
    set_request(recipe.request);
    auto& settings = model_.model_settings;
    settings.learn_scene = recipe.use_dreambooth;
    if (recipe.use_dreambooth) settings.learning = recipe.dreambooth;
    settings.guidance = recipe.guidance;
    settings.attention = recipe.attention;
    settings.device = recipe.job.device, settings.rasterizer = recipe.job.rasterizer,
    settings.precision = recipe.job.precision;
    settings.threads = recipe.job.threads, settings.front = recipe.job.front;
    if (recipe.job.model != model_path_ || recipe.job.lora != loras_)
        try_model(recipe.job.model, recipe.job.lora, false);
}

void Application::open(const std::filesystem::path& path) {
    if (work_.running()) return toast("Cancel the running job first.");
    const auto absolute = std::filesystem::absolute(path).lexically_normal();
    if (absolute.extension() == ".png") return open_recipe(absolute);
    if (only_cameras(absolute)) return open_cameras(absolute);
    auto loaded = std::make_shared<Loaded>();
    loaded->path = absolute;
    auto work = [loaded](const JobControl& control) {
        control.report("reading", 0, 0);
        if (!std::filesystem::exists(loaded->path))
            throw Error(ErrorCode::NotFound, "there is no such file", "check the name", loaded->path);
        if (std::filesystem::is_regular_file(loaded->path) && is_project_file(loaded->path)) {
            loaded->project = true;
            loaded->project_path = loaded->path;
            loaded->data = gse::load_project(loaded->path);
            loaded->state = loaded->data.state;
            loaded->notes = loaded->data.warnings;
        } else {
            if (std::filesystem::is_directory(loaded->path)) loaded->choices = files_of_folder(loaded->path);
            if (loaded->choices.size() > 1) return;
            if (loaded->choices.size() == 1) loaded->path = loaded->choices.front();
            auto [scene, views, notes] = load_scene_with_cameras(loaded->path);
            loaded->data.source = scene_source(loaded->path, scene.gaussians);
            loaded->notes = std::move(notes);
            loaded->state = initial_state(scene, std::move(views));
        }
        control.report("looking", 0, 0);
        loaded->statistics = compute_statistics(loaded->state.current);
    };
    auto done = [this, loaded](const Error* error) {
        if (error != nullptr) keep_ = false;  // what is open stays open
        if (error != nullptr) return error->code() == ErrorCode::Cancelled ? void() : report_error(*error);
        if (loaded->choices.size() > 1) return ask_which(loaded->path, loaded->choices);
        take_loaded(std::move(*loaded));
    };
    if (files_.start({fmt::format("Open {}", absolute.filename().string()), work, done})) return;
    keep_ = false;
    toast("Another file is being read or written; wait for it.");
}

/// Cameras without a scene are those of the scene that is open.
void Application::open_cameras(const std::filesystem::path& path) {
    if (document_.empty())
        return toast("These are cameras: open their scene first, then drop them on it.", true);
    auto found = std::make_shared<SceneCameras>();
    auto work = [found, path, set = document_.state().current, scene = scene_path_](const JobControl&) {
        *found = cameras_of_scene(set, scene, path.string());
    };
    auto done = [this, found, opened = opened_, name = path.filename().string()](const Error* error) {
        if (error != nullptr) return report_error(*error);
        if (opened != opened_) return;  // another scene meanwhile
        if (found->views.empty())
            return toast(
                found->notes.empty() ? "There are no cameras in " + name + "." : found->notes.front(), true);
        DocumentState state = document_.state();
        const std::string note = guess_up(state.info, found->views);
        state.views = std::move(found->views);
        toast(fmt::format("The scene has the {} cameras of {} now.{}{}", state.views.size(), name,
                          note.empty() ? "" : " ", note));
        document_.apply("Load cameras", std::move(state));
    };
    if (!files_.start({fmt::format("Open {}", path.filename().string()), work, done}))
        toast("Another file is being read or written; wait for it.");
}

void Application::ask_which(const std::filesystem::path& folder,
                            const std::vector<std::filesystem::path>& files) {
    std::vector<AskedAnswer> answers;
    for (const auto& file : files) {
        std::error_code ignored;
        const double megabytes = static_cast<double>(std::filesystem::file_size(file, ignored)) / 1e6;
        answers.push_back({{file.filename().string(), fmt::format("{:.1f} MB", megabytes), false, true},
                           [this, file] { open(file); }});
    }
    answers.push_back({{"Cancel"}, [this] { keep_ = false; }});
    ask("Which one is to be opened?", fmt::format("{} holds several scenes.", folder.string()),
        std::move(answers));
}

void Application::open_sample() { open(assets_path() / "scenes/bear/scene.ply"); }

void Application::take_loaded(Loaded loaded) {
    const bool recovered = loaded.recovered.has_value();
    let_go();
    ++opened_;
    kept_edit_ = {};
    job_.reset();
    searched_ = {};
    pending_.reset(std::move(loaded.pending));
    forget_snapshots();
    model_.attention.clear();
    const auto searches = std::exchange(model_.search, {}).number;
    model_.search.number = searches;
    model_.losses.clear();
    model_.snapshots.clear();
    model_.shown_snapshot = -1;
    attention_values_.reset();
    source_ = loaded.data.source;
    unknown_ = loaded.data.unknown;
    scene_path_ = source_.path.string();
    project_path_ = loaded.project_path.string();
    document_ = Document(std::move(loaded.state));
    show_hidden();
    compare_as_usual();
    drop_picked();
    if (pending_) pending_->before = document_.state().current;
    saved_revision_ = recovered ? ~std::uint64_t{0} : document_.revision();
    autosaved_revision_ = recovered ? ~std::uint64_t{0} : document_.revision();
    thumbnail_.reset();
    for (const auto& node : document_.state().stack) next_edit_id_ = std::max(next_edit_id_, node.id + 1);
    model_.statistics = loaded.statistics;
    counted_ = document_.state().current;
    const auto& info = document_.state().info;
    up_shown_ = info.up;
    model_.orbit = scene_orbit(Scene{document_.state().base, info, {}}, RenderParameters{});
    model_.framing = framing_bounds(document_.state().current);
    camera_ = {};
    document_seen_ = ~std::uint64_t{0};  // another document may be at the same revision
    reach_key_.clear();
    reach_choice_.reset();
    model_.camera_keys.clear();
    keys_unsaved_ = false;
    if (loaded.project) ui_from_json(loaded.data.ui);
    if (camera_.width == 0) go_home();
    ++camera_version_;
    ++content_;
    if (!recovered) add_recent(loaded.path);
    model_.recent.clear();
    for (const auto& path : load_recent()) model_.recent.push_back(path.string());
    recovered_ = std::move(loaded.recovered);
    refresh_recoverable();
    start_page_seen_ = true;
    for (const auto& note : loaded.notes) {
        log::info("{}", note);
        toast(note);
    }
}

nlohmann::json Application::ui_json() const {
    nlohmann::json json;
    json["view"] = fields_to_json(model_.view);
    json["exports"] = fields_to_json(model_.exports);
    json["request"] = fields_to_json(model_.request);
    json["model_settings"] = ui::model_settings_to_json(model_.model_settings);
    json["model"] = model_path_;
    json["loras"] = loras_;
    if (!layout_.empty()) json["layout"] = layout_;
    json["camera"] = camera_to_json(camera_);
    json["camera_keys"] = camera_keys_to_json(model_.camera_keys);
    return json;
}

void Application::ui_from_json(const nlohmann::json& json) {
    try {  // a project of another version may miss any of these
        if (json.contains("view")) fields_from_json(model_.view, json["view"]);
        if (json.contains("exports")) fields_from_json(model_.exports, json["exports"]);
        if (json.contains("request")) {
            edit::EditRequest request = model_.request;
            fields_from_json(request, json["request"]);
            set_request(request);
            refresh_words();
            // What an applied edit said already is no news, even if it was clicked once.
            if (contains_word(model_.said_words, model_.request.target)) model_.request.target.clear();
        }
        if (json.contains("model_settings"))
            model_.model_settings =
                ui::model_settings_from_json(json["model_settings"], model_.model_settings);
        if (json.contains("model"))
            try_model(json["model"].get<std::string>(), texts_of(json, "loras"), !json.contains("request"));
        if (json.contains("layout")) {
            layout_ = json["layout"].get<std::string>();
            layout_loaded_ = true;
        }
        if (json.contains("camera_keys")) model_.camera_keys = camera_keys_from_json(json["camera_keys"]);
        if (json.contains("camera")) camera_ = camera_from_json(json["camera"]);
    } catch (const std::exception& error) {
        log::warning("some of the window's settings in the project cannot be used ({})", error.what());
    }
}

/// Beside the scene; for the bundled one in the working folder.
std::filesystem::path Application::default_project_path() const {
    const auto beside = std::filesystem::path(scene_path_).replace_extension(".gsep");
    const bool bundled = scene_path_.rfind(assets_path().string(), 0) == 0;
    return bundled ? std::filesystem::absolute("sample.gsep") : beside;
}

void Application::save_project(const std::filesystem::path& path, std::function<void()> then) {
    if (!require_scene()) return;
    auto target = path.empty() ? std::filesystem::path(project_path_) : std::filesystem::absolute(path);
    if (target.empty()) target = default_project_path();
    if (target.extension() != ".gsep") target += ".gsep";
    auto data = std::make_shared<ProjectData>();
    data->state = document_.state();
    data->source = source_;
    data->ui = ui_json();
    data->unknown = unknown_;
    const auto revision = document_.revision();
    auto done = [this, target, revision, then](const Error* error) {
        if (error != nullptr) return report_error(*error);
        project_path_ = target.string();
        saved_revision_ = revision;
        keys_unsaved_ = false;
        model_.saved_at = fmt::format("saved {}{}", clock_now(), options_.autosave ? " (autosave on)" : "");
        autosaved_revision_ =
            ~std::uint64_t{0};  // what is still unsaved is written anew: the last one is older than this
        if (!unsaved() && recovered_) gse::discard(*recovered_), recovered_.reset();
        add_recent(target);
        model_.recent.clear();
        for (const auto& recent : load_recent()) model_.recent.push_back(recent.string());
        toast(fmt::format("Saved {}", target.filename().string()));
        if (then) then();
    };
    if (!files_.start({fmt::format("Save {}", target.filename().string()),
                       [this, data, target](const JobControl& control) {
                           control.report("saving", 0, 0);
                           writer_->save(target, *data);
                       },
                       done}))
        toast("Another file is being read or written; save again in a moment.");
}

void Application::set_up_axis(const std::string& up) {
    if (!require_scene()) return;
    DocumentState state = document_.state();
    state.info.up = parse_up(up, state.info);
    state.info.up_known = true;  // the artist says so: no guess any more, and written with the scene
    document_.apply("Up axis", std::move(state));
    stand_up();
}

/// Orbit and camera follow the up axis, which undo changes too.
void Application::stand_up() {
    up_shown_ = document_.state().info.up;
    model_.orbit = scene_orbit(Scene{document_.state().base, document_.state().info, {}}, RenderParameters{});
    go_home();
    ++camera_version_;
}

void Application::repair_scene() {
    if (!require_scene()) return;
    const auto& state = document_.state();
    auto rows = usable_rows(state.current);
    for (auto& row : rows) row = row == 0 ? 1 : 0;
    EditNode node = removal_of(state, rows, next_edit_id_++);
    if (node.delta->removed.empty()) return toast("There is nothing to repair.");
    node.name = fmt::format("Repair: {} splats that cannot be drawn removed", node.delta->removed.size());
    change_stack("Repair scene", [&](std::vector<EditNode>& stack) { stack.push_back(node); });
}

}  // namespace gse::app
