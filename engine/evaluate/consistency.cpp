// Mean colour changes of neighbouring pictures, compared.
#include "engine/evaluate/consistency.h"

#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "engine/base/check.h"

namespace gse::evaluate {
namespace {

using Change = std::array<double, 3>;

/// Mean of after - before inside the mask. Nothing when the mask is empty.
std::optional<Change> mean_change(const Image& before, const Image& after, const Mask& mask) {
    GSE_CHECK(before.channels == 3 && after.channels == 3);
    GSE_CHECK(before.data.size() == after.data.size() && mask.data.size() == before.pixel_count());
    Change sum{};
    std::size_t count = 0;
    for (std::size_t pixel = 0; pixel < mask.data.size(); ++pixel) {
        if (mask.data[pixel] == 0) continue;
        for (std::size_t c = 0; c < 3; ++c)
            sum[c] += static_cast<double>(after.data[pixel * 3 + c]) - before.data[pixel * 3 + c];
        ++count;
    }
    if (count == 0) return std::nullopt;
    for (auto& value : sum) value /= static_cast<double>(count);
    return sum;
}

}  // namespace

double path_inconsistency(const PathPictures& pictures) {
    const std::size_t count = pictures.before.size();
    GSE_CHECK_EQ(pictures.after.size(), count);
    GSE_CHECK_EQ(pictures.masks.size(), count);
    std::vector<std::optional<Change>> changes;
    for (std::size_t i = 0; i < count; ++i)
        changes.push_back(mean_change(pictures.before[i], pictures.after[i], pictures.masks[i]));
    double sum = 0;
    std::size_t pairs = 0;
    const std::size_t last = pictures.closed && count > 2 ? count : count > 0 ? count - 1 : 0;
    for (std::size_t i = 0; i < last; ++i) {
        const auto &here = changes[i], &next = changes[(i + 1) % count];
        if (!here || !next) continue;
        for (std::size_t c = 0; c < 3; ++c) sum += std::abs((*next)[c] - (*here)[c]) / 3;
        ++pairs;
    }
    return pairs > 0 ? sum / static_cast<double>(pairs) : 0;
}

}  // namespace gse::evaluate
