// The viewport's splats beside the document: a running edit's snapshot, a result that waits, chosen splats.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "engine/edit/interfaces/snapshot.h"
#include "engine/scene/gaussian_set.h"

namespace gse::app {

using RowValues = std::shared_ptr<const std::vector<float>>;  // [rows], or null

/// Valid for a frame.
struct Stage {
    GaussianSet set;                               // on the screen
    GaussianSet before;                            // other side of comparisons, unless a step was chosen
    const edit::EditSnapshot* snapshot = nullptr;  // that is shown, or null
    // Row in `set` of each row of the document. Null and empty = they are the document's.
    std::shared_ptr<const std::vector<std::int64_t>> base_to_new;  // of a result
    std::vector<std::int64_t> rows;                                // of an edit that runs
    std::optional<std::size_t> result;                             // which of the results is shown
    RowValues attention;                                           // of the document's rows
    std::shared_ptr<const std::vector<std::uint8_t>> picked;       // rows chosen by a property, or null
    bool picking = false;                                          // they take the place of the label's tint

    /// Row in `set` of each row of the document before the edit.
    std::vector<std::int64_t> new_rows() const { return base_to_new ? *base_to_new : rows; }
};

}  // namespace gse::app
