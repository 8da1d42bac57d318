// The editor behind the window: owns the document, the jobs and what the panels show. Everything here runs on
// the main thread; work goes to job threads and comes back through the main queue.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "app/cli/engine_names.h"
#include "app/window/preview_host.h"
#include "engine/base/job_thread.h"
#include "engine/io/project/autosave.h"
#include "engine/io/project/project_file.h"
#include "engine/localize/row_picking.h"
#include "engine/neural/api/model_profile.h"
#include "engine/pipeline/report/evidence_pictures.h"
#include "engine/pipeline/run/edit_job.h"
#include "engine/pipeline/session/edit_scope.h"
#include "engine/pipeline/session/estimate.h"
#include "engine/pipeline/session/waiting_results.h"
#include "engine/scene/document.h"
#include "engine/scene/hidden_rows.h"
#include "ui/commands/command.h"
#include "ui/view_model.h"

namespace gse::app {

constexpr std::size_t MostSnapshots = 24,
                      MostSnapshotBytes = std::size_t{512}
                                          << 20;  // kept for the scrubber; thinned out beyond
constexpr const char* AddsElsewhere =
    "What is added goes where the search placed it: corrections of the label by hand do not move that.";
constexpr const char* VoteTitle = "New vote";  // of the job
constexpr double MovingSeconds = 0.25;         // after the last movement of the camera the picture is refined

struct ApplicationOptions {
    bool autosave = true;
    double autosave_seconds = 3;      // at most this much work is lost to a crash
    std::function<void()> wake = {};  // makes the window draw a frame
    std::function<void(float)> on_scale = {};
    float ui_scale = 0;       // for this start only; 0 = as the artist chose last
    float desktop_scale = 1;  // until the artist chooses
    std::function<void()> on_fullscreen = {};
};

/// The edited set of one snapshot.
struct SnapshotSet {
    std::shared_ptr<const edit::SnapshotRows> of;  // that snapshot's rows; null = of none
    GaussianSet set;
};

/// What the edit thread hands over while it runs; newest wins.
struct LiveEdit {
    std::mutex mutex;
    std::deque<edit::EditSnapshot> snapshots;
    SnapshotSet newest;  // of the last snapshot, put together on the edit's thread
    std::vector<ui::LossPoint> losses;
    std::uint64_t version = 0;
    std::optional<std::vector<std::uint8_t>> label;  // corrected by the artist, not taken over yet
    std::shared_ptr<EditJob> found;                  // a search made for this edit, not shown yet
    std::vector<float> attention;                    // of it, per splat
    bool relabel = false;                            // what it found is the label now
    bool adds = false;                               // known once the search is over
    pipeline::Renamed renamed;                       // the same
    std::string name, recipe, target;                // of the edit, set before it starts
    int iterations = 0;
    bool wants_gate = false;
    std::optional<ui::GateView> gate;
    std::optional<edit::EditSnapshot> start;  // of an earlier run, to go on from
    neural::NetworkUse use_before, use;       // of the edit's thread: when it began, and by now
    // Of view guidance
    std::vector<ui::TargetRound> targets;
    std::vector<edit::TargetOrder> orders;  // by the artist, not taken over yet
    bool reviews = false;                   // the artist looks at every round before it is fitted to
    bool waits = false;                     // for the artist
    std::condition_variable_any spoken;     // of orders and waits
};

/// Says what is running: name, target and recipe.
void describe(LiveEdit& live, const EditRecipe& recipe);

class Application {
public:
    explicit Application(ApplicationOptions options);
    ~Application();

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
    /// The word the next edit is about: what was clicked, else what the sentence implies for the scene as it
    /// is.
    std::string target() const { return current_recipe().request.target; }

