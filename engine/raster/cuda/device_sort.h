// Sums of counts and stable sorting in a device's memory.
#pragma once

#include <deque>

#include "engine/raster/cuda/device.h"

namespace gse::raster::cuda {

/// Exclusive prefix sums, level by level.
class DeviceScan {
public:
    explicit DeviceScan(Device& device) : device_(device) {}

    /// out[i] = sum of in[0..i), saturated; `out` may be `in`.
    void run(const std::uint32_t* in, std::uint32_t* out, std::size_t count) {
        scan_level(in, out, count, 0);
    }
    /// Prefix sums as above. Returns the sum of all, for which it waits.
    std::uint32_t total(const std::uint32_t* in, std::uint32_t* out, std::size_t count);

private:
    /// Place of the sum of all. Does not wait.
    const std::uint32_t* scan_level(const std::uint32_t* in, std::uint32_t* out, std::size_t count,
                                    std::size_t level);

    Device& device_;
    std::deque<DeviceArray<std::uint32_t>> totals_;  // of each level's blocks
};

/// Places 0, 1, 2 ... in the order of their keys; equal keys stay in order.
class DeviceSort {
public:
    explicit DeviceSort(Device& device)
        : device_(device),
          scan_(device), keys_{DeviceArray<std::uint32_t>(device), DeviceArray<std::uint32_t>(device)},
          values_{DeviceArray<std::uint32_t>(device), DeviceArray<std::uint32_t>(device)}, counts_(device) {}

    struct Sorted {
        const std::uint32_t* keys;
        const std::uint32_t* places;
    };
    /// By the low `bits` of the keys, which hold nothing else. The result lives until the next call.
    Sorted sort(const std::uint32_t* keys, std::size_t count, std::uint32_t bits);

private:
    Device& device_;
    DeviceScan scan_;
    DeviceArray<std::uint32_t> keys_[2], values_[2], counts_;
};

}  // namespace gse::raster::cuda
