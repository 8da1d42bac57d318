// Lines over the picture: axes, bounds, cameras, the wipe, and the numbers in the corner.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "ui/commands/guarded.h"
#include "ui/model/glyphs.h"
#include "ui/state/state.h"
#include "ui/viewport/viewport.h"
#include "ui/widgets/controls.h"

namespace gse::ui {
namespace {

constexpr std::array<ImU32, 3> AxisColours{IM_COL32(226, 104, 98, 255), IM_COL32(124, 196, 104, 255),
                                           IM_COL32(98, 150, 232, 255)};
constexpr double FrustumShare = 0.07;  // length of a camera's drawn frustum, of the scene's radius
constexpr double RateSeconds = 1;      // the frame rate is shown this long after the last move
constexpr float AxesEm = 2.05f;        // from the middle of the axes to a ball
constexpr float AxisBallEm = 0.47f;    // radius of a ball
constexpr float FarEndShare = 0.8f;    // of that radius, where an axis ends
constexpr float PickRadiusEm = 0.8f;

double near_of(const Context& context) { return std::max(1e-9, context.model.orbit.radius * 1e-3); }

/// A line of the world, cut at the near plane; nothing when it is behind.
void world_line(const Context& context, ImDrawList* list, const Vec3& a, const Vec3& b, ImU32 colour,
                float width) {
    const Camera& camera = context.model.camera;
    Vec3 from = camera.to_camera(a), to = camera.to_camera(b);
    const double near = near_of(context);
    if (from.z < near && to.z < near) return;
    if (from.z < near) from = from + (to - from) * ((near - from.z) / (to.z - from.z));
    if (to.z < near) to = to + (from - to) * ((near - to.z) / (from.z - to.z));
    const auto project = [&](const Vec3& p) {
        return to_screen(context, camera.fx * p.x / p.z + camera.cx, camera.fy * p.y / p.z + camera.cy);
    };
    list->AddLine(project(from), project(to), colour, width);
}

ImVec2 axes_centre(const Context& context) {
    const auto& state = context.state.viewport;
    const float away = context.em * AxesEm * 1.5f;
    const bool covered = state.foot_low.x < state.low.x + 2 * away;
    return {state.low.x + away, (covered ? std::min(state.high.y, state.foot_low.y) : state.high.y) - away};
}

/// "x", "-x" and so on.
std::string axis_name(int end) { return fmt::format("{}{}", end < 3 ? "" : "-", "xyz"[end % 3]); }

/// How far an end points away from the eye, -1 to 1.
double axis_depth(const Context& context, int end) {
    return (context.model.camera.rotation * axis_direction(end)).z;
}

/// An end of a world axis: a ball with its letter, or a ring at the negative one.
void draw_axis_end(Context& context, ImDrawList* list, int end, bool under_mouse) {
    const ImVec2 centre = axes_centre(context), at = axis_ball(context, end);
    const bool positive = end<3, behind = axis_depth(context, end)> 0.2;
    const ImU32 colour = with_alpha(AxisColours[static_cast<std::size_t>(end % 3)], behind ? 0.55f : 1);
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
    std::array<int, AxisEnds> order{0, 1, 2, 3, 4, 5};
    std::sort(order.begin(), order.end(), [&](int a, int b) {
        return axis_depth(context, a) > axis_depth(context, b);  // far ones first
    });
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const int chosen = axis_end_at(context, mouse);
    for (const int end : order) draw_axis_end(context, list, end, end == chosen);
    if (chosen < 0 || context.state.viewport.stroke || context.state.viewport.drag_button >= 0) return;
    shaded_text(context, list, {mouse.x + context.em, mouse.y - context.em * 2},
                fmt::format("Look from {}", axis_name(chosen)));
}

void draw_bounds(Context& context, ImDrawList* list) {
    const Vec3 low = context.model.statistics.robust_low, high = context.model.statistics.robust_high;
    const auto corner = [&](int bits) {
        return Vec3{bits & 1 ? high.x : low.x, bits & 2 ? high.y : low.y, bits & 4 ? high.z : low.z};
    };
    for (int from = 0; from < 8; ++from)
        for (const int bit : {1, 2, 4})
            if ((from & bit) == 0)
                world_line(context, list, corner(from), corner(from | bit), with_alpha(palette::Text, 0.45f),
                           1);
}

void draw_view(Context& context, ImDrawList* list, const View& view, bool selected) {
    const Camera& camera = view.camera;
    const Mat3 to_world = camera.rotation.transposed();
    const Vec3 eye = camera.centre();
    const double length = context.model.orbit.radius * FrustumShare;
    // From inside a frustum only stray lines would be seen.
    if (gse::length(eye - context.model.camera.centre()) < 1.5 * length) return;
    std::array<Vec3, 4> corners;
    for (std::size_t at = 0; at < 4; ++at) {
        const double x = at == 0 || at == 3 ? 0 : camera.width, y = at < 2 ? 0 : camera.height;
        corners[at] =
            eye + to_world * (Vec3{(x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1} * length);
    }
    const ImU32 colour = selected ? palette::Accent : with_alpha(palette::Text, 0.55f);
    const float width = selected ? std::max(2.0f, context.em * 0.14f) : std::max(1.0f, context.em * 0.07f);
    for (std::size_t at = 0; at < 4; ++at) {
        world_line(context, list, eye, corners[at], colour, width);
        world_line(context, list, corners[at], corners[(at + 1) % 4], colour, width);
    }
    const auto apex = screen_point(context, eye);
    if (apex) list->AddCircleFilled(*apex, context.em * (selected ? 0.26f : 0.18f), colour);
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

Vec3 axis_direction(int end) {
    Vec3 direction;
    direction[end % 3] = end < 3 ? 1 : -1;
    return direction;
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
        if (nearest < 0 || axis_depth(context, end) < axis_depth(context, nearest)) nearest = end;
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
