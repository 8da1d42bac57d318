// Gradients of labelled rows for tests of what follows the rasterizer.
#pragma once

#include <cmath>
#include <vector>

#include "engine/edit/optimise/working_set.h"

namespace gse::test {

/// Gradients of every labelled row of `set`, all visible. Each value comes from `number()`; lengths on the
/// picture are positive.
template <class Number> raster::Gradients row_gradients(const edit::WorkingSet& set, Number&& number) {
    raster::Gradients gradients;
    const auto fill = [&](LineFloats& values, std::size_t stride) {
        values.resize(set.labelled() * stride);
        for (auto& value : values) value = static_cast<float>(number());
    };
    fill(gradients.position, 3);
    fill(gradients.log_scale, 3);
    fill(gradients.rotation, 4);
    fill(gradients.opacity_logit, 1);
    fill(gradients.sh, set.rows().sh_stride());
    fill(gradients.mean2d_norm, 1);
    for (auto& value : gradients.mean2d_norm) value = std::abs(value);
    gradients.visible.assign(set.labelled(), 1);
    return gradients;
}

}  // namespace gse::test
