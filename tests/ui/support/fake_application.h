// An application that only remembers what it was asked for, with a small real scene behind its view model.
#pragma once

#include <fmt/format.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "engine/scene/document.h"
#include "ui/actions.h"
#include "ui/view_model.h"

namespace gse::test {

/// What the window may be in.
enum class Situation { Nothing, Scene, Located, Editing, ResultWaiting, Failed };

/// An offer to recover work in SCENE.ply.
ui::RecoveryView recovery_of(const std::string& scene);

class FakeApplication final : public ui::Actions, public ui::Textures {
public:
    explicit FakeApplication(Situation situation);
    ~FakeApplication() override;

    ui::ViewModel& model() { return model_; }
    Document& document() { return *document_; }
    /// Renders the viewport's picture when camera or size changed (only when `pictures`).
    void refresh(bool pictures);

    const Image* picture(std::uint64_t id) const;
    /// Everything asked for, one line each: "locate", "set_label_threshold 0.3", ...
    std::vector<std::string> calls;
    bool asked(const std::string& start) const;
    std::vector<ui::ScreenRegion> regions;
    std::vector<ui::SetOperation> operations;

    ui::TextureId texture(const std::shared_ptr<const Image>& image) override;

    void open(const std::filesystem::path& path) override { calls.push_back("open " + path.string()); }
    void open_sample() override { calls.push_back("open_sample"); }
    void save_project(const std::filesystem::path& path, std::function<void()> then) override {
        calls.push_back("save_project " + path.string());
        if (then) then();
    }
    void leave_edit(bool keep, std::function<void()> then) override {
        calls.push_back(keep ? "leave_edit keep" : "leave_edit discard");
        model_.edit_running = model_.job.running = model_.result_waiting = false;
        if (then) then();
    }
    void answer(std::size_t index) override { calls.push_back("answer " + std::to_string(index)); }
    void recover(const std::string& project) override { calls.push_back("recover " + project); }
    void discard_recovery(const std::string& project) override {
        calls.push_back("discard_recovery " + project);
    }
    void postpone_recovery(const std::string& project) override {
        calls.push_back("postpone_recovery " + project);
    }
    void set_up_axis(const std::string& up) override { calls.push_back("set_up_axis " + up); }
    void repair_scene() override { calls.push_back("repair_scene"); }
    void locate() override { calls.push_back("locate"); }
    void label_anyway() override { calls.push_back("label_anyway"); }
    void edit() override { calls.push_back("edit"); }
    void pause(bool paused) override { calls.push_back(paused ? "pause" : "resume"); }
    void cancel() override { calls.push_back("cancel"); }
    void cancel_file_job() override { calls.push_back("cancel_file_job"); }
    void order_target(const edit::TargetOrder& order) override;
    void fit_to_targets() override { calls.push_back("fit_to_targets"); }
    void apply_result() override { calls.push_back("apply_result"); }
    void discard_result() override { calls.push_back("discard_result"); }
    void another_result() override { calls.push_back("another_result"); }
    void show_result(std::size_t index) override { calls.push_back("show_result " + std::to_string(index)); }
    void show_snapshot(int index) override { calls.push_back("show_snapshot " + std::to_string(index)); }
    void take_snapshot(int iteration) override {
        calls.push_back("take_snapshot " + std::to_string(iteration));
    }
    void branch_from_snapshot(int iteration) override {
        calls.push_back("branch_from_snapshot " + std::to_string(iteration));
    }
    void hide_label() override { calls.push_back("hide_label"); }
    void isolate_label() override { calls.push_back("isolate_label"); }
    void show_hidden() override { calls.push_back("show_hidden"); }
    void compare_with(std::size_t position) override {
        calls.push_back("compare_with " + std::to_string(position));
    }
    void pick_rows(const localize::RowChoice& choice) override;
    void set_keymap(const std::string& text) override {
        calls.push_back("set_keymap " + text);
        model_.keymap = text;
    }
    void adjust_colours(const ColourAdjustment& adjustment) override {
        calls.push_back("adjust_colours " + adjustment_text(adjustment));
        model_.adjusting = !(adjustment == ColourAdjustment{});
    }
    void drop_picked() override {
        calls.push_back("drop_picked");
        model_.picked = {};
    }
    void use_picked(ui::PickedUse use) override {
        calls.push_back("use_picked " + std::to_string(static_cast<int>(use)));
    }
    void set_attention_threshold(double value, bool drag_ends) override;
    void leave_out_view(std::size_t view, bool out) override;
    void set_label_threshold(float value, bool drag_ends) override;
    void set_active_label(int index) override {
        calls.push_back("set_active_label " + std::to_string(index));
    }
    void set_reach(bool by_label) override {
        calls.push_back(by_label ? "set_reach label" : "set_reach search");
    }
    void add_label(const std::string& name) override { calls.push_back("add_label " + name); }
    void rename_label(int index, const std::string& name) override {
        calls.push_back("rename_label " + std::to_string(index) + " " + name);
    }
    void delete_label(int index) override;
    void select(const ui::ScreenRegion& region, ui::SetOperation operation, bool stroke_ends) override;
    void cut_out(const ui::ScreenRegion& box, ui::SetOperation) override {
        calls.push_back("cut_out " + std::to_string(box.polygon.size()));
    }
    void grow_label(int steps) override { calls.push_back("grow_label " + std::to_string(steps)); }
    void invert_label() override { calls.push_back("invert_label"); }
    void clear_label() override { calls.push_back("clear_label"); }
    void delete_labelled_splats() override { calls.push_back("delete_labelled_splats"); }
    void undo() override { calls.push_back("undo"); }
    void redo() override { calls.push_back("redo"); }
    void go_to(std::size_t position) override { calls.push_back("go_to " + std::to_string(position)); }
    void set_edit_enabled(std::uint64_t id, bool on) override {
        calls.push_back("set_edit_enabled " + std::to_string(id) + (on ? " on" : " off"));
    }
    void set_edit_strength(std::uint64_t id, double strength, bool drag_ends) override {
        calls.push_back("set_edit_strength " + std::to_string(id) + " " + std::to_string(strength) +
                        (drag_ends ? " end" : ""));
    }
    void delete_edit(std::uint64_t id) override { calls.push_back("delete_edit " + std::to_string(id)); }
    void move_edit(std::uint64_t id, int places) override {
        calls.push_back("move_edit " + std::to_string(id) + " " + std::to_string(places));
    }
    void repeat_edit(std::uint64_t id) override { calls.push_back("repeat_edit " + std::to_string(id)); }
    void set_camera(const Camera& camera) override;
    void set_view_settings(const ui::ViewSettings& settings) override;
    void set_model_settings(const ui::ModelSettings& settings) override {
        model_.model_settings = settings;
        calls.push_back("set_model_settings");
    }
    void set_comparison(ui::Comparison comparison) override;
    void look_through(std::size_t view) override;
    void add_view() override { calls.push_back("add_view"); }
    void delete_view(std::size_t view) override { calls.push_back("delete_view " + std::to_string(view)); }
    void set_viewport_size(int width, int height) override;
    void set_request(const edit::EditRequest& request) override;
    void choose_model(const std::string& path) override { calls.push_back("choose_model " + path); }
    void choose_segmenter(ui::SegmenterRole role, const std::string& path) override {
        calls.push_back((role == ui::SegmenterRole::Clicks ? "choose_segmenter " : "choose_text_segmenter ") +
                        path);
    }
    void add_lora(const std::string& text) override { calls.push_back("add_lora " + text); }
    void set_lora_strength(std::size_t index, double strength) override {
        calls.push_back("set_lora_strength " + std::to_string(index) + " " + std::to_string(strength));
    }
    void remove_lora(std::size_t index) override { calls.push_back("remove_lora " + std::to_string(index)); }
    void set_exports(const ui::ExportSettings& settings) override;
    void export_picture() override { calls.push_back("export_picture"); }
    void export_turntable() override { calls.push_back("export_turntable"); }
    void export_scene() override { calls.push_back("export_scene"); }
    void export_viewpoints() override { calls.push_back("export_viewpoints"); }
    void add_camera_key() override { calls.push_back("add_camera_key"); }
    void delete_camera_key(std::size_t index) override {
        calls.push_back("delete_camera_key " + std::to_string(index));
    }
    void export_camera_path(bool as_film) override {
        calls.push_back(as_film ? "export_camera_path film" : "export_camera_path");
    }
    void dismiss_toast(std::size_t index) override {
        calls.push_back("dismiss_toast " + std::to_string(index));
    }
    void press_toast(std::size_t index) override { calls.push_back("press_toast " + std::to_string(index)); }
    void toggle_fullscreen() override { calls.push_back("toggle_fullscreen"); }
    void set_ui_scale(float scale) override;
    void set_cache_mb(int most) override { calls.push_back(fmt::format("set_cache_mb {}", most)); }
    void clear_cache() override { calls.push_back("clear_cache"); }
    void quit() override { calls.push_back("quit"); }

private:
    void make_scene();
    void make_attention();
    void make_work(bool running);
    void make_targets();
    void make_rest();

    ui::ViewModel model_;
    std::unique_ptr<Document> document_;
    struct Renderer;
    std::unique_ptr<Renderer> renderer_;
    std::map<std::uint64_t, std::shared_ptr<const Image>> textures_;
    std::map<const Image*, std::uint64_t> ids_;
    std::shared_ptr<const Image> viewport_picture_;
    Camera rendered_;
    std::uint64_t next_id_ = 100;
};

}  // namespace gse::test
