// The frame: what other threads posted, clocks, and the view model.
#include "app/application.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>

#include "app/scene_tools.h"
#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/io/user_files.h"
#include "engine/scene/label_ops.h"

namespace gse::app {
namespace {

constexpr double ToastSeconds = 7, ErrorToastSeconds = 20;
constexpr std::size_t MostToasts = 4, MostLogLines = 2000;
constexpr double MovingSeconds = 0.25;   // after the last movement of the camera the picture is refined

double seconds_since(std::chrono::steady_clock::time_point then) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - then).count();
}

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

}  // namespace

Application::Application(ApplicationOptions options)
    : options_(std::move(options)), work_(queue_), files_(queue_), saver_(queue_) {
    queue_.set_wake(options_.wake);
    auto box = std::make_shared<LogBox>();
    log_source_ = box;
    log::set_sink([box, wake = options_.wake](log::Level level, std::string_view text) {
        {
            const std::lock_guard lock(box->mutex);
            box->lines.push_back({level, fmt::format("{:%H:%M:%S}", fmt::localtime(std::time(nullptr))), std::string(text)});
        }
        if (wake) wake();
    });
    model_.request.prompt = "";
    model_.words_known = true;
    load_settings();
    model_.models = scan_models(model_path_);
    model_.known_words = model_words(model_path_.empty() ? starter_model_path() : std::filesystem::path(model_path_));
    for (const auto& path : load_recent()) model_.recent.push_back(path.string());
    for (const auto& found : find_recoverable()) model_.recoverable.push_back(found.file.string());
}

Application::~Application() {
    log::set_sink({});
    queue_.set_wake({});
}

