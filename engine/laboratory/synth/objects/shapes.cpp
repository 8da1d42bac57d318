// Parametric surfaces of the primitives and the tests for being inside them.
#include "engine/laboratory/synth/objects/shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace gse::synth {
namespace {

constexpr double Tau = 2 * std::numbers::pi;
// Cosine of the angle between normals up to which a profile counts as smooth.
constexpr double SoftBend = 0.75;
constexpr double Hair = 0.002;  // model units; keeps touching surfaces from culling each other

Vec3 multiply(const Vec3& a, const Vec3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
Vec3 divide(const Vec3& a, const Vec3& b) { return {a.x / b.x, a.y / b.y, a.z / b.z}; }

struct UnitPoint {
    Vec3 position{};
    Vec3 normal{};
};

UnitPoint sphere_point(double u, double v) {
    const double azimuth = Tau * u;
    const double polar = std::numbers::pi * v;
    const Vec3 direction{std::cos(azimuth) * std::sin(polar), -std::cos(polar),
                         std::sin(azimuth) * std::sin(polar)};
    return {direction, direction};
}

/// The six faces lie side by side along u.
UnitPoint cube_point(double u, double v) {
    const double scaled = std::clamp(u, 0.0, 1.0 - 1e-12) * 6;
    const int face = static_cast<int>(scaled);
    const double a = 2 * (scaled - face) - 1;
    const double b = 2 * v - 1;
    const double side = face % 2 == 0 ? 1 : -1;
    switch (face / 2) {
        case 0: return {{side, a, b}, {side, 0, 0}};
        case 1: return {{a, side, b}, {0, side, 0}};
        default: return {{a, b, side}, {0, 0, side}};
    }
}

/// Outward normal (radius, height) of profile segment `index`.
ProfilePoint segment_normal(const std::vector<ProfilePoint>& profile, std::size_t index) {
    const double dr = profile[index + 1].radius - profile[index].radius;
    const double dh = profile[index + 1].height - profile[index].height;
    const double size = std::max(std::hypot(dr, dh), 1e-12);
    return {dh / size, -dr / size};
}

/// Normal at an end of a segment: shared with the neighbour where the profile bends softly.
ProfilePoint corner_normal(const std::vector<ProfilePoint>& profile, std::size_t segment, bool at_end) {
    const ProfilePoint own = segment_normal(profile, segment);
    if (at_end ? segment + 2 >= profile.size() : segment == 0) return own;
    const ProfilePoint other = segment_normal(profile, at_end ? segment + 1 : segment - 1);
    if (own.radius * other.radius + own.height * other.height < SoftBend) return own;
    return {own.radius + other.radius, own.height + other.height};
}

UnitPoint revolution_point(const std::vector<ProfilePoint>& profile, double u, double v) {
    const auto segments = static_cast<double>(profile.size() - 1);
    const double scaled = std::clamp(v, 0.0, 1.0 - 1e-12) * segments;
    const auto segment = static_cast<std::size_t>(scaled);
    const double t = scaled - static_cast<double>(segment);
    const auto& p = profile[segment];
    const auto& q = profile[segment + 1];
    const ProfilePoint n0 = corner_normal(profile, segment, false);
    const ProfilePoint n1 = corner_normal(profile, segment, true);
    const double radius = p.radius + t * (q.radius - p.radius);
    const double nr = n0.radius + t * (n1.radius - n0.radius);
    const double nh = n0.height + t * (n1.height - n0.height);
    const double c = std::cos(Tau * u);
    const double s = std::sin(Tau * u);
    return {{radius * c, p.height + t * (q.height - p.height), radius * s}, normalized({nr * c, nh, nr * s})};
}

bool profile_contains(const std::vector<ProfilePoint>& profile, double radius, double height) {
    bool inside = false;
    for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
        const auto& p = profile[i];
        const auto& q = profile[i + 1];
        if ((p.height > height) == (q.height > height)) continue;
        const double crossing =
            p.radius + (height - p.height) / (q.height - p.height) * (q.radius - p.radius);
        if (crossing > radius) inside = !inside;
    }
    return inside;
}

void add_arc(std::vector<ProfilePoint>& profile, double height, double radius, double from, double to) {
    constexpr int Steps = 6;
    for (int i = 0; i <= Steps; ++i) {
        const double angle = from + (to - from) * i / Steps;
        profile.push_back({std::max(0.0, radius * std::cos(angle)), height + radius * std::sin(angle)});
    }
}

}  // namespace

