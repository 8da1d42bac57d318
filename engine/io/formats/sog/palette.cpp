// k-means of a tree: clusters are split until each needs few entries.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "engine/base/random.h"
#include "engine/io/formats/sog/codebook.h"

namespace gse::io {
namespace {

// Entries that are fitted at once; the time of a row is in proportion to it.
constexpr std::size_t LargestLeaf = 256;
// More of them do not move a mean visibly: the others are only assigned.
constexpr std::size_t RowsPerEntry = 64;
// Few are enough after good seeds (k-means++).
constexpr int PalettePasses = 3;
constexpr std::uint64_t PaletteSeed = 0x5eed;  // the same scene gives the same file
constexpr double LargestWeight = 1e30;         // of a cluster with infinite error
constexpr std::size_t AssignChunk = 1024;      // rows handed to a thread at a time

using Indices = std::vector<std::uint32_t>;

/// Entries while they are fitted, dimension-major, so that the distances to all of them are summed side by
/// side.
class Entries {
public:
    Entries(std::size_t dimension, std::size_t count)
        : dimension_(dimension), count_(count), values_(dimension * count) {}

    std::size_t size() const { return count_; }
    float at(std::size_t entry, std::size_t axis) const { return values_[axis * count_ + entry]; }
    void set(std::size_t entry, std::size_t axis, float value) { values_[axis * count_ + entry] = value; }
    void set(std::size_t entry, const float* row) {
        for (std::size_t axis = 0; axis < dimension_; ++axis) set(entry, axis, row[axis]);
    }

