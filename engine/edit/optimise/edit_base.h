// The Gaussians that an edit begins with.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/scene/scene.h"

namespace gse::edit {

/// Gaussians as they came in and as they are drawn, and which of them may be worked with. Refers to the set.
struct EditBase {
    const GaussianSet& set;
    GaussianSet drawn;
    std::vector<std::uint8_t> usable;  // [N]

    explicit EditBase(const GaussianSet& base)
        : set(base), drawn(drawable(base)), usable(usable_rows(base)) {}

    /// A label [N] without Gaussians that cannot be drawn.
    std::vector<std::uint8_t> editable(std::vector<std::uint8_t> label) const {
        for (std::size_t row = 0; row < label.size(); ++row)
            label[row] = label[row] != 0 && usable[row] != 0 ? 1 : 0;
        return label;
    }
};

}  // namespace gse::edit