SurfacePoint Shape::at(double u, double v) const {
    SurfacePoint result;
    result.u = u;
    result.v = v;
    if (kind == Kind::Sheet) {
        constexpr double Step = 1e-4;
        result.position = sheet(u, v);
        const Vec3 du = sheet(std::min(u + Step, 1.0), v) - sheet(std::max(u - Step, 0.0), v);
        const Vec3 dv = sheet(u, std::min(v + Step, 1.0)) - sheet(u, std::max(v - Step, 0.0));
        const Vec3 outward = result.position - centre;
        result.normal = normalized(cross(du, dv));
        if (length(result.normal) == 0) result.normal = normalized(outward);
        if (dot(result.normal, outward) < 0) result.normal = -result.normal;
        return result;
    }
    const UnitPoint unit = kind == Kind::Sphere ? sphere_point(u, v)
                           : kind == Kind::Cube ? cube_point(u, v)
                                                : revolution_point(profile, u, v);
    result.position = centre + rotation * multiply(unit.position, scale);
    result.normal = normalized(rotation * divide(unit.normal, scale));
    return result;
}

void Shape::keep_from_edges(double& u, double& v, double margin) const {
    constexpr double Most = 0.4;  // of the extent: something is left in the middle
    const auto squeeze = [&](double t, double low, double high) {
        low = std::min(low, Most);
        high = std::min(high, Most);
        return low + t * (1 - low - high);
    };
    if (kind == Kind::Cube) {
        const int face = std::min(static_cast<int>(u * 6), 5);
        const double extent_a = 2 * (face / 2 == 0 ? scale.y : scale.x);
        const double extent_b = 2 * (face / 2 == 2 ? scale.y : scale.z);
        u = (face + squeeze(u * 6 - face, margin / extent_a, margin / extent_a)) / 6;
        v = squeeze(v, margin / extent_b, margin / extent_b);
    } else if (kind == Kind::Revolution) {
        const auto segments = static_cast<double>(profile.size() - 1);
        const auto segment = static_cast<std::size_t>(std::clamp(v, 0.0, 1.0 - 1e-12) * segments);
        const auto& p = profile[segment];
        const auto& q = profile[segment + 1];
        const double extent = std::max(std::hypot(q.radius - p.radius, q.height - p.height), 1e-9);
        const auto sharp = [&](std::size_t corner) {
            if (corner == 0 || corner + 1 >= profile.size()) return false;
            const ProfilePoint before = segment_normal(profile, corner - 1);
            const ProfilePoint after = segment_normal(profile, corner);
            return before.radius * after.radius + before.height * after.height < SoftBend;
        };
        const double t = v * segments - static_cast<double>(segment);
        const double low = sharp(segment) ? margin / extent : 0;
        const double high = sharp(segment + 1) ? margin / extent : 0;
        v = (static_cast<double>(segment) + squeeze(t, low, high)) / segments;
    }
}

bool Shape::contains(const Vec3& point) const {
    if (!solid || kind == Kind::Sheet) return false;
    const Vec3 local = rotation.transposed() * (point - centre);
    const Vec3 unit = divide(local, scale);
    if (kind == Kind::Sphere) {
        const double smallest = std::min({scale.x, scale.y, scale.z});
        const double limit = std::max(0.0, 1 - Hair / smallest);
        return dot(unit, unit) < limit * limit;
    }
    if (kind == Kind::Cube)
        return std::abs(local.x) < scale.x - Hair && std::abs(local.y) < scale.y - Hair &&
               std::abs(local.z) < scale.z - Hair;
    return profile_contains(profile, std::hypot(unit.x, unit.z) + Hair, unit.y);
}

