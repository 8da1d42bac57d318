// Rows that an artist hides for a while. Display only: the scene keeps them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/scene/delta.h"

namespace gse {

/// Hidden rows by identity. They stay hidden as edits come and go; rows that an edit adds are visible.
class HiddenRows {
public:
    bool empty() const { return ids_.empty(); }
    /// Hides rows whose byte in `rows` [ids] is set, beside those hidden already.
    void hide(std::span<const RowId> ids, std::span<const std::uint8_t> rows);
    /// Hides all rows but these, which become visible. Rows that are not among `ids` stay as they were.
    void isolate(std::span<const RowId> ids, std::span<const std::uint8_t> rows);
    void show_all() { ids_.clear(); }
    /// Byte per row [ids]: 1 for hidden rows.
    std::vector<std::uint8_t> rows(std::span<const RowId> ids) const;

private:
    std::vector<RowId> ids_;  // ascending, each once
};

/// The set with the rows of `hidden` [N] invisible (an opacity logit of -infinity). All other arrays are
/// shared.
GaussianSet with_hidden(const GaussianSet& set, std::span<const std::uint8_t> hidden);

/// Values of the rows that are not hidden, out of `values` per row.
std::vector<float> seen_values(std::span<const float> values, std::span<const std::uint8_t> hidden);

/// The set without the hidden rows. Shares all arrays if none is hidden.
GaussianSet without_hidden(const GaussianSet& set, std::span<const std::uint8_t> hidden);

}  // namespace gse
