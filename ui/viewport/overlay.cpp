// Lines over the picture: axes, bounds, cameras, the wipe, and the numbers in the corner.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "ui/commands/guarded.h"
#include "ui/model/glyphs.h"
#include "ui/state/state.h"
#include "ui/viewport/scene_lines.h"
#include "ui/viewport/viewport.h"
#include "ui/widgets/controls.h"

namespace gse::ui {
namespace {

constexpr double RateSeconds = 1;  // the frame rate is shown this long after the last move
constexpr float PickRadiusEm = 0.8f;

double near_of(const Context& context) { return std::max(1e-9, context.model.orbit.radius * 1e-3); }

/// A line of the world, cut at the near plane; nothing when it is behind.
void draw_world_line(const Context& context, ImDrawList* list, const WorldLine& line, ImU32 colour,
                     float width) {
    if (const auto seen = seen_line(context.model.camera, line, context.model.orbit.radius))
        list->AddLine(to_screen(context, (*seen)[0], (*seen)[1]), to_screen(context, (*seen)[2], (*seen)[3]),
                      colour, width);
}

ImVec2 axes_centre(const Context& context) {
    const auto& state = context.state.viewport;
    const float away = context.em * AxesEm * AxesAway;
    const bool covered = state.foot_low.x < state.low.x + 2 * away;
    return {state.low.x + away, (covered ? std::min(state.high.y, state.foot_low.y) : state.high.y) - away};
}

/// "x", "-x" and so on.
std::string axis_name(int end) { return fmt::format("{}{}", end < 3 ? "" : "-", "xyz"[end % 3]); }

/// An end of a world axis: a ball with its letter, or a ring at the negative one.
void draw_axis_end(Context& context, ImDrawList* list, int end, bool under_mouse) {
    const ImVec2 centre = axes_centre(context), at = axis_ball(context, end);
    const bool positive = end < 3;
    const ImU32 colour = axis_colour(context.model.camera, end);
    const float line = std::max(1.5f, context.em * 0.13f);
    const float r = context.em * AxisBallEm * (positive ? 1.0f : FarEndShare);
    if (positive) list->AddLine(centre, at, colour, line);
    list->AddCircleFilled(at, r, positive ? colour : with_alpha(palette::Window, 0.75f));
    if (!positive) list->AddCircle(at, r, colour, 0, line);
    if (under_mouse) list->AddCircle(at, r + line, palette::Text, 0, line);
    note_rect(context, fmt::format("viewport.axis.{}", axis_name(end)), {at.x - r, at.y - r},
              {at.x + r, at.y + r});
    if (!positive && !under_mouse) return;
    const std::string name = axis_name(end);
    const ImVec2 text = ImGui::CalcTextSize(name.c_str());
    list->AddText({at.x - text.x * 0.5f, at.y - text.y * 0.54f},
                  positive ? IM_COL32(20, 20, 22, 255) : palette::Text, name.c_str());
}

/// The world's axes in the lower left corner, turned as the camera is. Each end is a button.
void draw_axes(Context& context, ImDrawList* list) {
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const int chosen = axis_end_at(context, mouse);
    for (const int end : axes_by_depth(context.model.camera))
        draw_axis_end(context, list, end, end == chosen);
    if (chosen < 0 || context.state.viewport.stroke || context.state.viewport.drag_button >= 0) return;
    shaded_text(context, list, {mouse.x + context.em, mouse.y - context.em * 2},
                fmt::format("Look from {}", axis_name(chosen)));
}

void draw_bounds(Context& context, ImDrawList* list) {
    const auto& statistics = context.model.statistics;
    for (const auto& line : box_lines(statistics.robust_low, statistics.robust_high))
        draw_world_line(context, list, line, with_alpha(palette::Text, BoundsAlpha), 1);
}

void draw_view(Context& context, ImDrawList* list, const View& view, bool selected) {
    const auto lines = frustum_lines(view.camera, context.model.orbit.radius, context.model.camera);
    if (lines.empty()) return;
    const ImU32 colour = selected ? palette::Accent : with_alpha(palette::Text, FrustumAlpha);
    const float width = selected ? std::max(2.0f, context.em * 0.14f) : frustum_width(context.em);
    for (const auto& line : lines) draw_world_line(context, list, line, colour, width);
    const auto apex = screen_point(context, view.camera.centre());
    if (apex) list->AddCircleFilled(*apex, context.em * (selected ? 0.26f : EyeEm), colour);
    if (apex && selected)
        list->AddText({apex->x + context.em * 0.5f, apex->y - context.em * 0.5f}, palette::Text,
                      std::string(Shown(view.name).text()).c_str());
}

void draw_views(Context& context, ImDrawList* list) {
    const auto& views = context.document().views;
    for (std::size_t index = 0; index < views.size(); ++index)
        draw_view(context, list, views[index],
                  static_cast<int>(index) == context.state.viewport.selected_view);
}

/// Number of shown splats.
std::size_t shown_splats(const Context& context) {
    const auto& model = context.model;
    const bool listed =
        model.shown_snapshot >= 0 && model.shown_snapshot < static_cast<int>(model.snapshots.size());
    if (listed && (model.result_waiting || model.edit_running))
        return model.snapshots[static_cast<std::size_t>(model.shown_snapshot)].splats;
    if (model.result_waiting) return model.result_splats;
    if (model.edit_running && !model.snapshots.empty()) return model.snapshots.back().splats;
    return context.document().current.size();
}

void draw_hud(Context& context, ImDrawList* list) {
    const auto& model = context.model;
    const auto& state = context.state.viewport;
    // At rest nothing is drawn, and a rate would say how often nobody looked.
    const bool moving = ImGui::GetTime() - state.moved_at < RateSeconds;
    const std::array<std::string, 5> parts{
        fmt::format("{} splats", count_text(shown_splats(context))),
        model.labelled > 0 && !model.result_waiting ? fmt::format("{} labelled", count_text(model.labelled))
                                                    : std::string(),
        fmt::format("{:.1f} ms", model.render_ms),
        moving ? fmt::format("{:.0f} fps", model.frames_per_second) : std::string(), model.renderer};
    const float room = state.high.x - state.low.x - context.em * 2;
    std::string text;
    for (const auto& part : parts) {
        const std::string longer = text.empty() ? part : fmt::format("{}   {}", text, part);
        if (!part.empty() && ImGui::CalcTextSize(longer.c_str()).x < room) text = longer;
    }
    shaded_text(context, list, {state.low.x + context.em * 0.5f, state.low.y + context.em * 0.5f}, text);
}

void draw_wipe(Context& context, ImDrawList* list) {
    const auto& state = context.state.viewport;
    const float x = std::round(state.low.x + context.view.wipe * (state.high.x - state.low.x));
    const float middle = (state.low.y + state.high.y) * 0.5f, r = context.em * 0.75f;
    list->AddLine({x, state.low.y}, {x, state.high.y}, IM_COL32(255, 255, 255, 220),
                  std::max(1.5f, context.em * 0.12f));
    list->AddCircleFilled({x, middle}, r, palette::Window);
    list->AddCircle({x, middle}, r, IM_COL32(255, 255, 255, 220), 0, std::max(1.5f, context.em * 0.12f));
    for (const float side : {-1.0f, 1.0f})
        list->AddTriangleFilled({x + side * r * 0.65f, middle}, {x + side * r * 0.2f, middle - r * 0.35f},
                                {x + side * r * 0.2f, middle + r * 0.35f}, palette::Text);
    const float y = std::min(state.high.y, state.foot_low.y) - context.em * 2.2f;
    const bool chosen = context.model.compared_revision != 0;  // another step than usual
    const std::string left = chosen ? shortened(context.model.compared_name, context.em * 14) : "before";
    const float before = ImGui::CalcTextSize(left.c_str()).x + context.em * 1.2f;
    shaded_text(context, list, {x - before - context.em * 0.3f, y}, left,
                chosen ? palette::Warning : palette::Text);
    shaded_text(context, list, {x + context.em * 0.6f, y}, chosen ? "now" : "after");
    note_rect(context, "viewport.wipe", {x - r, middle - r}, {x + r, middle + r});
}

/// Line below the numbers: the effect of the active tool and its keys, as much as fits.
void draw_hint(Context& context, ImDrawList* list) {
    const auto& state = context.state.viewport;
    if (state.tool == Tool::Orbit) return;
    const float below = context.view.show_hud ? 2.3f : 0.5f;
    const ImVec2 corner{state.low.x + context.em * 0.5f, state.low.y + context.em * below};
    if (state.tool == Tool::PickColour)
        return shaded_text(context, list, corner, "Click a colour   Esc leaves");
    const std::string why = why_not_work(context);
    if (state.tool == Tool::Place && !why.empty())
        return shaded_text(context, list, corner, fmt::format("Place: {}   Esc leaves", why));
    if (state.tool == Tool::Place)
        return shaded_text(context, list, corner,
                           context.model.placed ? "Place: drag a handle   Ctrl snaps   Esc leaves"
                                                : "Place: label a thing first   Esc leaves");
    if (state.tool == Tool::Heal)
        return shaded_text(context, list, corner,
                           "Heal: paint over a hole or a blemish   [ ] size   Esc leaves");
    std::string text = state.tool == Tool::Brush       ? "Brush: drag to paint"
                       : state.tool == Tool::Rectangle ? "Rectangle: drag a box"
                       : state.tool == Tool::CutOut    ? "Cut out: click on a thing, or drag a box around it"
                                                       : "Lasso: drag around";
    const auto& source = context.request.source;
    const bool asked =
        !source.empty() && !context.state.prompt.source_known && !context.model.labelled_by_hand;
    if (state.tool == Tool::CutOut && asked)
        text = fmt::format("I do not know \"{}\": click on it, or drag a box around it", source);
    const float room = state.high.x - state.low.x - context.em * 2;
    for (const char* part :
         {"Shift add", "Ctrl remove", "Alt intersect",
          state.tool == Tool::CutOut ? "labels all its sides; you see its front"
          : context.view.front_only  ? "N: front only"
                                     : "N: all the way through",
          state.tool == Tool::Brush ? "[ ] size" : "", "middle drag orbits", "Esc leaves"}) {
        const std::string longer = fmt::format("{}   {}", text, part);
        if (*part != 0 && ImGui::CalcTextSize(longer.c_str()).x < room) text = longer;
    }
    shaded_text(context, list, corner, text);
}

}  // namespace

std::optional<ImVec2> screen_point(const Context& context, const Vec3& world) {
    const Camera& camera = context.model.camera;
    const Vec3 p = camera.to_camera(world);
    if (p.z < near_of(context)) return std::nullopt;
    return to_screen(context, camera.fx * p.x / p.z + camera.cx, camera.fy * p.y / p.z + camera.cy);
}

void shaded_text(Context& context, ImDrawList* list, ImVec2 at, const std::string& text, ImU32 colour) {
    const ImVec2 size = ImGui::CalcTextSize(text.c_str());
    const float pad = context.em * 0.4f;
    list->AddRectFilled({at.x, at.y}, {at.x + size.x + 2 * pad, at.y + size.y + pad}, palette::Shade,
                        context.em * 0.2f);
    list->AddText({at.x + pad, at.y + pad * 0.5f}, colour, text.c_str());
}

ImVec2 to_screen(const Context& context, double x_px, double y_px) {
    const auto& state = context.state.viewport;
    const auto& camera = context.model.camera;
    return {
        state.low.x + static_cast<float>(x_px / std::max(1, camera.width)) * (state.high.x - state.low.x),
        state.low.y + static_cast<float>(y_px / std::max(1, camera.height)) * (state.high.y - state.low.y)};
}

ImVec2 axis_ball(const Context& context, int end) {
    const Vec3 seen = context.model.camera.rotation * axis_direction(end);
    const ImVec2 centre = axes_centre(context);
    const float size = context.em * AxesEm;
    return {centre.x + static_cast<float>(seen.x) * size, centre.y + static_cast<float>(seen.y) * size};
}

int axis_end_at(const Context& context, ImVec2 point) {
    int nearest = -1;
    for (int end = 0; end < AxisEnds; ++end) {
        const ImVec2 ball = axis_ball(context, end);
        if (std::hypot(ball.x - point.x, ball.y - point.y) > context.em * AxisBallEm * 1.1f) continue;
        if (nearest < 0 || axis_depth(context.model.camera, end) < axis_depth(context.model.camera, nearest))
            nearest = end;
    }
    return nearest;
}

int view_at(const Context& context, ImVec2 point) {
    const auto& views = context.document().views;
    int nearest = -1;
    float least = context.em * PickRadiusEm;
    for (std::size_t index = 0; index < views.size(); ++index) {
        const auto at = screen_point(context, views[index].camera.centre());
        if (!at) continue;
        const float distance = std::hypot(at->x - point.x, at->y - point.y);
        if (distance >= least) continue;
        least = distance;
        nearest = static_cast<int>(index);
    }
    return nearest;
}

void draw_overlays(Context& context, ImDrawList* list) {
    const auto& state = context.state.viewport;
    list->PushClipRect(state.low, state.high, true);
    if (context.model.camera.width > 0) {
        if (context.view.show_bounds) draw_bounds(context, list);
        if (context.view.show_views) draw_views(context, list);
        if (context.view.show_axes) draw_axes(context, list);
    }
    if (context.model.comparison == Comparison::Wipe) draw_wipe(context, list);
    if (context.model.comparison == Comparison::Original) {
        const std::string text = context.model.compared_revision != 0
                                     ? shortened(context.model.compared_name, context.em * 14)
                                     : "original";
        shaded_text(
            context, list,
            {(state.low.x + state.high.x) * 0.5f - context.em * 2.2f, state.low.y + context.em * 0.5f}, text,
            palette::Warning);
    }
    if (context.view.show_hud) draw_hud(context, list);
    draw_hint(context, list);
    draw_gizmo(context, list);
    list->PopClipRect();
}

}  // namespace gse::ui
