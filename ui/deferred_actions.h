// Holds what panels ask for until the frame is drawn, so that nothing they read changes under their hands.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "ui/actions.h"

namespace gse::ui {

class DeferredActions final : public Actions {
public:
    /// Hands everything on, in order. What is asked meanwhile waits for the next time.
    void run(Actions& target) {
        target_ = &target;
        std::vector<std::function<void()>> calls;
        calls.swap(calls_);
        for (const auto& call : calls) call();
    }
    bool empty() const { return calls_.empty(); }

    void open(const std::filesystem::path& path) override {
        later([this, path] { target_->open(path); });
    }
    void open_sample() override {
        later([this] { target_->open_sample(); });
    }
    void save_project(const std::filesystem::path& path, std::function<void()> then) override {
        later([this, path, then] { target_->save_project(path, then); });
    }
    void leave_edit(bool keep, std::function<void()> then) override {
        later([this, keep, then] { target_->leave_edit(keep, then); });
    }
    void answer(std::size_t index) override {
        later([this, index] { target_->answer(index); });
    }
    void recover(const std::string& project) override {
        later([this, project] { target_->recover(project); });
    }
    void discard_recovery(const std::string& project) override {
        later([this, project] { target_->discard_recovery(project); });
    }
    void postpone_recovery(const std::string& project) override {
        later([this, project] { target_->postpone_recovery(project); });
    }
    void set_up_axis(const std::string& up) override {
        later([this, up] { target_->set_up_axis(up); });
    }
    void repair_scene() override {
        later([this] { target_->repair_scene(); });
    }
    void locate() override {
        later([this] { target_->locate(); });
    }
    void label_anyway() override {
        later([this] { target_->label_anyway(); });
    }
    void edit() override {
        later([this] { target_->edit(); });
    }
    void pause(bool paused) override {
        later([this, paused] { target_->pause(paused); });
    }
    void cancel() override {
        later([this] { target_->cancel(); });
    }
    void cancel_file_job() override {
        later([this] { target_->cancel_file_job(); });
    }
    void order_target(const edit::TargetOrder& order) override {
        later([this, order] { target_->order_target(order); });
    }
    void fit_to_targets() override {
        later([this] { target_->fit_to_targets(); });
    }
    void apply_result() override {
        later([this] { target_->apply_result(); });
    }
    void discard_result() override {
        later([this] { target_->discard_result(); });
    }
    void another_result() override {
        later([this] { target_->another_result(); });
    }
    void show_result(std::size_t index) override {
        later([this, index] { target_->show_result(index); });
    }
    void show_snapshot(int index) override {
        later([this, index] { target_->show_snapshot(index); });
    }
    void take_snapshot(int iteration) override {
        later([this, iteration] { target_->take_snapshot(iteration); });
    }
    void branch_from_snapshot(int iteration) override {
        later([this, iteration] { target_->branch_from_snapshot(iteration); });
    }
    void set_attention_threshold(double value, bool drag_ends) override {
        later([this, value, drag_ends] { target_->set_attention_threshold(value, drag_ends); });
    }
    void leave_out_view(std::size_t view, bool out) override {
        later([this, view, out] { target_->leave_out_view(view, out); });
    }
    void set_label_threshold(float value, bool drag_ends) override {
        later([this, value, drag_ends] { target_->set_label_threshold(value, drag_ends); });
    }
    void set_active_label(int index) override {
        later([this, index] { target_->set_active_label(index); });
    }
    void set_reach(bool by_label) override {
        later([this, by_label] { target_->set_reach(by_label); });
    }
    void add_label(const std::string& name) override {
        later([this, name] { target_->add_label(name); });
    }
    void rename_label(int index, const std::string& name) override {
        later([this, index, name] { target_->rename_label(index, name); });
    }
    void delete_label(int index) override {
        later([this, index] { target_->delete_label(index); });
    }
    void select(const ScreenRegion& region, SetOperation operation, bool stroke_ends) override {
        later([this, region, operation, stroke_ends] { target_->select(region, operation, stroke_ends); });
    }
    void cut_out(const ScreenRegion& box, SetOperation operation) override {
        later([this, box, operation] { target_->cut_out(box, operation); });
    }
    void grow_label(int steps) override {
        later([this, steps] { target_->grow_label(steps); });
    }
    void invert_label() override {
        later([this] { target_->invert_label(); });
    }
    void clear_label() override {
        later([this] { target_->clear_label(); });
    }
    void adjust_colours(const ColourAdjustment& adjustment) override {
        later([this, adjustment] { target_->adjust_colours(adjustment); });
    }
    void pick_rows(const localize::RowChoice& choice) override {
        later([this, choice] { target_->pick_rows(choice); });
    }
    void drop_picked() override {
        later([this] { target_->drop_picked(); });
    }
    void use_picked(PickedUse use) override {
        later([this, use] { target_->use_picked(use); });
    }
    void hide_label() override {
        later([this] { target_->hide_label(); });
    }
    void isolate_label() override {
        later([this] { target_->isolate_label(); });
    }
    void show_hidden() override {
        later([this] { target_->show_hidden(); });
    }
    void delete_labelled_splats() override {
        later([this] { target_->delete_labelled_splats(); });
    }
    void undo() override {
        later([this] { target_->undo(); });
    }
    void redo() override {
        later([this] { target_->redo(); });
    }
    void go_to(std::size_t position) override {
        later([this, position] { target_->go_to(position); });
    }
    void set_edit_enabled(std::uint64_t id, bool enabled) override {
        later([this, id, enabled] { target_->set_edit_enabled(id, enabled); });
    }
    void set_edit_strength(std::uint64_t id, double strength, bool drag_ends) override {
        later([this, id, strength, drag_ends] { target_->set_edit_strength(id, strength, drag_ends); });
    }
    void delete_edit(std::uint64_t id) override {
        later([this, id] { target_->delete_edit(id); });
    }
    void move_edit(std::uint64_t id, int places) override {
        later([this, id, places] { target_->move_edit(id, places); });
    }
    void repeat_edit(std::uint64_t id) override {
        later([this, id] { target_->repeat_edit(id); });
    }
    void set_camera(const Camera& camera) override {
        later([this, camera] { target_->set_camera(camera); });
    }
    void set_view_settings(const ViewSettings& settings) override {
        later([this, settings] { target_->set_view_settings(settings); });
    }
    void set_model_settings(const ModelSettings& settings) override {
        later([this, settings] { target_->set_model_settings(settings); });
    }
    void set_comparison(Comparison comparison) override {
        later([this, comparison] { target_->set_comparison(comparison); });
    }
    void compare_with(std::size_t position) override {
        later([this, position] { target_->compare_with(position); });
    }
    void look_through(std::size_t view) override {
        later([this, view] { target_->look_through(view); });
    }
    void add_view() override {
        later([this] { target_->add_view(); });
    }
    void delete_view(std::size_t view) override {
        later([this, view] { target_->delete_view(view); });
    }
    void set_viewport_size(int width, int height) override {
        later([this, width, height] { target_->set_viewport_size(width, height); });
    }
    void set_request(const edit::EditRequest& request) override {
        later([this, request] { target_->set_request(request); });
    }
    void choose_model(const std::string& path) override {
        later([this, path] { target_->choose_model(path); });
    }
    void add_lora(const std::string& text) override {
        later([this, text] { target_->add_lora(text); });
    }
    void set_lora_strength(std::size_t index, double strength) override {
        later([this, index, strength] { target_->set_lora_strength(index, strength); });
    }
    void remove_lora(std::size_t index) override {
        later([this, index] { target_->remove_lora(index); });
    }
    void choose_segmenter(SegmenterRole role, const std::string& path) override {
        later([this, role, path] { target_->choose_segmenter(role, path); });
    }
    void set_exports(const ExportSettings& settings) override {
        later([this, settings] { target_->set_exports(settings); });
    }
    void export_picture() override {
        later([this] { target_->export_picture(); });
    }
    void export_turntable() override {
        later([this] { target_->export_turntable(); });
    }
    void export_scene() override {
        later([this] { target_->export_scene(); });
    }
    void export_viewpoints() override {
        later([this] { target_->export_viewpoints(); });
    }
    void add_camera_key() override {
        later([this] { target_->add_camera_key(); });
    }
    void delete_camera_key(std::size_t index) override {
        later([this, index] { target_->delete_camera_key(index); });
    }
    void export_camera_path(bool as_film) override {
        later([this, as_film] { target_->export_camera_path(as_film); });
    }
    void dismiss_toast(std::size_t index) override {
        later([this, index] { target_->dismiss_toast(index); });
    }
    void press_toast(std::size_t index) override {
        later([this, index] { target_->press_toast(index); });
    }
    void toggle_fullscreen() override {
        later([this] { target_->toggle_fullscreen(); });
    }
    void set_keymap(const std::string& text) override {
        later([this, text] { target_->set_keymap(text); });
    }
    void set_ui_scale(float scale) override {
        later([this, scale] { target_->set_ui_scale(scale); });
    }
    void set_cache_mb(int most) override {
        later([this, most] { target_->set_cache_mb(most); });
    }
    void clear_cache() override {
        later([this] { target_->clear_cache(); });
    }
    void quit() override {
        later([this] { target_->quit(); });
    }

private:
    void later(std::function<void()> call) { calls_.push_back(std::move(call)); }

    Actions* target_ = nullptr;
    std::vector<std::function<void()>> calls_;
};

}  // namespace gse::ui