    void run(const ui::Command& wanted);

private:
    void on(const ui::command::Open& one);
    void on(const ui::command::OpenSample& one);
    void on(const ui::command::SaveProject& one);
    void on(const ui::command::LeaveEdit& one);
    void on(const ui::command::Recover& one);
    void on(const ui::command::DiscardRecovery& one);
    void on(const ui::command::PostponeRecovery& one);
    void on(const ui::command::SetUpAxis& one);
    void on(const ui::command::RepairScene& one);
    void on(const ui::command::CancelFileJob& one);
    void on(const ui::command::SetRequest& one);
    void on(const ui::command::Locate& one);
    void on(const ui::command::LabelAnyway& one);
    void on(const ui::command::Edit& one);
    void on(const ui::command::Pause& one);
    void on(const ui::command::Cancel& one);
    void on(const ui::command::OrderTarget& one);
    void on(const ui::command::FitToTargets& one);
    void on(const ui::command::ApplyResult& one);
    void on(const ui::command::DiscardResult& one);
    void on(const ui::command::AnotherResult& one);
    void on(const ui::command::ShowResult& one);
    void on(const ui::command::ShowSnapshot& one);
    void on(const ui::command::TakeSnapshot& one);
    void on(const ui::command::BranchFromSnapshot& one);
    void on(const ui::command::SetAttentionThreshold& one);
    void on(const ui::command::LeaveOutView& one);
    void on(const ui::command::SetReach& one);
    void on(const ui::command::RepeatEdit& one);
    void on(const ui::command::SetLabelThreshold& one);
    void on(const ui::command::SetActiveLabel& one);
    void on(const ui::command::AddLabel& one);
    void on(const ui::command::RenameLabel& one);
    void on(const ui::command::DeleteLabel& one);
    void on(const ui::command::Select& one);
    void on(const ui::command::CutOut& one);
    void on(const ui::command::GrowLabel& one);
    void on(const ui::command::InvertLabel& one);
    void on(const ui::command::ClearLabel& one);
    void on(const ui::command::DeleteLabelledSplats& one);
    void on(const ui::command::AdjustColours& one);
    void on(const ui::command::PickRows& one);
    void on(const ui::command::DropPicked& one);
    void on(const ui::command::UsePicked& one);
    void on(const ui::command::Undo& one);
    void on(const ui::command::Redo& one);
    void on(const ui::command::GoTo& one);
    void on(const ui::command::SetEditEnabled& one);
    void on(const ui::command::SetEditStrength& one);
    void on(const ui::command::DeleteEdit& one);
    void on(const ui::command::MoveEdit& one);
    void on(const ui::command::HideLabel& one);
    void on(const ui::command::IsolateLabel& one);
    void on(const ui::command::ShowHidden& one);
    void on(const ui::command::SetCamera& one);
    void on(const ui::command::SetViewSettings& one);
    void on(const ui::command::SetComparison& one);
    void on(const ui::command::CompareWith& one);
    void on(const ui::command::LookThrough& one);
    void on(const ui::command::AddView& one);
    void on(const ui::command::DeleteView& one);
    void on(const ui::command::SetViewportSize& one);
    void on(const ui::command::SetModelSettings& one);
    void on(const ui::command::ChooseModel& one);
    void on(const ui::command::AddLora& one);
    void on(const ui::command::SetLoraStrength& one);
    void on(const ui::command::RemoveLora& one);
    void on(const ui::command::ChooseSegmenter& one);
    void on(const ui::command::SetCacheMb& one);
    void on(const ui::command::ClearCache& one);
    void on(const ui::command::SetExports& one);
    void on(const ui::command::ExportPicture& one);
    void on(const ui::command::ExportTurntable& one);
    void on(const ui::command::ExportScene& one);
    void on(const ui::command::ExportViewpoints& one);
    void on(const ui::command::AddCameraKey& one);
    void on(const ui::command::DeleteCameraKey& one);
    void on(const ui::command::ExportCameraPath& one);
    void on(const ui::command::Answer& one);
    void on(const ui::command::DismissToast& one);
    void on(const ui::command::PressToast& one);
    void on(const ui::command::ToggleFullscreen& one);
    void on(const ui::command::SetUiScale& one);
    void on(const ui::command::SetKeymap& one);
    void on(const ui::command::Quit& one);
    void open(const std::filesystem::path& path);
    void open_sample();
    void save_project(const std::filesystem::path& path, std::function<void()> then = {});
    void leave_edit(bool keep, std::function<void()> then);
    void answer(std::size_t index);
    void recover(const std::string& project);
    void discard_recovery(const std::string& project);
    void postpone_recovery(const std::string& project);
    void set_up_axis(const std::string& up);
    void repair_scene();
    void locate();
    void label_anyway();
    void edit();
    void pause(bool paused);
    void cancel();
    void cancel_file_job();
    void order_target(const edit::TargetOrder& order);
    void fit_to_targets();
    void apply_result();
    void discard_result();
    void another_result();
    void show_result(std::size_t index);
    void show_snapshot(int index);
    void take_snapshot(int iteration);
    void branch_from_snapshot(int iteration);
    void set_attention_threshold(double value, bool drag_ends);
    void leave_out_view(std::size_t view, bool out);
    void set_label_threshold(float value, bool drag_ends);
    void set_active_label(int index);
    void set_reach(bool by_label);
    void add_label(const std::string& name);
    void rename_label(int index, const std::string& name);
    void delete_label(int index);
    void select(const ui::ScreenRegion& region, ui::SetOperation operation, bool stroke_ends);
    void cut_out(const ui::ScreenRegion& box, ui::SetOperation operation);
    void grow_label(int steps);
    void invert_label();
    void clear_label();
    void delete_labelled_splats();
    void adjust_colours(const ColourAdjustment& adjustment);
    void pick_rows(const localize::RowChoice& choice);
    void drop_picked();
    void use_picked(ui::PickedUse use);
    void hide_label();
    void isolate_label();
    void show_hidden();
    void undo();
    void redo();
    void go_to(std::size_t position);
    void set_edit_enabled(std::uint64_t id, bool enabled);
    void set_edit_strength(std::uint64_t id, double strength, bool drag_ends);
    void delete_edit(std::uint64_t id);
    void move_edit(std::uint64_t id, int places);
    void repeat_edit(std::uint64_t id);
    void set_camera(const Camera& camera);
    void set_view_settings(const ui::ViewSettings& settings);
    void set_model_settings(const ui::ModelSettings& settings) { model_.model_settings = settings; }
    void set_comparison(ui::Comparison comparison);
    void compare_with(std::size_t position);
    void look_through(std::size_t view);
    void add_view();
    void delete_view(std::size_t view);
    void set_viewport_size(int width, int height);
    void set_request(const edit::EditRequest& request);
    void choose_model(const std::string& path);
    void add_lora(const std::string& text);
    void choose_segmenter(ui::SegmenterRole role, const std::string& path);
    void set_lora_strength(std::size_t index, double strength);
    void remove_lora(std::size_t index);
    void set_exports(const ui::ExportSettings& settings);
    void export_picture();
    void export_turntable();
    void export_scene();
    void export_viewpoints();
    void add_camera_key();
    void delete_camera_key(std::size_t index);
    void export_camera_path(bool as_film);
    void dismiss_toast(std::size_t index);
    void press_toast(std::size_t index);
    void toggle_fullscreen();
    void set_ui_scale(float scale);
    void set_keymap(const std::string& text);
    void set_cache_mb(int most);
    void clear_cache();
    void quit() { quit_ = true; }
    using Clock = std::chrono::steady_clock;
    struct Loaded;
    /// A question to the artist: an answer and what it does (empty = nothing).
    struct AskedAnswer {
        ui::AskedQuestion::Answer answer;
        std::function<void()> act;
    };
    struct ToastState {
        ui::Toast toast;
        Clock::time_point born;
        std::function<void()> action;
    };

