// Kernels 2: rows -> records, the tiles their ellipses touch, and the tiles' parts of the sorted pairs. One
// thread per row. EWA projection as in kernel_geometry.inl, in double (Kerbl et al. 2023).

constexpr float TileMargin = 0.01f;  // pixels, so that rounding can never drop a pair

GSE_DEVICE std::uint32_t row_of(const Grid& grid, std::uint32_t t) { return grid.block * BlockThreads + t; }

/// Colour before the clamp, of the first Count coefficients. The compiler knows the number, so that no array
/// lies in memory.
template <int Count> GSE_DEVICE void colour_of(F x, F y, F z, const float* sh, float* colour) {
    F basis[16];
    basis_lanes(x, y, z, Count, basis);
    F sums[3] = {set(0.5f), set(0.5f), set(0.5f)};
#pragma GCC unroll 16
    for (int k = 0; k < Count; ++k) {
        sums[0] = fma(basis[k], load(sh + k * 3), sums[0]);
        sums[1] = fma(basis[k], load(sh + k * 3 + 1), sums[1]);
        sums[2] = fma(basis[k], load(sh + k * 3 + 2), sums[2]);
    }
    for (int channel = 0; channel < 3; ++channel) store(colour + channel, sums[channel]);
}

/// Colour clamped at 0. Returns false if it is not finite.
GSE_DEVICE bool colour_record(const ProjectArguments& args, const RecordBatch& found, Record& record) {
    const F dx = load(found.direction[0]), dy = load(found.direction[1]), dz = load(found.direction[2]);
    const F scale = set(1.0f) / sqrt(fma(dz, dz, fma(dy, dy, dx * dx)));
    const F x = dx * scale, y = dy * scale, z = dz * scale;
    const float* sh = args.source.sh + record.row * args.source.sh_stride;
    float colour[3];
    if (args.view.sh_count >= 16) colour_of<16>(x, y, z, sh, colour);
    else if (args.view.sh_count >= 9) colour_of<9>(x, y, z, sh, colour);
    else if (args.view.sh_count >= 4) colour_of<4>(x, y, z, sh, colour);
    else colour_of<1>(x, y, z, sh, colour);
    constexpr float largest = 3.40282346638528859812e38f;
    bool finite = true;
    for (int channel = 0; channel < 3; ++channel) {
        finite = finite && colour[channel] >= -largest && colour[channel] <= largest;
        record.colour[channel] = colour[channel] > 0.0f ? colour[channel] : 0.0f;
    }
    if (args.values != nullptr) {
        record.colour[0] = args.values[record.row];
        record.colour[1] = record.colour[2] = 0.0f;
    }
    return finite;
}

GSE_DEVICE void write_record(const RecordColumns& from, Record& to) {
    to.x = from.x[0];
    to.y = from.y[0];
    to.l1 = from.l1[0];
    to.l2 = from.l2[0];
    to.l3 = from.l3[0];
    to.log2_opacity = from.log2_opacity[0];
    to.depth = from.depth[0];
    to.half_width = from.half_width[0];
    to.half_height = from.half_height[0];
    to.lean = from.lean[0];
    to.row = from.row[0];
}

enum class RowFate { Drawn, Culled, Unusable };

GSE_DEVICE RowFate record_of(const ProjectArguments& args, std::uint32_t row, Record& record) {
    RawBatch raw;
    load_row(args.source, row, 0, raw);
    Shape shape;
    compute_shape(raw, shape);
    Geometry g;
    compute_geometry(raw, shape, 0, args.view, g);
    RecordBatch found;
    const bool has_ellipse = bits(project_records(args.view, g, 0, found)) != 0;
    const bool drawn = bits(finish_records(args.view, shape, found)) != 0 && has_ellipse;
    if (bits(usable_lanes(raw)) == 0) return RowFate::Unusable;
    if (!drawn) return RowFate::Culled;
    found.columns.row[0] = row;
    write_record(found.columns, record);
    return colour_record(args, found, record) ? RowFate::Drawn : RowFate::Unusable;
}

/// Ellipse over rows of tiles, as bin_large has it over rows of blocks.
struct TileEllipse {
    float x, y, slope, inverse_l1, l3, reach, half_height, lean;
    std::int32_t top, bottom;  // rows of tiles
    std::int32_t columns;
};

GSE_DEVICE std::int32_t tile_at(float pixel, int size) {
    const float last = static_cast<float>(size - 1);
    return static_cast<std::int32_t>(pixel > 0.0f ? (pixel < last ? pixel : last) : 0.0f) / TileSize;
}

