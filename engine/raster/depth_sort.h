// Stable radix sort of 32-bit keys with their indices: three passes of 11 bits, in parallel for many items.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/thread_pool.h"

namespace gse::raster {

class DepthSort {
public:
    explicit DepthSort(ThreadPool& pool) : pool_(pool) {}

    struct Item {
        std::uint32_t key = 0;
        std::uint32_t index = 0;
    };

    /// Room for `count` items, to be filled by the caller.
    std::vector<Item>& items(std::size_t count);

    /// Sorts the first `count` items. Returns their indices in order (valid until the next call).
    const std::vector<std::uint32_t>& sort(std::size_t count);

private:
    static constexpr std::size_t Buckets = 2048;
    static constexpr int Bits = 11;

    void count_digits(std::size_t part);
    void scatter(std::size_t part);
    std::size_t part_begin(std::size_t part) const { return count_ * part / parts_; }
    bool prefix_sums();

    ThreadPool& pool_;
    std::vector<Item> from_, to_;
    std::vector<std::uint32_t> places_;  // [parts][Buckets]
    std::vector<std::uint32_t> order_;
    std::size_t count_ = 0, parts_ = 1;
    int shift_ = 0;
};

}  // namespace gse::raster
