// Camera of the viewport: orbit, pan, zoom to the cursor, fly, frame. Glides to its target and then stands
// still.
#include "ui/state/camera_control.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gse::ui {
namespace {

constexpr double GlideRate = 14;       // per second: a glide is over after about a third of a second
constexpr double LongestStep = 0.1;    // seconds; a slow frame must not throw the camera
constexpr double ArrivedShare = 5e-4;  // of the distance: below a pixel on any screen
constexpr double ArrivedAngle = 5e-4;  // radians
constexpr double ZoomPerNotch = 0.86;
constexpr double NearestShare = 1e-4, FarthestShare = 1e4;  // of the home radius
constexpr double PoleMargin = 0.02;  // radians the view keeps from straight up and down

/// Rotation by `angle` about a unit axis.
Mat3 about(const Vec3& axis, double angle) { return rotation_matrix(glm::angleAxis(angle, axis)); }

double angle_between(const Mat3& a, const Mat3& b) {
    const Mat3 difference = a * b.transposed();
    const double trace = difference(0, 0) + difference(1, 1) + difference(2, 2);
    return std::acos(std::clamp((trace - 1) / 2, -1.0, 1.0));
}

}  // namespace

Vec3 CameraPose::eye() const { return pivot - rotation.row(2) * distance; }

void CameraControl::set_home(const OrbitParameters& orbit, const Bounds& bounds) {
    home_ = orbit;
    home_bounds_ = bounds;
}

void CameraControl::set_size(int width, int height) {
    width = std::max(1, width);
    height = std::max(1, height);
    if (width == width_ && height == height_) return;
    width_ = width;
    height_ = height;
    if (!at_home_) return;
    target_ = home_pose();
    if (!gliding_) now_ = target_;
    moved_ = true;
}

double CameraControl::focal_px() const { return width_ / (2 * std::tan(fov_x_ / 2)); }

void CameraControl::arrive() {
    now_ = target_;
    gliding_ = false;
}

void CameraControl::go(const CameraPose& target) {
    target_ = target;
    gliding_ = true;
    at_home_ = false;
}

void CameraControl::adopt(const Camera& camera) {
    if (camera.width > 0 && camera.fx > 0) fov_x_ = 2 * std::atan(camera.width / (2 * camera.fx));
    const Vec3 eye = camera.centre();
    const double along = dot(home_bounds_.centre() - eye, camera.forward());
    target_.rotation = camera.rotation;
    target_.distance = along > home_.radius * 0.05 ? along : home_.radius;
    target_.pivot = eye + camera.forward() * target_.distance;
    const Camera home = home_camera(home_, home_bounds_, fov_x_, camera.width, camera.height);
    at_home_ = same_view(camera, home);
    if (at_home_) target_ = home_pose();
    arrive();
    moved_ = at_home_;  // the picture may have another shape than the camera that came
}

void CameraControl::rotate(const Mat3& world_rotation) {
    // world -> camera after the camera's frame was turned in the world: R (W)^T
    const Mat3 turned = world_rotation.transposed();
    now_.rotation = now_.rotation * turned;
    target_.rotation = target_.rotation * turned;
    at_home_ = false;
    moved_ = true;
}

void CameraControl::orbit(double dx_px, double dy_px) {
    const double per_px = std::numbers::pi / height_;
    const Vec3 up = normalized(home_.up);
    if (dx_px != 0) rotate(about(up, -dx_px * per_px));
    if (dy_px == 0) return;
    const Vec3 forward = now_.rotation.row(2);
    const double height = std::acos(std::clamp(dot(forward, up), -1.0, 1.0));  // 0 = looks straight up
    // Dragging down lifts the camera: it looks more downwards, the angle to up grows.
    const double wanted = std::clamp(height + dy_px * per_px, PoleMargin, std::numbers::pi - PoleMargin);
    const Vec3 axis = normalized(cross(forward, up));
    if (length(axis) > 0) rotate(about(axis, height - wanted));
}

void CameraControl::pan(double dx_px, double dy_px) {
    const double per_px = now_.distance / focal_px();
    const Vec3 shift = now_.rotation.row(0) * (-dx_px * per_px) + now_.rotation.row(1) * (-dy_px * per_px);
    now_.pivot = now_.pivot + shift;
    target_.pivot = target_.pivot + shift;
    at_home_ = false;
    moved_ = true;
}

Vec3 CameraControl::unproject(double x_px, double y_px, double depth) const {
    const double focal = focal_px();
    const Vec3 in_camera{(x_px - width_ * 0.5) / focal * depth, (y_px - height_ * 0.5) / focal * depth,
                         depth};
    return now_.eye() + now_.rotation.transposed() * in_camera;
}

