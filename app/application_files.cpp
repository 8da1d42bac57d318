// Opening, saving, autosave and recovery.
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>

#include "app/application.h"
#include "app/scene_tools.h"
#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/io/autosave.h"
#include "engine/io/cameras.h"
#include "engine/io/image_file.h"
#include "engine/io/project_file.h"
#include "engine/io/scene_io.h"
#include "engine/io/user_files.h"

namespace gse::app {
namespace {

constexpr double LeastVisibleShare = 0.05;   // cameras that see less of the splats belong to another world

std::string clock_now() { return fmt::format("{:%H:%M}", fmt::localtime(std::time(nullptr))); }

/// Up as the mean of the cameras' own (they stand upright more often than not); nothing when they disagree.
std::optional<Vec3> up_of_cameras(const std::vector<View>& views) {
    constexpr double least_agreement = 0.5;
    Vec3 sum;
    for (const auto& view : views)
        sum = sum + Vec3{-view.camera.rotation(1, 0), -view.camera.rotation(1, 1), -view.camera.rotation(1, 2)};
    const double share = length(sum) / static_cast<double>(std::max<std::size_t>(views.size(), 1));
    if (views.empty() || share < least_agreement) return std::nullopt;
    return normalized(sum);
}

}  // namespace

/// What the file thread read.
struct Application::Loaded {
    std::filesystem::path path;       // scene or project
    bool project = false;
    bool recovered = false;
    std::filesystem::path project_path;
    DocumentState state;
    ProjectData data;
    SceneStatistics statistics;
    std::vector<std::string> notes;
};

namespace {

/// Reads a scene with its cameras; what is odd is said in `notes`.
template <class Loaded>
void load_scene_into(Loaded& loaded) {
    Scene scene = load_scene(loaded.path);
    loaded.data.source = scene_source(loaded.path, scene.gaussians);
    std::vector<View> views;
    if (const auto cameras = find_cameras(loaded.path)) {
        try {
            views = load_cameras(*cameras);
            if (visible_share(views, scene.gaussians.position()) < LeastVisibleShare) {
                loaded.notes.push_back("The cameras found beside the scene look elsewhere; they are left out.");
                views.clear();
            }
        } catch (const Error& error) {
            loaded.notes.push_back(std::string("The cameras beside the scene cannot be used: ") + error.what());
        }
    }
    if (!scene.info.up_known)
        if (const auto up = up_of_cameras(views)) {
            scene.info.up = *up;
            loaded.notes.push_back(fmt::format("Up axis guessed from {} cameras; Scene > Up changes it.", views.size()));
        }
    for (const auto& warning : scene.info.warnings) loaded.notes.push_back(warning);
    loaded.state = initial_state(scene, std::move(views));
}

}  // namespace

void Application::open(const std::filesystem::path& path) {
    if (work_.running()) return toast("Cancel the running job first.");
    const auto absolute = std::filesystem::absolute(path).lexically_normal();
    if (absolute.extension() == ".png") {
        try {
            const auto text = read_png_text(absolute);
            const auto found = text.find("Recipe");
            if (found == text.end())
                throw Error(ErrorCode::InvalidArgument, "this picture carries no recipe", "drop a picture this program made", absolute);
            edit::EditRequest request;
            fields_from_json(request, nlohmann::ordered_json::parse(found->second).at("request"));
            set_request(request);
            toast("The prompt and its settings come from the picture.");
        } catch (const Error& error) {
            report_error(error);
        } catch (const nlohmann::json::exception&) {
            report_error(Error(ErrorCode::Malformed, "the recipe in this picture cannot be read", "", absolute));
        }
        return;
    }
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
            load_scene_into(*loaded);
        }
        control.report("looking", 0, 0);
        loaded->statistics = compute_statistics(loaded->state.current);
    };
    auto done = [this, loaded](const Error* error) {
        if (error != nullptr) return error->code() == ErrorCode::Cancelled ? void() : report_error(*error);
        take_loaded(std::move(*loaded));
    };
    if (!files_.start({fmt::format("Open {}", absolute.filename().string()), work, done}))
        toast("Another file is being read or written; wait for it.");
}

void Application::open_sample() { open(assets_path() / "scenes/bear/scene.ply"); }

