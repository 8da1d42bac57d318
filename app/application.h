// The editor behind the window: owns the document, the jobs and what the panels show. Everything here runs on the main
// thread; work goes to job threads and comes back through the main queue.
#pragma once

#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "app/edit_job.h"
#include "app/job_thread.h"
#include "app/preview_host.h"
#include "engine/io/autosave.h"
#include "engine/io/project_file.h"
#include "engine/scene/document.h"
#include "ui/actions.h"
#include "ui/view_model.h"

namespace gse::app {

struct ApplicationOptions {
    bool autosave = true;
    double autosave_seconds = 3;              // at most this much work is lost to a crash
    std::function<void()> wake = {};             // makes the window draw a frame
    std::function<void(float)> on_scale = {};
    std::function<void()> on_fullscreen = {};
};

/// What came of an edit that has not been applied yet.
struct PendingResult {
    GaussianSet before, set;
    std::shared_ptr<const std::vector<std::int64_t>> base_to_new;   // [before rows]
    std::string name, recipe, target;
    bool adds = false;
    double seconds = 0, psnr_outside_db = 0;
    std::size_t changed_outside_label = 0;
    std::shared_ptr<const Image> thumbnail;
};

/// What the edit thread hands over while it runs; newest wins.
struct LiveEdit {
    std::mutex mutex;
    std::deque<edit::EditSnapshot> snapshots;
    std::vector<ui::LossPoint> losses;
    std::uint64_t version = 0;
    std::optional<std::vector<std::uint8_t>> label;   // corrected by the artist, not taken over yet
    std::shared_ptr<EditJob> found;   // a search made for this edit, not shown yet
    std::vector<float> attention;     // of it, per splat
    bool relabel = false;             // what it found is the label now
    bool wants_gate = false;
    std::optional<ui::GateView> gate;
};

class Application : public ui::Actions {
public:
    explicit Application(ApplicationOptions options);
    ~Application() override;

    /// Runs what other threads posted, advances clocks, refreshes the view model. Call before every frame.
    void update(PreviewHost& preview);
    const ui::ViewModel& model() const { return model_; }
    /// Something moves or works: draw frames without waiting for input.
    bool busy() const;
    bool wants_to_quit() const { return quit_; }
    /// Where panels keep their places; part of settings and project.
    void set_layout(const std::string& json) { layout_ = json; }
    const std::string& layout() const { return layout_; }
    bool layout_changed() { return std::exchange(layout_loaded_, false); }
    /// Writes what is not saved to the recovery folder and stops all jobs.
    void shut_down();
    const Document& document() const { return document_; }

    // ui::Actions
    void open(const std::filesystem::path& path) override;
    void open_sample() override;
    void save_project(const std::filesystem::path& path) override;
    void recover(const std::string& project) override;
    void discard_recovery(const std::string& project) override;
    void set_up_axis(const std::string& up) override;
    void repair_scene() override;
    void locate() override;
    void edit() override;
    void pause(bool paused) override;
    void cancel() override;
    void cancel_file_job() override;
    void apply_result() override;
    void discard_result() override;
    void show_snapshot(int index) override;
    void branch_from_snapshot(int index) override;
    void set_attention_threshold(double value) override;
    void set_label_threshold(float value) override;
    void set_active_label(int index) override;
    void add_label(const std::string& name) override;
    void rename_label(int index, const std::string& name) override;
    void delete_label(int index) override;
    void select(const ui::ScreenRegion& region, ui::SetOperation operation, bool stroke_ends) override;
    void grow_label(int steps) override;
    void invert_label() override;
    void clear_label() override;
    void delete_labelled_splats() override;
    void undo() override;
    void redo() override;
    void go_to(std::size_t position) override;
    void set_edit_enabled(std::uint64_t id, bool enabled) override;
    void delete_edit(std::uint64_t id) override;
    void move_edit(std::uint64_t id, int places) override;
    void repeat_edit(std::uint64_t id) override;
    void set_camera(const Camera& camera) override;
    void set_view_settings(const ui::ViewSettings& settings) override;
    void set_model_settings(const ui::ModelSettings& settings) override { model_.model_settings = settings; }
    void set_comparison(ui::Comparison comparison) override;
    void look_through(std::size_t view) override;
    void add_view() override;
    void delete_view(std::size_t view) override;
    void set_viewport_size(int width, int height) override;
    void set_request(const edit::EditRequest& request) override;
    void choose_model(const std::string& path) override;
    void set_exports(const ui::ExportSettings& settings) override;
    void export_picture() override;
    void export_turntable() override;
    void export_scene() override;
    void add_camera_key() override;
    void delete_camera_key(std::size_t index) override;
    void export_camera_path(bool as_film) override;
    void dismiss_toast(std::size_t index) override;
    void press_toast(std::size_t index) override;
    void toggle_fullscreen() override;
    void set_ui_scale(float scale) override;
    void quit() override { quit_ = true; }

private:
    using Clock = std::chrono::steady_clock;
    struct Loaded;
    struct ToastState {
        ui::Toast toast;
        Clock::time_point born;
        std::function<void()> action;
    };

