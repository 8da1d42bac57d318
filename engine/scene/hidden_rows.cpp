// Identities in a sorted list.
#include "engine/scene/hidden_rows.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <memory>

#include "engine/base/check.h"

namespace gse {
namespace {

bool any_hidden(std::span<const std::uint8_t> hidden) {
    return std::any_of(hidden.begin(), hidden.end(), [](auto bit) { return bit != 0; });
}

void sort_unique(std::vector<RowId>& ids) {
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
}

}  // namespace

void HiddenRows::hide(std::span<const RowId> ids, std::span<const std::uint8_t> rows) {
    GSE_CHECK_EQ(ids.size(), rows.size());
    for (std::size_t row = 0; row < rows.size(); ++row)
        if (rows[row] != 0) ids_.push_back(ids[row]);
    sort_unique(ids_);
}

void HiddenRows::isolate(std::span<const RowId> ids, std::span<const std::uint8_t> rows) {
    GSE_CHECK_EQ(ids.size(), rows.size());
    std::vector<RowId> seen;
    for (std::size_t row = 0; row < rows.size(); ++row)
        if (rows[row] != 0) seen.push_back(ids[row]);
        else ids_.push_back(ids[row]);
    sort_unique(ids_);
    sort_unique(seen);
    std::vector<RowId> rest;
    std::set_difference(ids_.begin(), ids_.end(), seen.begin(), seen.end(), std::back_inserter(rest));
    ids_ = std::move(rest);
}

std::vector<std::uint8_t> HiddenRows::rows(std::span<const RowId> ids) const {
    std::vector<std::uint8_t> rows(ids.size(), 0);
    if (ids_.empty()) return rows;
    for (std::size_t row = 0; row < rows.size(); ++row)
        rows[row] = std::binary_search(ids_.begin(), ids_.end(), ids[row]) ? 1 : 0;
    return rows;
}

GaussianSet with_hidden(const GaussianSet& set, std::span<const std::uint8_t> hidden) {
    GSE_CHECK_EQ(hidden.size(), set.size());
    if (!any_hidden(hidden)) return set;
    auto opacity =
        std::make_shared<std::vector<float>>(set.opacity_logit().begin(), set.opacity_logit().end());
    for (std::size_t row = 0; row < hidden.size(); ++row)
        if (hidden[row] != 0) (*opacity)[row] = -std::numeric_limits<float>::infinity();
    GaussianBuffers buffers = set.buffers();
    buffers.opacity_logit = std::move(opacity);
    return GaussianSet(std::move(buffers));
}

std::vector<float> seen_values(std::span<const float> values, std::span<const std::uint8_t> hidden) {
    GSE_CHECK_EQ(hidden.size(), values.size());
    std::vector<float> seen;
    for (std::size_t row = 0; row < values.size(); ++row)
        if (hidden[row] == 0) seen.push_back(values[row]);
    return seen;
}

GaussianSet without_hidden(const GaussianSet& set, std::span<const std::uint8_t> hidden) {
    GSE_CHECK_EQ(hidden.size(), set.size());
    if (!any_hidden(hidden)) return set;
    std::vector<unsigned char> keep(hidden.size());
    std::transform(hidden.begin(), hidden.end(), keep.begin(),
                   [](auto bit) { return static_cast<unsigned char>(bit == 0 ? 1 : 0); });
    return set.filtered(keep);
}

}  // namespace gse
