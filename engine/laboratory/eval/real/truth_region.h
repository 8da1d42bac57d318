// Region of a scene that somebody drew by hand as the truth of a thing.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <variant>
#include <vector>

#include "engine/math/vec.h"

namespace gse::bench {

/// Set of points of a scene, in the world of its file. A value.
class TruthRegion {
public:
    /// Points in any of `parts` and in none of `minus`.
    struct Union {
        std::vector<TruthRegion> parts, minus;
    };
    /// Points in all of `parts`.
    struct Intersection {
        std::vector<TruthRegion> parts;
    };
    /// Points that differ from the centre by at most `half` along each row of `axes`.
    struct Box {
        Vec3 centre, half;
        Mat3 axes;
    };
    struct Ellipsoid {
        Vec3 centre, radii;
        Mat3 axes;
    };
    /// Points with dot(normal, point) <= offset.
    struct Halfspace {
        Vec3 normal;
        double offset = 0;
    };
    /// Points whose (u, v) lie in the polygon by the even-odd rule, and n in [low, high].
    struct Prism {
        Vec3 u, v, n;
        std::vector<std::array<double, 2>> polygon;
        double low = 0, high = 0;
    };
    using Shape = std::variant<Union, Intersection, Box, Ellipsoid, Halfspace, Prism>;

    TruthRegion(Shape shape);

    /// Tells whether a point lies inside; borders of boxes, ellipsoids and half-spaces do.
    bool contains(const Vec3& point) const;
    const Shape& shape() const { return shape_; }

private:
    Shape shape_;
};

/// Region of JSON: {"union": [...], "minus": [...]}, {"all": [...]}, {"box": {"centre", "half", "axes"?}},
/// {"ellipsoid": {"centre", "radii", "axes"?}}, {"halfspace": {"normal", "offset"}}, or {"prism": {"u", "v",
/// "n", "polygon", "low", "high"}}. Throws Error (Malformed) that begins with `where`.
TruthRegion parse_region(const nlohmann::ordered_json& json, const std::string& where);

}  // namespace gse::bench
