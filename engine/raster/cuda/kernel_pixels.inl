// Kernels 3: one block per tile of 16x16 pixels, one thread per pixel, the Gaussians in batches through
// shared memory. Forward keeps sums in registers. Backward and contributions walk front to back with equal
// decisions. Sums over a tile's pixels are added in one order, warp by warp, into the slot of the (tile,
// Gaussian). No result depends on the order of the blocks.

constexpr std::uint32_t BlendBatch = BlockThreads;  // records
constexpr std::uint32_t SumBatch = 32;              // one bit each
constexpr std::uint32_t NoSlot = 0xffffffff;
constexpr std::uint32_t RecordWords = sizeof(Record) / sizeof(std::uint32_t);

/// A thread's pixel; a warp has 8x4 of them.
struct TilePixel {
    float x, y;  // of the centre
    std::uint32_t index;
    bool inside;
};

GSE_DEVICE TilePixel tile_pixel(const TileLists& lists, std::uint32_t tile, std::uint32_t t) {
    const std::uint32_t warp = t / WarpLanes, lane = t % WarpLanes;
    const std::uint32_t x = tile % lists.tile_columns * TileSize + warp % 2 * 8 + lane % 8;
    const std::uint32_t y = tile / lists.tile_columns * TileSize + warp / 2 * 4 + lane / 8;
    const auto width = static_cast<std::uint32_t>(lists.width),
               height = static_cast<std::uint32_t>(lists.height);
    return {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, y * width + x,
            x < width && y < height};
}

/// Records of the rows, word by word. Neighbouring threads read neighbouring words.
GSE_DEVICE void copy_records(const Record* from, const std::uint32_t* rows, std::uint32_t count,
                             std::uint32_t t, Record* to) {
    for (std::uint32_t word = t; word < count * RecordWords; word += BlockThreads) {
        const std::uint32_t record = word / RecordWords, offset = word % RecordWords * sizeof(std::uint32_t);
        __builtin_memcpy(reinterpret_cast<char*>(to + record) + offset,
                         reinterpret_cast<const char*>(from + rows[record]) + offset, sizeof(std::uint32_t));
    }
}

struct BlendShared {
    Record records[BlendBatch];
    std::uint32_t rows[BlendBatch];
};

struct PixelLight {
    float running;  // transmittance that goes on shrinking behind the cut
    float transmittance, colour[3], depth;
    std::int32_t blended;
};

/// The batch over one pixel, until no light is left.
GSE_DEVICE void blend_pixel(const Record* records, std::uint32_t count, const TilePixel& pixel,
                            PixelLight& light) {
    for (std::uint32_t i = 0; i < count && light.running > CutTransmittance; ++i) {
        const Record& r = records[i];
        const Sample s = sample(r, set(pixel.x), set(pixel.y));
        if (!any(s.touched)) continue;
        const float after = fused(-s.alpha.v, light.running, light.running);
        if (after > CutTransmittance) {
            const float weight = s.alpha.v * light.running;
            light.colour[0] = fused(weight, r.colour[0], light.colour[0]);
            light.colour[1] = fused(weight, r.colour[1], light.colour[1]);
            light.colour[2] = fused(weight, r.colour[2], light.colour[2]);
            light.depth = fused(weight, r.depth, light.depth);
            light.transmittance = after;
            ++light.blended;
        }
        light.running = after;
    }
}

GSE_DEVICE void write_pixel(const BlendArguments& args, std::uint32_t pixel, const PixelLight& light) {
    const float rest = light.transmittance;
    if (args.channels == 1) {
        args.colour[pixel] = light.colour[0] + rest * args.background[0];
    } else {
        args.colour[pixel * 3] = light.colour[0] + rest * args.background[0];
        args.colour[pixel * 3 + 1] = light.colour[1] + rest * args.background[1];
        args.colour[pixel * 3 + 2] = light.colour[2] + rest * args.background[2];
    }
    args.transmittance[pixel] = rest;
    args.depth[pixel] = light.depth;
    args.blended[pixel] = light.blended;
}

GSE_DEVICE void blend_tile(const Grid& grid, const BlendArguments& args) {
    GSE_SHARED(grid, BlendShared, shared);
    const TileRange range = args.lists.ranges[grid.block];
    PerThread<TilePixel> pixel;
    PerThread<PixelLight> light;
    GSE_THREADS(grid, t) {
        pixel[t] = tile_pixel(args.lists, grid.block, t);
        light[t] = {pixel[t].inside ? 1.0f : 0.0f, 1.0f, {0.0f, 0.0f, 0.0f}, 0.0f, 0};
    }
    for (std::uint32_t begin = range.begin; begin < range.end; begin += BlendBatch) {
        const std::uint32_t size = range.end - begin < BlendBatch ? range.end - begin : BlendBatch;
        GSE_THREADS(grid, t) {
            if (t < size) shared.rows[t] = args.lists.pair_rows[args.lists.entries[begin + t]];
        }
        GSE_THREADS(grid, t) copy_records(args.lists.records, shared.rows, size, t, shared.records);
        PerThread<bool> alive;
        GSE_THREADS(grid, t) {
            blend_pixel(shared.records, size, pixel[t], light[t]);
            alive[t] = light[t].running > CutTransmittance;
        }
        if (!any_thread(grid, alive)) break;
    }
    GSE_THREADS(grid, t) {
        if (pixel[t].inside) write_pixel(args, pixel[t].index, light[t]);
    }
}