void Application::recover(const std::string& project) {
    auto loaded = std::make_shared<Loaded>();
    loaded->path = project;
    auto work = [loaded](const JobControl& control) {
        control.report("recovering", 0, 0);
        loaded->project = loaded->recovered = true;
        loaded->data = gse::load_project(loaded->path);
        loaded->state = loaded->data.state;
        loaded->notes = loaded->data.warnings;
        loaded->statistics = compute_statistics(loaded->state.current);
        for (const auto& found : find_recoverable())
            if (found.file == loaded->path) loaded->project_path = found.project;
    };
    auto done = [this, loaded](const Error* error) {
        if (error != nullptr) return report_error(*error);
        take_loaded(std::move(*loaded));
        for (const auto& found : find_recoverable())   // from here on the own autosave holds it
            if (found.file == loaded->path) {
                autosave_if_due();
                recovered_ = found;
            }
        toast("The work of the last session is back. Save it to keep it.");
    };
    files_.start({"Recover", work, done});
}

void Application::discard_recovery(const std::string& project) {
    for (const auto& found : find_recoverable())
        if (found.file == project) gse::discard(found);
    std::erase(model_.recoverable, project);
}

void Application::take_loaded(Loaded loaded) {
    job_.reset();
    pending_.reset();
    snapshots_.clear();
    model_.attention.clear();
    model_.losses.clear();
    model_.snapshots.clear();
    model_.shown_snapshot = -1;
    attention_values_.reset();
    source_ = loaded.data.source;
    unknown_ = loaded.data.unknown;
    scene_path_ = source_.path.string();
    project_path_ = loaded.project_path.string();
    document_ = Document(std::move(loaded.state));
    saved_revision_ = loaded.recovered ? ~std::uint64_t{0} : document_.revision();
    autosaved_revision_ = loaded.recovered ? ~std::uint64_t{0} : document_.revision();
    autosave_->discard();
    for (const auto& node : document_.state().stack) next_edit_id_ = std::max(next_edit_id_, node.id + 1);
    model_.statistics = loaded.statistics;
    const auto& info = document_.state().info;
    RenderParameters home;
    model_.orbit = scene_orbit(Scene{document_.state().base, info, {}}, home);
    camera_ = {};
    if (loaded.project) ui_from_json(loaded.data.ui);
    if (camera_.width == 0) camera_ = orbit_camera(model_.orbit, 0.5, std::max(viewport_width_, 64), std::max(viewport_height_, 64));
    ++camera_version_;
    ++content_;
    if (!loaded.recovered) add_recent(loaded.path);
    model_.recent.clear();
    for (const auto& path : load_recent()) model_.recent.push_back(path.string());
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
    json["model_settings"] = fields_to_json(model_.model_settings);
    json["model"] = model_path_;
    if (!layout_.empty()) json["layout"] = layout_;
    const auto rotation = camera_.rotation;
    json["camera"] = {{"fx", camera_.fx}, {"fy", camera_.fy}, {"width", camera_.width}, {"height", camera_.height}};
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) json["camera"]["rotation"].push_back(rotation(r, c));
    json["camera"]["translation"] = {camera_.translation.x, camera_.translation.y, camera_.translation.z};
    return json;
}

void Application::ui_from_json(const nlohmann::json& json) {
    try {   // a project of another version may miss any of these
        if (json.contains("view")) fields_from_json(model_.view, json["view"]);
        if (json.contains("exports")) fields_from_json(model_.exports, json["exports"]);
        if (json.contains("request")) fields_from_json(model_.request, json["request"]);
        if (json.contains("model_settings")) fields_from_json(model_.model_settings, json["model_settings"]);
        if (json.contains("model")) choose_model(json["model"].get<std::string>());
        if (json.contains("layout")) {
            layout_ = json["layout"].get<std::string>();
            layout_loaded_ = true;
        }
        if (!json.contains("camera")) return;
        const auto& from = json["camera"];
        Camera camera;
        camera.width = from.at("width").get<int>();
        camera.height = from.at("height").get<int>();
        camera.fx = from.at("fx").get<double>();
        camera.fy = from.at("fy").get<double>();
        camera.cx = camera.width / 2.0;
        camera.cy = camera.height / 2.0;
        for (int i = 0; i < 9; ++i) camera.rotation(i / 3, i % 3) = from.at("rotation").at(static_cast<std::size_t>(i)).get<double>();
        camera.translation = {from.at("translation").at(0).get<double>(), from.at("translation").at(1).get<double>(),
                              from.at("translation").at(2).get<double>()};
        const bool sane = camera.width > 0 && camera.height > 0 && camera.width < 65536 && camera.height < 65536 &&
                          camera.fx > 0 && camera.fy > 0 && std::isfinite(length(camera.centre()));
        if (sane) camera_ = camera;
    } catch (const std::exception& error) {
        log::warning("some of the window's settings in the project cannot be used ({})", error.what());
    }
}

