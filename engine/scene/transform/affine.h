// Affine maps of space: moves, turns, scales, stretches, mirrors, and what they are together.
#pragma once

#include "engine/math/vec.h"

namespace gse {

/// Map p' = linear p + translation. The identity without values.
struct Affine {
    Mat3 linear = Mat3::identity();
    Vec3 translation{};

    static Affine move_by(const Vec3& by);
    /// Turn by `radians` about an axis through a point, counter-clockwise as seen from the axis's tip. The
    /// axis need not have length one and must not be zero.
    static Affine turn_about(const Vec3& axis, double radians, const Vec3& through);
    /// Turn of the direction `from` into `to` by the smallest angle, about a point. Neither may be zero.
    static Affine turn_towards(const Vec3& from, const Vec3& to, const Vec3& through);
    /// Equal scale in all directions that keeps a point. `factor` is above 0.
    static Affine scale_about(double factor, const Vec3& about);
    /// Scale along one axis that keeps the plane through a point at right angles to it. `factor` is above 0.
    static Affine stretch_along(const Vec3& axis, double factor, const Vec3& about);
    /// Mirror image at the plane through a point with that normal.
    static Affine mirror_at(const Vec3& normal, const Vec3& through);

    Vec3 operator()(const Vec3& point) const { return linear * point + translation; }
    /// True when no digit of any point changes.
    bool is_identity() const { return linear == Mat3::identity() && translation == Vec3{}; }
    /// True when angles stay: turns, mirrors, moves and equal scales.
    bool is_similarity() const;
    /// Factor of volumes; negative for mirror images.
    double determinant() const;

    bool operator==(const Affine&) const = default;
};

/// The map that does `second` after `first`.
Affine operator*(const Affine& second, const Affine& first);

/// Map back. The determinant must not be 0.
Affine inverse(const Affine& affine);

}  // namespace gse
