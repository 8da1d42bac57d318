// Least-significant-digit radix sort. Every part of the input keeps its order, so ties stay in place.
#include "engine/raster/depth_sort.h"

#include <algorithm>

namespace gse::raster {

std::vector<DepthSort::Item>& DepthSort::items(std::size_t count) {
    if (from_.size() < count) {
        from_.resize(count);
        to_.resize(count);
        order_.resize(count);
    }
    return from_;
}

void DepthSort::count_digits(std::size_t part) {
    std::uint32_t* counts = &places_[part * Buckets];
    std::fill_n(counts, Buckets, 0u);
    const std::size_t end = part_begin(part + 1);
    for (std::size_t i = part_begin(part); i < end; ++i) ++counts[from_[i].key >> shift_ & (Buckets - 1)];
}

/// Counts -> first places. Returns false when one bucket holds everything and the pass would change nothing.
bool DepthSort::prefix_sums() {
    std::uint32_t place = 0;
    for (std::size_t bucket = 0; bucket < Buckets; ++bucket) {
        const std::uint32_t before = place;
        for (std::size_t part = 0; part < parts_; ++part) {
            const std::uint32_t count = places_[part * Buckets + bucket];
            places_[part * Buckets + bucket] = place;
            place += count;
        }
        if (before == 0 && place == count_) return false;
        if (place == count_) break;
    }
    return true;
}

void DepthSort::scatter(std::size_t part) {
    std::uint32_t* places = &places_[part * Buckets];
    const std::size_t end = part_begin(part + 1);
    for (std::size_t i = part_begin(part); i < end; ++i)
        to_[places[from_[i].key >> shift_ & (Buckets - 1)]++] = from_[i];
}

const std::vector<std::uint32_t>& DepthSort::sort(std::size_t count) {
    constexpr std::size_t worth_a_thread = 30000;
    count_ = count;
    parts_ = std::clamp<std::size_t>(count / worth_a_thread, 1, pool_.thread_count());
    places_.resize(pool_.thread_count() * Buckets);
    for (shift_ = 0; shift_ < 32; shift_ += Bits) {
        pool_.parallel_for(parts_, 1,
                           [this](std::size_t begin, std::size_t, unsigned) { count_digits(begin); });
        if (!prefix_sums()) continue;
        pool_.parallel_for(parts_, 1, [this](std::size_t begin, std::size_t, unsigned) { scatter(begin); });
        from_.swap(to_);
    }
    for (std::size_t i = 0; i < count; ++i) order_[i] = from_[i].index;
    return order_;
}

}  // namespace gse::raster