std::function<DocumentState()> Application::state_with_live_edit() const {
    const DocumentState state = document_.state();
    if (!pending_ && !(work_.running() && !snapshots_.empty())) return [state] { return state; };
    const GaussianSet after = pending_ ? pending_->set : *snapshots_.back().set;
    const auto rows = pending_ ? pending_->base_to_new : snapshots_.back().base_to_new;
    const std::string name = pending_ ? pending_->name
                                      : fmt::format("{} (interrupted at iteration {})", model_.request.prompt,
                                                    snapshots_.back().iteration);
    return [state, after, rows, name, id = next_edit_id_] {
        if (rows->size() != state.current.size()) return state;
        EditNode node;
        node.id = id;
        node.name = name;
        node.delta = std::make_shared<const SceneDelta>(make_delta(state.current, *state.row_ids, after, *rows, id));
        auto stack = state.stack;
        stack.push_back(std::move(node));
        return with_stack(state, std::move(stack));
    };
}

void Application::autosave_if_due() {
    if (!options_.autosave || document_.empty() || saver_.running()) return;
    const bool changed = document_.revision() != autosaved_revision_ || content_live() != autosaved_live_;
    const double since = std::chrono::duration<double>(Clock::now() - last_autosave_).count();
    if (!changed || since < options_.autosave_seconds) return;
    if (document_.revision() == saved_revision_ && content_live() == 0) return;
    last_autosave_ = Clock::now();
    autosaved_revision_ = document_.revision();
    autosaved_live_ = content_live();
    auto data = std::make_shared<ProjectData>();
    data->source = source_;
    data->ui = ui_json();
    data->unknown = unknown_;
    saver_.start({"Autosave",
                  [this, data, state = state_with_live_edit(), project = project_path_](const JobControl&) {
                      data->state = state();   // here, not on the main thread: a large edit takes a while
                      autosave_->write(*data, project, *writer_);
                  },
                  [this](const Error* error) {
                      if (error != nullptr) return report_error(*error);
                      if (recovered_) gse::discard(*recovered_), recovered_.reset();
                  }});
}

/// Beside the scene; for the bundled one in the working folder.
std::filesystem::path Application::default_project_path() const {
    const auto beside = std::filesystem::path(scene_path_).replace_extension(".gsep");
    const bool bundled = scene_path_.rfind(assets_path().string(), 0) == 0;
    return bundled ? std::filesystem::absolute("sample.gsep") : beside;
}

void Application::save_project(const std::filesystem::path& path) {
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
    auto done = [this, target, revision](const Error* error) {
        if (error != nullptr) return report_error(*error);
        project_path_ = target.string();
        saved_revision_ = revision;
        model_.saved_at = fmt::format("saved {}{}", clock_now(), options_.autosave ? " (autosave on)" : "");
        if (document_.revision() == revision && !saver_.running()) autosave_->discard();
        if (recovered_) gse::discard(*recovered_), recovered_.reset();
        add_recent(target);
        model_.recent.clear();
        for (const auto& recent : load_recent()) model_.recent.push_back(recent.string());
        toast(fmt::format("Saved {}", target.filename().string()));
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
    document_.apply("Up axis", std::move(state));
    RenderParameters home;
    model_.orbit = scene_orbit(Scene{document_.state().base, document_.state().info, {}}, home);
    camera_ = orbit_camera(model_.orbit, 0.5, std::max(viewport_width_, 64), std::max(viewport_height_, 64));
    ++camera_version_;
}

void Application::repair_scene() {
    if (!require_scene()) return;
    const auto& state = document_.state();
    const auto kept = usable_rows(state.current);
    SceneDelta delta;
    for (std::size_t row = 0; row < kept.size(); ++row)
        if (kept[row] == 0) delta.removed.push_back((*state.row_ids)[row]);
    if (delta.removed.empty()) return toast("There is nothing to repair.");
    std::sort(delta.removed.begin(), delta.removed.end());
    delta.changed_rows.sh_degree = delta.added_rows.sh_degree = state.current.sh_degree();
    EditNode node;
    node.id = next_edit_id_++;
    node.name = fmt::format("Repair: {} splats that cannot be drawn removed", delta.removed.size());
    node.delta = std::make_shared<const SceneDelta>(std::move(delta));
    change_stack("Repair scene", [&](std::vector<EditNode>& stack) { stack.push_back(node); });
    model_.statistics = compute_statistics(document_.state().current);
}

}  // namespace gse::app
