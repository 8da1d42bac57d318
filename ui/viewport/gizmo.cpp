// Handles of the labelled thing in the viewport: three arrows, a plate on the ground, a ring, a knob for
// size.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "ui/commands/guarded.h"
#include "ui/state/state.h"
#include "ui/viewport/viewport.h"

namespace gse::ui {
namespace {

enum Handle { Side, Up, Front, Ground, Turn, Size, HandleCount };

constexpr float ArmEm = 5.5f;       // length of an arrow on the screen
constexpr float PlateEm = 0.6f;     // radius of the plate
constexpr float RingShare = 0.72f;  // radius of the ring, of an arm
constexpr float KnobShare = 1.2f;   // distance of the size's knob from the middle, of an arm
constexpr float GrabEm = 0.6f;      // from a handle, at which it is under the mouse
constexpr int RingSteps = 64;
constexpr double TurnSnap = 15;        // degrees, while Ctrl is held
constexpr double MoveSnapShare = 0.1;  // of the thing's height, while Ctrl is held
constexpr double SizeSnap = 0.1;
constexpr double LeastSize = 0.05, LargestSize = 20;
constexpr double FarthestDrag = 3;    // of the eye's distance: the thing is still seen at a quarter its size
constexpr double NearestDrag = 0.25;  // of the thing's depth: a drag brings it no nearer to the eye
constexpr double LeastSlant = 0.17;   // sine of an axis's angle to the ray to the thing: 10 degrees

constexpr std::array<ImU32, HandleCount> Colours{IM_COL32(226, 104, 98, 255), IM_COL32(124, 196, 104, 255),
                                                 IM_COL32(98, 150, 232, 255), IM_COL32(230, 230, 230, 255),
                                                 IM_COL32(236, 196, 92, 255), IM_COL32(214, 140, 226, 255)};
constexpr std::array<const char*, HandleCount> Names{"side", "up", "front", "ground", "turn", "size"};

double snapped(double value, double step) {
    return ImGui::GetIO().KeyCtrl && step > 0 ? std::round(value / step) * step : value;
}

/// Interval of a drag.
struct Reach {
    double least = 0, most = 0;
};

/// An axis through the thing as it lies on the screen. A place on it, in world units from the thing, is seen
/// at q = slant t / (depth + recede t) pixels from the thing, along one direction of the screen.
struct SeenAxis {
    ImVec2 direction{};  // unit, on the screen
    double slant = 0;    // pixels
    double depth = 0, recede = 0;