/// Remaining-light form of the derivative, as in backward_pixels: dL/dalpha = T (c.v) - R / (1 - alpha). R is
/// the gradient-weighted light behind the pair.
struct SlopePixel {
    using Arguments = BackwardArguments;
    static constexpr std::uint32_t Floats = SlotFloats;
    float x, y, transmittance, remaining, d[3];

    GSE_MEMBER void begin(const BackwardArguments& args, const TilePixel& pixel) {
        *this = {pixel.x, pixel.y, 0.0f, 0.0f, {0.0f, 0.0f, 0.0f}};
        if (!pixel.inside) return;
        transmittance = 1.0f;
        if (args.d_alpha != nullptr) remaining = -args.d_alpha[pixel.index] * args.transmittance[pixel.index];
        for (std::uint32_t channel = 0; channel < 3; ++channel) {
            d[channel] = args.d_colour[pixel.index * 3 + channel];
            remaining = fused(d[channel], args.colour[pixel.index * 3 + channel], remaining);
        }
    }

    /// Takes the record's light, and the sums' terms if `active`. Returns whether it was blended.
    GSE_MEMBER bool take(const Record& r, bool active, float* sums) {
        for (std::uint32_t k = 0; k < Floats; ++k) sums[k] = 0.0f;
        if (!(transmittance > CutTransmittance)) return false;
        const Sample s = sample(r, set(x), set(y));
        if (!any(s.touched)) return false;
        const float alpha = s.alpha.v, before = transmittance;
        transmittance = fused(-alpha, before, before);
        if (!(transmittance > CutTransmittance)) return false;
        const float weight = alpha * before;
        const float light = fused(r.colour[2], d[2], fused(r.colour[1], d[1], r.colour[0] * d[0])),
                    lit = weight * light;
        remaining -= lit;
        if (!active) return true;
        const float g = any(s.free) ? fused(-(alpha * remaining), 1.0f / (1.0f - alpha), lit) : 0.0f;
        const float gu = g * s.u.v, gv = g * s.v.v;
        sums[SumG] = g;
        sums[SumGu] = gu;
        sums[SumGv] = gv;
        sums[SumGuu] = gu * s.u.v;
        sums[SumGuv] = gu * s.v.v;
        sums[SumGvv] = gv * s.v.v;
        sums[SumRed] = weight * d[0];
        sums[SumGreen] = weight * d[1];
        sums[SumBlue] = weight * d[2];
        sums[SumBlended] = 1.0f;
        return true;
    }
};

struct WeightPixel {
    using Arguments = ContributeArguments;
    static constexpr std::uint32_t Floats = WeightFloats;
    float x, y, transmittance, mask;

    GSE_MEMBER void begin(const ContributeArguments& args, const TilePixel& pixel) {
        *this = {pixel.x, pixel.y, pixel.inside ? 1.0f : 0.0f, pixel.inside ? args.mask[pixel.index] : 0.0f};
    }

    GSE_MEMBER bool take(const Record& r, bool, float* sums) {
        sums[SumWeight] = sums[SumMasked] = 0.0f;
        if (!(transmittance > CutTransmittance)) return false;
        const Sample s = sample(r, set(x), set(y));
        if (!any(s.touched)) return false;
        const float before = transmittance;
        transmittance = fused(-s.alpha.v, before, before);
        if (!(transmittance > CutTransmittance)) return false;
        sums[SumWeight] = s.alpha.v * before;
        sums[SumMasked] = sums[SumWeight] * mask;
        return true;
    }
};

template <std::uint32_t Floats> struct SumShared {
    Record records[SumBatch];
    std::uint32_t rows[SumBatch], slots[SumBatch];
    std::uint32_t touched[BlockWarps];  // bit i: the warp has sums of record i
    float sums[BlockWarps][SumBatch][Floats];
    std::uint32_t last[BlockThreads];
};

