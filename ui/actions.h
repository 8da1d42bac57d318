// What the panels can ask for. The application implements it; every call returns at once, work goes to the
// job threads, and what came of it is seen in the ViewModel of a later frame. Errors are shown by the
// application, never thrown to panels.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "engine/localize/row_property.h"
#include "engine/scene/colour_adjustment.h"
#include "ui/view_model.h"

namespace gse::ui {

/// A region on the screen, in pixels of the viewport texture, that splats are selected with.
struct ScreenRegion {
    std::vector<std::array<float, 2>> polygon;  // closed; empty = use the circles
    std::vector<std::array<float, 2>> circles;  // centres of a brush stroke
    float radius_px = 0;
};

/// What to do with splats that were chosen by a property.
enum class PickedUse { NewLabel, Add, Remove, Delete };

class Actions {
public:
    virtual ~Actions() = default;
    // Files
    virtual void open(const std::filesystem::path&
                          path) = 0;  // scene, folder, project, cameras of the open scene, PNG with a recipe
    virtual void open_sample() = 0;
    /// An empty path = where it was saved last. `then` (may be empty) is called once it is saved.
    virtual void save_project(const std::filesystem::path& path, std::function<void()> then = {}) = 0;
    /// Stops a running edit. Keep: what it reached and all else that is unsaved is written down, to be
    /// offered when the scene is opened again or the program starts; else what it reached, or the result that
    /// waits, is dropped. Then calls `then`.
    virtual void leave_edit(bool keep, std::function<void()> then) = 0;
    virtual void answer(std::size_t index) = 0;  // to the question the model holds
    virtual void recover(const std::string& project) = 0;
    virtual void discard_recovery(const std::string& project) = 0;
    virtual void postpone_recovery(const std::string& project) = 0;  // it is offered again another time
    virtual void set_up_axis(const std::string& up) = 0;             // "y", "-y", "auto", ...
    virtual void repair_scene() = 0;                                 // drops what cannot be drawn (undoable)
    // Work
    virtual void locate() = 0;
    virtual void label_anyway() = 0;  // what an unsure search found
    virtual void edit() = 0;
    virtual void pause(bool paused) = 0;
    virtual void cancel() = 0;  // the edit job
    virtual void cancel_file_job() = 0;
    /// Of the round that is fitted to now: what the fit uses, or a view once more.
    virtual void order_target(const edit::TargetOrder& order) = 0;
    virtual void fit_to_targets() = 0;  // the edit waits for it
    virtual void apply_result() = 0;
    virtual void discard_result() = 0;  // and those beside it
    virtual void
    another_result() = 0;  // once more with another seed; the result that waits is kept beside it
    virtual void show_result(std::size_t index) = 0;  // that one waits
    virtual void show_snapshot(int index) = 0;        // -1 = newest
    virtual void take_snapshot(int iteration) = 0;    // that state is the result that waits
    virtual void branch_from_snapshot(
        int iteration) = 0;  // goes on from there with the settings as they are now
    // Labels (all undoable)
    virtual void set_attention_threshold(double value, bool drag_ends) = 0;  // one step of undo per drag
    virtual void leave_out_view(
        std::size_t view, bool out) = 0;  // of the search; the label is voted again without it, or with it
    virtual void set_label_threshold(float value, bool drag_ends) = 0;
    virtual void set_active_label(int index) = 0;
    virtual void set_reach(bool by_label) = 0;  // the active label, or a search, says what may change
    virtual void add_label(const std::string& name) = 0;
    virtual void rename_label(int index, const std::string& name) = 0;
    virtual void delete_label(int index) = 0;
    virtual void select(const ScreenRegion& region, SetOperation operation, bool stroke_ends) = 0;
    virtual void cut_out(const ScreenRegion& box,
                         SetOperation operation) = 0;  // selects the thing in the box
    virtual void grow_label(int steps) = 0;            // negative shrinks
    virtual void invert_label() = 0;
    virtual void clear_label() = 0;
    virtual void delete_labelled_splats() = 0;
    /// Colours of what is labelled, or of all splats where nothing is: of how they were before the first of
    /// several calls in a row, which are one step of undo. As it is = as if there had been none.
    virtual void adjust_colours(const ColourAdjustment& adjustment) = 0;
    /// Shows which splats a choice means, until they are dropped. Only use_picked() changes anything.
    virtual void pick_rows(const localize::RowChoice& choice) = 0;
    virtual void drop_picked() = 0;
    virtual void use_picked(PickedUse use) = 0;
    // What is seen; the scene stays as it is, and undo does not know of it
    virtual void hide_label() = 0;
    virtual void isolate_label() = 0;  // hides all else
    virtual void show_hidden() = 0;
    // History
    virtual void undo() = 0;
    virtual void redo() = 0;
    virtual void go_to(std::size_t position) = 0;
    virtual void set_edit_enabled(std::uint64_t id, bool enabled) = 0;
    virtual void set_edit_strength(std::uint64_t id, double strength,
                                   bool drag_ends) = 0;  // a drag is one step of undo
    virtual void delete_edit(std::uint64_t id) = 0;
    virtual void move_edit(std::uint64_t id, int places) = 0;
    virtual void repeat_edit(std::uint64_t id) = 0;  // its settings into the prompt, with a new seed
    // View
    virtual void set_camera(const Camera& camera) = 0;  // in viewport pixels; moving = resolution may drop
    virtual void set_view_settings(const ViewSettings& settings) = 0;
    virtual void set_comparison(Comparison comparison) = 0;
    /// What comparisons show as before: a step of undo; one that is shown so already = the original again.
    virtual void compare_with(std::size_t position) = 0;
    virtual void look_through(std::size_t view) = 0;
    virtual void add_view() = 0;  // the present camera becomes a view
    virtual void delete_view(std::size_t view) = 0;
    virtual void set_viewport_size(int width, int height) = 0;  // framebuffer pixels wanted
    // Prompt and models
    virtual void set_request(const edit::EditRequest& request) = 0;
    virtual void set_model_settings(const ModelSettings& settings) = 0;
    virtual void choose_model(const std::string& path) = 0;  // a path typed or picked; added to the list
    virtual void add_lora(
        const std::string& text) = 0;  // FILE or FILE:strength; these three load the model anew, and
    virtual void set_lora_strength(std::size_t index,
                                   double strength) = 0;  // leave it as it was where that fails
    virtual void remove_lora(std::size_t index) = 0;
    virtual void choose_segmenter(
        SegmenterRole role, const std::string& path) = 0;  // weights, tried before they count; empty = none
    // Export
    virtual void set_exports(const ExportSettings& settings) = 0;
    virtual void export_picture() = 0;
    virtual void export_turntable() = 0;
    virtual void export_scene() = 0;
    virtual void export_viewpoints() = 0;
    virtual void add_camera_key() = 0;
    virtual void delete_camera_key(std::size_t index) = 0;
    virtual void export_camera_path(bool as_film) = 0;  // JSON, or the film along the path
    // Window
    virtual void dismiss_toast(std::size_t index) = 0;
    virtual void press_toast(std::size_t) {}  // its button
    virtual void toggle_fullscreen() {}
    virtual void set_ui_scale(float scale) = 0;
    virtual void set_keymap(const std::string&) {}  // Keymap::text()
    virtual void set_cache_mb(int) {}               // answers of the networks on the disk; 0 = none
    virtual void clear_cache() {}
    virtual void quit() = 0;
};

}  // namespace gse::ui