    /// Place that is seen at q; a far one where q lies behind the axis's vanishing point.
    double at(double q) const {
        constexpr double LeastLeft = 1e-6;  // of the slant
        return q * depth / std::max(slant - recede * q, LeastLeft * slant);
    }
};

/// The handles as they lie on the screen.
class Gizmo {
public:
    Gizmo(const Context& context, const PlacedThing& thing, const edit::RearrangeSettings& values)
        : context_(context), thing_(thing) {
        foot_ = thing.foot + thing.side * values.move_right + thing.up * values.move_up +
                thing.front * values.move_forward;
        middle_ = foot_ + thing.up * (thing.height * values.resize / 2);
        const auto centre = screen_point(context, middle_);
        if (!centre) return;
        centre_ = *centre;
        const Camera& camera = context.model.camera;
        const double depth = camera.to_camera(middle_).z;
        const auto& state = context.state.viewport;
        const double pixels = camera.fx / depth * (state.high.x - state.low.x) / std::max(1, camera.width);
        arm_ = context.em * ArmEm / std::max(1e-9, pixels);
        farthest_ = FarthestDrag * length(middle_ - camera.centre());
        seen_ = true;
    }
    bool seen() const { return seen_; }
    ImVec2 centre() const { return centre_; }
    Vec3 axis(int handle) const {
        return handle == Side ? thing_.side : handle == Up ? thing_.up : thing_.front;
    }
    /// End of an arrow; nothing behind the camera.
    std::optional<ImVec2> tip(int handle) const {
        return screen_point(context_, middle_ + axis(handle) * arm_);
    }
    ImVec2 knob() const {
        const float away = context_.em * ArmEm * KnobShare * 0.7f;
        return {centre_.x + away, centre_.y - away};
    }
    std::optional<ImVec2> ring(int step) const {
        const double angle = 2 * std::numbers::pi * step / RingSteps;
        return screen_point(
            context_,
            middle_ + (thing_.side * std::cos(angle) + thing_.front * std::sin(angle)) * (arm_ * RingShare));
    }
    /// True for an arrow that is seen from the side; one that points at the eye cannot be dragged.
    bool slants(int handle) const { return seen_axis(handle).has_value(); }
    /// World units along an axis by which the thing follows the mouse. The thing stays in the picture.
    double along(int handle, ImVec2 from, ImVec2 to) const {
        const auto axis = seen_axis(handle);
        if (!axis) return 0;
        const auto pixels = [&](ImVec2 at) {
            return double{(at.x - centre_.x) * axis->direction.x + (at.y - centre_.y) * axis->direction.y};
        };
        const Reach reach = reach_of(*axis);
        return std::clamp(axis->at(pixels(to)) - axis->at(pixels(from)), reach.least, reach.most);
    }
    /// Shift of the thing's middle to where the mouse drags it, in its plane at right angles to up. It comes
    /// no farther away than a drag goes, and no nearer to the eye; the plane ends there, before its horizon.
    Vec3 over_plane(ImVec2 from, ImVec2 to) const {
        if (from.x == to.x && from.y == to.y) return {};
        const Camera& camera = context_.model.camera;
        const auto& state = context_.state.viewport;
        const auto share = [](float at, float low, float high) {
            return std::clamp((at - low) / (high - low), 0.0f, 1.0f);
        };
        const double px = share(centre_.x + to.x - from.x, state.low.x, state.high.x) * camera.width,
                     py = share(centre_.y + to.y - from.y, state.low.y, state.high.y) * camera.height;
        const Vec3 ray = camera.rotation.transposed() *
                         Vec3{(px - camera.cx) / camera.fx, (py - camera.cy) / camera.fy, 1};
        const double falls = dot(ray, thing_.up), height = dot(middle_ - camera.centre(), thing_.up);
        const bool hits = falls * height > 0;
        Vec3 away = hits ? camera.centre() + ray * (height / falls) - middle_ : ray - thing_.up * falls;
        if (const double far = length(away); !hits || far > farthest_) away = away * (farthest_ / far);
        const double depth = camera.to_camera(middle_).z, nearer = -dot(away, camera.forward());
        const double most = (1 - NearestDrag) * depth;
        return nearer > most ? away * (most / nearer) : away;
    }
    /// Distance of a handle from a point of the screen, pixels.
    float distance(int handle, ImVec2 at) const;

private:
    /// Nothing for an axis that points at the eye, or nearly so.
    std::optional<SeenAxis> seen_axis(int handle) const {
        const Camera& camera = context_.model.camera;
        const auto& state = context_.state.viewport;
        const Vec3 from = camera.to_camera(middle_), along = camera.rotation * axis(handle);
        if (length(cross(normalized(from), along)) < LeastSlant) return std::nullopt;
        const double scale = (state.high.x - state.low.x) / std::max(1, camera.width);
        const double x = camera.fx * scale * (along.x - along.z * from.x / from.z),
                     y = camera.fy * scale * (along.y - along.z * from.y / from.z);
        const double slant = std::hypot(x, y);
        return SeenAxis{
            {static_cast<float>(x / slant), static_cast<float>(y / slant)}, slant, from.z, along.z};
    }
    /// Drags along an axis that leave the thing in the picture, not too far and not too near.
    Reach reach_of(const SeenAxis& axis) const {
        const auto& state = context_.state.viewport;
        constexpr double Endless = std::numeric_limits<double>::infinity();
        double least = -Endless, most = Endless;  // pixels to the picture's edges
        for (const auto& [at, low, high, step] :
             {std::array{centre_.x, state.low.x, state.high.x, axis.direction.x},
              std::array{centre_.y, state.low.y, state.high.y, axis.direction.y}}) {
            if (step == 0) continue;
            const auto [back, on] = std::minmax({(low - at) / step, (high - at) / step});
            least = std::max(least, double{back}), most = std::min(most, double{on});
        }
        Reach reach{std::min(0.0, std::max(axis.at(least), -farthest_)),
                    std::max(0.0, std::min(axis.at(most), farthest_))};
        const double nearest = (NearestDrag - 1) * axis.depth;  // change of the depth
        if (axis.recede < 0) reach.most = std::min(reach.most, nearest / axis.recede);
        if (axis.recede > 0) reach.least = std::max(reach.least, nearest / axis.recede);
        return reach;
    }