/// Place behind the last entry of the tile that wants sums; 0 if none does.
GSE_DEVICE std::uint32_t last_active(const Grid& grid, const TileLists& lists, std::uint32_t first_row,
                                     std::uint32_t* last) {
    const TileRange range = lists.ranges[grid.block];
    if (first_row == 0) return range.end;
    GSE_THREADS(grid, t) {
        last[t] = 0;
        for (std::uint32_t i = range.begin + t; i < range.end; i += BlockThreads)
            if (lists.pair_rows[lists.entries[i]] >= first_row) last[t] = i + 1;
    }
    for (std::uint32_t half = BlockThreads / 2; half > 0; half /= 2) GSE_THREADS(grid, t) {
            if (t < half && last[t + half] > last[t]) last[t] = last[t + half];
        }
    return last[0];  // which nobody writes again
}

/// Rows and slots of the entries from `begin` on.
GSE_DEVICE void load_entry(const TileLists& lists, const SlotTable& table, std::uint32_t entry,
                           std::uint32_t& row, std::uint32_t& slot) {
    const std::uint32_t pair = lists.entries[entry];
    row = lists.pair_rows[pair];
    slot = row < table.first_row ? NoSlot
                                 : table.slot_begins[row - table.first_row] + (pair - table.pair_begins[row]);
}

/// One warp's pixels through the batch: sums of each record over its lanes.
template <class Pixel>
GSE_DEVICE void sum_warp(const Grid& grid, std::uint32_t warp, std::uint32_t size, PerThread<Pixel>& pixels,
                         SumShared<Pixel::Floats>& shared) {
    std::uint32_t touched = 0;
    for (std::uint32_t i = 0; i < size; ++i) {
        const bool active = shared.slots[i] != NoSlot;
        PerLane<float> sums[Pixel::Floats];
        PerLane<bool> hit;
        GSE_LANES(grid, lane) {
            float terms[Pixel::Floats];
            hit[lane] = pixels[warp * WarpLanes + lane].take(shared.records[i], active, terms);
            for (std::uint32_t k = 0; k < Pixel::Floats; ++k) sums[k][lane] = terms[k];
        }
        if (!active || !any_lane(hit)) continue;
        for (std::uint32_t k = 0; k < Pixel::Floats; ++k) sum_lanes(sums[k]);
        touched |= 1u << i;
        GSE_LANES(grid, lane) {
            if (lane == 0)
                for (std::uint32_t k = 0; k < Pixel::Floats; ++k) shared.sums[warp][i][k] = sums[k][lane];
        }
    }
    GSE_LANES(grid, lane) {
        if (lane == 0) shared.touched[warp] = touched;
    }
}

/// Adds the warps' sums, in order, into the slots. Slots that no pixel reached stay as they are.
template <std::uint32_t Floats>
GSE_DEVICE void write_slots(const SumShared<Floats>& shared, std::uint32_t size, std::uint32_t t,
                            float* slots) {
    for (std::uint32_t item = t; item < size * Floats; item += BlockThreads) {
        const std::uint32_t i = item / Floats, k = item % Floats;
        bool any_warp = false;
        float sum = 0.0f;
        for (std::uint32_t warp = 0; warp < BlockWarps; ++warp) {
            if ((shared.touched[warp] >> i & 1u) == 0) continue;
            any_warp = true;
            sum += shared.sums[warp][i][k];
        }
        if (any_warp) slots[static_cast<std::size_t>(shared.slots[i]) * Floats + k] = sum;
    }
}

template <class Pixel> GSE_DEVICE void sum_tile(const Grid& grid, const typename Pixel::Arguments& args) {
    GSE_SHARED(grid, SumShared<Pixel::Floats>, shared);
    const std::uint32_t end = last_active(grid, args.lists, args.table.first_row, shared.last);
    PerThread<Pixel> pixels;
    GSE_THREADS(grid, t) pixels[t].begin(args, tile_pixel(args.lists, grid.block, t));
    for (std::uint32_t begin = args.lists.ranges[grid.block].begin; begin < end; begin += SumBatch) {
        const std::uint32_t size = end - begin < SumBatch ? end - begin : SumBatch;
        GSE_THREADS(grid, t) {
            if (t < size) load_entry(args.lists, args.table, begin + t, shared.rows[t], shared.slots[t]);
        }
        GSE_THREADS(grid, t) copy_records(args.lists.records, shared.rows, size, t, shared.records);
        GSE_WARPS(grid, warp) sum_warp<Pixel>(grid, warp, size, pixels, shared);
        PerThread<bool> alive;
        GSE_THREADS(grid, t) {
            write_slots(shared, size, t, args.table.slots);
            alive[t] = pixels[t].transmittance > CutTransmittance;
        }
        if (!any_thread(grid, alive)) break;
    }
}

GSE_DEVICE void backward_tile(const Grid& grid, const BackwardArguments& args) {
    sum_tile<SlopePixel>(grid, args);
}
GSE_DEVICE void contribute_tile(const Grid& grid, const ContributeArguments& args) {
    sum_tile<WeightPixel>(grid, args);
}
