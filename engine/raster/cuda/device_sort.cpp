// Launches of the sums and of the radix sort, least digit first.
#include "engine/raster/cuda/device_sort.h"

namespace gse::raster::cuda {

const std::uint32_t* DeviceScan::scan_level(const std::uint32_t* in, std::uint32_t* out, std::size_t count,
                                            std::size_t level) {
    const std::size_t blocks = blocks_for(count, BlockThreads * ScanItems);
    if (totals_.size() <= level) totals_.emplace_back(device_);
    std::uint32_t* totals = totals_[level].at_least(blocks);
    device_.launch(kernels::scan, blocks, {in, out, totals, static_cast<std::uint32_t>(count)});
    if (blocks <= 1) return totals;
    const std::uint32_t* total = scan_level(totals, totals, blocks, level + 1);
    device_.launch(kernels::add_offsets, blocks, {out, totals, static_cast<std::uint32_t>(count)});
    return total;
}

std::uint32_t DeviceScan::total(const std::uint32_t* in, std::uint32_t* out, std::size_t count) {
    if (count == 0) return 0;
    std::uint32_t sum = 0;
    device_.download(&sum, scan_level(in, out, count, 0), sizeof sum);
    return sum;
}

DeviceSort::Sorted DeviceSort::sort(const std::uint32_t* keys, std::size_t count, std::uint32_t bits) {
    const std::size_t blocks = blocks_for(count, BlockThreads * RadixItems);
    RadixArguments args{};
    args.count = static_cast<std::uint32_t>(count);
    args.blocks = static_cast<std::uint32_t>(blocks);
    args.counts = counts_.at_least(blocks * RadixDigits);
    args.keys = keys;
    std::size_t side = 0;
    do {
        args.sorted_keys = keys_[side].at_least(count);
        args.sorted_values = values_[side].at_least(count);
        device_.launch(kernels::radix_count, blocks, args);
        scan_.run(args.counts, args.counts, blocks * RadixDigits);
        device_.launch(kernels::radix_scatter, blocks, args);
        args.keys = args.sorted_keys;
        args.values = args.sorted_values;
        args.shift += RadixBits;
        side = 1 - side;
    } while (args.shift < bits);
    return {args.keys, args.values};
}

}  // namespace gse::raster::cuda
