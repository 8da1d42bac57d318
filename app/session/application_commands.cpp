// Commands of the panels, each handed to the part of the application that does it.
#include "app/session/application.h"

namespace gse::app {

namespace command = ui::command;

void Application::run(const ui::Command& wanted) {
    std::visit([this](const auto& group) { std::visit([this](const auto& one) { on(one); }, group); },
               wanted);
}

void Application::on(const command::Open& one) { open(one.path); }
void Application::on(const command::OpenSample&) { open_sample(); }
void Application::on(const command::SaveProject& one) { save_project(one.path, one.then); }
void Application::on(const command::LeaveEdit& one) { leave_edit(one.keep, one.then); }
void Application::on(const command::Recover& one) { recover(one.project); }
void Application::on(const command::DiscardRecovery& one) { discard_recovery(one.project); }
void Application::on(const command::PostponeRecovery& one) { postpone_recovery(one.project); }
void Application::on(const command::SetUpAxis& one) { set_up_axis(one.up); }
void Application::on(const command::RepairScene&) { repair_scene(); }
void Application::on(const command::CancelFileJob&) { cancel_file_job(); }
void Application::on(const command::SetRequest& one) { set_request(one.request); }
void Application::on(const command::Locate&) { locate(); }
void Application::on(const command::LabelAnyway&) { label_anyway(); }
void Application::on(const command::Edit&) { edit(); }
void Application::on(const command::Pause& one) { pause(one.paused); }
void Application::on(const command::Cancel&) { cancel(); }
void Application::on(const command::OrderTarget& one) { order_target(one.order); }
void Application::on(const command::FitToTargets&) { fit_to_targets(); }
void Application::on(const command::ApplyResult&) { apply_result(); }
void Application::on(const command::DiscardResult&) { discard_result(); }
void Application::on(const command::AnotherResult&) { another_result(); }
void Application::on(const command::ShowResult& one) { show_result(one.index); }
void Application::on(const command::ShowSnapshot& one) { show_snapshot(one.index); }
void Application::on(const command::TakeSnapshot& one) { take_snapshot(one.iteration); }
void Application::on(const command::BranchFromSnapshot& one) { branch_from_snapshot(one.iteration); }
void Application::on(const command::SetAttentionThreshold& one) {
    set_attention_threshold(one.value, one.drag_ends);
}
void Application::on(const command::LeaveOutView& one) { leave_out_view(one.view, one.out); }
void Application::on(const command::SetReach& one) { set_reach(one.by_label); }
void Application::on(const command::RepeatEdit& one) { repeat_edit(one.id); }
void Application::on(const command::SetLabelThreshold& one) { set_label_threshold(one.value, one.drag_ends); }
void Application::on(const command::SetActiveLabel& one) { set_active_label(one.index); }
void Application::on(const command::AddLabel& one) { add_label(one.name); }
void Application::on(const command::RenameLabel& one) { rename_label(one.index, one.name); }
void Application::on(const command::DeleteLabel& one) { delete_label(one.index); }
void Application::on(const command::Select& one) { select(one.region, one.operation, one.stroke_ends); }
void Application::on(const command::CutOut& one) { cut_out(one.box, one.operation); }
void Application::on(const command::GrowLabel& one) { grow_label(one.steps); }
void Application::on(const command::InvertLabel&) { invert_label(); }
void Application::on(const command::ClearLabel&) { clear_label(); }
void Application::on(const command::DeleteLabelledSplats&) { delete_labelled_splats(); }
void Application::on(const command::AdjustColours& one) { adjust_colours(one.adjustment); }
void Application::on(const command::PickRows& one) { pick_rows(one.choice); }
void Application::on(const command::DropPicked&) { drop_picked(); }
void Application::on(const command::UsePicked& one) { use_picked(one.use); }
void Application::on(const command::Undo&) { undo(); }
void Application::on(const command::Redo&) { redo(); }
void Application::on(const command::GoTo& one) { go_to(one.position); }
void Application::on(const command::SetEditEnabled& one) { set_edit_enabled(one.id, one.enabled); }
void Application::on(const command::SetEditStrength& one) {
    set_edit_strength(one.id, one.strength, one.drag_ends);
}
void Application::on(const command::DeleteEdit& one) { delete_edit(one.id); }
void Application::on(const command::MoveEdit& one) { move_edit(one.id, one.places); }
void Application::on(const command::HideLabel&) { hide_label(); }
void Application::on(const command::IsolateLabel&) { isolate_label(); }
void Application::on(const command::ShowHidden&) { show_hidden(); }
void Application::on(const command::SetCamera& one) { set_camera(one.camera); }
void Application::on(const command::SetViewSettings& one) { set_view_settings(one.settings); }
void Application::on(const command::SetComparison& one) { set_comparison(one.comparison); }
void Application::on(const command::CompareWith& one) { compare_with(one.position); }
void Application::on(const command::LookThrough& one) { look_through(one.view); }
void Application::on(const command::AddView&) { add_view(); }
void Application::on(const command::DeleteView& one) { delete_view(one.view); }
void Application::on(const command::SetViewportSize& one) { set_viewport_size(one.width, one.height); }
void Application::on(const command::SetModelSettings& one) { set_model_settings(one.settings); }
void Application::on(const command::ChooseModel& one) { choose_model(one.path); }
void Application::on(const command::AddLora& one) { add_lora(one.text); }
void Application::on(const command::SetLoraStrength& one) { set_lora_strength(one.index, one.strength); }
void Application::on(const command::RemoveLora& one) { remove_lora(one.index); }
void Application::on(const command::ChooseSegmenter& one) { choose_segmenter(one.role, one.path); }
void Application::on(const command::SetCacheMb& one) { set_cache_mb(one.most); }
void Application::on(const command::ClearCache&) { clear_cache(); }
void Application::on(const command::SetExports& one) { set_exports(one.settings); }
void Application::on(const command::ExportPicture&) { export_picture(); }
void Application::on(const command::ExportTurntable&) { export_turntable(); }
void Application::on(const command::ExportScene&) { export_scene(); }
void Application::on(const command::ExportViewpoints&) { export_viewpoints(); }
void Application::on(const command::AddCameraKey&) { add_camera_key(); }
void Application::on(const command::DeleteCameraKey& one) { delete_camera_key(one.index); }
void Application::on(const command::ExportCameraPath& one) { export_camera_path(one.as_film); }
void Application::on(const command::Answer& one) { answer(one.index); }
void Application::on(const command::DismissToast& one) { dismiss_toast(one.index); }
void Application::on(const command::PressToast& one) { press_toast(one.index); }
void Application::on(const command::ToggleFullscreen&) { toggle_fullscreen(); }
void Application::on(const command::SetUiScale& one) { set_ui_scale(one.scale); }
void Application::on(const command::SetKeymap& one) { set_keymap(one.text); }
void Application::on(const command::Quit&) { quit(); }

}  // namespace gse::app
