// Vectors, matrices and quaternions of the host side: glm's, in double precision. No other file includes glm
// (tests/lint), so that its settings are equal everywhere.
#pragma once

#include <array>

#define GLM_FORCE_CTOR_INIT  // a vector without values is zero, a quaternion the identity
#define GLM_FORCE_XYZW_ONLY  // plain members instead of unions with r, g, b
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

namespace gse {

using Vec3 = glm::dvec3;
/// Rotation quaternion. The constructor takes w first, as 3DGS files do. The product a * b turns first by b.
using Quat = glm::dquat;

using glm::cross;
using glm::dot;
using glm::length;

/// Unit vector; the zero vector gives (0, 0, 0).
inline Vec3 normalized(const Vec3& a) {
    const double size = length(a);
    return size > 0 ? a / size : Vec3{};
}

/// 3x3 matrix indexed (row, column), as in formulas and files. glm's own index is the column. Zero without
/// values.
struct Mat3 {
    glm::dmat3 columns{0.0};

    Mat3() = default;
    explicit Mat3(const glm::dmat3& matrix) : columns(matrix) {}
    static Mat3 identity() { return Mat3(glm::dmat3(1.0)); }
    static Mat3 from_columns(const Vec3& a, const Vec3& b, const Vec3& c) {
        return Mat3(glm::dmat3(a, b, c));
    }
    /// Conversion from nine numbers row by row, and back.
    static Mat3 from_rows(const std::array<double, 9>& n) {
        return from_columns({n[0], n[3], n[6]}, {n[1], n[4], n[7]}, {n[2], n[5], n[8]});
    }
    std::array<double, 9> rows() const {
        const Vec3 &a = columns[0], &b = columns[1], &c = columns[2];
        return {a.x, b.x, c.x, a.y, b.y, c.y, a.z, b.z, c.z};
    }
    double& operator()(int row, int column) { return columns[column][row]; }
    double operator()(int row, int column) const { return columns[column][row]; }
    Vec3 row(int index) const { return {columns[0][index], columns[1][index], columns[2][index]}; }
    Mat3 transposed() const { return Mat3(glm::transpose(columns)); }

    friend Vec3 operator*(const Mat3& a, const Vec3& v) { return a.columns * v; }
    /// Row vector times matrix.
    friend Vec3 operator*(const Vec3& v, const Mat3& a) { return v * a.columns; }
    friend Mat3 operator*(const Mat3& a, const Mat3& b) { return Mat3(a.columns * b.columns); }
    friend bool operator==(const Mat3&, const Mat3&) = default;
};

/// Rotation matrix of q / |q|; the zero quaternion gives the identity.
Mat3 rotation_matrix(const Quat& q);
/// Unit quaternion with w >= 0 of a rotation matrix.
Quat quaternion(const Mat3& rotation);

}  // namespace gse