    /// What the views of the search are to vote with, that it has not been told yet.
    struct Vote {
        edit::LabelThresholds with;
        std::string step, merge_key;  // of the undo step it makes; empty = none: undo brought it back
    };

    // application.cpp: frame
    void refresh_jobs(const JobStatus& work, const JobStatus& files);
    void refresh_live();
    void refresh_toasts();
    void refresh_document();
    void refresh_words();
    void refresh_reading();
    void count_anew();
    void refresh_log();
    void toast(std::string text, bool is_error = false, std::string button = {},
               std::function<void()> action = {});
    void toast_step(std::string text);
    void report_error(const Error& error);
    void ask(std::string title, std::string text, std::vector<AskedAnswer> answers);
    void save_settings();
    void load_settings();
    bool require_scene();

    // application_files.cpp
    void open_recipe(const std::filesystem::path& picture);
    void take_recipe(const EditRecipe& recipe);
    void open_cameras(const std::filesystem::path& path);
    void take_loaded(Loaded loaded);
    void ask_which(const std::filesystem::path& folder, const std::vector<std::filesystem::path>& files);
    std::filesystem::path default_project_path() const;
    nlohmann::json ui_json() const;
    void ui_from_json(const nlohmann::json& json);

    // application_recovery.cpp
    void autosave_if_due();
    void write_autosave(std::function<void()> then);
    void discard_autosave();
    void let_go();
    void leave_when_stopped();
    bool unsaved() const;
    std::uint64_t content_live() const;
    nlohmann::json edit_json() const;
    std::function<DocumentState()> state_with_live_edit() const;
    std::function<std::shared_ptr<const Image>()> thumbnail() const;
    void refresh_recoverable();

    // application_export.cpp
    std::filesystem::path free_place(const std::string& name) const;
    void write_scene(const std::filesystem::path& path);
    void note_keys();
    std::string said_of_export() const;
    void start_export(const char* what, const std::filesystem::path& path,
                      std::function<void(const JobControl&)> work, const std::string& said,
                      bool can_pause = false);

