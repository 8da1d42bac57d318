// Kernel part 3: the 16x16 tiles and their 4x4 blocks that an ellipse touches, exactly. Per band of four
// pixel rows it takes the ellipse's largest extent in x, on pixel centres. Most ellipses lie within 2x2
// tiles: W of them are cut at once, band by band. The others are cut one by one, W bands at once.

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
        }
    }
}

GSE_INLINE float clamp_to(float value, float high) {
    return value > 0.0f ? (value < high ? value : high) : 0.0f;
}

/// One Gaussian of any size. Returns false when `pairs` may not suffice.
static bool bin_large(const Record& record, BinJob& job) {
    const int block_columns = (job.width + BlockSize - 1) / BlockSize;
    const std::uint32_t tile_columns = static_cast<std::uint32_t>((job.width + TileSize - 1) / TileSize);
    Bands bands;
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
    if (job.written + most > job.capacity) return false;
    for (int band = top & ~3; band <= bottom; band += BandLanes) {
        cut_bands(ellipse, band, block_columns, bands);
        for (int at = 0; at < BandLanes && band + at <= bottom; at += 4)
            emit_row(bands, at, static_cast<std::uint32_t>((band + at) / 4) * tile_columns, job);
    }
    return true;
}

/// Blocks of W Gaussians in the 2x2 tiles from `tile` on, row by row. `fits` is false for those that need
/// more tiles.
struct alignas(64) SmallFootprints {
    std::int32_t blocks[4][F::W];
    std::int32_t tile[F::W];
    std::int32_t fits[F::W];
};

/// Values that the bands of W Gaussians share.
struct SmallCut {
    F reach, inverse_l1, slope, half_height;
    F base, columns;  // first block column; those of the picture
};

/// Bits 0..7: the block columns of one band from `base` on. The sums are those of cut_bands.
GSE_INLINE I band_bits(const RecordColumns& r, const SmallCut& c, F first_row) {
    const F nought = zero(), quarter = set(1.0f / BlockSize);
    const F low = first_row - load(r.y), high = low + set(static_cast<float>(BlockSize - 1));
    const F from = max(low, nought - c.half_height), to = min(high, c.half_height);
    const F lean = load(r.lean), l3 = load(r.l3), x = load(r.x);
    const F right = min(max(lean, from), to), left = min(max(nought - lean, from), to);
    const F right_v = right * l3, left_v = left * l3;
    const F right_w = sqrt(max(fnma(right_v, right_v, c.reach), nought));
    const F left_w = sqrt(max(fnma(left_v, left_v, c.reach), nought));
    const F x_right = fma(right_w, c.inverse_l1, fma(right, c.slope, x + set(BinMargin)));
    const F x_left = fnma(left_w, c.inverse_l1, fma(left, c.slope, x - set(BinMargin)));
    const F first = max(ceil((x_left - set(BlockSize - 0.5f)) * quarter), nought) - c.base;
    const F last = min(floor((x_right - set(0.5f)) * quarter), c.columns - set(1.0f)) - c.base;
    const M hit = (from <= to) & (max(first, nought) <= min(last, set(7.0f)));
    return bit_range(hit, max(first, nought), min(last, set(7.0f)));
}

/// Four bands of eight columns -> the 4x4 blocks of the left tile, or of the right one for bands shifted by
/// four columns.
GSE_INLINE I tile_blocks(I bands) {
    I x = bands & set_int(0x0f0f0f0f);
    x = (x | shift_right<4>(x)) & set_int(0x00ff00ff);
    return (x | shift_right<8>(x)) & set_int(0xffff);
}

static void cut_small(const RecordColumns& r, const BinJob& job, SmallFootprints& out) {
    const F nought = zero(), one = set(1.0f), sixteenth = set(1.0f / TileSize);
    const F tile_columns = set(static_cast<float>((job.width + TileSize - 1) / TileSize));
    const F width = set(static_cast<float>(job.width - 1)), height = set(static_cast<float>(job.height - 1));
    SmallCut c;
    c.reach = fma(load(r.log2_opacity) + set(static_cast<float>(Log2Of255)), set(1.0f + 1e-4f), set(1e-4f));
    c.inverse_l1 = one / load(r.l1);
    c.slope = (nought - load(r.l2)) * c.inverse_l1;
    c.half_height = load(r.half_height) + set(BinMargin);
    c.columns = set(static_cast<float>((job.width + BlockSize - 1) / BlockSize));
    const F tall = c.half_height + set(0.5f), wide = load(r.half_width) + set(BinMargin + 0.5f);
    const F x = load(r.x), y = load(r.y);
    const F top = floor(min(max(y - tall, nought), height) * sixteenth);
    const F bottom = floor(min(max(y + tall, nought), height) * sixteenth);
    const F left = floor(min(max(x - wide, nought), width) * sixteenth);
    const F right = floor(min(max(x + wide, nought), width) * sixteenth);
    c.base = left * set(static_cast<float>(TileSize / BlockSize));
    store_int(out.tile, fma(top, tile_columns, left));
    store_int(out.fits, only((bottom - top <= one) & (right - left <= one), one));
    const F first_row = fma(top, set(static_cast<float>(TileSize)), set(0.5f));
    const M two_rows = bottom > top;  // what reaches below the picture has no second row of tiles
    const int rows = any(two_rows) ? 2 : 1;
    for (int row = 0; row < 2; ++row) {
        I bands = set_int(0);
        for (int k = 3; k >= 0 && row < rows; --k)
            bands = shift_left<8>(bands) |
                    band_bits(r, c, first_row + set(static_cast<float>(row * TileSize + k * BlockSize)));
        if (row == 1) bands = only(two_rows, bands);
        store(out.blocks[row * 2], tile_blocks(bands));
        store(out.blocks[row * 2 + 1], tile_blocks(shift_right<4>(bands)));
    }
}

/// Writes all four and keeps those that are touched. Nothing here can be predicted.
GSE_INLINE void emit_small(const SmallFootprints& small, int lane, std::uint32_t tile_columns, BinJob& job) {
    const auto tile = static_cast<std::uint32_t>(small.tile[lane]);
    for (std::uint32_t k = 0; k < 4; ++k) {
        const auto blocks = static_cast<std::uint32_t>(small.blocks[k][lane]);
        job.pairs[job.written].tile = tile + k / 2 * tile_columns + k % 2;
        job.pairs[job.written].blocks = blocks;
        job.written += blocks != 0 ? 1 : 0;
    }
}

static void bin(BinJob& job) {
    const std::uint32_t tile_columns = static_cast<std::uint32_t>((job.width + TileSize - 1) / TileSize);
    RecordColumns columns;
    SmallFootprints small;
    while (job.begin < job.end) {
        const std::size_t left = job.end - job.begin;
        const int size = left < F::W ? static_cast<int>(left) : F::W;
        const float* rows[F::W];
        for (int lane = 0; lane < F::W; ++lane)
            rows[lane] = &job.records[job.begin + static_cast<std::size_t>(lane < size ? lane : 0)].x;
        load_columns(rows, RecordFloats, columns.x);
        cut_small(columns, job, small);
        for (int lane = 0; lane < size; ++lane, ++job.begin) {
            const std::size_t before = job.written;
            if (before + 4 > job.capacity) return;
            if (small.fits[lane] != 0) emit_small(small, lane, tile_columns, job);
            else if (!bin_large(job.records[job.begin], job)) return;
            job.ranges[job.begin] = {static_cast<std::uint32_t>(before),
                                     static_cast<std::uint32_t>(job.written - before)};
        }
    }
}
