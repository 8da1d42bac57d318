// The one map of all rows from their means, and its powers.
#include "engine/scene/transform/turn_share.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "engine/math/sh.h"
#include "engine/math/vec.h"

namespace gse {
namespace {

constexpr double LeastTurn = 1e-4;      // radians: less is no turn but rounding
constexpr double PlaceRounding = 1e-5;  // of the rows' extent, and of their distance from the origin
constexpr double ShapeRounding = 1e-4;  // of log-scales, and of what quaternions of one turn differ by

Vec3 place(const float* xyz) { return {xyz[0], xyz[1], xyz[2]}; }

Quat unit(const float* wxyz) {
    const Quat q(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
    const double norm = length(q);
    return norm > 0 ? q / norm : Quat(0, 0, 0, 0);
}

/// Angle in [0, pi] and unit axis.
struct AxisAngle {
    Vec3 axis{0, 1, 0};
    double angle = 0;
};

AxisAngle axis_angle(const Mat3& rotation) {
    const Quat q = quaternion(rotation);
    const Vec3 vector{q.x, q.y, q.z};
    AxisAngle result;
    result.angle = 2 * std::atan2(length(vector), q.w);
    if (length(vector) > 0) result.axis = normalized(vector);
    return result;
}

/// Pairs of rows before and after.
class Pairs {
public:
    Pairs(const GaussianSpans& before, std::span<const std::size_t> from, const GaussianData& after)
        : before_(before), from_(from), after_(after) {}

    /// The map of the rows' means; it may be no map of each row.
    Affine mean_map() const {
        Vec3 middle_before{}, middle_after{};
        Quat turn(0, 0, 0, 0);
        double count = 0, growth = 0;
        each([&](std::size_t old, std::size_t row) {
            middle_before = middle_before + place(&before_.position[old * 3]);
            middle_after = middle_after + place(&after_.position[row * 3]);
            const Quat q = unit(&after_.rotation[row * 4]) * conjugate(unit(&before_.rotation[old * 4]));
            turn += dot(turn, q) < 0 ? -q : q;
            growth += static_cast<double>(after_.log_scale[row * 3]) - before_.log_scale[old * 3];
            count += 1;
        });
        if (count == 0 || !(length(turn) > 0)) return {};
        const double factor = std::exp(growth / count);
        if (!std::isfinite(factor) || !(factor > 0)) return {};
        Affine map;
        map.linear = Mat3(rotation_matrix(turn / length(turn)).columns * factor);
        map.translation = middle_after / count - map.linear * (middle_before / count);
        return map;
    }

    bool follow(const Affine& map) const {
        double slack = 0;
        Vec3 low(1e300), high(-1e300);
        each([&](std::size_t old, std::size_t row) {
            const Vec3 at = place(&before_.position[old * 3]), to = place(&after_.position[row * 3]);
            low = glm::min(low, at), high = glm::max(high, at);
            slack = std::max({slack, length(at), length(to)});
        });
        slack = PlaceRounding * std::max(slack, length(high - low));
        const double factor = std::cbrt(map.determinant()), growth = std::log(factor);
        const Quat turn = quaternion(Mat3(map.linear.columns / factor));
        bool all = true;
        each([&](std::size_t old, std::size_t row) {
            all = all && follows(old, row, map, turn, growth, slack);
        });
        return all;
    }

private:
    template <class F> void each(F&& call) const {
        for (std::size_t row = 0; row < from_.size(); ++row)
            if (from_[row] < before_.size) call(from_[row], row);
    }

    bool follows(std::size_t old, std::size_t row, const Affine& map, const Quat& turn, double growth,
                 double slack) const {
        const std::size_t old_stride = static_cast<std::size_t>(sh_coefficient_count(before_.sh_degree)) * 3;
        for (std::size_t i = 0; i < 3; ++i) {
            if (before_.sh[old * old_stride + i] != after_.sh[row * after_.sh_stride() + i]) return false;
            const double grown =
                static_cast<double>(after_.log_scale[row * 3 + i]) - before_.log_scale[old * 3 + i];
            if (!(std::abs(grown - growth) <= ShapeRounding)) return false;
        }
        if (before_.opacity_logit[old] != after_.opacity_logit[row]) return false;
        const Quat wanted = turn * unit(&before_.rotation[old * 4]);
        const double along = std::abs(dot(wanted, unit(&after_.rotation[row * 4])));
        if (!(1 - along <= ShapeRounding)) return false;
        return length(map(place(&before_.position[old * 3])) - place(&after_.position[row * 3])) <= slack;
    }

    const GaussianSpans& before_;
    std::span<const std::size_t> from_;
    const GaussianData& after_;
};

}  // namespace

std::optional<Affine> common_turn(const GaussianSpans& before, std::span<const std::size_t> from,
                                  const GaussianData& after) {
    const Pairs pairs(before, from, after);
    const Affine map = pairs.mean_map();
    const double factor = std::cbrt(map.determinant());
    if (map.is_identity() || axis_angle(Mat3(map.linear.columns / factor)).angle < LeastTurn) return {};
    return pairs.follow(map) ? std::optional(map) : std::nullopt;
}

Affine share_of_turn(const Affine& turn, double share) {
    using Complex = std::complex<double>;
    const double factor = std::cbrt(turn.determinant()), growth = std::log(factor);
    const auto [axis, angle] = axis_angle(Mat3(turn.linear.columns / factor));
    if (angle < LeastTurn) {
        Affine part = Affine::scale_about(std::pow(factor, share), {});
        part.translation = turn.translation * share;
        return part;
    }
    // Across the axis the map is a complex factor and a shift, whose powers are known.
    const Vec3 right = normalized(cross(axis, std::abs(axis.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
    const Vec3 ahead = cross(axis, right);
    const Complex whole = std::polar(factor, angle),
                  part = std::polar(std::exp(growth * share), angle * share);
    const Complex shift =
        Complex(dot(turn.translation, right), dot(turn.translation, ahead)) * (1.0 - part) / (1.0 - whole);
    const double along = growth == 0 ? share : std::expm1(growth * share) / std::expm1(growth);
    Affine result = Affine::turn_about(axis, angle * share, {});
    result.linear = Mat3(result.linear.columns * std::exp(growth * share));
    result.translation =
        right * shift.real() + ahead * shift.imag() + axis * (dot(turn.translation, axis) * along);
    return result;
}

}  // namespace gse