GSE_DEVICE TileEllipse tile_ellipse(const Record& r, int width, int height) {
    TileEllipse e;
    e.x = r.x;
    e.y = r.y;
    e.inverse_l1 = 1.0f / r.l1;
    e.slope = -r.l2 * e.inverse_l1;
    e.l3 = r.l3;
    e.reach = (r.log2_opacity + static_cast<float>(Log2Of255)) * (1.0f + 1e-4f) + 1e-4f;
    e.half_height = r.half_height + TileMargin;
    e.lean = r.lean;
    e.top = tile_at(r.y - (e.half_height + 0.5f), height);
    e.bottom = tile_at(r.y + (e.half_height + 0.5f), height);
    e.columns = (width + TileSize - 1) / TileSize;
    return e;
}

/// Columns [first, end) of the tiles of one row that the ellipse touches at pixel centres.
GSE_DEVICE void tile_span(const TileEllipse& e, std::int32_t row, std::int32_t& first, std::int32_t& end) {
    const F low = set(static_cast<float>(row * TileSize) + 0.5f - e.y),
            high = low + set(static_cast<float>(TileSize - 1));
    const F from = max(low, set(-e.half_height)), to = min(high, set(e.half_height));
    // The right edge is a concave function of dy with its top at `lean`; the left edge is its mirror image.
    const F right = min(max(set(e.lean), from), to), left = min(max(set(-e.lean), from), to);
    const F right_v = right * set(e.l3), left_v = left * set(e.l3);
    const F right_w = sqrt(max(fnma(right_v, right_v, set(e.reach)), zero()));
    const F left_w = sqrt(max(fnma(left_v, left_v, set(e.reach)), zero()));
    const F x_right = fma(right_w, set(e.inverse_l1), fma(right, set(e.slope), set(e.x + TileMargin)));
    const F x_left = fnma(left_w, set(e.inverse_l1), fma(left, set(e.slope), set(e.x - TileMargin)));
    const F part = set(1.0f / TileSize), columns = set(static_cast<float>(e.columns));
    const F begin = min(max(ceil((x_left - set(TileSize - 0.5f)) * part), zero()), columns);
    const F last = max(min(floor((x_right - set(0.5f)) * part), columns - set(1.0f)), set(-1.0f));
    first = static_cast<std::int32_t>(begin.v);
    end = any(from <= to) ? static_cast<std::int32_t>(last.v) + 1 : first;
}

GSE_DEVICE std::uint32_t count_tiles(const Record& record, int width, int height) {
    const TileEllipse e = tile_ellipse(record, width, height);
    std::uint32_t count = 0;
    for (std::int32_t row = e.top; row <= e.bottom; ++row) {
        std::int32_t first, end;
        tile_span(e, row, first, end);
        if (end > first) count += static_cast<std::uint32_t>(end - first);
    }
    return count;
}

GSE_DEVICE void project_rows(const Grid& grid, const ProjectArguments& args) {
    GSE_THREADS(grid, t) {
        const std::uint32_t row = row_of(grid, t);
        if (row >= args.rows) continue;
        Record record = {};
        const RowFate fate = record_of(args, row, record);
        const std::uint32_t count =
            fate == RowFate::Drawn ? count_tiles(record, args.view.width, args.view.height) : 0u;
        if (count > 0) args.records[row] = record;
        args.keys[row] = count > 0 ? __builtin_bit_cast(std::uint32_t, record.depth) : NotDrawn;
        args.pair_counts[row] = count;
        if (fate == RowFate::Unusable) add_atomically(args.unusable, 1);
    }
}

GSE_DEVICE void gather(const Grid& grid, const GatherArguments& args) {
    GSE_THREADS(grid, t) {
        const std::uint32_t i = row_of(grid, t);
        if (i < args.count) args.out[i] = args.values[args.order[i]];
    }
}

GSE_DEVICE void emit_pairs(const Grid& grid, const EmitArguments& args) {
    GSE_THREADS(grid, t) {
        const std::uint32_t rank = row_of(grid, t);
        if (rank >= args.rows) continue;
        const std::uint32_t row = args.order[rank];
        std::uint32_t pair = args.begins[rank];
        args.pair_begins[row] = pair;
        if (args.pair_counts[row] == 0) continue;
        const TileEllipse e = tile_ellipse(args.records[row], args.width, args.height);
        for (std::int32_t y = e.top; y <= e.bottom; ++y) {
            std::int32_t first, end;
            tile_span(e, y, first, end);
            for (std::int32_t x = first; x < end; ++x, ++pair) {
                args.pair_tiles[pair] = static_cast<std::uint32_t>(y * e.columns + x);
                args.pair_rows[pair] = row;
            }
        }
    }
}

GSE_DEVICE void find_ranges(const Grid& grid, const RangeArguments& args) {
    GSE_THREADS(grid, t) {
        const std::uint32_t i = row_of(grid, t);
        if (i >= args.pairs) continue;
        const std::uint32_t tile = args.tiles[i];
        if (i == 0 || args.tiles[i - 1] != tile) args.ranges[tile].begin = i;
        if (i + 1 == args.pairs || args.tiles[i + 1] != tile) args.ranges[tile].end = i + 1;
    }
}
