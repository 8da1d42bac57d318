// Matrices of moves, turns, scales and mirrors.
#include "engine/scene/transform/affine.h"

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"

namespace gse {
namespace {

constexpr double LinearRounding =
    1e-9;  // relative: products of many maps stay far below it, real stretches above

/// Map with that linear part which keeps a point.
Affine keeping(const Mat3& linear, const Vec3& point) { return {linear, point - linear * point}; }

/// a b^T.
Mat3 outer(const Vec3& a, const Vec3& b) { return Mat3(glm::outerProduct(a, b)); }

Mat3 plus(const Mat3& a, const Mat3& b) { return Mat3(a.columns + b.columns); }

}  // namespace

Affine Affine::move_by(const Vec3& by) { return {Mat3::identity(), by}; }

Affine Affine::turn_about(const Vec3& axis, double radians, const Vec3& through) {
    GSE_CHECK(length(axis) > 0);
    const Vec3 unit = normalized(axis) * std::sin(radians / 2);
    return keeping(rotation_matrix(Quat(std::cos(radians / 2), unit.x, unit.y, unit.z)), through);
}

Affine Affine::turn_towards(const Vec3& from, const Vec3& to, const Vec3& through) {
    GSE_CHECK(length(from) > 0 && length(to) > 0);
    const Vec3 a = normalized(from), b = normalized(to);
    Vec3 axis = cross(a, b);
    if (!(length(axis) > 0))  // the same direction, or its opposite: any axis at right angles
        axis = cross(a, std::abs(a.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0});
    return turn_about(axis, std::atan2(length(cross(a, b)), dot(a, b)), through);
}

Affine Affine::scale_about(double factor, const Vec3& about) {
    GSE_CHECK(factor > 0 && std::isfinite(factor));
    return keeping(Mat3(glm::dmat3(factor)), about);
}

Affine Affine::stretch_along(const Vec3& axis, double factor, const Vec3& about) {
    GSE_CHECK(factor > 0 && std::isfinite(factor) && length(axis) > 0);
    const Vec3 unit = normalized(axis);
    return keeping(plus(Mat3::identity(), outer(unit * (factor - 1), unit)), about);
}

Affine Affine::mirror_at(const Vec3& normal, const Vec3& through) {
    GSE_CHECK(length(normal) > 0);
    const Vec3 unit = normalized(normal);
    return keeping(plus(Mat3::identity(), outer(unit * -2.0, unit)), through);
}

bool Affine::is_similarity() const {
    const Mat3 product = linear.transposed() * linear;
    const double size = (product(0, 0) + product(1, 1) + product(2, 2)) / 3;
    double worst = 0;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            worst = std::max(worst, std::abs(product(row, column) - (row == column ? size : 0)));
    return size > 0 && worst <= LinearRounding * size;
}

double Affine::determinant() const { return glm::determinant(linear.columns); }

Affine operator*(const Affine& second, const Affine& first) {
    return {second.linear * first.linear, second.linear * first.translation + second.translation};
}

Affine inverse(const Affine& affine) {
    GSE_CHECK(affine.determinant() != 0);
    const Mat3 linear(glm::inverse(affine.linear.columns));
    return {linear, -(linear * affine.translation)};
}

}  // namespace gse