    const Context& context_;
    const PlacedThing& thing_;
    Vec3 foot_, middle_;
    ImVec2 centre_{};
    double arm_ = 0, farthest_ = 0;  // world units
    bool seen_ = false;
};

float distance_to_segment(ImVec2 at, ImVec2 a, ImVec2 b) {
    const float x = b.x - a.x, y = b.y - a.y, squared = std::max(1e-6f, x * x + y * y);
    const float t = std::clamp(((at.x - a.x) * x + (at.y - a.y) * y) / squared, 0.0f, 1.0f);
    return std::hypot(a.x + t * x - at.x, a.y + t * y - at.y);
}

float Gizmo::distance(int handle, ImVec2 at) const {
    constexpr float Far = std::numeric_limits<float>::max();
    if (handle == Ground)
        return std::max(0.0f, std::hypot(at.x - centre_.x, at.y - centre_.y) - context_.em * PlateEm);
    if (handle == Size) return std::hypot(at.x - knob().x, at.y - knob().y);
    if (handle == Turn) {
        float least = Far;
        for (int step = 0; step < RingSteps; ++step)
            if (const auto a = ring(step), b = ring(step + 1); a && b)
                least = std::min(least, distance_to_segment(at, *a, *b));
        return least;
    }
    const auto end = tip(handle);
    return end && slants(handle) ? distance_to_segment(at, centre_, *end) : Far;
}

/// The handle under the mouse, -1 = none. The plate and the arrows win over the ring.
int handle_at(const Context& context, const Gizmo& gizmo, ImVec2 mouse) {
    for (const int handle : {int{Ground}, int{Size}, int{Side}, int{Up}, int{Front}, int{Turn}})
        if (gizmo.distance(handle, mouse) < context.em * GrabEm) return handle;
    return -1;
}

/// Values that the drag from its start to the mouse comes to.
edit::RearrangeSettings dragged(const Context& context, const PlacedThing& thing, ImVec2 mouse) {
    const auto& place = context.state.by_hand.place;
    auto values = place.start_values;
    const Gizmo gizmo(context, thing, place.start_values);
    const auto along = [&](int handle) { return gizmo.along(handle, place.start, mouse); };
    const double step = MoveSnapShare * thing.height;
    const auto angle = [&](ImVec2 at) {
        return std::atan2(at.y - gizmo.centre().y, at.x - gizmo.centre().x);
    };
    const auto reach = [&](ImVec2 at) {
        return std::max(1.0f, std::hypot(at.x - gizmo.centre().x, at.y - gizmo.centre().y));
    };
    switch (place.handle) {
        case Side: values.move_right = snapped(values.move_right + along(Side), step); break;
        case Up: values.move_up = snapped(values.move_up + along(Up), step); break;
        case Front: values.move_forward = snapped(values.move_forward + along(Front), step); break;
        case Ground: {
            const Vec3 by = gizmo.over_plane(place.start, mouse);
            values.move_right = snapped(values.move_right + dot(by, thing.side), step);
            values.move_forward = snapped(values.move_forward + dot(by, thing.front), step);
            break;
        }
        case Turn: {
            // Counter-clockwise from above is counter-clockwise on the screen, seen from above.
            const bool above = dot(context.model.camera.forward(), thing.up) < 0;
            const double turn = (angle(place.start) - angle(mouse)) * 180 / std::numbers::pi;
            values.turn = snapped(std::remainder(values.turn + (above ? turn : -turn), 360.0), TurnSnap);
            break;
        }
        case Size:
            values.resize = std::clamp(snapped(values.resize * reach(mouse) / reach(place.start), SizeSnap),
                                       LeastSize, LargestSize);
            break;
        default: break;
    }
    return values;
}

/// The changed number beside the mouse.
std::string drag_text(int handle, const edit::RearrangeSettings& values) {
    switch (handle) {
        case Side: return fmt::format("right {:.3g}", values.move_right);
        case Up: return fmt::format("up {:.3g}", values.move_up);
        case Front: return fmt::format("forward {:.3g}", values.move_forward);
        case Ground:
            return fmt::format("right {:.3g}, forward {:.3g}", values.move_right, values.move_forward);
        case Turn: return fmt::format("turn {:.0f} degrees", values.turn);
        default: return fmt::format("size {:.2f}", values.resize);
    }
}

void draw_handles(Context& context, ImDrawList* list, const Gizmo& gizmo, int chosen) {
    const float line = std::max(2.0f, context.em * 0.16f), head = context.em * 0.4f;
    const auto colour = [&](int handle) {
        return handle == chosen ? palette::Accent : Colours[static_cast<std::size_t>(handle)];
    };
    const auto noted = [&](int handle, ImVec2 at) {
        note_rect(context, fmt::format("gizmo.{}", Names[static_cast<std::size_t>(handle)]),
                  {at.x - head, at.y - head}, {at.x + head, at.y + head});
    };
    for (int step = 0; step < RingSteps; ++step)
        if (const auto a = gizmo.ring(step), b = gizmo.ring(step + 1); a && b)
            list->AddLine(*a, *b, colour(Turn), line);
    if (const auto at = gizmo.ring(RingSteps / 8)) noted(Turn, *at);
    for (const int handle : {int{Side}, int{Up}, int{Front}}) {
        const auto end = gizmo.tip(handle);
        if (!end || !gizmo.slants(handle)) continue;
        list->AddLine(gizmo.centre(), *end, colour(handle), line);
        list->AddCircleFilled(*end, head, colour(handle));
        noted(handle, *end);
    }
    list->AddCircleFilled(gizmo.centre(), context.em * PlateEm, with_alpha(colour(Ground), 0.85f));
    noted(Ground, gizmo.centre());
    const ImVec2 knob = gizmo.knob();
    list->AddLine(gizmo.centre(), knob, with_alpha(colour(Size), 0.5f), line * 0.5f);
    list->AddRectFilled({knob.x - head, knob.y - head}, {knob.x + head, knob.y + head}, colour(Size));
    noted(Size, knob);
}

}  // namespace

bool use_gizmo(Context& context, bool hovered) {
    auto& place = context.state.by_hand.place;
    const auto& thing = context.model.placed;
    if (!thing || !why_not_work(context).empty()) return place.dragged = false;
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    if (!place.dragged) {
        const Gizmo gizmo(context, *thing, place.values);
        place.handle = hovered && gizmo.seen() && context.state.viewport.drag_button < 0
                           ? handle_at(context, gizmo, mouse)
                           : -1;
        if (place.handle < 0 || !ImGui::IsMouseClicked(0)) return place.handle >= 0;
        place.dragged = true;
        place.start = mouse;
        place.start_values = place.values;
    }
    const auto values = dragged(context, *thing, mouse);
    if (values != place.values) {
        context.emit(command::PlaceThing{place.values = values, false});
        place.ends = true;
    }
    if (!ImGui::IsMouseDown(0)) place.dragged = false;
    context.state.animating = true;
    return true;
}

void draw_gizmo(Context& context, ImDrawList* list) {
    const auto& place = context.state.by_hand.place;
    const auto& thing = context.model.placed;
    if (context.state.viewport.tool != Tool::Place || !thing || !why_not_work(context).empty()) return;
    const Gizmo gizmo(context, *thing, place.values);
    if (!gizmo.seen()) return;
    draw_handles(context, list, gizmo, place.handle);
    if (!place.dragged) return;
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    shaded_text(context, list, {mouse.x + context.em, mouse.y - context.em * 2},
                drag_text(place.handle, place.values));
}

}  // namespace gse::ui
