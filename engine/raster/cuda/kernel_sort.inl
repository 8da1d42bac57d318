// Kernels 1: sums of counts, and one digit of a stable radix sort (least digit first). Each thread has
// neighbouring items, so that the order of threads is that of items within a block.

GSE_DEVICE std::uint32_t add_saturated(std::uint32_t a, std::uint32_t b) {
    return a + b < a ? Saturated : a + b;
}

struct ScanShared {
    std::uint32_t sums[BlockThreads];
};

/// Sums of each thread's and all earlier ones, in place (Hillis and Steele 1986).
GSE_DEVICE void scan_threads(const Grid& grid, std::uint32_t* sums) {
    for (std::uint32_t distance = 1; distance < BlockThreads; distance *= 2) {
        PerThread<std::uint32_t> earlier;
        GSE_THREADS(grid, t) earlier[t] = t >= distance ? sums[t - distance] : 0u;
        GSE_THREADS(grid, t) sums[t] = add_saturated(sums[t], earlier[t]);
    }
}

GSE_DEVICE void scan(const Grid& grid, const ScanArguments& args) {
    GSE_SHARED(grid, ScanShared, shared);
    GSE_THREADS(grid, t) {
        const std::uint32_t first = (grid.block * BlockThreads + t) * ScanItems;
        std::uint32_t sum = 0;
        for (std::uint32_t i = first; i < first + ScanItems && i < args.count; ++i)
            sum = add_saturated(sum, args.in[i]);
        shared.sums[t] = sum;
    }
    scan_threads(grid, shared.sums);
    GSE_THREADS(grid, t) {
        const std::uint32_t first = (grid.block * BlockThreads + t) * ScanItems;
        std::uint32_t sum = t > 0 ? shared.sums[t - 1] : 0u;
        for (std::uint32_t i = first; i < first + ScanItems && i < args.count; ++i) {
            const std::uint32_t value = args.in[i];
            args.out[i] = sum;
            sum = add_saturated(sum, value);
        }
        if (t == BlockThreads - 1) args.totals[grid.block] = shared.sums[t];
    }
}

GSE_DEVICE void add_offsets(const Grid& grid, const AddArguments& args) {
    GSE_THREADS(grid, t) {
        for (std::uint32_t k = 0; k < ScanItems; ++k) {
            const std::uint32_t i = grid.block * BlockThreads * ScanItems + k * BlockThreads + t;
            if (i < args.count) args.values[i] = add_saturated(args.values[i], args.offsets[grid.block]);
        }
    }
}

struct RadixShared {
    std::uint32_t counts[RadixDigits * BlockThreads];  // of digit d in thread t at d * BlockThreads + t
    std::uint32_t sums[BlockThreads];
};

GSE_DEVICE std::uint32_t digit_of(const RadixArguments& args, std::uint32_t i) {
    return args.keys[i] >> args.shift & (RadixDigits - 1);
}

GSE_DEVICE std::uint32_t first_item(const Grid& grid, std::uint32_t t) {
    return (grid.block * BlockThreads + t) * RadixItems;
}

/// Ends with the counts of each thread's digits.
GSE_DEVICE void count_digits(const Grid& grid, const RadixArguments& args, RadixShared& shared) {
    GSE_THREADS(grid, t) {
        for (std::uint32_t digit = 0; digit < RadixDigits; ++digit)
            shared.counts[digit * BlockThreads + t] = 0;
        const std::uint32_t first = first_item(grid, t);
        for (std::uint32_t i = first; i < first + RadixItems && i < args.count; ++i)
            ++shared.counts[digit_of(args, i) * BlockThreads + t];
    }
}

/// sums[t] = counts [t, t + 1) * RadixDigits of the flat list; a digit has as many of these as there are
/// digits.
GSE_DEVICE void sum_digits(const Grid& grid, RadixShared& shared) {
    GSE_THREADS(grid, t) {
        std::uint32_t sum = 0;
        for (std::uint32_t k = 0; k < RadixDigits; ++k) sum += shared.counts[t * RadixDigits + k];
        shared.sums[t] = sum;
    }
}

GSE_DEVICE void radix_count(const Grid& grid, const RadixArguments& args) {
    GSE_SHARED(grid, RadixShared, shared);
    constexpr std::uint32_t parts = BlockThreads / RadixDigits;
    count_digits(grid, args, shared);
    sum_digits(grid, shared);
    GSE_THREADS(grid, t) {
        if (t >= RadixDigits) continue;
        std::uint32_t sum = 0;
        for (std::uint32_t k = 0; k < parts; ++k) sum += shared.sums[t * parts + k];
        args.counts[t * args.blocks + grid.block] = sum;
    }
}

GSE_DEVICE void radix_scatter(const Grid& grid, const RadixArguments& args) {
    GSE_SHARED(grid, RadixShared, shared);
    count_digits(grid, args, shared);
    sum_digits(grid, shared);
    scan_threads(grid, shared.sums);
    GSE_THREADS(grid, t) {
        std::uint32_t sum = t > 0 ? shared.sums[t - 1] : 0u;
        for (std::uint32_t k = 0; k < RadixDigits; ++k) {
            const std::uint32_t count = shared.counts[t * RadixDigits + k];
            shared.counts[t * RadixDigits + k] = sum;
            sum += count;
        }
    }
    // Where the block's first of each digit goes, less what the block has in front of it.
    GSE_THREADS(grid, t) {
        if (t < RadixDigits)
            shared.sums[t] = args.counts[t * args.blocks + grid.block] - shared.counts[t * BlockThreads];
    }
    GSE_THREADS(grid, t) {
        const std::uint32_t first = first_item(grid, t);
        for (std::uint32_t i = first; i < first + RadixItems && i < args.count; ++i) {
            const std::uint32_t digit = digit_of(args, i);
            const std::uint32_t to = shared.sums[digit] + shared.counts[digit * BlockThreads + t]++;
            args.sorted_keys[to] = args.keys[i];
            args.sorted_values[to] = args.values != nullptr ? args.values[i] : i;
        }
    }
}
