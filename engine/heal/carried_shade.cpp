// Logarithms of the light, averaged over the measured rows around each place.
#include "engine/heal/carried_shade.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>

#include "engine/base/check.h"
#include "engine/math/sh.h"

namespace gse::heal {
namespace {

constexpr double KernelCells = 1.5;  // radius of the average
constexpr double LeastShade = 0.02;  // share of the light that a shadow takes, to change a row

/// Measured rows by the cube of space that holds them.
class Cubes {
public:
    Cubes(const Shadow& shadow, const Affine& placement)
        : radius_(KernelCells * shadow.cell * std::cbrt(std::abs(placement.determinant()))) {
        for (const auto& [at, gain] : shadow.rows) {
            const Vec3 moved = placement(at);
            const Vec3 light{-std::log(gain.x), -std::log(gain.y), -std::log(gain.z)};
            cubes_[key(cube_of(moved))].push_back({moved, light});
            if (std::min({light.x, light.y, light.z}) > -LeastShade) continue;
            low_ = glm::min(low_, moved), high_ = glm::max(high_, moved);
        }
    }

    /// Factors of the light at a place.
    Vec3 light_at(const Vec3& place) const {
        for (int axis = 0; axis < 3; ++axis)
            if (!(place[axis] >= low_[axis] - radius_ && place[axis] <= high_[axis] + radius_))
                return Vec3(1);
        Vec3 sum{};
        double weights = 0;
        const Cube middle = cube_of(place);
        for (std::int64_t x = middle.x - 1; x <= middle.x + 1; ++x)
            for (std::int64_t y = middle.y - 1; y <= middle.y + 1; ++y)
                for (std::int64_t z = middle.z - 1; z <= middle.z + 1; ++z) {
                    const auto found = cubes_.find(key({x, y, z}));
                    if (found == cubes_.end()) continue;
                    for (const auto& [at, light] : found->second) {
                        const double off = dot(at - place, at - place) / (radius_ * radius_);
                        if (off >= 1) continue;
                        sum = sum + light * ((1 - off) * (1 - off));
                        weights += (1 - off) * (1 - off);
                    }
                }
        if (!(weights > 0)) return Vec3(1);
        sum = sum / weights;
        const Vec3 factor{std::exp(sum.x), std::exp(sum.y), std::exp(sum.z)};
        const bool shaded = std::min({factor.x, factor.y, factor.z}) < 1 - LeastShade;
        return shaded ? glm::min(factor, Vec3(1)) : Vec3(1);
    }

private:
    struct Cube {
        std::int64_t x = 0, y = 0, z = 0;
    };
    struct Sample {
        Vec3 at, light;  // logarithms
    };

    Cube cube_of(const Vec3& at) const {
        const auto number = [&](double value) {
            return static_cast<std::int64_t>(std::floor(value / radius_));
        };
        return {number(at.x), number(at.y), number(at.z)};
    }
    static std::int64_t key(const Cube& cube) {
        constexpr std::int64_t Range = std::int64_t{1}
                                       << 20;  // cubes far apart may share a key: they are few
        return (cube.x * Range + cube.y) * Range + cube.z;
    }

    double radius_;
    std::unordered_map<std::int64_t, std::vector<Sample>> cubes_;
    Vec3 low_{1e300, 1e300, 1e300}, high_{-1e300, -1e300, -1e300};
};

}  // namespace

std::vector<Vec3> carried_shade(const Shadow& shadow, const Affine& placement, const GaussianSet& set) {
    std::vector<Vec3> factors(set.size(), Vec3(1));
    if (shadow.rows.empty() || !(shadow.cell > 0)) return factors;
    const Cubes cubes(shadow, placement);
    for (std::size_t row = 0; row < set.size(); ++row) {
        const auto p = set.position().subspan(row * 3, 3);
        factors[row] = cubes.light_at({p[0], p[1], p[2]});
    }
    return factors;
}

namespace {

/// Coefficients of one row [(d+1)^2,3], its colours times `light`. 1 keeps their bits.
void light_row(std::span<float> sh, const Vec3& light) {
    for (std::size_t k = 0; k < sh.size(); ++k) {
        const double value = sh[k], factor = light[static_cast<int>(k % 3)];
        if (factor != 1)
            sh[k] =
                static_cast<float>(k < 3 ? sh_from_colour(colour_from_sh(value) * factor) : value * factor);
    }
}

}  // namespace

void append_lit(const GaussianSet& set, std::size_t row, const Vec3& light, GaussianData& added) {
    const std::size_t to = added.size(), stride = added.sh_stride();
    added.resize(to + 1);
    const auto copy = [&](std::span<const float> from, std::vector<float>& values, std::size_t count) {
        std::copy_n(&from[row * count], count, &values[to * count]);
    };
    copy(set.position(), added.position, 3);
    copy(set.log_scale(), added.log_scale, 3);
    copy(set.rotation(), added.rotation, 4);
    copy(set.opacity_logit(), added.opacity_logit, 1);
    copy(set.sh(), added.sh, stride);
    light_row(std::span(added.sh).subspan(to * stride, stride), light);
}

GaussianSet lit(const GaussianSet& set, std::span<const Vec3> light) {
    GSE_CHECK_EQ(light.size(), set.size());
    auto buffers = set.buffers();
    auto sh = *buffers.sh;
    const std::size_t stride = set.size() > 0 ? sh.size() / set.size() : 0;
    for (std::size_t row = 0; row < light.size(); ++row)
        light_row(std::span(sh).subspan(row * stride, stride), light[row]);
    buffers.sh = std::make_shared<const std::vector<float>>(std::move(sh));
    return GaussianSet(std::move(buffers));
}

}  // namespace gse::heal
