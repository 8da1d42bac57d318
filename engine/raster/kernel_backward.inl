// Kernel part 5: derivative of one tile's blending with respect to its records, and the weights of
// contributions. Both walk the tile's list in forward order and write one slot of sums per (tile, Gaussian).
// Slots are added up later in a fixed order, so no result depends on the thread of a tile.

/// Sums over pixels of g and w times the factors in PartialSum (g = dL/d ln alpha, w = alpha T).
struct Sums {
    F s[10];
};

/// One register of pixels of one active Gaussian. Remaining-light form of the derivative: dL/dalpha = T (c.v)
/// - R / (1 - alpha). R is the gradient-weighted light behind the pair.
GSE_INLINE void backward_pixels(const Record& r, int pixel, const PixelGrid& grid, BackwardScratch& scratch,
                                Sums& sums, M& blended) {
    const Sample s = sample(r, load(grid.x + pixel), load(grid.y + pixel));
    const F before = load(scratch.transmittance + pixel);
    const F after = fnma(s.alpha, before, before);
    const M live = after > set(CutTransmittance);
    store(scratch.transmittance + pixel, after);
    const F weight = only(live, s.alpha * before);
    const F red = load(scratch.d_colour[0] + pixel), green = load(scratch.d_colour[1] + pixel),
            blue = load(scratch.d_colour[2] + pixel);
    const F light = fma(set(r.colour[2]), blue, fma(set(r.colour[1]), green, set(r.colour[0]) * red));
    const F lit = weight * light;
    const F remaining = load(scratch.remaining + pixel) - lit;
    store(scratch.remaining + pixel, remaining);
    const F g = only(live & s.free, fnma(s.alpha * remaining, reciprocal(set(1.0f) - s.alpha), lit));
    const F gu = g * s.u, gv = g * s.v;
    sums.s[SumG] = sums.s[SumG] + g;
    sums.s[SumGu] = sums.s[SumGu] + gu;
    sums.s[SumGv] = sums.s[SumGv] + gv;
    sums.s[SumGuu] = fma(gu, s.u, sums.s[SumGuu]);
    sums.s[SumGuv] = fma(gu, s.v, sums.s[SumGuv]);
    sums.s[SumGvv] = fma(gv, s.v, sums.s[SumGvv]);
    sums.s[SumRed] = fma(weight, red, sums.s[SumRed]);
    sums.s[SumGreen] = fma(weight, green, sums.s[SumGreen]);
    sums.s[SumBlue] = fma(weight, blue, sums.s[SumBlue]);
    blended = blended | (live & s.touched);
}

/// Pixels of a Gaussian that wants no gradient: it only takes its light.
GSE_INLINE void pass_pixels(const Record& r, int pixel, const PixelGrid& grid, BackwardScratch& scratch) {
    const Sample s = sample(r, load(grid.x + pixel), load(grid.y + pixel));
    const F before = load(scratch.transmittance + pixel);
    const F after = fnma(s.alpha, before, before);
    const M live = after > set(CutTransmittance);
    store(scratch.transmittance + pixel, after);
    const F weight = only(live, s.alpha * before);
    const F red = load(scratch.d_colour[0] + pixel), green = load(scratch.d_colour[1] + pixel),
            blue = load(scratch.d_colour[2] + pixel);
    const F light = fma(set(r.colour[2]), blue, fma(set(r.colour[1]), green, set(r.colour[0]) * red));
    store(scratch.remaining + pixel, load(scratch.remaining + pixel) - weight * light);
}

GSE_INLINE M weigh_pixels(const Record& r, int pixel, const PixelGrid& grid, BackwardScratch& scratch,
                          F& total, F& masked) {
    const Sample s = sample(r, load(grid.x + pixel), load(grid.y + pixel));
    const F before = load(scratch.transmittance + pixel);
    const F after = fnma(s.alpha, before, before);
    const M live = after > set(CutTransmittance);
    store(scratch.transmittance + pixel, after);
    const F weight = only(live, s.alpha * before);
    total = total + weight;
    masked = fma(weight, load(scratch.mask + pixel), masked);
    return live;
}

GSE_INLINE float* slot_of(const BackwardJob& job, const TileEntry& entry) {
    return job.partials + static_cast<std::size_t>(entry.slot - job.first_slot) * PartialStride;
}

GSE_INLINE void clear_slot(float* slot) {
    for (int k = 0; k < PartialStride; k += F::W) store(slot + k, zero());
}

#ifndef GSE_HAS_STREAMS
constexpr bool HasStreams = false;  // these are never called
GSE_INLINE void stream_columns(const float*, int, float* const*, int) {}
GSE_INLINE void stream_sums(const F*, float*) {}
GSE_INLINE void stream_zeros(float*, std::size_t) {}
GSE_INLINE void end_streams() {}
#endif

/// store_sums and clear_slot of a job's slot. Slots may be too many for the caches.
GSE_INLINE void fill_slot(const BackwardJob& job, const TileEntry& entry, const F* sums) {
    if (HasStreams && job.past_caches) return stream_sums(sums, slot_of(job, entry));
    store_sums(sums, slot_of(job, entry));
}

GSE_INLINE void empty_slot(const BackwardJob& job, const TileEntry& entry) {
    if (HasStreams && job.past_caches) return stream_zeros(slot_of(job, entry), PartialStride);
    clear_slot(slot_of(job, entry));
}

