// Camera of the viewport: what orbit, pan, zoom, fly and frame keep, and that it comes to rest.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/base/random.h"
#include "ui/state/camera_control.h"

namespace gse::ui::camera_test {
namespace {

constexpr double Rounding = 1e-9;       // of doubles through a few rotations
constexpr double GlideRounding = 1e-6;  // of a glide: interpolated rotations are normalised again
constexpr int Width = 800, Height = 600;

CameraControl at_home() {
    CameraControl control;
    control.set_size(Width, Height);
    OrbitParameters orbit;
    orbit.centre = {1, -2, 3};
    orbit.radius = 4;
    control.set_home(orbit, {orbit.centre - Vec3{1, 1.5, 2}, orbit.centre + Vec3{1, 1.5, 2}});
    control.adopt(orbit_camera(orbit, 0.7, Width, Height));
    return control;
}

void rest(CameraControl& control) {
    for (int step = 0; step < 600 && control.gliding(); ++step) control.update(1.0 / 60);
}

/// Pixel of a point, z = depth.
Vec3 pixel(const Camera& camera, const Vec3& world) {
    const Vec3 p = camera.to_camera(world);
    return {camera.fx * p.x / p.z + camera.cx, camera.fy * p.y / p.z + camera.cy, p.z};
}

bool is_rotation(const Mat3& m) {
    const Mat3 product = m * m.transposed();
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            if (std::abs(product(row, column) - (row == column ? 1 : 0)) > 1e-8) return false;
    return true;
}

}  // namespace

DOCTEST_TEST_CASE("orbiting keeps the distance and the pivot in the middle") {
    auto control = at_home();
    Random random(4);
    for (int step = 0; step < 500; ++step) {
        control.orbit(random.uniform(-60, 60), random.uniform(-60, 60));
        const auto& pose = control.pose();
        DOCTEST_CHECK(length(pose.eye() - pose.pivot) == doctest::Approx(4).epsilon(Rounding));
        const Vec3 middle = pixel(control.camera(), pose.pivot);
        DOCTEST_CHECK(std::abs(middle.x - Width / 2.0) < 1e-6);
        DOCTEST_CHECK(std::abs(middle.y - Height / 2.0) < 1e-6);
    }
    DOCTEST_CHECK(is_rotation(control.pose().rotation));
}

DOCTEST_TEST_CASE("what is in front of the pivot follows the drag, and the horizon stays level") {
    auto control = at_home();
    const auto camera = control.camera();
    const Vec3 near_point = control.pose().pivot - camera.forward() * 1.0;
    control.orbit(30, 0);
    DOCTEST_CHECK(pixel(control.camera(), near_point).x > Width / 2.0 + 1);
    control = at_home();
    control.orbit(0, 30);
    DOCTEST_CHECK(pixel(control.camera(), near_point).y > Height / 2.0 + 1);
    // The camera's right stays at right angles to the world's up.
    for (int step = 0; step < 50; ++step) control.orbit(13, step % 7 - 3.0);
    DOCTEST_CHECK(std::abs(dot(control.pose().rotation.row(0), {0, -1, 0})) < 1e-7);
}

DOCTEST_TEST_CASE("orbiting stops short of the poles") {
    for (const double way : {-1.0, 1.0}) {
        auto control = at_home();
        for (int step = 0; step < 100; ++step) control.orbit(0, way * 100);
        const double along = dot(control.camera().forward(), Vec3{0, -1, 0});
        DOCTEST_CHECK(std::abs(along) < 1);
        DOCTEST_CHECK(std::abs(along) > 0.99);
        control.orbit(0, -way * 50);
        DOCTEST_CHECK(std::abs(dot(control.camera().forward(), Vec3{0, -1, 0})) < 0.99);
    }
}

DOCTEST_TEST_CASE("panning keeps the point at the pivot's depth under the cursor") {
    auto control = at_home();
    const Vec3 point = control.unproject(200, 150, control.pose().distance);
    control.pan(37, -21);
    const Vec3 now = pixel(control.camera(), point);
    DOCTEST_CHECK(now.x == doctest::Approx(237).epsilon(1e-9));
    DOCTEST_CHECK(now.y == doctest::Approx(129).epsilon(1e-9));
}

DOCTEST_TEST_CASE("zooming keeps what is under the cursor there, all the way") {
    for (const double depth : {-1.0, 2.5, 7.0}) {
        auto control = at_home();
        const Vec3 point = control.unproject(610, 90, depth > 0 ? depth : control.pose().distance);
        control.zoom(3, 610, 90, depth);
        DOCTEST_CHECK(control.gliding());
        for (int step = 0; step < 20; ++step) {
            control.update(1.0 / 60);
            const Vec3 now = pixel(control.camera(), point);
            DOCTEST_CHECK(std::abs(now.x - 610) < 1e-4);
            DOCTEST_CHECK(std::abs(now.y - 90) < 1e-4);
        }
        rest(control);
        DOCTEST_CHECK(control.pose().distance < 4 * 0.7);
    }
}

DOCTEST_TEST_CASE("zooming has ends") {
    auto control = at_home();
    for (int step = 0; step < 300; ++step) {
        control.zoom(5, 400, 300, -1);
        rest(control);
    }
    DOCTEST_CHECK(control.pose().distance > 0);
    DOCTEST_CHECK(std::isfinite(control.camera().translation.x));
    for (int step = 0; step < 300; ++step) {
        control.zoom(-5, 400, 300, -1);
        rest(control);
    }
    DOCTEST_CHECK(control.pose().distance <= 4e4 * (1 + GlideRounding));
}

DOCTEST_TEST_CASE("a glide ends, and then nothing moves") {
    auto control = at_home();
    control.orbit(200, 30);
    control.home();
    DOCTEST_CHECK(control.gliding());
    double seconds = 0;
    while (control.update(1.0 / 60) && seconds < 5) seconds += 1.0 / 60;
    DOCTEST_CHECK(seconds < 1.5);
    DOCTEST_CHECK(!control.gliding());
    DOCTEST_CHECK(!control.update(1.0 / 60));
    OrbitParameters orbit;
    orbit.centre = {1, -2, 3};
    orbit.radius = 4;
    const Bounds bounds{orbit.centre - Vec3{1, 1.5, 2}, orbit.centre + Vec3{1, 1.5, 2}};
    DOCTEST_CHECK(same_view(control.camera(), home_camera(orbit, bounds, control.fov(), Width, Height)));
}

DOCTEST_TEST_CASE("home and frame show a box whole and as large as can be, at any window shape") {
    constexpr int shapes[][2] = {{1600, 900}, {900, 1600}, {640, 640}, {3000, 200}, {200, 3000}};
    const Bounds boxes[] = {{{-1, -1, -1}, {1, 1, 1}},
                            {{4, -3, 2}, {4.2, 3, 2.1}},
                            {{-5, 0, -5}, {5, 0.2, 5}},
                            {{1e-3, 1e-3, 1e-3}, {2e-3, 3e-3, 2e-3}},
                            {{1e4, 0, 0}, {3e4, 2e4, 1e4}}};
    for (const auto& box : boxes)
        for (const auto& shape : shapes)
            for (const bool frames : {false, true}) {
                DOCTEST_CAPTURE(shape[0]);
                DOCTEST_CAPTURE(box.radius());
                OrbitParameters orbit;
                orbit.centre = box.centre();
                orbit.radius = 4 * box.radius();
                CameraControl control;
                control.set_size(shape[0], shape[1]);
                control.set_home(orbit, box);
                control.adopt(orbit_camera(orbit, 2.2, shape[0], shape[1]));
                if (frames) control.frame(box);
                else control.home();
                rest(control);
                const Camera camera = control.camera();
                double nearest = 1;  // to an edge, of the picture
                for (int corner = 0; corner < 8; ++corner) {
                    const Vec3 at = pixel(
                        camera, {corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                                 corner & 4 ? box.high.z : box.low.z});
                    DOCTEST_CHECK(at.z > 0);
                    const double x = at.x / shape[0], y = at.y / shape[1];
                    nearest = std::min({nearest, x, 1 - x, y, 1 - y});
                }
                DOCTEST_CHECK(nearest > 0.04);
                DOCTEST_CHECK(nearest < 0.06);
            }
}

DOCTEST_TEST_CASE(
    "a camera at home stays there when the window changes its shape, one that was moved does not") {
    OrbitParameters orbit;
    const Bounds box{{-0.3, -0.5, -0.3}, {0.3, 0.5, 0.3}};
    for (const bool moved : {false, true}) {
        CameraControl control;
        control.set_home(orbit, box);
        control.adopt(
            home_camera(orbit, box, 0.87, 64, 64));  // as it is opened, before the window has its size
        control.set_size(1600, 500);
        control.update(0.016);
        DOCTEST_CHECK(same_view(control.camera(), home_camera(orbit, box, control.fov(), 1600, 500)));
        if (moved) control.orbit(30, 10);
        const CameraPose before = control.pose();
        control.set_size(500, 1600);
        control.update(0.016);
        if (moved) DOCTEST_CHECK(control.pose().distance == before.distance);
        else DOCTEST_CHECK(same_view(control.camera(), home_camera(orbit, box, control.fov(), 500, 1600)));
    }
}

DOCTEST_TEST_CASE("a slow frame does not throw the camera") {
    auto control = at_home();
    const Vec3 before = control.pose().eye();
    control.fly({0, 0, 1}, 30, 1);
    DOCTEST_CHECK(length(control.pose().eye() - before) < 1);
    control.zoom(1, 10, 10, -1);
    control.update(1e9);
    DOCTEST_CHECK(std::isfinite(control.pose().distance));
}

DOCTEST_TEST_CASE("framing shows what is in the box") {
    auto control = at_home();
    const Vec3 centre{0.5, 0.25, -1};
    control.frame({centre - Vec3{0.8, 0.8, 0.8}, centre + Vec3{0.8, 0.8, 0.8}});
    rest(control);
    const Camera camera = control.camera();
    Random random(8);
    for (int sample = 0; sample < 200; ++sample) {
        const Vec3 direction = normalized({random.normal(), random.normal(), random.normal()});
        const Vec3 at = pixel(camera, centre + direction * 0.8);
        DOCTEST_CHECK(at.z > 0);
        DOCTEST_CHECK(at.x > 0);
        DOCTEST_CHECK(at.x < Width);
        DOCTEST_CHECK(at.y > 0);
        DOCTEST_CHECK(at.y < Height);
    }
}

DOCTEST_TEST_CASE("a new pivot glides to the middle without turning or moving nearer") {
    auto control = at_home();
    const Mat3 rotation = control.pose().rotation;
    const Vec3 point = control.unproject(100, 500, 3);
    const double depth_before = dot(point - control.pose().eye(), control.camera().forward());
    control.set_pivot(point);
    rest(control);
    DOCTEST_CHECK(length(control.pose().pivot - point) < 1e-9);
    DOCTEST_CHECK(control.pose().distance == doctest::Approx(depth_before).epsilon(Rounding));
    DOCTEST_CHECK(control.pose().rotation == rotation);
}

DOCTEST_TEST_CASE("a camera taken over is shown as it was") {
    OrbitParameters orbit;
    orbit.radius = 2;
    const Camera camera = orbit_camera(orbit, 2.1, Width, Height);
    CameraControl control;
    control.set_size(Width, Height);
    control.set_home(orbit, {{-1, -1, -1}, {1, 1, 1}});
    control.adopt(camera);
    DOCTEST_CHECK(same_view(control.camera(), camera));
    DOCTEST_CHECK(control.pose().distance == doctest::Approx(2).epsilon(Rounding));
    // One that looks away from the scene gets a pivot in front of it all the same.
    control.adopt(Camera::look_at({5, 0, 0}, {9, 0, 0}, {0, -1, 0}, 0.8, Width, Height));
    DOCTEST_CHECK(control.pose().distance > 0);
}

DOCTEST_TEST_CASE("cameras that come back late are ours, others are not") {
    OrbitParameters orbit;
    SentCameras sent;
    std::vector<Camera> cameras;
    for (int step = 0; step < 10; ++step) cameras.push_back(orbit_camera(orbit, step * 0.1, 640, 480));
    for (const auto& camera : cameras) sent.sent(camera);
    DOCTEST_CHECK(!sent.is_foreign(cameras[4].resized(320, 240)));
    DOCTEST_CHECK(!sent.is_foreign(cameras[4]));
    DOCTEST_CHECK(sent.is_foreign(cameras[2]));
    DOCTEST_CHECK(sent.is_foreign(orbit_camera(orbit, 3, 640, 480)));
    DOCTEST_CHECK(!sent.is_foreign(cameras[9]));
}

}  // namespace gse::ui::camera_test
