// Adam on flat arrays of rows.
#pragma once

#include <span>
#include <vector>

namespace gse::edit {

/// First and second moments of Adam (Kingma and Ba 2015) for one attribute of the labelled rows.
struct AdamMoments {
    std::vector<float> first, second;
};

/// Learning rates of one Adam step: `rates` are those of the components of a row (repeated for every row),
/// `row_factor` (may be empty) multiplies them per row. `step` counts from 1.
struct AdamRates {
    std::span<const double> rates;
    std::span<const float> row_factor;
    int step = 1;
};

/// One Adam step; beta 0.9 / 0.999, eps 1e-15 as in 3DGS. Dense: rows with zero gradient still follow their
/// momentum.
void adam_step(std::span<float> parameters, std::span<const float> gradient, AdamMoments& moments,
               const AdamRates& rates);

}  // namespace gse::edit
