// The picture in the middle: its header, the camera and tools that work in it, and its overlays.
#pragma once

#include <optional>
#include <string>

#include "ui/model/context.h"

namespace gse::ui {

struct ViewportState;

/// Header, picture (or what to do when nothing is open), overlays. Fills the current ImGui window.
void draw_viewport(Context& context);

// Its parts, in the order they run; the picture lies between state.low and state.high on the screen.

/// Asks for the picture's size in framebuffer pixels, adopts cameras that others set, moves ours and sends
/// it.
void update_camera(Context& context, bool keys_free);
/// Mouse and wheel over the picture. `hovered` = nothing lies above it.
void navigate(Context& context, bool hovered);
/// Brush, rectangle and lasso. True when the left button belongs to a tool.
bool use_tool(Context& context, bool hovered);
/// Handles of the labelled thing. True when the left button belongs to one.
bool use_gizmo(Context& context, bool hovered);
void draw_gizmo(Context& context, ImDrawList* list);
/// Operation of the keys held now, else the chosen one.
SetOperation operation_now(const Context& context);

/// Chosen view of the last search, if the picture is seen from there and a layer of it lies over it. Else
/// null.
const AttentionView* view_looked_through(const Context& context);
/// Chooses it, turns the camera there and shows its attention or mask over the picture.
void look_through_attention(Context& context, int index);
/// Box to tick: the vote of that view of the search.
void draw_vote(Context& context, const char* name, int index);
/// Layer of that view: attention or mask.
void draw_evidence(Context& context, ImDrawList* list);
void draw_overlays(Context& context, ImDrawList* list);
void draw_tool_cursor(Context& context, ImDrawList* list, bool hovered);
void draw_start_page(Context& context);
/// Messages at the lower right, clear of all controls; none above `top` (screen). Returns their height with
/// their margin, 0 = none. Part of the current ImGui window, so that dialogs and menus lie above.
float draw_toasts(Context& context, float top);
/// Bar at the top of the picture: apply, discard and compare while a result waits, and work of another
/// session that can be recovered.
void draw_bars(Context& context);
/// Recoverable work of a session: picture, scene, time, and what ran. Its buttons are named
/// PREFIX.recover.INDEX and so on.
void draw_recovery(Context& context, const char* prefix, std::size_t index, bool can_wait);

/// Depth along the view under a point of the window. Not positive = nothing there or unknown.
double depth_at(const Context& context, ImVec2 point);
/// Place in the window of a point of the world; nothing behind the camera.
std::optional<ImVec2> screen_point(const Context& context, const Vec3& world);
/// Text before a shade.
void shaded_text(Context& context, ImDrawList* list, ImVec2 at, const std::string& text,
                 ImU32 colour = palette::Text);
/// Place in the window of a pixel of the shown camera.
ImVec2 to_screen(const Context& context, double x_px, double y_px);
/// Place in the window of the ball of an axis's end (scene_lines.h).
ImVec2 axis_ball(const Context& context, int end);
/// End whose ball lies under the point, the nearest to the eye; -1 = none.
int axis_end_at(const Context& context, ImVec2 point);
/// Stored view whose drawing lies under the point, -1 = none.
int view_at(const Context& context, ImVec2 point);

}  // namespace gse::ui
