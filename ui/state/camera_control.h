// Camera of the viewport: orbit, pan, zoom to the cursor, fly, frame. Glides to its target and then stands
// still.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/math/framing.h"

namespace gse::ui {

/// Pose of the camera. It looks along row 2 of `rotation` at `pivot` from `distance` away.
struct CameraPose {
    Vec3 pivot{};
    double distance = 1;
    Mat3 rotation = Mat3::identity();  // world -> camera
    Vec3 eye() const;
};

/// Pixels are those of the picture given by set_size(). Drags act at once; wheel, frame and home glide.
class CameraControl {
public:
    /// Sets the fitted orbit and the view from home, the world's up, and the size of objects. Does not move
    /// the camera.
    void set_home(const OrbitParameters& orbit, const Bounds& bounds);
    /// Sets the picture's size. A camera that has not moved since it was sent home sees all of the scene at
    /// the new size, too.
    void set_size(int width, int height);
    void set_fov(double radians) { fov_x_ = radians; }
    double fov() const { return fov_x_; }

    /// Takes over a camera from elsewhere (a view that is looked through). The pivot is put at the scene's
    /// depth.
    void adopt(const Camera& camera);

    void orbit(double dx_px, double dy_px);
    void pan(double dx_px, double dy_px);
    /// Zooms; `notches` > 0 = nearer. The point at the cursor stays there. `depth` > 0 = its distance along
    /// the view, else the pivot's.
    void zoom(double notches, double x_px, double y_px, double depth);
    /// Moves along the camera's axes (right, down, forward), in scene sizes.
    void fly(const Vec3& direction, double seconds, double speed);
    /// Sees a box whole, from the present direction.
    void frame(const Bounds& bounds);
    void home();
    /// Looks at the pivot from this direction of the world.
    void look_from(const Vec3& direction);
    /// Turns around this point from now on. It glides to the middle of the picture.
    void set_pivot(const Vec3& point);

    /// Point under a pixel at this depth along the view.
    Vec3 unproject(double x_px, double y_px, double depth) const;

    /// Advances the glide. True while the camera moves, once more after it arrived.
    bool update(double seconds);
    bool gliding() const { return gliding_; }
    Camera camera() const;
    const CameraPose& pose() const { return now_; }

private:
    double focal_px() const;
    void rotate(const Mat3& world_rotation);
    void arrive();
    void go(const CameraPose& target);

    CameraPose home_pose() const;

    OrbitParameters home_;
    Bounds home_bounds_{{-1, -1, -1}, {1, 1, 1}};
    CameraPose now_, target_;
    double fov_x_ = 0.87;
    int width_ = 1, height_ = 1;
    bool gliding_ = false, moved_ = false, at_home_ = false;
};

/// True when both show one view, whatever the size of the picture.
bool same_view(const Camera& a, const Camera& b);

/// Cameras handed to the application that may still come back in later frames, since rendering lags behind. A
/// camera that is not among them was set by somebody else.
class SentCameras {
public:
    void sent(const Camera& camera);
    /// True for a camera that is not one of ours. Ours and all older ones are forgotten when they came back.
    bool is_foreign(const Camera& shown);
    void clear() { sent_.clear(); }

private:
    static constexpr std::size_t Limit = 256;
    std::vector<Camera> sent_;  // oldest first
};

}  // namespace gse::ui
