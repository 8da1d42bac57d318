// Rotations, cameras and orbits.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <new>
#include <numbers>

#include "engine/base/random.h"
#include "engine/math/camera.h"
#include "engine/math/sh.h"
#include "engine/math/vec.h"

namespace math_test {

using namespace gse;

namespace {

constexpr double Tolerance = 1e-12;  // a few roundings of double

Quat random_quaternion(Random& random) {
    return {random.normal(), random.normal(), random.normal(), random.normal()};
}

double largest(const Mat3& a, const Mat3& b) {
    double difference = 0;
    for (std::size_t i = 0; i < 9; ++i)
        difference = std::max(difference, std::abs(a.rows()[i] - b.rows()[i]));
    return difference;
}

double determinant(const Mat3& m) { return dot(m.row(0), cross(m.row(1), m.row(2))); }

/// A T without values, in memory that was not empty.
template <class T> T without_values() {
    alignas(T) std::array<std::byte, sizeof(T)> place;
    place.fill(std::byte{0x5a});
    return *new (place.data()) T;
}

}  // namespace

DOCTEST_TEST_CASE("what is given no values is zero, and a quaternion no turn") {
    DOCTEST_CHECK(without_values<Vec3>() == Vec3{0, 0, 0});
    DOCTEST_CHECK(without_values<Mat3>().rows() == std::array<double, 9>{});
    DOCTEST_CHECK(without_values<Quat>() == Quat{1, 0, 0, 0});
    DOCTEST_CHECK(without_values<Camera>().translation == Vec3{});
    DOCTEST_CHECK(normalized(Vec3{}) == Vec3{});
}

DOCTEST_TEST_CASE("matrices are indexed by row and column") {
    const double c = std::cos(0.3), s = std::sin(0.3);
    const std::array<double, 9> rows{c, -s, 0, s, c, 0, 0, 0, 1};  // about z
    const Mat3 turn = Mat3::from_rows(rows);
    DOCTEST_CHECK(turn.rows() == rows);
    DOCTEST_CHECK(turn(0, 1) == -s);
    DOCTEST_CHECK(turn(1, 0) == s);
    DOCTEST_CHECK(turn.row(1) == Vec3{s, c, 0});
    DOCTEST_CHECK(turn.columns[1] == Vec3{-s, c, 0});
    DOCTEST_CHECK(turn == Mat3::from_columns({c, s, 0}, {-s, c, 0}, {0, 0, 1}));
    DOCTEST_CHECK(turn.transposed() == Mat3::from_columns(turn.row(0), turn.row(1), turn.row(2)));
    DOCTEST_CHECK(turn * Vec3{1, 0, 0} == Vec3{c, s, 0});
    DOCTEST_CHECK(Vec3{1, 0, 0} * turn == Vec3{c, -s, 0});
    const Quat same{std::cos(0.15), 0, 0, std::sin(0.15)};
    DOCTEST_CHECK(largest(rotation_matrix(same), turn) < Tolerance);
    DOCTEST_CHECK(length(quaternion(turn) - same) < Tolerance);
    const Mat3 a = Mat3::from_rows({1, 2, 3, 4, 5, 6, 7, 8, 9}),
               b = Mat3::from_rows({0, 1, 0, 0, 0, 2, 3, 0, 0});
    DOCTEST_CHECK((a * b).rows() == std::array<double, 9>{9, 1, 4, 18, 4, 10, 27, 7, 16});
}

DOCTEST_TEST_CASE("quaternions and matrices say the same rotation") {
    Random random(1);
    for (int i = 0; i < 200; ++i) {
        const Mat3 r = rotation_matrix(random_quaternion(random));
        DOCTEST_CHECK(largest(r * r.transposed(), Mat3::identity()) < Tolerance);
        DOCTEST_CHECK(determinant(r) == doctest::Approx(1));
        const Quat q = quaternion(r);
        DOCTEST_CHECK(q.w >= 0);
        DOCTEST_CHECK(largest(rotation_matrix(q), r) < Tolerance);
    }
    for (const Quat& q :
         {Quat{0, 1, 0, 0}, Quat{0, 0, 1, 0}, Quat{0, 0, 0, 1}, Quat{1e-9, 1, 0, 0}, Quat{1, 0, 0, 0}})
        DOCTEST_CHECK(largest(rotation_matrix(quaternion(rotation_matrix(q))), rotation_matrix(q)) <
                      Tolerance);
    DOCTEST_CHECK(rotation_matrix({0, 0, 0, 0}) == Mat3::identity());
}

DOCTEST_TEST_CASE("the product of quaternions turns first by the right one") {
    Random random(2);
    for (int i = 0; i < 50; ++i) {
        const Quat a = quaternion(rotation_matrix(random_quaternion(random)));
        const Quat b = quaternion(rotation_matrix(random_quaternion(random)));
        DOCTEST_CHECK(largest(rotation_matrix(a * b), rotation_matrix(a) * rotation_matrix(b)) < Tolerance);
    }
}

DOCTEST_TEST_CASE("look_at puts the target in the middle and up to the top") {
    Random random(3);
    for (int i = 0; i < 100; ++i) {
        const Vec3 eye = {random.normal(), random.normal(), random.normal()};
        const Vec3 target = eye + Vec3{random.normal(), random.normal(), random.normal()};
        const Vec3 up = normalized({random.normal(), random.normal(), random.normal()});
        const Camera camera = Camera::look_at(eye, target, up, 0.8, 300, 200);
        DOCTEST_CHECK(length(camera.centre() - eye) < 1e-9);
        DOCTEST_CHECK(determinant(camera.rotation) == doctest::Approx(1));
        const Vec3 seen = camera.to_camera(target);
        DOCTEST_CHECK(std::abs(seen.x) < 1e-9);
        DOCTEST_CHECK(std::abs(seen.y) < 1e-9);
        DOCTEST_CHECK(seen.z == doctest::Approx(length(target - eye)));
        DOCTEST_CHECK(camera.to_camera(eye + up).y <= 1e-9);
        DOCTEST_CHECK(2 * std::atan(150 / camera.fx) == doctest::Approx(0.8));
    }
}

DOCTEST_TEST_CASE("look_at survives a view along up and a target at the eye") {
    for (const Vec3& target : {Vec3{0, -5, 0}, Vec3{0, 5, 0}, Vec3{0, 0, 0}}) {
        const Camera camera = Camera::look_at({0, 0, 0}, target, {0, -1, 0}, 0.8, 100, 100);
        DOCTEST_CHECK(largest(camera.rotation * camera.rotation.transposed(), Mat3::identity()) < Tolerance);
    }
}

DOCTEST_TEST_CASE("resizing keeps the view") {
    const Camera camera = Camera::look_at({1, 2, 3}, {0, 0, 0}, {0, -1, 0}, 0.8, 300, 200);
    const Camera half = camera.resized(150, 100);
    DOCTEST_CHECK(half.fx == doctest::Approx(camera.fx / 2));
    DOCTEST_CHECK(half.cy == doctest::Approx(50));
    const Camera square = camera.resized(300, 300);  // more above and below, the middle stays the middle
    DOCTEST_CHECK(square.cy == doctest::Approx(150));
    DOCTEST_CHECK(square.fx == camera.fx);
}

DOCTEST_TEST_CASE("orbit cameras stand on the sphere and look at its centre") {
    OrbitParameters orbit;
    orbit.centre = {1, 2, 3};
    orbit.radius = 4;
    for (int i = 0; i < 16; ++i) {
        const Camera camera = orbit_camera(orbit, i * std::numbers::pi / 8, 64, 64);
        DOCTEST_CHECK(length(camera.centre() - orbit.centre) == doctest::Approx(4));
        DOCTEST_CHECK(dot(camera.centre() - orbit.centre, orbit.up) ==
                      doctest::Approx(4 * std::sin(orbit.elevation)));
        DOCTEST_CHECK(length(camera.forward() - normalized(orbit.centre - camera.centre())) < Tolerance);
    }
    DOCTEST_CHECK(orbit_camera(orbit, 0, 64, 64).centre().z < orbit.centre.z);  // the front faces -z
}

DOCTEST_TEST_CASE("spherical harmonics: counts and base colours") {
    DOCTEST_CHECK(sh_coefficient_count(0) == 1);
    DOCTEST_CHECK(sh_coefficient_count(3) == 16);
    for (const double colour : {0.0, 0.25, 1.0})
        DOCTEST_CHECK(colour_from_sh(sh_from_colour(colour)) == doctest::Approx(colour));
}

}  // namespace math_test
