// Brush, rectangle, lasso and box in the viewport, the wipe's handle, and the cursor that shows their effect.
#include <algorithm>
#include <cmath>

#include "ui/commands/guarded.h"
#include "ui/state/state.h"
#include "ui/viewport/viewport.h"

namespace gse::ui {
namespace {

constexpr float WipeGrabEm = 0.7f;
constexpr float DabSpacing = 0.35f;  // of the radius, between the circles of a stroke
constexpr float LassoSpacingPx = 3;
constexpr float ClickPx = 4;  // a shorter drag is a click

/// Point of the window in pixels of the viewport's texture.
std::array<float, 2> to_texture(const Context& context, std::array<float, 2> point) {
    const auto& state = context.state.viewport;
    const float x = (point[0] - state.low.x) / std::max(1.0f, state.high.x - state.low.x);
    const float y = (point[1] - state.low.y) / std::max(1.0f, state.high.y - state.low.y);
    return {x * static_cast<float>(context.model.viewport_width),
            y * static_cast<float>(context.model.viewport_height)};
}

float texture_scale(const Context& context) {
    const auto& state = context.state.viewport;
    return static_cast<float>(context.model.viewport_width) / std::max(1.0f, state.high.x - state.low.x);
}

void send_circles(Context& context, std::size_t first, bool ends) {
    auto& state = context.state.viewport;
    ScreenRegion region;
    for (std::size_t at = first; at < state.path.size(); ++at)
        region.circles.push_back(to_texture(context, state.path[at]));
    region.radius_px = context.view.brush_px * texture_scale(context);
    // A stroke that replaces does so with its first dab, and adds with the others.
    const bool replaces = state.stroke_operation == SetOperation::Replace && first > 0;
    context.emit(command::Select{region, replaces ? SetOperation::Add : state.stroke_operation, ends});
}

/// True for the tools that paint with circles.
bool paints(Tool tool) { return tool == Tool::Brush || tool == Tool::Heal; }

/// True for a stroke whose effect is only known when it is whole.
bool waits_for_end(const ViewportState& state) {
    return state.tool == Tool::Heal || state.stroke_operation == SetOperation::Intersect;
}

/// Circles from the last point to the mouse, close enough to leave no gaps.
void extend_brush(Context& context, ImVec2 mouse) {
    auto& state = context.state.viewport;
    const auto last = state.path.back();
    const float distance = std::hypot(mouse.x - last[0], mouse.y - last[1]);
    const float spacing = std::max(1.0f, context.view.brush_px * DabSpacing);
    const int steps = static_cast<int>(distance / spacing);
    if (steps == 0) return;
    const std::size_t first = state.path.size();
    for (int step = 1; step <= steps; ++step) {
        const float share = static_cast<float>(step) / static_cast<float>(steps);
        state.path.push_back({last[0] + (mouse.x - last[0]) * share, last[1] + (mouse.y - last[1]) * share});
    }
    if (!waits_for_end(state)) send_circles(context, first, false);
}

void begin_stroke(Context& context, ImVec2 mouse) {
    auto& state = context.state.viewport;
    if (state.tool != Tool::Heal) {
        if (context.active_label() == nullptr) context.emit(command::AddLabel{"label"});
        show_labelled(context);
    }
    state.stroke = true;
    state.stroke_operation = operation_now(context);
    state.stroke_start = mouse;
    state.path.assign(1, {mouse.x, mouse.y});
    if (state.tool == Tool::Brush && !waits_for_end(state)) send_circles(context, 0, false);
}

/// The circles of the whole stroke.
ScreenRegion painted(const Context& context) {
    const auto& state = context.state.viewport;
    ScreenRegion region;
    for (const auto& point : state.path) region.circles.push_back(to_texture(context, point));
    region.radius_px = context.view.brush_px * texture_scale(context);
    return region;
}

void end_stroke(Context& context, ImVec2 mouse) {
    auto& state = context.state.viewport;
    state.stroke = false;
    if (state.tool == Tool::Heal) return context.emit(command::HealStroke{painted(context)});
    if (state.tool == Tool::Brush) {
        const bool whole = waits_for_end(state);
        return send_circles(context, whole ? 0 : state.path.size() - (state.path.size() > 1 ? 1 : 0), true);
    }
    const bool box = state.tool == Tool::Rectangle || state.tool == Tool::CutOut;
    if (box) {
        const ImVec2 a = state.stroke_start;
        if (state.tool == Tool::CutOut && std::hypot(a.x - mouse.x, a.y - mouse.y) < ClickPx)
            return context.emit(
                command::CutOut{{.polygon = {to_texture(context, {a.x, a.y})}}, state.stroke_operation});
        if (std::abs(a.x - mouse.x) < 2 || std::abs(a.y - mouse.y) < 2) return;
        state.path = {{a.x, a.y}, {mouse.x, a.y}, {mouse.x, mouse.y}, {a.x, mouse.y}};
    }
    if (state.path.size() < 3) return;
    ScreenRegion region;
    for (const auto& point : state.path) region.polygon.push_back(to_texture(context, point));
    if (state.tool == Tool::CutOut) return context.emit(command::CutOut{region, state.stroke_operation});
    context.emit(command::Select{region, state.stroke_operation, true});
}

/// Asks for the colour that is seen there. False where nothing is to be seen.
bool pick_colour(Context& context, ImVec2 mouse) {
    if (context.model.viewport_depth != nullptr && !(depth_at(context, mouse) > 0)) return false;
    const auto at = to_texture(context, {mouse.x, mouse.y});
    context.emit(command::PickColour{static_cast<int>(at[0]), static_cast<int>(at[1])});
    return true;
}

/// True while the handle of the wipe is dragged or would be by a press.
bool drag_wipe(Context& context, bool hovered) {
    auto& state = context.state.viewport;
    if (context.model.comparison != Comparison::Wipe) return state.wipe_dragged = false;
    const float width = std::max(1.0f, state.high.x - state.low.x);
    const float x = state.low.x + context.view.wipe * width;
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const bool near =
        hovered && std::abs(mouse.x - x) < context.em * WipeGrabEm && !state.stroke && state.drag_button < 0;
    if (near && ImGui::IsMouseClicked(0)) state.wipe_dragged = true;
    if (!ImGui::IsMouseDown(0)) state.wipe_dragged = false;
    if (state.wipe_dragged) {
        context.view.wipe = std::clamp((mouse.x - state.low.x) / width, 0.0f, 1.0f);
        context.view_changed = true;
    }
    if (near || state.wipe_dragged) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    return near || state.wipe_dragged;
}

/// "+", "-", "n" (intersect) or "=" (replace) beside the cursor.
void draw_badge(ImDrawList* list, ImVec2 at, float em, SetOperation operation) {
    const float r = em * 0.42f, w = std::max(1.5f, em * 0.12f);
    const ImU32 colour = operation == SetOperation::Remove ? palette::Bad
                         : operation == SetOperation::Add  ? palette::Good
                                                           : palette::Accent;
    list->AddCircleFilled(at, r * 1.35f, palette::Shade);
    const auto across = [&](float y) {
        list->AddLine({at.x - r * 0.7f, at.y + y}, {at.x + r * 0.7f, at.y + y}, colour, w);
    };
    switch (operation) {
        case SetOperation::Add:
            across(0);
            list->AddLine({at.x, at.y - r * 0.7f}, {at.x, at.y + r * 0.7f}, colour, w);
            break;
        case SetOperation::Remove: across(0); break;
        case SetOperation::Replace:
            across(-r * 0.3f);
            across(r * 0.3f);
            break;
        case SetOperation::Intersect:
            list->PathArcTo(at, r * 0.6f, 3.1415927f, 6.2831853f);
            list->PathStroke(colour, ImDrawFlags_None, w);
            for (const float side : {-1.0f, 1.0f})
                list->AddLine({at.x + side * r * 0.6f, at.y}, {at.x + side * r * 0.6f, at.y + r * 0.6f},
                              colour, w);
            break;
    }
}

void draw_stroke(Context& context, ImDrawList* list, ImVec2 mouse) {
    const auto& state = context.state.viewport;
    const ImU32 colour = state.stroke_operation == SetOperation::Remove ? palette::Bad : palette::Accent;
    if (paints(state.tool)) {
        for (const auto& point : state.path) list->PathLineTo({point[0], point[1]});
        list->PathStroke(with_alpha(colour, 0.25f), ImDrawFlags_None, context.view.brush_px * 2);
    }
    if (state.tool == Tool::Rectangle || state.tool == Tool::CutOut) {
        list->AddRectFilled(state.stroke_start, mouse, with_alpha(colour, 0.15f));
        list->AddRect(state.stroke_start, mouse, colour, 0, 0, std::max(1.0f, context.em * 0.08f));
    }
    if (state.tool == Tool::Lasso) {
        for (const auto& point : state.path) list->PathLineTo({point[0], point[1]});
        list->PathLineTo(mouse);
        list->PathStroke(colour, ImDrawFlags_Closed, std::max(1.0f, context.em * 0.1f));
    }
}

}  // namespace

SetOperation operation_now(const Context& context) {
    const auto& io = ImGui::GetIO();
    if ((io.KeyAlt && !context.state.keymap.alt_navigates()) || (io.KeyShift && io.KeyCtrl))
        return SetOperation::Intersect;
    if (io.KeyShift) return SetOperation::Add;
    if (io.KeyCtrl) return SetOperation::Remove;
    return context.state.viewport.operation;
}

bool use_tool(Context& context, bool hovered) {
    auto& state = context.state.viewport;
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    if (drag_wipe(context, hovered)) return true;
    if (state.tool == Tool::Orbit ||
        (!state.stroke && ImGui::GetIO().KeyAlt && context.state.keymap.alt_navigates()))
        return false;
    if (state.tool == Tool::Place) return use_gizmo(context, hovered);
    if (state.tool == Tool::PickColour) {
        if (!hovered || !ImGui::IsMouseClicked(0)) return true;
        if (pick_colour(context, mouse)) state.tool = Tool::Orbit;
        return true;
    }
    if (!state.stroke && context.view.show_axes && axis_end_at(context, mouse) >= 0) return false;
    if (!state.stroke && hovered && ImGui::IsMouseClicked(0)) begin_stroke(context, mouse);
    if (!state.stroke) return true;
    if (!ImGui::IsMouseDown(0)) {
        end_stroke(context, mouse);
        return true;
    }
    if (paints(state.tool)) extend_brush(context, mouse);
    if (state.tool == Tool::Lasso &&
        std::hypot(mouse.x - state.path.back()[0], mouse.y - state.path.back()[1]) > LassoSpacingPx)
        state.path.push_back({mouse.x, mouse.y});
    return true;
}

void draw_tool_cursor(Context& context, ImDrawList* list, bool hovered) {
    const auto& state = context.state.viewport;
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    if (state.tool == Tool::Orbit || state.tool == Tool::Place || state.wipe_dragged) return;
    if (state.stroke) draw_stroke(context, list, mouse);
    if (!hovered) return;
    if (state.tool == Tool::PickColour) {
        for (const auto& [radius, colour] :
             {std::pair{0.55f, IM_COL32(0, 0, 0, 160)}, std::pair{0.45f, IM_COL32(255, 255, 255, 220)}})
            list->AddCircle(mouse, context.em * radius, colour, 0, std::max(1.0f, context.em * 0.1f));
        return;
    }
    float reach = context.em * 0.5f;
    if (paints(state.tool)) {
        ImGui::SetMouseCursor(ImGuiMouseCursor_None);
        reach = context.view.brush_px;
        list->AddCircle(mouse, reach + 1, IM_COL32(0, 0, 0, 160), 0, std::max(1.0f, context.em * 0.08f));
        list->AddCircle(mouse, reach, IM_COL32(255, 255, 255, 220), 0, std::max(1.0f, context.em * 0.08f));
        list->AddCircleFilled(mouse, std::max(1.0f, context.em * 0.08f), IM_COL32(255, 255, 255, 220));
    }
    if (state.tool == Tool::Heal) return;
    const float away = reach * 0.72f + context.em * 0.6f;
    draw_badge(list, {mouse.x + away, mouse.y + away}, context.em,
               state.stroke ? state.stroke_operation : operation_now(context));
}

}  // namespace gse::ui
