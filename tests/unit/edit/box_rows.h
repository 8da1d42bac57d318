// Things and grounds made of boxes full of rows.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/random.h"
#include "engine/scene/gaussian_set.h"

namespace gse::test {

/// Rows of boxes; up is -y, the ground is y = 0, the front looks along -z.
struct BoxRows {
    GaussianData data;
    std::vector<std::uint8_t> bits;  // labelled
    Random random{7}, shade{3};

    /// Heights from `low` to `high` above the ground; the first coefficients are near `colour`.
    BoxRows& box(double x0, double x1, double low, double high, double z0, double z1, int count,
                 bool labelled, const Vec3& colour = {}) {
        for (int i = 0; i < count; ++i)
            row({random.uniform(x0, x1), -random.uniform(low, high), random.uniform(z0, z1)}, labelled, 2,
                colour);
        return *this;
    }
    BoxRows& row(const Vec3& at, bool labelled, float opacity_logit = 2, const Vec3& colour = {}) {
        constexpr double Shading = 0.05;
        const std::size_t i = data.size();
        data.resize(i + 1);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            data.position[i * 3 + axis] = static_cast<float>(at[static_cast<int>(axis)]);
            data.log_scale[i * 3 + axis] = -4;
            data.sh[i * 3 + axis] =
                static_cast<float>(colour[static_cast<int>(axis)] + shade.uniform(-Shading, Shading));
        }
        data.rotation[i * 4] = 1;
        data.opacity_logit[i] = opacity_logit;
        bits.push_back(labelled ? 1 : 0);
        return *this;
    }
    GaussianSet set() const { return GaussianSet(GaussianData(data)); }
};

}  // namespace gse::test
