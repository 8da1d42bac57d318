// Small double-precision vectors and row-major 3x3 matrices; glm stays inside the window code.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace gse {

struct Vec3 {
    double x = 0, y = 0, z = 0;

    friend Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend Vec3 operator*(const Vec3& a, double s) { return {a.x * s, a.y * s, a.z * s}; }
    friend Vec3 operator*(double s, const Vec3& a) { return a * s; }
    friend Vec3 operator/(const Vec3& a, double s) { return {a.x / s, a.y / s, a.z / s}; }
    Vec3 operator-() const { return {-x, -y, -z}; }
    friend bool operator==(const Vec3&, const Vec3&) = default;
    double& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
    double operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
};

inline double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(const Vec3& a) { return std::sqrt(dot(a, a)); }
/// Unit vector; the zero vector gives (0, 0, 0).
inline Vec3 normalized(const Vec3& a) {
    const double size = length(a);
    return size > 0 ? a / size : Vec3{};
}

/// Row-major 3x3.
struct Mat3 {
    std::array<double, 9> m{};

    static Mat3 identity() { return {{1, 0, 0, 0, 1, 0, 0, 0, 1}}; }
    double& operator()(int row, int column) { return m[static_cast<std::size_t>(row * 3 + column)]; }
    double operator()(int row, int column) const { return m[static_cast<std::size_t>(row * 3 + column)]; }
    friend Vec3 operator*(const Mat3& a, const Vec3& v) {
        return {a.m[0] * v.x + a.m[1] * v.y + a.m[2] * v.z, a.m[3] * v.x + a.m[4] * v.y + a.m[5] * v.z,
                a.m[6] * v.x + a.m[7] * v.y + a.m[8] * v.z};
    }
    friend Mat3 operator*(const Mat3& a, const Mat3& b) {
        Mat3 result;
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column)
                result(row, column) = a(row, 0) * b(0, column) + a(row, 1) * b(1, column) + a(row, 2) * b(2, column);
        return result;
    }
    friend bool operator==(const Mat3&, const Mat3&) = default;
    Mat3 transposed() const { return {{m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]}}; }
};

/// Rotation quaternion, w first as in 3DGS files.
struct Quat {
    double w = 1, x = 0, y = 0, z = 0;
    friend bool operator==(const Quat&, const Quat&) = default;
};

/// Rotation matrix of q / |q|; the zero quaternion gives the identity.
Mat3 rotation_matrix(const Quat& q);
/// Unit quaternion with w >= 0 of a rotation matrix.
Quat quaternion(const Mat3& rotation);
/// Hamilton product a b (first b, then a).
Quat operator*(const Quat& a, const Quat& b);

}  // namespace gse
