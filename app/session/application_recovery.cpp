// Nothing is lost: autosave, what is kept when the window closes in the middle of an edit, and having it
// back.
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <thread>

#include "app/cli/engine_names.h"
#include "app/session/application.h"
#include "app/session/application_loaded.h"
#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/io/project/autosave.h"
#include "engine/io/project/project_file.h"
#include "engine/pipeline/run/scene_tools.h"

namespace gse::app {
namespace {

constexpr double ThumbnailSeconds = 30;  // a picture of the scene is drawn anew this often at most
constexpr int ThumbnailPx = 192;
constexpr std::uint64_t WaitingEdit = std::uint64_t{1} << 63, RunningEdit = std::uint64_t{1} << 62;

std::string moment_text(std::int64_t seconds) {
    const std::time_t moment = seconds, now = std::time(nullptr);
    const std::tm then = fmt::localtime(moment), today = fmt::localtime(now);
    const bool same_day = then.tm_year == today.tm_year && then.tm_yday == today.tm_yday;
    return same_day ? fmt::format("today {:%H:%M}", then) : fmt::format("{:%d %B, %H:%M}", then);
}

bool same_file(const std::filesystem::path& a, const std::filesystem::path& b) {
    std::error_code ignored;
    return !a.empty() && !b.empty() && (a == b || std::filesystem::equivalent(a, b, ignored));
}

std::string running_text(const nlohmann::json& edit) {
    const auto name = edit.value("name", "");
    const int iteration = edit.value("iteration", -1), iterations = edit.value("iterations", 0);
    if (edit.value("waits", false))
        return iteration >= 0 && iteration + 1 < iterations
                   ? fmt::format("The edit \"{}\", stopped at iteration {} of {}, was not applied yet.", name,
                                 iteration, iterations)
                   : fmt::format("The edit \"{}\" was not applied yet.", name);
    if (iteration < 0) return fmt::format("The edit \"{}\" had just begun.", name);
    return fmt::format("The edit \"{}\" was running, at iteration {} of {}.", name, iteration, iterations);
}

ui::RecoveryView view_of(const Recoverable& found) {
    ui::RecoveryView view;
    const auto& place = found.project.empty() ? found.scene : found.project;
    view.file = found.file.string();
    view.name = place.empty() ? "a scene" : place.filename().string();
    view.place = place.string();
    view.facts = moment_text(found.saved_at);
    try {
        const ProjectSummary summary = read_project_summary(found.file);
        view.thumbnail = summary.thumbnail;
        std::size_t edits = summary.stack.size();
        if (const auto edit = summary.jobs.find("edit"); edit != summary.jobs.end()) {
            view.running = running_text(*edit);
            if (!summary.stack.empty() && edit->value("id", std::uint64_t{0}) == summary.stack.back().id)
                --edits;
        }
        view.facts += fmt::format(", {} splats", summary.splats);
        if (edits > 0) view.facts += fmt::format(", {} edit{}", edits, edits == 1 ? "" : "s");
        if (!summary.scene_found)
            view.running += (view.running.empty() ? "" : " ") + std::string("Its scene file is gone.");
    } catch (const std::exception& error) {
        log::warning("an autosave cannot be looked at: {}", error.what());
    }
    return view;
}

}  // namespace

bool Application::unsaved() const {
    return !document_.empty() &&
           (document_.revision() != saved_revision_ || keys_unsaved_ || content_live() != 0);
}

std::uint64_t Application::content_live() const {
    if (pending_.kept() != nullptr) return WaitingEdit | content_;
    if (!edit_running()) return 0;
    return RunningEdit | static_cast<std::uint64_t>(snapshots_.empty() ? 0 : snapshots_.back().iteration + 1);
}

nlohmann::json Application::edit_json() const {
    if (content_live() == 0) return {};
    nlohmann::json json;
    const auto* whole = pending_.kept();  // also while another edit runs
    json["waits"] = whole != nullptr;
    json["name"] = whole ? whole->name : live_->name;
    json["target"] = whole ? whole->target : live_->target;
    if (whole) json["seed"] = whole->seed;
    json["iterations"] = live_->iterations;
    json["id"] = whole || !snapshots_.empty() ? next_edit_id_ : 0;
    if (!model_.losses.empty()) json["iteration"] = model_.losses.back().iteration;
    const std::lock_guard lock(live_->mutex);
    json["adds"] = whole ? whole->adds : live_->adds;
    const auto& renamed = whole ? whole->renamed : live_->renamed;
    json["source"] = renamed.from, json["becomes"] = renamed.to;
    return json;
}

std::function<DocumentState()> Application::state_with_live_edit() const {
    const DocumentState state = document_.state();
    const auto* whole = pending_.kept();
    if (!whole && (!edit_running() || snapshots_.empty())) return [state] { return state; };
    GaussianSet after;
    std::shared_ptr<const std::vector<std::int64_t>> rows;
    std::optional<edit::EditSnapshot> snapshot;  // what waits to be applied goes before what ran
    if (whole) after = whole->set, rows = whole->base_to_new;
    else snapshot = snapshots_.back();
    if (snapshot && newest_set_.of == snapshot->rows) after = newest_set_.set;
    EditNode node = whole ? node_of(*whole) : EditNode{};
    node.id = next_edit_id_;
    if (!whole) {
        node.name = fmt::format("{} (interrupted at iteration {})", live_->name, snapshots_.back().iteration);
        node.recipe = live_->recipe;
    }
    return [state, after, rows, snapshot, node]() mutable {
        if (snapshot) {
            if (after.empty()) after = snapshot->materialise();
            rows = std::make_shared<const std::vector<std::int64_t>>(snapshot->base_to_new());
        }
        if (rows->size() != state.current.size()) return state;
        node.delta = std::make_shared<const SceneDelta>(
            make_delta(state.current, *state.row_ids, after, *rows, node.id));
        auto stack = state.stack;
        stack.push_back(node);
        return with_stack(state, std::move(stack));
    };
}

/// Draws what the artist sees small, on the thread that calls it.
std::function<std::shared_ptr<const Image>()> Application::thumbnail() const {
    const double age = std::chrono::duration<double>(Clock::now() - thumbnail_made_).count();
    if (thumbnail_ && age < ThumbnailSeconds) return [picture = thumbnail_] { return picture; };
    const Camera& from = camera_;
    if (from.width <= 0 || from.height <= 0) return [] { return std::shared_ptr<const Image>(); };
    const int height = std::clamp(ThumbnailPx * from.height / from.width, 16, ThumbnailPx);
    raster::Settings settings;
    settings.background = parse_colour(model_.view.background);
    settings.antialiased = document_.state().info.antialiased;
    return [set = shown_set_.empty() ? document_.state().current : shown_set_, settings,
            camera = from.resized(ThumbnailPx, height)] {
        Painter painter(1);
        return std::make_shared<const Image>(painter.paint(set.spans(), camera, settings).colour);
    };
}

void Application::write_autosave(std::function<void()> then) {
    last_autosave_ = Clock::now();
    autosaved_revision_ = document_.revision();
    autosaved_live_ = content_live();
    autosaved_ = true;
    auto data = std::make_shared<ProjectData>();
    data->source = source_;
    data->ui = ui_json();
    data->unknown = unknown_;
    const auto edit = content_live() != 0 ? edit_json() : kept_edit_;
    if (!edit.is_null()) data->jobs["edit"] = edit;
    saver_.start({"Autosave",
                  [this, data, state = state_with_live_edit(), picture = thumbnail(),
                   project = project_path_](const JobControl&) {
                      data->state = state();  // here, not on the main thread: a large edit takes a while
                      data->thumbnail = picture();
                      autosave_->write(*data, project, *writer_);
                  },
                  [this, data, then, opened = opened_](const Error* error) {
                      if (opened != opened_) return autosave_->discard();  // of a document that is gone
                      if (error != nullptr) return report_error(*error);
                      if (data->thumbnail != thumbnail_)
                          thumbnail_ = data->thumbnail, thumbnail_made_ = Clock::now();
                      if (recovered_) gse::discard(*recovered_), recovered_.reset();
                      if (then) then();
                  }});
}

void Application::autosave_if_due() {
    if (!options_.autosave || document_.empty() || saver_.running()) return;
    if (!unsaved()) {
        if (autosaved_ && !keep_) discard_autosave();
        return;
    }
    const bool changed = document_.revision() != autosaved_revision_ || content_live() != autosaved_live_;
    const double since = std::chrono::duration<double>(Clock::now() - last_autosave_).count();
    if (changed && since >= options_.autosave_seconds) write_autosave({});
}

void Application::discard_autosave() {
    autosave_->discard();
    autosaved_ = false;
    if (recovered_) gse::discard(*recovered_), recovered_.reset();
}

/// The document goes: what was open is saved, given up, or left to be offered again.
void Application::let_go() {
    if (!std::exchange(keep_, false)) return discard_autosave();
    try {
        autosave_->leave();
    } catch (const Error& error) {  // it stays all the same, and is offered once this program has ended
        report_error(error);
        autosave_ = std::make_unique<Autosave>();
    }
    autosaved_ = false;
    recovered_.reset();
}

void Application::leave_edit(bool keep, std::function<void()> then) {
    kept_edit_ = keep ? edit_json() : nlohmann::json();
    leaving_ = {keep, std::move(then)};
    if (work_.running()) toast("The edit is being stopped.");
    work_.cancel();
}

void Application::leave_when_stopped() {
    if (!leaving_ || work_.running() || saver_.running()) return;
    queue_.run();  // what the edit left
    const Leaving leaving = *std::exchange(leaving_, std::nullopt);
    if (!leaving.keep) {
        discard_result();
        model_.edit_running = model_.result_waiting =
            false;  // what is asked next is asked of the state as it is now
        model_.unsaved = unsaved();
        return leaving.then();
    }
    keep_ = true;
    if (unsaved() || !kept_edit_.is_null()) write_autosave(leaving.then);
    else leaving.then();
}

void Application::shut_down() {
    const auto wait_for_saver = [this] {
        for (; saver_.running(); queue_.run()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
        queue_.run();
    };
    refresh_live();  // the newest snapshot
    save_settings();
    wait_for_saver();
    // Nobody was asked when a signal ends the program: what is not saved stays.
    const bool unasked = !quit_ && options_.autosave && unsaved();
    if (unasked) write_autosave({}), wait_for_saver();
    keep_ |= unasked;
    if (!document_.empty()) let_go();
    work_.cancel();
    files_.cancel();
}

void Application::refresh_recoverable() {
    const auto before = std::exchange(model_.recoverable, {});
    for (const auto& found : find_recoverable()) {
        if (recovered_ && recovered_->file == found.file) continue;
        auto view = view_of(found);
        const bool of_this = same_file(found.scene, scene_path_) || same_file(found.project, project_path_);
        const bool was = std::any_of(before.begin(), before.end(),
                                     [&](const auto& old) { return old.file == view.file && old.offered; });
        view.offered = !document_.empty() && (of_this || was || !start_page_seen_);
        model_.recoverable.push_back(std::move(view));
    }
}

void Application::recover(const std::string& project) {
    if (work_.running()) return toast("Cancel the running job first.");
    auto loaded = std::make_shared<Loaded>();
    loaded->path = project;
    auto work = [loaded](const JobControl& control) {
        control.report("recovering", 0, 0);
        for (const auto& found : find_recoverable())
            if (found.file == loaded->path) loaded->recovered = found;
        if (!loaded->recovered)
            throw Error(ErrorCode::NotFound, "the unsaved work is not there any more",
                        "it was recovered or discarded elsewhere", loaded->path);
        loaded->project = true;
        loaded->project_path = loaded->recovered->project;
        loaded->data = gse::load_project(loaded->path);
        loaded->state = loaded->data.state;
        loaded->pending = take_back_edit(loaded->state, loaded->data.jobs);
        loaded->notes = loaded->data.warnings;
        loaded->statistics = compute_statistics(loaded->state.current);
    };
    auto done = [this, loaded](const Error* error) {
        if (error != nullptr) keep_ = false;
        if (error != nullptr) return error->code() == ErrorCode::Cancelled ? void() : report_error(*error);
        const bool waits = loaded->pending.has_value();
        take_loaded(std::move(*loaded));
        toast(waits ? "The work is back, with the edit that was not applied. Save it to keep it."
                    : "The work of the last session is back. Save it to keep it.");
    };
    if (!files_.start({"Recover", work, done})) toast("Another file is being read or written; wait for it.");
}

void Application::discard_recovery(const std::string& project) {
    for (const auto& found : find_recoverable())
        if (found.file == project) gse::discard(found);
    std::erase_if(model_.recoverable, [&](const auto& view) { return view.file == project; });
}

void Application::postpone_recovery(const std::string& project) {
    for (auto& view : model_.recoverable)
        if (view.file == project) view.offered = false;
}

}  // namespace gse::app
