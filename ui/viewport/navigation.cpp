// Camera of the viewport: its owner, its movement by mouse and keys, and reports to the application.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/scene/viewpoints.h"
#include "ui/commands/guarded.h"
#include "ui/keys/keys.h"
#include "ui/state/state.h"
#include "ui/viewport/scene_lines.h"
#include "ui/viewport/viewport.h"

namespace gse::ui {
namespace {

constexpr float ClickTravelEm = 0.3f;  // a press that moves less is a click
constexpr double FlyFast = 4, FlySlow = 0.2;
constexpr float ZoomDragEm = 2;  // of a drag that zooms, per notch of a wheel

struct Pixels {
    int width, height;
};

Pixels framebuffer_size(const ViewportState& state) {
    const ImVec2 scale = ImGui::GetIO().DisplayFramebufferScale;
    return {std::max(1, static_cast<int>(std::lround((state.high.x - state.low.x) * scale.x))),
            std::max(1, static_cast<int>(std::lround((state.high.y - state.low.y) * scale.y)))};
}

/// Stored view that this camera looks through, -1 = none. A view that is looked through is fitted into the
/// picture.
int view_of(const Context& context, const Camera& shown) {
    const auto& views = context.document().views;
    const auto sees = [&](std::size_t index) {
        const Camera& stored = views[index].camera;
        return stored.width > 0 && stored.height > 0 &&
               same_view(fitted(stored, shown.width, shown.height), shown);
    };
    // The one that was asked for, where several are at one place.
    const int chosen = context.state.viewport.selected_view;
    if (chosen >= 0 && chosen < static_cast<int>(views.size()) && sees(static_cast<std::size_t>(chosen)))
        return chosen;
    for (std::size_t index = 0; index < views.size(); ++index)
        if (sees(index)) return static_cast<int>(index);
    return -1;
}

void take_over(Context& context) {
    auto& state = context.state.viewport;
    const Camera& shown = context.model.camera;
    if (shown.width <= 0 || !(shown.fx > 0)) return;
    if (state.camera_known && !state.sent.is_foreign(shown)) return;
    state.labelled_home.reset();  // that of another camera
    state.camera.set_home(context.model.orbit, context.model.home);
    state.camera.adopt(shown);
    state.camera_known = true;
    state.sent.clear();
    state.sent.sent(shown);
    state.selected_view = view_of(context, shown);
}

void send(Context& context) {
    auto& state = context.state.viewport;
    const Pixels size = framebuffer_size(state);
    const Camera camera = state.camera.camera().resized(size.width, size.height);
    state.sent.sent(camera);
    context.emit(command::SetCamera{camera});
}

/// Camera axes: right, down, forward.
Vec3 fly_direction() {
    const auto axis = [](int positive, int negative) {
        return (ImGui::IsKeyDown(positive) ? 1.0 : 0.0) - (ImGui::IsKeyDown(negative) ? 1.0 : 0.0);
    };
    return {axis('D', 'A'), axis('Q', 'E'), axis('W', 'S')};
}

void fly(Context& context) {
    const auto& io = ImGui::GetIO();
    if (io.KeyCtrl || io.KeySuper) return;
    const Vec3 direction = fly_direction();
    if (direction == Vec3{}) return;
    const double speed = context.view.move_speed * (io.KeyShift ? FlyFast : io.KeyAlt ? FlySlow : 1.0);
    context.state.viewport.camera.fly(direction, io.DeltaTime, speed);
}

/// Looks from the end of an axis whose ball is clicked; once more, from the other side.
bool look_along_axis(Context& context, ImVec2 mouse) {
    const int end = context.view.show_axes ? axis_end_at(context, mouse) : -1;
    if (end < 0) return false;
    const Vec3 from = axis_direction(end);
    auto& camera = context.state.viewport.camera;
    const bool there = dot(camera.camera().forward(), from) < -0.99;
    camera.look_from(there ? -from : from);
    return true;
}

void release(Context& context, ImVec2 mouse) {
    auto& state = context.state.viewport;
    const float travelled = std::hypot(mouse.x - state.stroke_start.x, mouse.y - state.stroke_start.y);
    const bool clicked = state.drag_button == ImGuiMouseButton_Left && travelled < context.em * ClickTravelEm;
    state.drag_button = -1;
    if (!clicked || look_along_axis(context, mouse) || !context.view.show_views) return;
    const int view = view_at(context, mouse);
    if (view >= 0) state.selected_view = view;
}

void drag(Context& context) {
    auto& state = context.state.viewport;
    const auto& io = ImGui::GetIO();
    const ImVec2 delta = io.MouseDelta;
    if (delta.x == 0 && delta.y == 0) return;
    const bool alt = io.KeyAlt && context.state.keymap.alt_navigates();
    const bool zooms = alt && state.drag_button == ImGuiMouseButton_Right;
    const bool pans = state.drag_button == ImGuiMouseButton_Right ||
                      (state.drag_button == ImGuiMouseButton_Middle && (io.KeyShift || alt));
    if (zooms) {
        const ImVec2 middle((state.high.x - state.low.x) / 2, (state.high.y - state.low.y) / 2);
        state.camera.zoom((delta.x - delta.y) / (context.em * ZoomDragEm), middle.x, middle.y, 0);
    } else if (pans) {
        state.camera.pan(delta.x, delta.y);
    } else {
        state.camera.orbit(delta.x, delta.y);
    }
}

void double_click(Context& context, ImVec2 mouse) {
    auto& state = context.state.viewport;
    const int view = context.view.show_views ? view_at(context, mouse) : -1;
    if (view >= 0) return context.emit(command::LookThrough{static_cast<std::size_t>(view)});
    const double depth = depth_at(context, mouse);
    if (depth > 0)
        state.camera.set_pivot(state.camera.unproject(mouse.x - state.low.x, mouse.y - state.low.y, depth));
}

void turn_wheel(Context& context, float notches) {
    auto& state = context.state.viewport;
    const auto& io = ImGui::GetIO();
    if (io.KeyAlt) {
        context.view.brush_px = std::clamp(context.view.brush_px * std::pow(1.15f, notches), 1.0f, 500.0f);
        context.view_changed = true;
        return;
    }
    const ImVec2 mouse = io.MousePos;
    state.camera.zoom(notches, mouse.x - state.low.x, mouse.y - state.low.y, depth_at(context, mouse));
}

}  // namespace

double depth_at(const Context& context, ImVec2 point) {
    const auto& depth = context.model.viewport_depth;
    const auto& state = context.state.viewport;
    if (depth == nullptr || depth->width <= 0 || state.high.x <= state.low.x || state.high.y <= state.low.y)
        return -1;
    const float x = (point.x - state.low.x) / (state.high.x - state.low.x),
                y = (point.y - state.low.y) / (state.high.y - state.low.y);
    if (x < 0 || y < 0 || x >= 1 || y >= 1) return -1;
    const float value = depth->at(static_cast<int>(x * static_cast<float>(depth->width)),
                                  static_cast<int>(y * static_cast<float>(depth->height)), 0);
    return std::isfinite(value) ? static_cast<double>(value) : -1;
}

void update_camera(Context& context, bool keys_free) {
    auto& state = context.state.viewport;
    const Pixels size = framebuffer_size(state);
    const bool resized = size.width != state.sent_width || size.height != state.sent_height;
    if (resized) {
        context.emit(command::SetViewportSize{size.width, size.height});
        state.sent_width = size.width;
        state.sent_height = size.height;
    }
    if (!context.scene_open()) {
        state.camera_known = false;
        return;
    }
    state.camera.set_home(context.model.orbit, state.labelled_home.value_or(context.model.home));
    state.camera.set_size(static_cast<int>(std::lround(state.high.x - state.low.x)),
                          static_cast<int>(std::lround(state.high.y - state.low.y)));
    take_over(context);
    if (!state.camera_known) return;
    bool moved = resized;
    if (state.fov_setting != 0 && state.fov_setting != context.model.view.fov_degrees) {
        state.camera.set_fov(context.model.view.fov_degrees * std::numbers::pi / 180);
        moved = true;
    }
    state.fov_setting = context.model.view.fov_degrees;
    if (keys_free) fly(context);
    moved |= state.camera.update(ImGui::GetIO().DeltaTime);
    if (moved) send(context);
    if (moved) state.moved_at = ImGui::GetTime();
    context.state.animating |= moved || state.camera.gliding();
}

void navigate(Context& context, bool hovered) {
    auto& state = context.state.viewport;
    const auto& io = ImGui::GetIO();
    const bool left_is_tool = use_tool(context, hovered);
    if (state.drag_button >= 0) {
        if (ImGui::IsMouseDown(state.drag_button)) drag(context);
        else release(context, io.MousePos);
    }
    if (!hovered) return;
    if (io.MouseWheel != 0) turn_wheel(context, io.MouseWheel);
    for (const int mouse_button : {0, 1, 2}) {
        if (mouse_button == 0 && left_is_tool) continue;
        if (state.drag_button >= 0 || !ImGui::IsMouseClicked(mouse_button)) continue;
        state.drag_button = mouse_button;
        state.stroke_start = io.MousePos;
    }
    if (!left_is_tool && ImGui::IsMouseDoubleClicked(0)) double_click(context, io.MousePos);
}

}  // namespace gse::ui