void CameraControl::zoom(double notches, double x_px, double y_px, double depth) {
    const Vec3 point = unproject(x_px, y_px, depth > 0 ? depth : now_.distance);
    const double nearest = home_.radius * NearestShare, farthest = home_.radius * FarthestShare;
    const double wanted = std::clamp(target_.distance * std::pow(ZoomPerNotch, notches), nearest, farthest);
    const double factor = wanted / target_.distance;
    CameraPose next = target_;
    next.pivot = point + (target_.pivot - point) * factor;
    next.distance = wanted;
    go(next);
}

void CameraControl::fly(const Vec3& direction, double seconds, double speed) {
    const double step = home_.radius * speed * std::min(seconds, LongestStep);
    const Vec3 shift = now_.rotation.transposed() * (direction * step);
    now_.pivot = now_.pivot + shift;
    target_.pivot = target_.pivot + shift;
    at_home_ = false;
    moved_ = true;
}

void CameraControl::frame(const Bounds& bounds) {
    CameraPose next = target_;
    next.pivot = bounds.centre();
    next.distance = std::max(fitting_distance(bounds, next.rotation, fov_x_, width_, height_),
                             home_.radius * NearestShare);
    go(next);
}

CameraPose CameraControl::home_pose() const {
    const Camera camera = home_camera(home_, home_bounds_, fov_x_, width_, height_);
    const Vec3 centre = home_bounds_.centre();
    return {centre, length(centre - camera.centre()), camera.rotation};
}

void CameraControl::home() {
    go(home_pose());
    at_home_ = true;
}

void CameraControl::look_from(const Vec3& direction) {
    CameraPose next = target_;
    // Straight from above the picture keeps its heading, so that it does not spin.
    const bool vertical = std::abs(dot(normalized(direction), normalized(home_.up))) > 0.999;
    const Vec3 lean = vertical ? now_.rotation.row(2) * -PoleMargin : Vec3{};
    next.rotation =
        Camera::look_at(normalized(direction) + lean, {}, home_.up, fov_x_, width_, height_).rotation;
    go(next);
}

void CameraControl::set_pivot(const Vec3& point) {
    const double along = dot(point - now_.eye(), now_.rotation.row(2));
    if (along <= 0) return;
    CameraPose next = target_;
    next.pivot = point;
    next.distance = along;
    go(next);
}

bool CameraControl::update(double seconds) {
    bool moves = moved_;
    moved_ = false;
    if (!gliding_) return moves;
    const double share = 1 - std::exp(-GlideRate * std::clamp(seconds, 0.0, LongestStep));
    now_.pivot = now_.pivot + (target_.pivot - now_.pivot) * share;
    now_.distance += (target_.distance - now_.distance) * share;
    now_.rotation =
        rotation_matrix(glm::slerp(quaternion(now_.rotation), quaternion(target_.rotation), share));
    const double tolerance = ArrivedShare * target_.distance;
    if (length(now_.pivot - target_.pivot) < tolerance &&
        std::abs(now_.distance - target_.distance) < tolerance &&
        angle_between(now_.rotation, target_.rotation) < ArrivedAngle)
        arrive();
    return true;
}

Camera CameraControl::camera() const {
    Camera camera;
    camera.width = width_;
    camera.height = height_;
    camera.fx = camera.fy = focal_px();
    camera.cx = width_ * 0.5;
    camera.cy = height_ * 0.5;
    camera.rotation = now_.rotation;
    camera.translation = -(now_.rotation * now_.eye());
    return camera;
}

bool same_view(const Camera& a, const Camera& b) {
    constexpr double Tolerance = 1e-6;       // doubles that went through at most a resize
    constexpr double PlaceTolerance = 1e-9;  // of the way to the origin, which may be far from a small scene
    const auto turn = a.rotation.rows(), other = b.rotation.rows();
    for (std::size_t at = 0; at < turn.size(); ++at)
        if (std::abs(turn[at] - other[at]) > Tolerance) return false;
    if (length(a.translation - b.translation) > PlaceTolerance * length(a.translation)) return false;
    if (a.width <= 0 || b.width <= 0) return false;
    return std::abs(a.fx / a.width - b.fx / b.width) < Tolerance * (1 + a.fx / a.width);
}

void SentCameras::sent(const Camera& camera) {
    if (sent_.size() >= Limit) sent_.erase(sent_.begin());
    sent_.push_back(camera);
}

bool SentCameras::is_foreign(const Camera& shown) {
    for (std::size_t at = sent_.size(); at-- > 0;) {
        if (!same_view(sent_[at], shown)) continue;
        sent_.erase(sent_.begin(), sent_.begin() + static_cast<std::ptrdiff_t>(at));
        return false;
    }
    return true;
}

}  // namespace gse::ui
