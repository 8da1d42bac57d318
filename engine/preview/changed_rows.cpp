// Compares blocks first, since most of them are equal.
#include "engine/preview/changed_rows.h"

#include <algorithm>
#include <cstring>
#include <span>

namespace gse::preview {
namespace {

constexpr std::size_t BlockRows = 64;
constexpr std::size_t MostGap = 8;  // equal rows that are sent along
constexpr std::size_t SampleRows = 1024;
constexpr double MostChanged = 0.5;  // share of the sample

/// One array of both sets, `width` floats per row.
struct Pair {
    const float *from, *to;
    std::size_t width;

    Pair(std::span<const float> a, std::span<const float> b, std::size_t per_row)
        : from(a.data()), to(b.data()), width(per_row) {}
    bool differs(std::size_t begin, std::size_t end) const {
        return from != to && std::memcmp(from + begin * width, to + begin * width,
                                         (end - begin) * width * sizeof(float)) != 0;
    }
};

bool any_differs(std::span<const Pair> pairs, std::size_t begin, std::size_t end) {
    return std::any_of(pairs.begin(), pairs.end(),
                       [&](const Pair& pair) { return pair.differs(begin, end); });
}

void append(std::vector<RowRun>& runs, std::size_t first, std::size_t row) {
    if (runs.size() > first && row - runs.back().end <= MostGap) runs.back().end = row + 1;
    else runs.push_back({row, row + 1});
}

void find_changed(std::span<const Pair> pairs, std::size_t begin, std::size_t end,
                  std::vector<RowRun>& runs) {
    const std::size_t first = runs.size();  // runs of an earlier call are not made longer
    for (std::size_t block = begin; block < end; block += BlockRows) {
        const std::size_t block_end = std::min(block + BlockRows, end);
        if (!any_differs(pairs, block, block_end)) continue;
        for (std::size_t row = block; row < block_end; ++row)
            if (any_differs(pairs, row, row + 1)) append(runs, first, row);
    }
}

std::vector<Pair> geometry_pairs(const GaussianSet& from, const GaussianSet& to) {
    return {{from.position(), to.position(), 3},
            {from.log_scale(), to.log_scale(), 3},
            {from.rotation(), to.rotation(), 4},
            {from.opacity_logit(), to.opacity_logit(), 1}};
}

Pair harmonics_pair(const GaussianSet& from, const GaussianSet& to) {
    return {from.sh(), to.sh(), static_cast<std::size_t>(sh_coefficient_count(to.sh_degree())) * 3};
}

}  // namespace

void changed_geometry(const GaussianSet& from, const GaussianSet& to, std::size_t begin, std::size_t end,
                      std::vector<RowRun>& runs) {
    find_changed(geometry_pairs(from, to), begin, end, runs);
}

void changed_harmonics(const GaussianSet& from, const GaussianSet& to, std::size_t begin, std::size_t end,
                       std::vector<RowRun>& runs) {
    const Pair pair = harmonics_pair(from, to);
    find_changed({&pair, 1}, begin, end, runs);
}

bool mostly_changed(const GaussianSet& from, const GaussianSet& to) {
    auto pairs = geometry_pairs(from, to);
    pairs.push_back(harmonics_pair(from, to));
    const std::size_t step = std::max<std::size_t>(to.size() / SampleRows, 1);
    std::size_t looked = 0, changed = 0;
    for (std::size_t row = 0; row < to.size(); row += step, ++looked)
        changed += any_differs(pairs, row, row + 1) ? 1u : 0u;
    return static_cast<double>(changed) > MostChanged * static_cast<double>(looked);
}

}  // namespace gse::preview
