// Files and recovery: opening, saving, recipes out of pictures, autosaves, and leaving a running edit.
#include "app/session/file_controller.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "app/engine_names.h"
#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/io/cameras/camera_json.h"
#include "engine/io/cameras/cameras.h"
#include "engine/io/image/image_file.h"
#include "engine/pipeline/models/installed.h"
#include "engine/pipeline/recipe/recipe.h"
#include "engine/pipeline/scene/scene_loading.h"
#include "engine/pipeline/scene/scene_tools.h"
#include "engine/scene/stack_edits.h"

namespace gse::app {
namespace {

namespace command = ui::command;

constexpr const char* FilesBusy = "Another file is being read or written; wait for it.";
constexpr int ThumbnailPx = 192;

}  // namespace

FileController::FileController(Workspace& workspace, const Parts& parts)
    : workspace_(workspace), parts_(parts), recovery_(workspace), project_(workspace), counter_(workspace),
      recent_(workspace) {
    recovery_.list();
}

// Opening

template <> void FileController::on(const command::Open& one) {
    open(one.path, {.activated = one.activated});
}

template <> void FileController::on(const command::OpenSample&) {
    open(assets_path() / "scenes/bear/scene.ply");
}

void FileController::open(const std::filesystem::path& path, const ReadingOptions& options) {
    if (workspace_.jobs->works()) return workspace_.notices.toast("Cancel the running job first.");
    const auto absolute = std::filesystem::absolute(path).lexically_normal();
    if (names_png(absolute)) return open_recipe(absolute);
    if (only_cameras(absolute)) return open_cameras(absolute);
    start_reading(fmt::format("Open {}", absolute.filename().string()), {absolute, {}, false, options});
}

template <> void FileController::on(const command::Recover& one) {
    if (workspace_.jobs->works()) return workspace_.notices.toast("Cancel the running job first.");
    start_reading("Recover", {one.project, {}, true});
}

template <> void FileController::on(const command::FindScene& one) {
    if (lost_.path.empty()) return;
    if (workspace_.jobs->works()) return workspace_.notices.toast("Cancel the running job first.");
    WorkToOpen work = lost_;
    work.scene = std::filesystem::absolute(one.path).lexically_normal();
    start_reading(fmt::format("Open {}", lost_view_.name), std::move(work));
}

template <> void FileController::on(const command::ForgetLostScene&) {
    lost_ = {};
    lost_view_ = {};
}

void FileController::start_reading(const std::string& title, WorkToOpen to_open) {
    auto opened = std::make_shared<OpenedWork>();
    auto work = [opened, to_open](const JobControl& control) { *opened = open_work(to_open, control); };
    auto done = [this, opened, to_open, recovers = to_open.recovers](const Error* error) {
        workspace_.jobs->reads_work = false;
        if (error != nullptr) recovery_.keep(false);  // what is open stays open
        if (error != nullptr) return workspace_.report_end(*error);
        if (opened->choices.size() > 1) return ask_which(opened->path, opened->choices);
        if (!opened->lost.empty()) return take_lost(to_open, *opened);
        const bool waits = opened->pending.has_value();
        take(std::move(*opened));
        if (recovers)
            workspace_.notices.toast(
                waits ? "The work is back, with the edit that was not applied. Save it to keep it."
                      : "The work of the last session is back. Save it to keep it.");
    };
    if (workspace_.jobs->files.start({title, work, done})) {
        workspace_.jobs->reads_work = true;
        return workspace_.notices.begin_reading();
    }
    if (!to_open.recovers) recovery_.keep(false);
    workspace_.notices.toast(FilesBusy);
}

/// A bar asks where the scene is now; what is open stays open.
void FileController::take_lost(const WorkToOpen& work, const OpenedWork& opened) {
    recovery_.keep(false);
    lost_ = work;
    const auto& project = opened.project_path;
    lost_view_ = {work.path.string(), project.empty() ? "unsaved work" : project.filename().string(),
                  opened.lost.string()};
}

void FileController::ask_which(const std::filesystem::path& folder,
                               const std::vector<std::filesystem::path>& files) {
    std::vector<AskedAnswer> answers;
    for (const auto& file : files) {
        std::error_code ignored;
        const double megabytes = static_cast<double>(std::filesystem::file_size(file, ignored)) / 1e6;
        answers.push_back({{file.filename().string(), fmt::format("{:.1f} MB", megabytes), false, true},
                           [this, file] { open(file); }});
    }
    answers.push_back({{"Cancel"}, [this] { recovery_.keep(false); }});
    workspace_.notices.ask("Which one is to be opened?",
                           fmt::format("{} holds several scenes.", folder.string()), std::move(answers));
}

void FileController::take(OpenedWork opened) {
    recovery_.let_go();
    forget_document();
    source_ = opened.data.source;
    embeds_ = opened.project && source_.path.empty();
    unknown_ = opened.data.unknown;
    workspace_.scene_path = source_.path.string();
    workspace_.project_path = opened.project_path.string();
    workspace_.document = Document(std::move(opened.state));
    const auto& state = workspace_.document.state();
    workspace_.variations.take(std::move(opened.data.variations));
    for (const auto& node : state.stack)
        workspace_.next_edit_id = std::max(workspace_.next_edit_id, node.id + 1);
    take_parts(std::move(opened.pending));
    counter_.take(state.current, opened.statistics);
    if (opened.project) parts_from_json(opened.data.ui);
    parts_.view.settle();
    if (!opened.recovered) recent_.add(opened.path, picture_of(state.current));
    const auto now = moment();
    using Moment = Recovery::Moment;
    const bool as_saved = !opened.recovered && !opened.found_elsewhere;
    const auto holds = as_saved ? std::optional(Moment{now.revision, 0, now.keys}) : std::nullopt;
    const bool alone = project_.begin(opened.project_path, holds);
    recovery_.begin(now, std::move(opened.recovered));
    if (!alone)
        project_.offer_copy([this](const auto& path) {
            run(ui::FileCommand(command::SaveProject{path, {}}));
        });
    for (const auto& note : opened.notes) {
        log::info("{}", note);
        workspace_.notices.toast(note);
    }
    if (!opened.project && state.info.looks_activated) offer_activated(opened.path);
}

/// Forgets all that belongs to the document that goes. Every state of a scene is reset here or in
/// take_parts().
void FileController::forget_document() {
    workspace_.take_document();
    on(command::ForgetLostScene{});
    kept_edit_ = {};
    leaving_.reset();
}

/// Each part forgets what belongs to the last document, and takes over the one that is open now.
void FileController::take_parts(std::optional<PendingResult> pending) {
    parts_.view.take_document();
    parts_.models.take_document();
    parts_.search.take_document();
    parts_.edits.take_document(std::move(pending));
    parts_.labels.take_document();
    parts_.exports.take_document();
}

/// Adds what to press to the warning that such a scene was read with.
void FileController::offer_activated(const std::filesystem::path& path) {
    workspace_.notices.toast(
        "A fog? Sizes or opacities of this scene may be stored as they are drawn.", false, "Read them so",
        [this, path, revision = workspace_.document.revision()] {
            if (workspace_.document.revision() == revision) return open(path, {.activated = true});
            workspace_.notices.toast("The scene was changed since: open it again first.");
        });
}

void FileController::open_recipe(const std::filesystem::path& picture) {
    auto& notices = workspace_.notices;
    try {
        const auto json = read_recipe_json(picture);
        const EditRecipe recipe = recipe_from_json(json, picture.parent_path());
        const bool here =
            !workspace_.document.empty() && std::filesystem::path(recipe.job.scene) == workspace_.scene_path;
        // As the command line takes --recipe, but for the files that are open already.
        parts_.search.set_request(recipe.request, !here);
        parts_.models.take_recipe(recipe);
        parts_.servers.mention(recipe.server);
        if (here && json.contains("camera")) parts_.view.look_from(camera_from_json(json["camera"]));
        notices.toast(here ? "The prompt, its settings and the camera come from the picture."
                           : "The prompt and its settings come from the picture; it shows another scene, so "
                             "the camera stays.");
    } catch (const Error& error) { notices.report(error); } catch (const nlohmann::json::exception&) {
        notices.report(Error(ErrorCode::Malformed, "the recipe in this picture cannot be read", "", picture));
    }
}

/// Cameras without a scene are those of the scene that is open.
void FileController::open_cameras(const std::filesystem::path& path) {
    if (workspace_.document.empty())
        return workspace_.notices.toast("These are cameras: open their scene first, then drop them on it.",
                                        true);
    auto found = std::make_shared<SceneCameras>();
    const auto& state = workspace_.document.state();
    auto work = [found, path, scene = PlacedScene{state.current, state.info.offset, workspace_.scene_path}](
                    const JobControl&) { *found = cameras_of_scene(scene, path.string()); };
    auto done = [this, found, opened = workspace_.opened,
                 name = path.filename().string()](const Error* error) {
        if (error != nullptr) return workspace_.notices.report(*error);
        if (opened == workspace_.opened)  // else another scene meanwhile
            take_cameras(name, std::move(found->views), found->notes);
    };
    if (!workspace_.jobs->files.start({fmt::format("Open {}", path.filename().string()), work, done}))
        workspace_.notices.toast(FilesBusy);
}

void FileController::take_cameras(const std::string& name, std::vector<View> views,
                                  const std::vector<std::string>& notes) {
    if (views.empty())
        return workspace_.notices.toast(
            notes.empty() ? "There are no cameras in " + name + "." : notes.back(), true);
    for (const auto& odd : notes) workspace_.notices.toast(odd);
    DocumentState state = workspace_.document.state();
    const std::string note = guess_up(state.info, views);
    state.views = std::move(views);
    workspace_.notices.toast(fmt::format("The scene has the {} cameras of {} now.{}{}", state.views.size(),
                                         name, note.empty() ? "" : " ", note));
    workspace_.document.apply("Load cameras", std::move(state));
}

void FileController::parts_from_json(const nlohmann::json& json) {
    try {  // a project of another version may miss any of these
        parts_.view.from_json(json);
        parts_.exports.from_json(json);
        parts_.search.from_json(json);
        parts_.models.from_json(json);
        if (json.contains("layout")) {
            workspace_.layout = json["layout"].get<std::string>();
            workspace_.layout_loaded = true;
        }
    } catch (const std::exception& error) {
        log::warning("some of the window's settings in the project cannot be used ({})", error.what());
    }
}

// Saving

/// Beside the scene; for the bundled one in the working folder.
std::filesystem::path FileController::default_project_path() const {
    const auto beside = std::filesystem::path(workspace_.scene_path).replace_extension(".gsep");
    const bool bundled = workspace_.scene_path.rfind(assets_path().string(), 0) == 0;
    return bundled ? std::filesystem::absolute("sample.gsep") : beside;
}

/// All of a project but the document's state.
std::shared_ptr<ProjectData> FileController::project_data() const {
    auto data = std::make_shared<ProjectData>();
    data->source = source_;
    data->embeds = embeds_;
    data->unknown = unknown_;
    data->variations = workspace_.variations.stored(workspace_.document.state().stack);
    parts_.view.to_json(data->ui);
    parts_.exports.to_json(data->ui);
    parts_.search.to_json(data->ui);
    parts_.models.to_json(data->ui);
    if (!workspace_.layout.empty()) data->ui["layout"] = workspace_.layout;
    return data;
}

template <> void FileController::on(const command::SaveProject& one) {
    if (!workspace_.require_scene()) return;
    auto target = one.path.empty() ? std::filesystem::path(workspace_.project_path)
                                   : std::filesystem::absolute(one.path);
    if (target.empty()) target = default_project_path();
    if (target.extension() != ".gsep") target += ".gsep";
    const auto data = project_data();
    data->state = workspace_.document.state();
    const auto now = moment();
    const bool first = target != std::filesystem::path(workspace_.project_path);
    project_.save(target, data, {now.revision, 0, now.keys}, [this, target, first, then = one.then] {
        if (first) tell_link(target);
        recovery_.outdate();  // what is still unsaved is written anew
        if (!unsaved()) recovery_.forget_recovered();
        recent_.add(target, thumbnail());
        if (then) then();
    });
}

/// Says once what the project does not hold, and offers to hold it.
void FileController::tell_link(const std::filesystem::path& project) {
    if (embeds_ || source_.path.empty()) return;
    workspace_.notices.toast(
        fmt::format("{} refers to {} and does not hold it: keep that file, or put the scene into the project "
                    "(about {} MB more).",
                    project.filename().string(), source_.path.filename().string(),
                    std::max<std::uint64_t>(1, source_.bytes / 1000000)),
        false, "Put it in", [this, opened = workspace_.opened] {
            if (opened == workspace_.opened) run(ui::FileCommand(command::EmbedScene{}));
        });
}

template <> void FileController::on(const command::EmbedScene& one) {
    if (!workspace_.require_scene()) return;
    embeds_ = one.on || source_.path.empty();  // without a file only the project has it
    if (!workspace_.project_path.empty()) run(ui::FileCommand(command::SaveProject{}));
}

template <> void FileController::on(const command::CancelFileJob&) { workspace_.jobs->files.cancel(); }

// Recovery

Recovery::Moment FileController::moment() const {
    return {workspace_.document.revision(), parts_.edits.kept_number(), parts_.exports.keys_number()};
}

bool FileController::unsaved() const {
    if (workspace_.document.empty()) return false;
    const auto now = moment();
    return now.live != 0 || !project_.holds(now);
}

/// Draws what the artist sees small, on the thread that calls it.
std::function<std::shared_ptr<const Image>()> FileController::thumbnail() const {
    if (const auto known = recovery_.thumbnail()) return [known] { return known; };
    const auto& drawn = parts_.view.drawn_set();
    return picture_of(drawn.empty() ? workspace_.document.state().current : drawn);
}

/// Draws other splats so, from where the artist looks.
std::function<std::shared_ptr<const Image>()> FileController::picture_of(const GaussianSet& set) const {
    const Camera& from = parts_.view.camera();
    if (from.width <= 0 || from.height <= 0) return [] { return std::shared_ptr<const Image>(); };
    const int height = std::clamp(ThumbnailPx * from.height / from.width, 16, ThumbnailPx);
    const auto& state = workspace_.document.state();
    raster::Settings settings;
    settings.background = parse_colour(parts_.view.settings().background);
    settings.antialiased = state.info.antialiased;
    return [set, settings, camera = from.resized(ThumbnailPx, height)] {
        Painter painter(1);
        return std::make_shared<const Image>(painter.paint(set.spans(), camera, settings).colour);
    };
}

void FileController::write_autosave(std::function<void()> then) {
    const auto data = project_data();
    const auto now = moment();
    const auto edit = now.live != 0 ? parts_.edits.kept_json() : kept_edit_;
    if (!edit.is_null()) data->jobs["edit"] = edit;
    recovery_.write(now, {data, parts_.edits.kept_state(), thumbnail()}, project_.writer(), std::move(then));
}

template <> void FileController::on(const command::LeaveEdit& one) {
    kept_edit_ = one.keep ? parts_.edits.kept_json() : nlohmann::json();
    leaving_ = {one.keep, one.then};
    if (workspace_.jobs->works()) workspace_.notices.toast("The edit is being stopped.");
    workspace_.jobs->work.cancel();
}

void FileController::leave_when_stopped() {
    if (!leaving_ || workspace_.jobs->works() || workspace_.jobs->saver.running()) return;
    workspace_.queue.run();  // what the edit left
    const Leaving leaving = *std::exchange(leaving_, std::nullopt);
    if (!leaving.keep) {
        parts_.edits.discard_result();
        return leaving.then();
    }
    recovery_.keep(true);
    if (unsaved() || !kept_edit_.is_null()) write_autosave(leaving.then);
    else leaving.then();
}

template <> void FileController::on(const command::DiscardRecovery& one) { recovery_.run(one); }

template <> void FileController::on(const command::PostponeRecovery& one) { recovery_.run(one); }

void FileController::shut_down(bool asked) {
    auto& jobs = *workspace_.jobs;
    const auto wait_for_saver = [&] {
        for (; jobs.saver.running(); workspace_.queue.run())
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        workspace_.queue.run();
    };
    parts_.edits.refresh();  // the newest snapshot
    wait_for_saver();
    // Nobody was asked when a signal ends the program: what is not saved stays.
    const bool unasked = !asked && workspace_.options.autosave && unsaved();
    if (unasked) write_autosave({}), wait_for_saver();
    if (unasked) recovery_.keep(true);
    if (!workspace_.document.empty()) recovery_.let_go();
    jobs.work.cancel();
    jobs.files.cancel();
}

// The scene

template <> void FileController::on(const command::SetUpAxis& one) {
    if (!workspace_.require_scene()) return;
    DocumentState state = workspace_.document.state();
    state.info.up = parse_up(one.up, state.info);
    state.info.up_unsure = false;
    state.info.up_known = true;  // the artist says so: no guess any more, and written with the scene
    workspace_.document.apply("Up axis", std::move(state));
    parts_.view.stand_up();
}

template <> void FileController::on(const command::RepairScene&) {
    if (!workspace_.require_scene()) return;
    const auto& state = workspace_.document.state();
    auto rows = usable_rows(state.current);
    for (auto& row : rows) row = row == 0 ? 1 : 0;
    EditNode node = removal_of(state, rows, workspace_.next_edit_id++);
    if (node.delta->removed.empty()) return workspace_.notices.toast("There is nothing to repair.");
    node.name = fmt::format("Repair: {} splats that cannot be drawn removed", node.delta->removed.size());
    parts_.labels.change_stack("Repair scene", [&](std::vector<EditNode>& stack) { stack.push_back(node); });
}

// Frames

void FileController::refresh() {
    auto& jobs = *workspace_.jobs;
    recent_.refresh();
    if (workspace_.document.empty()) {
        if (!jobs.files.running()) recovery_.see_start_page();
        recovery_.refresh();
    } else {
        if (!parts_.view.moving()) counter_.refresh();  // not at every step of a drag
        if (workspace_.options.autosave && !jobs.saver.running()) {
            if (!unsaved()) {
                if (recovery_.stale()) recovery_.discard();
            } else if (recovery_.due(moment())) {
                write_autosave({});
            }
        }
    }
    leave_when_stopped();
}

void FileController::show(ui::DocumentPart& model) const {
    const auto& document = workspace_.document;
    model.document = document.empty() ? nullptr : &document;
    model.statistics = counter_.statistics();
    model.opened = workspace_.opened;
    model.scene_path = workspace_.scene_path;
    model.project_path = workspace_.project_path;
    model.suggested_project = document.empty() ? std::string() : default_project_path().string();
    model.unsaved = unsaved();
    model.embeds = embeds_;
    model.linked = !source_.path.empty();
    model.lost = lost_view_;
    model.saved_at = project_.saved_at();
    recent_.show(model);
    recovery_.show(model);
}

void FileController::run(const ui::FileCommand& command) {
    std::visit([this](const auto& one) { on(one); }, command);
}

}  // namespace gse::app
