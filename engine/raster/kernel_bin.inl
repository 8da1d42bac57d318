// Kernel part 3: which 16x16 tiles and which 4x4 blocks of them an ellipse touches, exactly: per band of four
// pixel rows the ellipse's largest extent in x, on pixel centres.

constexpr float BinMargin = 0.01f;  // pixels, so that rounding can never drop a pair
constexpr int BandLanes = F::W < 4 ? 4 : F::W;

/// Block columns [first, last] of each band; first > last where the band is missed.
struct alignas(64) Bands {
    std::int32_t first[BandLanes], last[BandLanes];
};

struct Ellipse {
    float x, y, slope, inverse_l1, l3, reach, half_height, lean;
};

GSE_INLINE void cut_bands(const Ellipse& e, int band, int columns, Bands& out) {
    alignas(64) static const float ramp[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    for (int i = 0; i < BandLanes; i += F::W) {
        const F rows = set(static_cast<float>(band * BlockSize) + 0.5f - e.y);
        const F low = fma(load(ramp + i), set(static_cast<float>(BlockSize)), rows);
        const F high = low + set(static_cast<float>(BlockSize - 1));
        const F from = max(low, set(-e.half_height)), to = min(high, set(e.half_height));
        // The right edge is a concave function of dy with its top at `lean`; the left edge is its mirror
        // image.
        const F right = min(max(set(e.lean), from), to), left = min(max(set(-e.lean), from), to);
        const F zero_lanes = zero();
        const F right_v = right * set(e.l3), left_v = left * set(e.l3);
        const F right_w = sqrt(max(fnma(right_v, right_v, set(e.reach)), zero_lanes));
        const F left_w = sqrt(max(fnma(left_v, left_v, set(e.reach)), zero_lanes));
        const F x_right = fma(right_w, set(e.inverse_l1), fma(right, set(e.slope), set(e.x + BinMargin)));
        const F x_left = fnma(left_w, set(e.inverse_l1), fma(left, set(e.slope), set(e.x - BinMargin)));
        const F quarter = set(1.0f / BlockSize);
        F first = ceil((x_left - set(BlockSize - 0.5f)) * quarter);
        F last = floor((x_right - set(0.5f)) * quarter);
        first = min(max(first, zero_lanes), set(static_cast<float>(columns)));
        last = max(min(last, set(static_cast<float>(columns - 1))), set(-1.0f));
        const M hit = from <= to;
        store_int(out.first + i, select(hit, first, set(static_cast<float>(columns))));
        store_int(out.last + i, select(hit, last, set(-1.0f)));
    }
}

/// Bits first..last of a 64-block window that begins at block column `base`.
GSE_INLINE std::uint64_t window_bits(std::int32_t first, std::int32_t last, std::int32_t base) {
    const std::int32_t low = first > base ? first - base : 0;
    const std::int32_t high = last - base < 63 ? last - base : 63;
    return low <= high ? (~0ull >> (63 - high)) & (~0ull << low) : 0ull;
}

/// Emits the tiles of one row of tiles from its four bands.
GSE_INLINE void emit_row(const Bands& bands, int at, std::uint32_t row_base, BinJob& job) {
    // Missed bands have first = all columns and last = -1, which no minimum or maximum notices.
    std::int32_t first = bands.first[at], last = bands.last[at];
    for (int k = at + 1; k < at + 4; ++k) {
        first = bands.first[k] < first ? bands.first[k] : first;
        last = bands.last[k] > last ? bands.last[k] : last;
    }
    if (first > last) return;
    std::int32_t tile = first / 4;
    const std::int32_t end = last / 4 + 1;
    while (tile < end) {
        std::uint64_t rows[4];
        for (int k = 0; k < 4; ++k) rows[k] = window_bits(bands.first[at + k], bands.last[at + k], tile * 4);
        const std::int32_t stop = tile + 16 < end ? tile + 16 : end;
        for (int shift = 0; tile < stop; ++tile, shift += 4) {
            std::uint32_t blocks = 0;
            for (int k = 0; k < 4; ++k)
                blocks |= static_cast<std::uint32_t>(rows[k] >> shift & 15u) << (4 * k);
            if (blocks == 0) continue;
            const std::uint32_t index = row_base + static_cast<std::uint32_t>(tile);
            job.pairs[job.written].tile = index;
            job.pairs[job.written++].blocks = blocks;
            ++job.tile_counts[index];
        }
    }
}

GSE_INLINE float clamp_to(float value, float high) {
    return value > 0.0f ? (value < high ? value : high) : 0.0f;
}

static void bin(BinJob& job) {
    const int block_columns = (job.width + BlockSize - 1) / BlockSize;
    const std::uint32_t tile_columns = static_cast<std::uint32_t>((job.width + TileSize - 1) / TileSize);
    Bands bands;
    for (; job.begin < job.end; ++job.begin) {
        if (job.begin + 16 < job.end) __builtin_prefetch(job.records + job.order[job.begin + 16], 1);
        Record& record = job.records[job.order[job.begin]];
        const float reach = (record.log2_opacity + static_cast<float>(Log2Of255)) * (1.0f + 1e-4f) + 1e-4f;
        const float inverse_l1 = 1.0f / record.l1;
        const Ellipse ellipse = {record.x,  record.y, -record.l2 * inverse_l1,        inverse_l1,
                                 record.l3, reach,    record.half_height + BinMargin, record.lean};
        const float tall = ellipse.half_height + 0.5f, wide = record.half_width + BinMargin + 0.5f;
        const int top =
            static_cast<int>(clamp_to(record.y - tall, static_cast<float>(job.height - 1))) / BlockSize;
        const int bottom =
            static_cast<int>(clamp_to(record.y + tall, static_cast<float>(job.height - 1))) / BlockSize;
        const int left =
            static_cast<int>(clamp_to(record.x - wide, static_cast<float>(job.width - 1))) / TileSize;
        const int right =
            static_cast<int>(clamp_to(record.x + wide, static_cast<float>(job.width - 1))) / TileSize;
        const std::size_t most =
            static_cast<std::size_t>(bottom / 4 - top / 4 + 1) * static_cast<std::size_t>(right - left + 2);
        if (job.written + most > job.capacity) return;
        const std::size_t before = job.written;
        for (int band = top & ~3; band <= bottom; band += BandLanes) {
            cut_bands(ellipse, band, block_columns, bands);
            for (int at = 0; at < BandLanes && band + at <= bottom; at += 4)
                emit_row(bands, at, static_cast<std::uint32_t>((band + at) / 4) * tile_columns, job);
        }
        record.pair_count = static_cast<std::uint32_t>(job.written - before);
        job.pair_counts[job.begin] = record.pair_count;
    }
}
