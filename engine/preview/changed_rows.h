// Rows in which two scenes differ: the part that an upload has to send.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/scene/gaussian_set.h"

namespace gse::preview {

/// Rows [begin, end).
struct RowRun {
    std::size_t begin = 0, end = 0;
};

/// Appends the rows of [begin, end) whose position, scale, rotation or opacity differ in any bit. Both sets
/// have one size. Runs are in order. A few equal rows between two runs are sent along, which is cheaper than
/// another copy.
void changed_geometry(const GaussianSet& from, const GaussianSet& to, std::size_t begin, std::size_t end,
                      std::vector<RowRun>& runs);

/// Appends the rows of [begin, end) whose coefficients differ in any bit. Both sets have one degree.
void changed_harmonics(const GaussianSet& from, const GaussianSet& to, std::size_t begin, std::size_t end,
                       std::vector<RowRun>& runs);

/// True when so many rows differ (estimated from a sample) that looking for them costs more than it saves.
bool mostly_changed(const GaussianSet& from, const GaussianSet& to);

}  // namespace gse::preview
