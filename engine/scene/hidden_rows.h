// Rows that an artist does not want to see for a while: display only, the scene keeps them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/scene/delta.h"

namespace gse {

/// Hidden rows by identity: they stay hidden as edits come and go, and rows that an edit adds are seen.
class HiddenRows {
public:
    bool empty() const { return ids_.empty(); }
    /// Hides rows whose byte in `rows` [ids] is set, beside what is hidden already.
    void hide(std::span<const RowId> ids, std::span<const std::uint8_t> rows);
    /// Hides all rows but these, which are seen again; rows that are not among `ids` are as they were.
    void isolate(std::span<const RowId> ids, std::span<const std::uint8_t> rows);
    void show_all() { ids_.clear(); }
    /// [ids] 1 for hidden rows.
    std::vector<std::uint8_t> rows(std::span<const RowId> ids) const;

private:
    std::vector<RowId> ids_;  // ascending, each once
};

/// The set with these rows invisible (an opacity logit of -infinity); all other arrays are shared. `hidden`
/// [N].
GaussianSet with_hidden(const GaussianSet& set, std::span<const std::uint8_t> hidden);

/// Of values per row, those of rows that are not hidden.
std::vector<float> seen_values(std::span<const float> values, std::span<const std::uint8_t> hidden);

/// The set without them; shares all arrays where none is hidden.
GaussianSet without_hidden(const GaussianSet& set, std::span<const std::uint8_t> hidden);

}  // namespace gse