double Shape::bounding_radius() const {
    if (kind == Kind::Sphere) return std::max({scale.x, scale.y, scale.z});
    if (kind == Kind::Cube) return length(scale);
    double largest = 0;
    for (const auto& p : profile)
        largest = std::max(largest, std::hypot(p.radius * std::max(scale.x, scale.z), p.height * scale.y));
    return largest;
}

Mat3 rotation_x(double a) {
    return Mat3::from_rows({1, 0, 0, 0, std::cos(a), -std::sin(a), 0, std::sin(a), std::cos(a)});
}
Mat3 rotation_y(double a) {
    return Mat3::from_rows({std::cos(a), 0, std::sin(a), 0, 1, 0, -std::sin(a), 0, std::cos(a)});
}
Mat3 rotation_z(double a) {
    return Mat3::from_rows({std::cos(a), -std::sin(a), 0, std::sin(a), std::cos(a), 0, 0, 0, 1});
}

Mat3 rotation_to(const Vec3& axis) {
    const Vec3 helper = std::abs(axis.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 0, 1};
    const Vec3 z = normalized(cross(helper, axis));
    const Vec3 x = cross(axis, z);
    return Mat3::from_columns(x, axis, z);
}

Shape ellipsoid(const Vec3& centre, const Vec3& radii, Paint paint) {
    Shape shape;
    shape.centre = centre;
    shape.scale = radii;
    shape.paint = paint;
    return shape;
}

Shape box(const Vec3& centre, const Vec3& half, Paint paint) {
    Shape shape = ellipsoid(centre, half, paint);
    shape.kind = Shape::Kind::Cube;
    return shape;
}

Shape revolution(const Vec3& centre, std::vector<ProfilePoint> profile, Paint paint) {
    Shape shape = ellipsoid(centre, {1, 1, 1}, paint);
    shape.kind = Shape::Kind::Revolution;
    shape.profile = std::move(profile);
    return shape;
}

Shape capsule(const Vec3& a, const Vec3& b, double radius_a, double radius_b, Paint paint) {
    const double half = 0.5 * length(b - a);
    std::vector<ProfilePoint> profile;
    add_arc(profile, -half, radius_a, -std::numbers::pi / 2, 0);
    add_arc(profile, half, radius_b, 0, std::numbers::pi / 2);
    Shape shape = revolution((a + b) * 0.5, std::move(profile), paint);
    shape.rotation = rotation_to(normalized(b - a));
    return shape;
}

Shape cone(const Vec3& a, const Vec3& b, double radius_a, double radius_b, Paint paint) {
    const double half = 0.5 * length(b - a);
    Shape shape =
        revolution((a + b) * 0.5, {{0, -half}, {radius_a, -half}, {radius_b, half}, {0, half}}, paint);
    shape.rotation = rotation_to(normalized(b - a));
    return shape;
}

Shape torus(const Vec3& centre, double ring_radius, double tube_radius, Paint paint) {
    constexpr int Steps = 16;
    std::vector<ProfilePoint> profile;
    for (int i = 0; i <= Steps; ++i) {
        const double angle = Tau * i / Steps;
        profile.push_back({ring_radius + tube_radius * std::cos(angle), tube_radius * std::sin(angle)});
    }
    return revolution(centre, std::move(profile), paint);
}

Shape sheet(const Vec3& inner, std::function<Vec3(double u, double v)> surface, Paint paint) {
    Shape shape = ellipsoid(inner, {1, 1, 1}, paint);
    shape.kind = Shape::Kind::Sheet;
    shape.solid = false;
    shape.sheet = std::move(surface);
    return shape;
}

}  // namespace gse::synth