    /// Nearest entry and the squared distance to it. `work` is as long as there are entries.
    std::pair<std::uint32_t, float> nearest(const float* row, std::span<float> work) const {
        std::fill(work.begin(), work.end(), 0.0f);
        float* sums = work.data();
        for (std::size_t axis = 0; axis < dimension_; ++axis) {
            const float value = row[axis];
            const float* line = values_.data() + axis * count_;
            for (std::size_t entry = 0; entry < count_; ++entry) {
                const float difference = value - line[entry];
                sums[entry] += difference * difference;
            }
        }
        const auto best = std::min_element(work.begin(), work.end());
        return {static_cast<std::uint32_t>(best - work.begin()), *best};
    }

private:
    std::size_t dimension_, count_;
    std::vector<float> values_;
};

/// Squared distance, in four sums side by side for the processor.
float squared_distance(const float* a, const float* b, std::size_t dimension) {
    std::array<float, 4> sums{};
    std::size_t axis = 0;
    for (; axis + 4 <= dimension; axis += 4)
        for (std::size_t i = 0; i < 4; ++i)
            sums[i] += (a[axis + i] - b[axis + i]) * (a[axis + i] - b[axis + i]);
    for (; axis < dimension; ++axis) sums[0] += (a[axis] - b[axis]) * (a[axis] - b[axis]);
    return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

struct Assigned {
    std::vector<std::uint32_t> label;  // entry of indices[i]
    std::vector<float> error;          // its squared distance
};

/// Nearest entry of every row. Runs on the calling thread if `pool` is null.
Assigned assign(const VectorRows& rows, const Indices& indices, const Entries& entries, ThreadPool* pool) {
    Assigned result{std::vector<std::uint32_t>(indices.size()), std::vector<float>(indices.size())};
    const auto work_on = [&](std::size_t begin, std::size_t end, unsigned) {
        std::vector<float> work(entries.size());
        for (std::size_t i = begin; i < end; ++i)
            std::tie(result.label[i], result.error[i]) = entries.nearest(rows.row(indices[i]), work);
    };
    if (pool != nullptr) pool->parallel_for(indices.size(), AssignChunk, work_on);
    else work_on(0, indices.size(), 0);
    return result;
}

/// Moves entries without rows, one after the other, to the row that is farthest from all.
void reseed(const VectorRows& rows, const Indices& indices, std::span<const std::size_t> counts,
            Assigned& assigned, Entries& entries) {
    for (std::size_t entry = 0; entry < entries.size(); ++entry) {
        if (counts[entry] > 0) continue;
        const auto farthest = std::max_element(assigned.error.begin(), assigned.error.end());
        if (farthest == assigned.error.end() || !(*farthest > 0)) return;
        const float* chosen = rows.row(indices[static_cast<std::size_t>(farthest - assigned.error.begin())]);
        entries.set(entry, chosen);
        for (std::size_t i = 0; i < indices.size(); ++i)
            assigned.error[i] =
                std::min(assigned.error[i], squared_distance(rows.row(indices[i]), chosen, rows.dimension));
    }
}

/// One pass of k-means: every entry becomes the mean of the rows that are nearest to it.
void move_to_means(const VectorRows& rows, const Indices& indices, ThreadPool* pool, Entries& entries) {
    Assigned assigned = assign(rows, indices, entries, pool);
    std::vector<double> sums(entries.size() * rows.dimension, 0.0);
    std::vector<std::size_t> counts(entries.size(), 0);
    for (std::size_t i = 0; i < indices.size(); ++i) {
        const float* row = rows.row(indices[i]);
        double* sum = sums.data() + assigned.label[i] * rows.dimension;
        for (std::size_t axis = 0; axis < rows.dimension; ++axis) sum[axis] += row[axis];
        ++counts[assigned.label[i]];
    }
    for (std::size_t entry = 0; entry < entries.size(); ++entry)
        for (std::size_t axis = 0; counts[entry] > 0 && axis < rows.dimension; ++axis)
            entries.set(
                entry, axis,
                static_cast<float>(sums[entry * rows.dimension + axis] / static_cast<double>(counts[entry])));
    reseed(rows, indices, counts, assigned, entries);
}

/// First entries. Each row is drawn with a probability in proportion to its squared distance from the rows
/// before. No distant group is missed (Arthur and Vassilvitskii, "k-means++: the advantages of careful
/// seeding", 2007).
void seed_entries(const VectorRows& rows, const Indices& sample, Random& random, Entries& entries) {
    std::vector<float> distance(sample.size(), std::numeric_limits<float>::max());
    std::size_t chosen = random.below(sample.size());
    for (std::size_t entry = 0; entry < entries.size(); ++entry) {
        const float* row = rows.row(sample[chosen]);
        entries.set(entry, row);
        double total = 0;
        for (std::size_t i = 0; i < sample.size(); ++i) {
            distance[i] = std::min(distance[i], squared_distance(rows.row(sample[i]), row, rows.dimension));
            total += distance[i];
        }
        double left = random.uniform() * total;
        chosen = 0;
        while (chosen + 1 < sample.size() && left >= distance[chosen]) left -= distance[chosen++];
    }
}

/// k-means on at most RowsPerEntry rows per entry.
Entries fit_entries(const VectorRows& rows, const Indices& indices, std::size_t count, ThreadPool* pool) {
    Random random = Random::stream(PaletteSeed, indices.front());
    const std::size_t used = std::min(indices.size(), count * RowsPerEntry);
    Indices sample(indices);
    for (std::size_t i = 0; i < used; ++i)  // the first `used` of a shuffle
        std::swap(sample[i], sample[i + random.below(sample.size() - i)]);
    sample.resize(used);
    Entries entries(rows.dimension, count);
    std::sort(sample.begin(), sample.end());  // memory in its order
    seed_entries(rows, sample, random, entries);
    for (int pass = 0; pass < PalettePasses; ++pass) move_to_means(rows, sample, pool, entries);
    return entries;
}

/// Rows that share `entries` entries.
struct Cluster {
    Indices indices;
    std::size_t entries = 0;

    bool kept_exactly() const { return indices.size() <= entries; }
    bool is_leaf() const { return kept_exactly() || entries <= LargestLeaf; }
};

/// Entries for each child in proportion to its error, at most one per row and at least one.
void share_entries(std::size_t entries, std::span<const double> errors, std::vector<Cluster>& children) {
    for (Cluster& child : children) child.entries = 1;
    std::size_t left = entries - children.size();
    for (bool given = true; given && left > 0;) {
        double total = 0;
        for (std::size_t i = 0; i < children.size(); ++i)
            if (!children[i].kept_exactly()) total += errors[i];
        given = false;
        const auto share = static_cast<double>(left);
        for (std::size_t i = 0; i < children.size() && left > 0 && total > 0; ++i) {
            Cluster& child = children[i];
            if (child.kept_exactly()) continue;
            const auto part = static_cast<std::size_t>(share * errors[i] / total);
            const std::size_t more = std::min({part, left, child.indices.size() - child.entries});
            child.entries += more;
            left -= more;
            given |= more > 0;
        }
    }
}

std::vector<Cluster> split(const VectorRows& rows, const Cluster& cluster, ThreadPool& pool) {
    const auto root = static_cast<std::size_t>(std::sqrt(static_cast<double>(cluster.entries)));
    const Entries coarse =
        fit_entries(rows, cluster.indices, std::clamp<std::size_t>(root, 2, LargestLeaf), &pool);
    const Assigned assigned = assign(rows, cluster.indices, coarse, &pool);
    std::vector<Cluster> all(coarse.size()), children;
    std::vector<double> errors(coarse.size(), 0.0), errors_of_children;
    for (std::size_t i = 0; i < cluster.indices.size(); ++i) {
        all[assigned.label[i]].indices.push_back(cluster.indices[i]);
        errors[assigned.label[i]] += std::min<double>(assigned.error[i], LargestWeight);
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (all[i].indices.empty()) continue;
        children.push_back(std::move(all[i]));
        errors_of_children.push_back(errors[i]);
    }
    share_entries(cluster.entries, errors_of_children, children);
    return children;
}

/// Leaves of the tree, neighbours side by side. A cluster that cannot be divided (equal rows) is a leaf of
/// one entry.
std::vector<Cluster> grow(const VectorRows& rows, std::size_t most, ThreadPool& pool) {
    Cluster all{Indices(rows.count), most};
    std::iota(all.indices.begin(), all.indices.end(), 0u);
    std::vector<Cluster> open, leaves;
    open.push_back(std::move(all));
    while (!open.empty()) {
        Cluster cluster = std::move(open.back());
        open.pop_back();
        if (cluster.is_leaf()) {
            leaves.push_back(std::move(cluster));
            continue;
        }
        std::vector<Cluster> children = split(rows, cluster, pool);
        if (children.size() == 1) children.front().entries = 1;
        for (auto child = children.rbegin(); child != children.rend(); ++child)
            open.push_back(std::move(*child));
    }
    return leaves;
}

/// Entries of a leaf and the labels of its rows among them.
void fit_leaf(const VectorRows& rows, const Cluster& leaf, std::size_t first, Palette& palette) {
    const auto copy = [&](std::size_t entry, const auto& value_at) {
        float* target = palette.entries.data() + (first + entry) * rows.dimension;
        for (std::size_t axis = 0; axis < rows.dimension; ++axis) target[axis] = value_at(axis);
    };
    if (leaf.kept_exactly()) {
        for (std::size_t i = 0; i < leaf.indices.size(); ++i) {
            copy(i, [&](std::size_t axis) { return rows.row(leaf.indices[i])[axis]; });
            palette.labels[leaf.indices[i]] = static_cast<std::uint32_t>(first + i);
        }
        return;
    }
    const Entries entries = fit_entries(rows, leaf.indices, leaf.entries, nullptr);
    const Assigned assigned = assign(rows, leaf.indices, entries, nullptr);
    for (std::size_t i = 0; i < leaf.indices.size(); ++i)
        palette.labels[leaf.indices[i]] = static_cast<std::uint32_t>(first + assigned.label[i]);
    for (std::size_t entry = 0; entry < entries.size(); ++entry)
        copy(entry, [&](std::size_t axis) { return entries.at(entry, axis); });
}

}  // namespace

Palette fit_palette(const VectorRows& rows, std::size_t most, ThreadPool& pool) {
    Palette palette;
    palette.dimension = rows.dimension;
    if (rows.count == 0 || rows.dimension == 0 || most == 0) return palette;
    const std::vector<Cluster> leaves = grow(rows, most, pool);
    std::vector<std::size_t> first;
    std::size_t entries = 0;
    for (const Cluster& leaf : leaves) {
        first.push_back(entries);
        entries += std::min(leaf.entries, leaf.indices.size());
    }
    palette.entries.resize(entries * rows.dimension);
    palette.labels.resize(rows.count);
    pool.parallel_for(leaves.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t i = begin; i < end; ++i) fit_leaf(rows, leaves[i], first[i], palette);
    });
    return palette;
}

}  // namespace gse::io