    // application.cpp: frame
    void refresh_jobs();
    void refresh_live();
    void refresh_toasts();
    void refresh_document();
    void refresh_log();
    void toast(std::string text, bool is_error = false, std::string button = {}, std::function<void()> action = {});
    void report_error(const Error& error);
    void save_settings();
    void load_settings();
    bool require_scene();

    // application_files.cpp
    void take_loaded(Loaded loaded);
    void autosave_if_due();
    std::filesystem::path default_project_path() const;
    std::uint64_t content_live() const;
    nlohmann::json ui_json() const;
    void ui_from_json(const nlohmann::json& json);
    std::function<DocumentState()> state_with_live_edit() const;

    // application_work.cpp
    bool job_fits() const;
    EditRecipe current_recipe() const;
    Scene working_scene() const;
    void take_located(std::shared_ptr<EditJob> job, std::vector<float> attention, bool relabel);
    void take_found();
    bool label_drives_edit() const;
    bool edit_running() const;
    void finish_edit(const Error* error);
    void refresh_estimate();

    // application_labels.cpp
    NamedLabel* active_label_copy(DocumentState& state) const;
    void change_label(const std::string& name, const std::function<NamedLabel(NamedLabel)>& change,
                      const std::string& merge_key = {});
    void change_stack(const std::string& name, const std::function<void(std::vector<EditNode>&)>& change);

    // application_view.cpp
    PictureRequest picture_request();
    std::shared_ptr<const std::vector<float>> shown_values(const GaussianSet& set, int snapshot);
    OrbitParameters export_orbit() const;

    ApplicationOptions options_;
    ui::ViewModel model_;
    Document document_;
    MainQueue queue_;
    // Files
    SceneSource source_;
    nlohmann::json unknown_ = nlohmann::json::object();
    std::unique_ptr<ProjectWriter> writer_ = std::make_unique<ProjectWriter>();
    std::unique_ptr<Autosave> autosave_ = std::make_unique<Autosave>();
    std::optional<Recoverable> recovered_;
    std::string scene_path_, project_path_;
    std::uint64_t saved_revision_ = 0, autosaved_revision_ = 0, autosaved_live_ = 0;
    Clock::time_point last_autosave_ = Clock::now();
    std::string layout_;
    bool layout_loaded_ = false;

    // Work
    std::shared_ptr<neural::TextToImage> text_model_;
    std::string text_model_path_, model_path_;
    std::shared_ptr<EditJob> job_;
    std::string job_key_, live_key_;
    GaussianSet job_set_;
    std::shared_ptr<const std::vector<float>> attention_values_;
    GaussianSet attention_set_;
    std::shared_ptr<LiveEdit> live_ = std::make_shared<LiveEdit>();
    std::uint64_t live_seen_ = 0;
    std::deque<edit::EditSnapshot> snapshots_;
    std::optional<PendingResult> pending_;
    std::uint64_t next_edit_id_ = 1;
    double seconds_per_iteration_ = 0, seconds_per_view_ = 0;   // measured by the last run, for the estimate
    double wanted_threshold_ = -1;

    // View
    Camera camera_;
    int viewport_width_ = 1, viewport_height_ = 1;
    Clock::time_point last_move_ = Clock::now() - std::chrono::seconds(10), last_frame_ = Clock::now(), last_estimate_{};
    std::uint64_t content_ = 1, stroke_ = 0, camera_version_ = 0, document_seen_ = 0;
    struct ShownKey {
        std::uint64_t revision = 0, live = 0;
        int mode = -1, snapshot = -2, active = -1;
        bool tint = false, pending = false;
        bool operator==(const ShownKey&) const = default;
    } shown_key_;
    GaussianSet shown_set_;
    std::shared_ptr<const std::vector<float>> shown_values_;
    std::vector<ToastState> toasts_;
    std::vector<ui::LogLine> log_;
    std::shared_ptr<void> log_source_;
    bool quit_ = false;
    JobThread work_, files_, saver_;   // last: their threads end before what they use
};

/// On the work thread: runs a located job with the artist's label (empty = as located), feeding `live`.
void run_live(const std::shared_ptr<EditJob>& job, const std::vector<std::uint8_t>& label,
              const std::vector<float>& attention, LiveEdit& live);
/// Takes what a finished run leaves. Throws Error (Cancelled) when it was stopped before its first step.
void fill_pending(EditJob& job, PendingResult& pending);

/// Where models were found and what they are; reads headers only.
std::vector<ui::ModelView> scan_models(const std::string& chosen);
/// Words of the model in `folder` (gseditpro.json), empty for an open vocabulary.
std::vector<std::string> model_words(const std::filesystem::path& folder);

}  // namespace gse::app