void Application::shut_down() {
    work_.cancel();
    files_.cancel();
    save_settings();
    while (saver_.running()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    queue_.run();
    if (document_.empty()) return;
    if (document_.revision() == saved_revision_ && !pending_) {
        autosave_->discard();
        return;
    }
    last_autosave_ = {};
    autosaved_revision_ = ~std::uint64_t{0};
    autosave_if_due();
    while (saver_.running()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

bool Application::busy() const {
    return work_.running() || files_.running() || !toasts_.empty() || seconds_since(last_move_) < 2 * MovingSeconds;
}

void Application::update(PreviewHost& preview) {
    queue_.run();
    const auto now = Clock::now();
    const double frame = std::chrono::duration<double>(now - last_frame_).count();
    last_frame_ = now;
    if (frame > 0) model_.frames_per_second = 0.9 * model_.frames_per_second + 0.1 / std::max(frame, 1e-4);
    refresh_log();
    refresh_live();
    refresh_jobs();
    refresh_document();
    refresh_toasts();
    autosave_if_due();
    if (document_.empty()) {
        model_.viewport = 0;
        return;
    }
    preview.want(picture_request());
    const auto picture = preview.state();
    model_.viewport = picture.texture;
    model_.viewport_original = picture.original;
    // Overlays and tools work in pixels of the whole viewport; while moving the picture has fewer and is stretched.
    model_.camera = picture.camera.width > 0 ? picture.camera : camera_.resized(viewport_width_, viewport_height_);
    model_.viewport_width = model_.camera.width;
    model_.viewport_height = model_.camera.height;
    model_.viewport_depth = picture.depth;
    model_.render_ms = picture.render_ms;
    model_.renderer = picture.renderer;
}

void Application::refresh_jobs() {
    model_.job = job_view(work_.status());
    model_.file_job = job_view(files_.status());
    model_.result_waiting = pending_.has_value() && !work_.running();
    if (!work_.running() && wanted_threshold_ >= 0 && job_ && !pending_) set_attention_threshold(wanted_threshold_);
}

void Application::take_found() {
    std::unique_lock lock(live_->mutex);
    const auto job = std::exchange(live_->found, nullptr);
    if (job == nullptr) return;
    auto attention = std::move(live_->attention);
    const bool relabel = live_->relabel;
    lock.unlock();
    job_ = job;
    job_key_ = live_key_;
    job_set_ = job->scene().gaussians;
    take_located(job, std::move(attention), relabel);
}

void Application::refresh_live() {
    take_found();
    const std::lock_guard lock(live_->mutex);
    if (live_->version == live_seen_) return;
    live_seen_ = live_->version;
    model_.losses = live_->losses;
    if (live_->gate) {
        model_.gate = *std::exchange(live_->gate, std::nullopt);
        if (model_.gate.warns) toast(model_.gate.verdict);
    }
    const bool more = live_->snapshots.size() != snapshots_.size() ||
                      (!snapshots_.empty() && live_->snapshots.back().iteration != snapshots_.back().iteration);
    if (!more) return;
    snapshots_ = live_->snapshots;
    model_.snapshots.clear();
    for (const auto& snapshot : snapshots_) model_.snapshots.push_back({snapshot.iteration, snapshot.set->size()});
    ++content_;
}

std::uint64_t Application::content_live() const {
    if (pending_) return ~std::uint64_t{0};
    return work_.running() && !snapshots_.empty() ? static_cast<std::uint64_t>(snapshots_.back().iteration) : 0;
}

void Application::refresh_document() {
    model_.document = document_.empty() ? nullptr : &document_;
    model_.scene_path = scene_path_;
    model_.project_path = project_path_;
    model_.suggested_project = document_.empty() ? std::string() : default_project_path().string();
    model_.unsaved = !document_.empty() && document_.revision() != saved_revision_;
    model_.cannot_edit = document_.empty() ? "Open a scene first."
                         : work_.running() ? "A job is running."
                         : pending_        ? "Apply or discard the edit first."
                                           : "";
    if (document_.empty()) return;
    if (document_seen_ != document_.revision()) {
        document_seen_ = document_.revision();
        ++content_;
        const auto& state = document_.state();
        model_.labelled = state.active_label >= 0 && state.active_label < static_cast<int>(state.labels.size())
                              ? count_labelled(state.labels[static_cast<std::size_t>(state.active_label)])
                              : 0;
    }
    if (seconds_since(last_estimate_) > 0.5) {
        last_estimate_ = Clock::now();
        refresh_estimate();
    }
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
    std::erase_if(toasts_, [&](const ToastState& old) { return old.toast.text == text; });
    if (toasts_.size() >= MostToasts) toasts_.erase(toasts_.begin());
    toasts_.push_back({{std::move(text), is_error, 0, std::move(button)}, Clock::now(), std::move(action)});
}

void Application::report_error(const Error& error) {
    toast(error.what(), true);
    model_.log.push_back({log::Level::Error, fmt::format("{:%H:%M:%S}", fmt::localtime(std::time(nullptr))), error.what()});
}

void Application::refresh_toasts() {
    std::erase_if(toasts_, [](const ToastState& state) {
        return seconds_since(state.born) > (state.toast.is_error ? ErrorToastSeconds : ToastSeconds);
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

void Application::cancel_file_job() { files_.cancel(); }

void Application::set_request(const edit::EditRequest& request) { model_.request = request; }

void Application::choose_model(const std::string& path) {
    if (path == starter_model_path().string() || path.empty()) model_path_.clear();
    else model_path_ = path;
    model_.models = scan_models(model_path_);
    model_.known_words = model_words(model_path_.empty() ? starter_model_path() : std::filesystem::path(model_path_));
    save_settings();
}

void Application::set_ui_scale(float scale) {
    model_.ui_scale = scale;
    if (options_.on_scale) options_.on_scale(scale);
    save_settings();
}

void Application::toggle_fullscreen() {
    if (options_.on_fullscreen) options_.on_fullscreen();
}

void Application::save_settings() {
    nlohmann::json json;
    json["ui_scale"] = model_.ui_scale;
    json["model"] = model_path_;
    json["seconds_per_iteration"] = seconds_per_iteration_;
    json["seconds_per_view"] = seconds_per_view_;
    if (!layout_.empty()) json["layout"] = layout_;
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
    model_.ui_scale = static_cast<float>(std::clamp(number("ui_scale", 0), 0.0, 4.0));
    seconds_per_iteration_ = std::max(0.0, number("seconds_per_iteration", 0));
    seconds_per_view_ = std::max(0.0, number("seconds_per_view", 0));
    model_path_ = text("model");
    layout_ = text("layout");
    layout_loaded_ = !layout_.empty();
}

}  // namespace gse::app