    // application_work.cpp
    bool job_fits() const;
    std::optional<neural::TunedModel> known_tuning(const EditRecipe& recipe) const;
    EditRecipe current_recipe() const;
    EditRecipe open_recipe(EditRecipe recipe) const;
    std::string read_target() const;
    void remember_search(std::shared_ptr<EditJob> job);
    std::string model_key() const;
    Scene working_scene() const;
    void take_located(std::shared_ptr<EditJob> job, std::vector<float> attention);
    void show_located(const EditJob& job);
    void label_located(const EditJob& job, const std::string& step, const std::string& merge_key);
    void vote_if_wanted();
    void show_arriving();
    void travel(const std::function<void()>& move);
    void take_found();
    const NamedLabel* active_label() const;
    void refresh_reach();
    void choose_label_by_hand();
    bool label_drives_edit() const;
    bool edit_running() const;
    void start_edit(std::optional<edit::EditSnapshot> start);
    void finish_edit(const Error* error);
    void untint();

    // application_estimate.cpp
    std::string measured_key() const;
    Measured measured_now() const;
    void remember_measured(const std::string& key, const Measured& measured);
    void refresh_estimate();
    PlannedMemory planned_memory() const;

    // application_targets.cpp
    void refresh_targets();

    // application_snapshots.cpp
    void list_snapshots();
    void take_snapshots(const std::deque<edit::EditSnapshot>& snapshots);
    const edit::EditSnapshot* usable_snapshot(int iteration);
    GaussianSet snapshot_set(const edit::EditSnapshot& snapshot);
    void forget_snapshots();
    void go_on_from_branch();

    // application_models.cpp
    std::string model_in_use() const;
    void list_models();
    void refuse_model(const std::string& path, std::string problem);
    void take_chosen_model();
    void try_model(const std::string& path, std::vector<std::string> loras, bool takes_settings);
    void try_loras(std::vector<std::string> loras);
    void list_loras();
    void use_model(const std::string& path, const neural::ModelProfile& profile, bool takes_settings);
    void use_profile(const neural::ModelProfile& profile, bool takes_settings);
    void drop_model(const std::string& path, const Error& error);

    // application_labels.cpp
    NamedLabel* active_label_copy(DocumentState& state) const;
    void change_label(const std::string& name, const std::function<NamedLabel(NamedLabel)>& change,
                      const std::string& merge_key = {});
    void change_stack(const std::string& name, const std::function<void(std::vector<EditNode>&)>& change,
                      const std::string& merge_key = {});

    void delete_rows(const std::vector<std::uint8_t>& rows);

    // application_picked.cpp
    void refresh_picked();

    // application_hidden.cpp
    std::vector<std::uint8_t> hidden_rows(const GaussianSet& set) const;
    GaussianSet seen(const GaussianSet& set);
    GaussianSet exported(const GaussianSet& set) const;
    bool something_to_export();
    void hidden_changed();

    // application_view.cpp
    PictureRequest picture_request();
    void go_home();
    void stand_up();
    std::shared_ptr<const std::vector<float>> shown_values(const GaussianSet& set) const;
    std::shared_ptr<const std::vector<float>> on_screen(
        const std::shared_ptr<const std::vector<float>>& values, const GaussianSet& set) const;
    bool shows_snapshot() const;
    GaussianSet set_on_screen();
    const GaussianSet& before_on_screen() const;
    void compare_as_usual();
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
    std::optional<Recoverable> recovered_;        // open now, on disk until it is saved or autosaved anew
    std::vector<std::function<void()>> answers_;  // to the question of the model
    struct Leaving {
        bool keep = false;
        std::function<void()> then;
    };
    nlohmann::json kept_edit_;        // of an edit that was stopped before its first step
    std::uint64_t opened_ = 0;        // documents so far
    std::optional<Leaving> leaving_;  // waits for the edit to stop
    bool keep_ = false;               // the autosave stays when this document goes
    bool autosaved_ = false;          // there is an autosave of this document
    bool start_page_seen_ = false;
    bool keys_unsaved_ = false;               // of the camera path
    std::shared_ptr<const Image> thumbnail_;  // of the last autosave
    Clock::time_point thumbnail_made_{};
    std::string scene_path_, project_path_;
    std::uint64_t saved_revision_ = 0, autosaved_revision_ = 0, autosaved_live_ = 0;
    Clock::time_point last_autosave_ = Clock::now();
    std::string layout_;
    bool layout_loaded_ = false;
    float chosen_scale_ = 0;  // by the artist; 0 = as the desktop says

