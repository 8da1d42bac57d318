// The frame: what other threads posted, clocks, and the view model.
#include "app/session/application.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>

#include "app/cli/engine_names.h"
#include "engine/base/clock.h"
#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/io/files/user_files.h"
#include "engine/pipeline/run/scene_tools.h"
#include "engine/scene/label_ops.h"

namespace gse::app {
namespace {

constexpr double ToastSeconds = 7, ButtonToastSeconds = 12, ErrorToastSeconds = 20;
constexpr std::size_t MostToasts = 4, MostLogLines = 2000;

/// Lines of the log from any thread, until the application takes them.
struct LogBox {
    std::mutex mutex;
    std::vector<ui::LogLine> lines;
};

ui::JobView job_view(const JobStatus& status) {
    ui::JobView view;
    view.running = status.running;
    view.paused = status.paused;
    view.can_pause = status.can_pause;
    view.title = status.title;
    view.stage = status.stage;
    view.step = status.step;
    view.total = status.total;
    view.seconds = status.seconds;
    view.eta_seconds = status.eta_seconds;
    view.outcome = status.outcome;
    view.error = status.error;
    return view;
}

/// Of the window's settings, those that are not of one scene or one moment.
nlohmann::ordered_json lasting(nlohmann::ordered_json fields) {
    for (auto field = fields.begin(); field != fields.end();) {
        const std::string& name = field.key();
        const bool passing = name == "mode" || name == "tint_labels" || name == "wipe" ||
                             name == "visible_only" || name.ends_with("_path");
        field = passing ? fields.erase(field) : std::next(field);
    }
    return fields;
}

}  // namespace

Application::Application(ApplicationOptions options)
    : options_(std::move(options)), work_(queue_, JobThread::Priority::Patient), files_(queue_),
      saver_(queue_, JobThread::Priority::Patient), counter_(queue_, JobThread::Priority::Patient) {
    queue_.set_wake(options_.wake);
    auto box = std::make_shared<LogBox>();
    log_source_ = box;
    log::set_sink([box, wake = options_.wake](log::Level level, std::string_view text) {
        {
            const std::lock_guard lock(box->mutex);
            box->lines.push_back(
                {level, fmt::format("{:%H:%M:%S}", fmt::localtime(std::time(nullptr))), std::string(text)});
        }
        if (wake) wake();
    });
    model_.request.prompt = "";
    model_.words_known = true;
    load_settings();
    list_models();
    const auto in_use =
        std::find_if(model_.models.begin(), model_.models.end(), [](const auto& row) { return row.chosen; });
    if (!model_path_.empty() && in_use != model_.models.end() && !in_use->usable)
        refuse_model(std::exchange(model_path_, {}), in_use->problem);
    take_chosen_model();
    for (const auto& path : load_recent()) model_.recent.push_back(path.string());
    refresh_recoverable();
}

Application::~Application() {
    log::set_sink({});
    queue_.set_wake({});
}

bool Application::busy() const {
    return work_.running() || files_.running() || leaving_ || !toasts_.empty() ||
           seconds_since(last_move_) < 2 * MovingSeconds;
}

void Application::update(PreviewHost& preview) {
    const JobStatus work = work_.status(),
                    files = files_.status();  // before the queue: an ended job has left its result
    queue_.run();
    const auto now = Clock::now();
    const double frame = std::chrono::duration<double>(now - last_frame_).count();
    last_frame_ = now;
    if (frame > 0) model_.frames_per_second = 0.9 * model_.frames_per_second + 0.1 / std::max(frame, 1e-4);
    refresh_log();
    refresh_live();
    refresh_jobs(work, files);
    refresh_document();
    refresh_toasts();
    autosave_if_due();
    leave_when_stopped();
    if (document_.empty()) {
        start_page_seen_ |= !files.running;
        model_.viewport = 0;
        return;
    }
    preview.want(picture_request());
    const auto picture = preview.state();
    model_.viewport = picture.texture;
    model_.viewport_original = picture.original;
    // Overlays and tools work in pixels of the whole viewport; while moving the picture has fewer and is
    // stretched.
    model_.camera =
        picture.camera.width > 0 ? picture.camera : camera_.resized(viewport_width_, viewport_height_);
    model_.viewport_width = model_.camera.width;
    model_.viewport_height = model_.camera.height;
    model_.viewport_depth = picture.depth;
    model_.render_ms = picture.render_ms;
    model_.renderer = picture.renderer;
}

void Application::refresh_jobs(const JobStatus& work, const JobStatus& files) {
    model_.job = job_view(work);
    model_.file_job = job_view(files);
    model_.edit_running = edit_running();
    if (!model_.edit_running) model_.targets_wait = false;
    model_.voting = work.running && work.title == VoteTitle;
    model_.read_target = read_target();
    model_.result_waiting = pending_.has_value() && !work_.running();
    model_.result_splats = pending_ ? pending_->set.size() : 0;
    model_.result_changed_outside = pending_ ? pending_->changed_outside_label : 0;
    model_.result_psnr_outside_db = pending_ ? pending_->psnr_outside_db : 0;
    model_.result_seconds = pending_ ? pending_->seconds : 0;
    model_.results.clear();
    for (const auto& result : pending_.all()) model_.results.push_back({result.thumbnail, result.seed});
    model_.shown_result = pending_.shown().value_or(0);
    vote_if_wanted();
}

void Application::take_found() {
    std::unique_lock lock(live_->mutex);
    const auto job = std::exchange(live_->found, nullptr);
    if (job == nullptr) return;
    auto attention = std::move(live_->attention);
    const bool relabel = live_->relabel;
    lock.unlock();
    remember_search(job);
    live_recipe_.request.target = searched_.words.target;
    describe(*live_, live_recipe_);
    job_key_ = search_key(live_recipe_);
    take_located(job, std::move(attention));
    const auto& located = job->located();
    if (!job->found()) report_error(Error(ErrorCode::NotFound, located.message, located.remedy));
    else if (relabel) label_located(*job, {}, {});
}

void Application::refresh_live() {
    take_found();
    show_arriving();
    const std::lock_guard lock(live_->mutex);
    if (live_->version == live_seen_) return;
    live_seen_ = live_->version;
    model_.losses = live_->losses;
    model_.cost = cost_of(live_->use - live_->use_before);
    refresh_targets();
    if (live_->gate) {
        model_.gate = *std::exchange(live_->gate, std::nullopt);
        if (model_.gate.warns) toast(model_.gate.verdict);
    }
    const bool more =
        live_->snapshots.size() != snapshots_.size() ||
        (!snapshots_.empty() && live_->snapshots.back().iteration != snapshots_.back().iteration);
    if (!more) return;
    untint();
    newest_set_ = live_->newest;
    take_snapshots(live_->snapshots);
}

void Application::refresh_document() {
    model_.document = document_.empty() ? nullptr : &document_;
    model_.scene_path = scene_path_;
    model_.project_path = project_path_;
    model_.suggested_project = document_.empty() ? std::string() : default_project_path().string();
    model_.unsaved = unsaved();
    model_.cannot_edit = document_.empty() ? "Open a scene first."
                         : work_.running() ? "A job is running."
                         : pending_        ? "Apply or discard the edit first."
                                           : "";
    if (document_.empty()) return;
    if (document_seen_ != document_.revision()) {
        document_seen_ = document_.revision();
        ++content_;
        if (!(up_shown_ == document_.state().info.up)) stand_up();
        refresh_words();
        model_.labelled = active_label() ? count_labelled(*active_label()) : 0;
        if (!hidden_.empty()) hidden_changed();
    }
    refresh_reach();
    count_anew();
    refresh_picked();
    if (adjusted_ && adjusted_->revision != document_.revision()) adjusted_.reset();
    model_.adjusting = adjusted_.has_value();
    if (seconds_since(last_estimate_) > 0.5) {
        last_estimate_ = Clock::now();
        refresh_estimate();
    }
}

/// What the Scene panel tells is counted beside the frames: large scenes take a while.
void Application::count_anew() {
    const auto& current = document_.state().current;
    if (counted_.shares_all_with(current)) return;
    auto statistics = std::make_shared<SceneStatistics>();
    auto done = [this, statistics, opened = opened_](const Error*) {
        if (opened == opened_) model_.statistics = *statistics;
    };
    if (counter_.start(
            {"Count",
             [statistics, set = current](const JobControl&) { *statistics = compute_statistics(set); },
             done}))
        counted_ = current;  // else once the last count has ended, whose news wake the window
}

void Application::refresh_log() {
    const auto box = std::static_pointer_cast<LogBox>(log_source_);
    const std::lock_guard lock(box->mutex);
    for (auto& line : box->lines) {
        if (line.level == log::Level::Warning) toast(line.text);
        model_.log.push_back(std::move(line));
    }
    box->lines.clear();
    if (model_.log.size() > MostLogLines)
        model_.log.erase(model_.log.begin(), model_.log.end() - static_cast<std::ptrdiff_t>(MostLogLines));
}

void Application::toast(std::string text, bool is_error, std::string button, std::function<void()> action) {
    // The same news again, or told at more length: one of them is enough.
    std::erase_if(toasts_,
                  [&](const ToastState& old) { return text.find(old.toast.text) != std::string::npos; });
    if (std::any_of(toasts_.begin(), toasts_.end(),
                    [&](auto& old) { return old.toast.text.find(text) != std::string::npos; }))
        return;
    if (toasts_.size() >= MostToasts) toasts_.erase(toasts_.begin());
    toasts_.push_back({{std::move(text), is_error, 0, std::move(button)}, Clock::now(), std::move(action)});
}

/// Says what the last step did, with a button that takes it back as long as nothing came after it.
void Application::toast_step(std::string text) {
    toast(std::move(text), false, "Undo", [this, revision = document_.revision()] {
        if (document_.revision() == revision) return undo();
        toast("More was done since: History leads back to any step.");
    });
}

void Application::report_error(const Error& error) {
    toast(error.what(), true);
    model_.log.push_back(
        {log::Level::Error, fmt::format("{:%H:%M:%S}", fmt::localtime(std::time(nullptr))), error.what()});
}

void Application::refresh_toasts() {
    std::erase_if(toasts_, [](const ToastState& state) {
        const auto& toast = state.toast;
        return seconds_since(state.born) > (toast.is_error         ? ErrorToastSeconds
                                            : toast.button.empty() ? ToastSeconds
                                                                   : ButtonToastSeconds);
    });
    model_.toasts.clear();
    for (auto& state : toasts_) {
        state.toast.age_seconds = seconds_since(state.born);
        model_.toasts.push_back(state.toast);
    }
}

void Application::dismiss_toast(std::size_t index) {
    if (index < toasts_.size()) toasts_.erase(toasts_.begin() + static_cast<std::ptrdiff_t>(index));
}

void Application::press_toast(std::size_t index) {
    if (index >= toasts_.size()) return;
    const auto action = toasts_[index].action;
    dismiss_toast(index);
    if (action) action();
}

void Application::ask(std::string title, std::string text, std::vector<AskedAnswer> answers) {
    model_.question = {model_.question.number + 1, std::move(title), std::move(text), {}};
    answers_.clear();
    for (auto& [answer, act] : answers) {
        model_.question.answers.push_back(std::move(answer));
        answers_.push_back(std::move(act));
    }
}

void Application::answer(std::size_t index) {
    const auto answers = std::exchange(answers_, {});
    if (index < answers.size() && answers[index]) answers[index]();
}

void Application::cancel_file_job() { files_.cancel(); }

void Application::set_request(const edit::EditRequest& request) {
    const bool told_else = request.source != model_.request.source || request.prompt != model_.request.prompt;
    model_.request = request;
    if (told_else) model_.request.left_out.clear();  // they were views of another search
    // A word that was clicked in another sentence is no target of this one.
    auto& target = model_.request.target;
    if (!target.empty() && !edit::has_word(request.prompt, target)) target.clear();
    refresh_reading();
}

void Application::set_ui_scale(float scale) {
    model_.ui_scale = chosen_scale_ = scale;
    if (options_.on_scale) options_.on_scale(scale);
    save_settings();
}

void Application::set_keymap(const std::string& text) {
    model_.keymap = text;
    save_settings();
}

void Application::toggle_fullscreen() {
    if (options_.on_fullscreen) options_.on_fullscreen();
}

void Application::save_settings() {
    nlohmann::json json;
    json["ui_scale"] = chosen_scale_;
    json["cache_mb"] = model_.cache_mb;
    json["keys"] = model_.keymap;
    json["model"] = model_path_;
    json["loras"] = loras_;
    json["segmenter"] = segmenter_path_;
    json["text_segmenter"] = text_segmenter_path_;
    for (const auto& [key, measured] : measured_) json["measured"][key] = fields_to_json(measured);
    if (!layout_.empty()) json["layout"] = layout_;
    json["view"] = lasting(fields_to_json(model_.view));
    json["exports"] = lasting(fields_to_json(model_.exports));
    gse::save_settings(json);
}

void Application::load_settings() {
    const auto json = gse::load_settings();
    const auto number = [&](const char* key, double fallback) {
        return json.contains(key) && json[key].is_number() ? json[key].get<double>() : fallback;
    };
    const auto text = [&](const char* key) {
        return json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : std::string();
    };
    chosen_scale_ = static_cast<float>(std::clamp(number("ui_scale", 0), 0.0, 4.0));
    model_.ui_scale = options_.ui_scale > 0 ? options_.ui_scale
                      : chosen_scale_ > 0   ? chosen_scale_
                                            : options_.desktop_scale;
    if (json.contains("measured") && json["measured"].is_object())
        for (const auto& [key, measured] : json["measured"].items()) {
            try {
                fields_from_json(measured_[key], measured);
            } catch (const Error&) {  // of another version: it is measured anew
                measured_.erase(key);
            }
        }
    try {
        if (json.contains("view")) fields_from_json(model_.view, lasting(json["view"]));
        if (json.contains("exports")) fields_from_json(model_.exports, lasting(json["exports"]));
    } catch (const std::exception& error) {  // of another version, or edited by hand
        log::warning("some settings of view and export cannot be used ({})", error.what());
    }
    model_.cache_mb = static_cast<int>(cache_->most_bytes() >> 20);
    model_.cache_bytes = cached_bytes(cache_->folder());
    model_path_ = text("model");
    loras_ = texts_of(json, "loras");
    model_.segmenters = {ui::SegmenterView{segmenter_path_ = text("segmenter")},
                         ui::SegmenterView{text_segmenter_path_ = text("text_segmenter")}};
    model_.keymap = text("keys");
    layout_ = text("layout");
    layout_loaded_ = !layout_.empty();
}

}  // namespace gse::app