/// Clears the slots of the active entries in [begin, end), which nothing reached.
static void clear_rest(const BackwardJob& job, std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t i = begin; i < end; ++i)
        if (job.entries[i].record >= job.first_record) empty_slot(job, job.entries[i]);
    if (HasStreams && job.past_caches) end_streams();
}

GSE_INLINE void prefetch_entry(const BackwardJob& job, std::uint32_t i) {
    if (i >= job.count) return;
    const TileEntry& entry = job.entries[i];
    __builtin_prefetch(&record_at(job.records, entry.record));
    if (entry.record >= job.first_record && !(HasStreams && job.past_caches))
        __builtin_prefetch(slot_of(job, entry), 1);
}

GSE_INLINE void sum_record(const Record& r, std::uint32_t blocks, const PixelGrid& grid,
                           BackwardScratch& scratch, Sums& sums) {
    for (F& sum : sums.s) sum = zero();
    M blended = none();
    for (std::uint32_t left = blocks; left != 0; left &= left - 1) {
        const int block = __builtin_ctz(left);
        for (int sub = 0; sub < Subs; ++sub)
            backward_pixels(r, block * 16 + sub * F::W, grid, scratch, sums, blended);
    }
    sums.s[SumBlended] = only(blended, set(1.0f));
}

GSE_INLINE void pass_record(const Record& r, std::uint32_t blocks, const PixelGrid& grid,
                            BackwardScratch& scratch) {
    for (std::uint32_t left = blocks; left != 0; left &= left - 1) {
        const int block = __builtin_ctz(left);
        for (int sub = 0; sub < Subs; ++sub) pass_pixels(r, block * 16 + sub * F::W, grid, scratch);
    }
}

/// End of each block's work: behind its last active entry, and at the end of its light. Blocks without an
/// active entry have no work.
struct Reach {
    std::uint32_t ends[16];
    std::uint32_t last_active;  // behind the last active entry of the tile
};

GSE_INLINE Reach find_reach(const BackwardJob& job) {
    Reach reach;
    reach.last_active = 0;
    for (std::uint32_t& end : reach.ends) end = 0;
    std::uint32_t found = 0;
    for (std::uint32_t i = job.count; i > 0 && found != AllBlocks; --i) {
        const TileEntry& entry = job.entries[i - 1];
        if (entry.record < job.first_record) continue;
        if (reach.last_active == 0) reach.last_active = i;
        for (std::uint32_t left = entry.blocks & ~found; left != 0; left &= left - 1) {
            const int block = __builtin_ctz(left);
            reach.ends[block] = job.ends[block] < i ? job.ends[block] : i;
        }
        found |= entry.blocks;
    }
    return reach;
}

/// Blocks that reach beyond entry i. `until` becomes the entry at which the first of them ends.
GSE_INLINE std::uint32_t blocks_beyond(const Reach& reach, std::uint32_t i, std::uint32_t& until) {
    std::uint32_t blocks = 0;
    until = 0xffffffff;
    for (int block = 0; block < 16; ++block) {
        if (reach.ends[block] <= i) continue;
        blocks |= 1u << block;
        until = reach.ends[block] < until ? reach.ends[block] : until;
    }
    return blocks;
}

static void backward(const BackwardJob& job) {
    const Reach reach = find_reach(job);
    if (reach.last_active == 0) return;
    PixelGrid grid;
    fill_grid(job.x, job.y, grid);
    start_transmittance(job.width, job.height, grid, job.scratch->transmittance);
    std::uint32_t until = 0, alive = 0, i = 0;
    for (;; ++i) {
        if (i == until) alive = blocks_beyond(reach, i, until);
        if (alive == 0) break;
        prefetch_entry(job, i + 8);
        const TileEntry& entry = job.entries[i];
        const Record& r = record_at(job.records, entry.record);
        const std::uint32_t blocks = entry.blocks & alive;
        if (entry.record < job.first_record) pass_record(r, blocks, grid, *job.scratch);
        else if (blocks == 0) empty_slot(job, entry);
        else {
            Sums sums;
            sum_record(r, blocks, grid, *job.scratch, sums);
            fill_slot(job, entry, sums.s);
        }
    }
    clear_rest(job, i, reach.last_active);
}

static void contribute(const BackwardJob& job) {
    PixelGrid grid;
    fill_grid(job.x, job.y, grid);
    start_transmittance(job.width, job.height, grid, job.scratch->transmittance);
    std::uint32_t alive = AllBlocks, i = 0;
    for (; i < job.count && alive != 0; ++i) {
        prefetch_entry(job, i + 8);
        const TileEntry& entry = job.entries[i];
        const Record& r = record_at(job.records, entry.record);
        Sums sums;
        for (F& sum : sums.s) sum = zero();
        for (std::uint32_t left = entry.blocks & alive; left != 0; left &= left - 1) {
            const int block = __builtin_ctz(left);
            M live = none();
            for (int sub = 0; sub < Subs; ++sub)
                live = live | weigh_pixels(r, block * 16 + sub * F::W, grid, *job.scratch, sums.s[SumWeight],
                                           sums.s[SumMasked]);
            if (!any(live)) alive &= ~(1u << block);
        }
        fill_slot(job, entry, sums.s);
    }
    clear_rest(job, i, job.count);
}
