// The picture in the middle: its header, the camera and tools that work in it, and what is drawn over it.
#pragma once

#include "ui/context.h"

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
/// Operation of the keys held now, else the chosen one.
SetOperation operation_now(const ViewportState& state);

void draw_overlays(Context& context, ImDrawList* list);
void draw_tool_cursor(Context& context, ImDrawList* list, bool hovered);
void draw_start_page(Context& context);
void draw_toasts(Context& context);
/// Apply, discard and compare over the picture while a result waits.
void draw_result_bar(Context& context);

/// Depth along the view under a point of the window; not positive = nothing there or unknown.
double depth_at(const Context& context, ImVec2 point);
/// Pixel of the shown camera to the window.
ImVec2 to_screen(const Context& context, double x_px, double y_px);
/// Where the ball of a world axis (0, 1, 2) is drawn in the corner.
ImVec2 axis_ball(const Context& context, int axis);
/// The shown camera's view that lies under the point, -1 = none.
int view_at(const Context& context, ImVec2 point);

}  // namespace gse::ui
