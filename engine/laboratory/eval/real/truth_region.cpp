// Shapes and their points.
#include "engine/laboratory/eval/real/truth_region.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/laboratory/eval/real/suite_json.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;
using Region = TruthRegion;

bool in_any(const std::vector<Region>& parts, const Vec3& point) {
    return std::any_of(parts.begin(), parts.end(), [&](const auto& part) { return part.contains(point); });
}

bool inside(const Region::Union& shape, const Vec3& point) {
    return in_any(shape.parts, point) && !in_any(shape.minus, point);
}

bool inside(const Region::Intersection& shape, const Vec3& point) {
    return std::all_of(shape.parts.begin(), shape.parts.end(),
                       [&](const auto& part) { return part.contains(point); });
}

bool inside(const Region::Box& shape, const Vec3& point) {
    const Vec3 at = shape.axes * (point - shape.centre);
    return std::abs(at.x) <= shape.half.x && std::abs(at.y) <= shape.half.y && std::abs(at.z) <= shape.half.z;
}

bool inside(const Region::Ellipsoid& shape, const Vec3& point) {
    const Vec3 at = shape.axes * (point - shape.centre) / shape.radii;
    return dot(at, at) <= 1;
}

bool inside(const Region::Halfspace& shape, const Vec3& point) {
    return dot(shape.normal, point) <= shape.offset;
}

bool inside(const Region::Prism& shape, const Vec3& point) {
    const double u = dot(shape.u, point), v = dot(shape.v, point), n = dot(shape.n, point);
    if (!(n >= shape.low && n <= shape.high)) return false;
    bool odd = false;
    auto last = shape.polygon.back();
    for (const auto& corner : shape.polygon) {
        const auto [x0, y0] = last;
        const auto [x1, y1] = corner;
        if ((y0 > v) != (y1 > v) && u < (x0 - x1) * (v - y1) / (y0 - y1) + x1) odd = !odd;
        last = corner;
    }
    return odd;
}

std::vector<Region> regions(const Json& list, const std::string& where) {
    std::vector<Region> parts;
    for (std::size_t i = 0; i < list.size(); ++i)
        parts.push_back(parse_region(list[i], fmt::format("{}, shape {}", where, i + 1)));
    return parts;
}

Mat3 axes_of(const Json& json, const std::string& where) {
    if (!has_entry(json, "axes")) return Mat3::identity();
    const auto& rows = list_entry(json, "axes", where);
    if (rows.size() != 3) refuse_suite(where, "\"axes\" is no list of three vectors");
    std::array<Vec3, 3> axes;
    for (std::size_t i = 0; i < 3; ++i) axes[i] = vector_of(rows[i], where + ", \"axes\"");
    return Mat3::from_columns(axes[0], axes[1], axes[2]).transposed();
}

Region::Prism prism_of(const Json& json, const std::string& where) {
    Region::Prism prism{vector_entry(json, "u", where),   vector_entry(json, "v", where),
                        vector_entry(json, "n", where),   {},
                        number_entry(json, "low", where), number_entry(json, "high", where)};
    for (const auto& corner : list_entry(json, "polygon", where)) {
        if (!corner.is_array() || corner.size() != 2)
            refuse_suite(where, "a corner of \"polygon\" is no list of two numbers");
        prism.polygon.push_back({number_of(corner[0], where), number_of(corner[1], where)});
    }
    if (prism.polygon.size() < 3) refuse_suite(where, "\"polygon\" has fewer than three corners");
    return prism;
}

Region::Ellipsoid ellipsoid_of(const Json& json, const std::string& where) {
    Region::Ellipsoid shape{vector_entry(json, "centre", where), vector_entry(json, "radii", where),
                            axes_of(json, where)};
    if (!(shape.radii.x > 0 && shape.radii.y > 0 && shape.radii.z > 0))
        refuse_suite(where, "\"radii\" are not above 0");
    return shape;
}

}  // namespace

TruthRegion::TruthRegion(Shape shape) : shape_(std::move(shape)) {}

bool TruthRegion::contains(const Vec3& point) const {
    return std::visit([&](const auto& shape) { return inside(shape, point); }, shape_);
}

TruthRegion parse_region(const Json& json, const std::string& where) {
    if (has_entry(json, "union")) {
        Region::Union whole{regions(list_entry(json, "union", where), where), {}};
        if (has_entry(json, "minus"))
            whole.minus = regions(list_entry(json, "minus", where), where + ", minus");
        return Region::Shape(std::move(whole));
    }
    if (has_entry(json, "all"))
        return Region::Shape(Region::Intersection{regions(list_entry(json, "all", where), where)});
    if (!json.is_object() || json.size() != 1) refuse_suite(where, "it is no single shape");
    const auto& name = json.begin().key();
    const auto& shape = json.begin().value();
    const auto place = fmt::format("{}, {}", where, name);
    if (name == "box")
        return Region::Shape(Region::Box{vector_entry(shape, "centre", place),
                                         vector_entry(shape, "half", place), axes_of(shape, place)});
    if (name == "ellipsoid") return Region::Shape(ellipsoid_of(shape, place));
    if (name == "halfspace")
        return Region::Shape(
            Region::Halfspace{vector_entry(shape, "normal", place), number_entry(shape, "offset", place)});
    if (name == "prism") return Region::Shape(prism_of(shape, place));
    refuse_suite(where, fmt::format("the shape \"{}\" is not known (union, all, box, ellipsoid, halfspace, "
                                    "prism are)",
                                    name));
}

}  // namespace gse::bench