    // Work
    std::shared_ptr<neural::TextToImage> text_model_;
    std::string text_model_key_, model_path_, model_tried_;
    std::string segmenter_path_, text_segmenter_path_;  // weights of SAM and CLIPSeg; empty = none
    std::vector<std::string> loras_;                    // FILE or FILE:strength, merged into the model in use
    neural::ModelProfile profile_;                      // of the model in use
    EditRecipe defaults_;                               // what settings are that nobody chose
    std::map<std::string, std::string>
        model_problems_;  // by path, of models that were tried; empty = none yet
    std::shared_ptr<EditJob> job_;
    /// What every frame asks of the last search: what runs may be changing job_ itself.
    struct Searched {
        edit::EditWords words;
        bool target_read = false;
        std::string tuning_key;
        std::optional<neural::TunedModel> tuned = {};
    };
    Searched searched_;
    std::string job_key_, reach_key_;
    std::string looked_from_;  // where the camera was turned to when the last search began; empty = nowhere
    std::optional<ReachChoice> reach_choice_;  // of the label that was active then
    EditRecipe live_recipe_;                   // of the edit that runs
    GaussianSet job_set_;
    std::shared_ptr<const std::vector<float>> attention_values_;
    GaussianSet attention_set_;
    std::shared_ptr<LiveEdit> live_ = std::make_shared<LiveEdit>();
    std::uint64_t live_seen_ = 0;
    std::deque<edit::EditSnapshot> snapshots_;
    SnapshotSet newest_set_, looked_at_;
    std::optional<bool> tint_before_;           // of the edit whose snapshots are shown
    GaussianSet snapshot_base_;                 // what the snapshots are states of
    std::optional<edit::EditSnapshot> branch_;  // to go on from when the running edit has ended
    WaitingResults pending_;
    std::uint64_t next_edit_id_ = 1;
    std::map<std::string, Measured> measured_;  // by model and size of pictures
    ModelLoad model_load_;                      // of the model in memory
    std::shared_ptr<DiskCache> cache_ = open_answer_cache(load_cache_settings());  // of what models answered
    std::optional<Vote> wanted_vote_;
    edit::LabelThresholds voted_with_;                                             // what job_ was last told
    std::shared_ptr<ArrivingViews> arriving_ = std::make_shared<ArrivingViews>();  // of the search under way

    // View
    Camera camera_;
    Vec3 up_shown_{};  // that the orbit stands on
    int viewport_width_ = 1, viewport_height_ = 1;
    Clock::time_point last_move_ = Clock::now() - std::chrono::seconds(10), last_frame_ = Clock::now(),
                      last_estimate_{};
    struct {
        GaussianSet set;
        std::shared_ptr<const std::vector<RowId>> ids;
    } compared_;  // that comparisons show as before, where the artist chose a step
    struct AdjustedColours {
        DocumentState before;
        std::uint64_t revision, id;  // of the step, and of its edit
    };
    std::optional<AdjustedColours> adjusted_;      // while that is the last step
    std::optional<localize::RowPicking> picking_;  // splats chosen by a property
    HiddenRows hidden_;
    struct SeenSet {
        GaussianSet of, set;
    };
    std::deque<SeenSet> seen_;  // the last ones, made for hidden_ and the document's rows as they are
    std::uint64_t content_ = 1, stroke_ = 0, camera_version_ = 0, document_seen_ = 0;
    struct ShownKey {
        std::uint64_t revision = 0, live = 0;
        int mode = -1, snapshot = -2, active = -1;
        bool tint = false;
        std::optional<std::size_t> pending;
        bool operator==(const ShownKey&) const = default;
    } shown_key_;
    GaussianSet shown_set_;
    std::shared_ptr<const std::vector<float>> shown_values_;
    std::vector<ToastState> toasts_;
    std::vector<ui::LogLine> log_;
    std::shared_ptr<void> log_source_;
    bool quit_ = false;
    GaussianSet counted_;                       // what the statistics are of
    JobThread work_, files_, saver_, counter_;  // last: their threads end before what they use
};

ui::NetworkCost cost_of(const neural::NetworkUse& use);

/// On the work thread: runs a located job with the artist's label (empty = as located), feeding `live`.
void run_live(const std::shared_ptr<EditJob>& job, const std::vector<std::uint8_t>& label,
              const std::vector<float>& attention, LiveEdit& live);
/// On the work thread: shows redrawn views in `live` and takes what the artist says about them.
void watch_targets(const EditJob& job, LiveEdit& live, EditObserver& observer);

/// The texts of a list in settings or projects; what is no text is passed over.
std::vector<std::string> texts_of(const nlohmann::json& json, const char* key);

}  // namespace gse::app
