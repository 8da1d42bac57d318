// The panels of the window; each draws into the current ImGui window.
#pragma once

#include <array>

#include "ui/model/context.h"
#include "ui/model/layout.h"

namespace gse::ui {

void draw_prompt_panel(Context& context);
// Frames in which an unfolded part is scrolled to: until the panel knows how long it has become.
inline constexpr int FramesToBring = 3;
/// Part of the labels: splats by opacity, size, colour or isolation.
void draw_pick(Context& context);
/// Part of the labels: colours of what is labelled.
void draw_adjust(Context& context);
/// Part of the labels: place, size and number of what is labelled.
void draw_place(Context& context);
/// Begins anew behind another step, and asks for the labelled thing's place while the tool is chosen. Once
/// per frame.
void follow_placing(Context& context);
void draw_labels_panel(Context& context);
void draw_scene_panel(Context& context);
/// Part of the models: the server that draws the views of edits.
void draw_image_server(Context& context);
void draw_models_panel(Context& context);
void draw_history_panel(Context& context);
void draw_views_panel(Context& context);
void draw_export_panel(Context& context);
void draw_settings_panel(Context& context);
void draw_attention_panel(Context& context);
void draw_targets_panel(Context& context);
void draw_progress_panel(Context& context);
void draw_log_panel(Context& context);

/// Functions by PanelId, in the order of PanelTable (layout.h).
inline constexpr std::array DrawPanel{draw_prompt_panel,  draw_labels_panel,   draw_scene_panel,
                                      draw_models_panel,  draw_history_panel,  draw_views_panel,
                                      draw_export_panel,  draw_settings_panel, draw_attention_panel,
                                      draw_targets_panel, draw_progress_panel, draw_log_panel};

static_assert(DrawPanel.size() == PanelCount, "every panel is drawn");

/// "Apply" and "Discard" of a finished edit, if it asks for them. Nothing when no result waits.
void draw_result_notice(Context& context, const char* prefix);

}  // namespace gse::ui
