// Kernel part 4: blending one tile. Forward goes block by block with the sums in registers. Backward and
// contributions go Gaussian by Gaussian in that order, so that horizontal sums are paid once per (tile,
// Gaussian).

constexpr float CutExponent = static_cast<float>(-Log2Of255);
constexpr float Limit = static_cast<float>(AlphaLimit);
constexpr float CutTransmittance = static_cast<float>(TransmittanceCut);
constexpr int Subs = 16 / F::W;  // registers per 4x4 block

GSE_INLINE const Record& record_at(const RecordTable& table, std::uint32_t index) {
    return index < table.split ? table.first[index] : table.second[index - table.split];
}

/// Offsets of the pixel centres of a tile, in block order.
struct alignas(64) PixelGrid {
    float x[TilePixels], y[TilePixels];
};

GSE_INLINE void fill_grid(int x, int y, PixelGrid& grid) {
    for (int pixel = 0; pixel < TilePixels; ++pixel) {
        const int block = pixel / 16, lane = pixel % 16;
        grid.x[pixel] = static_cast<float>(x + block % 4 * 4 + lane % 4) + 0.5f;
        grid.y[pixel] = static_cast<float>(y + block / 4 * 4 + lane / 4) + 0.5f;
    }
}

/// Light at the start: 1 inside the image; 0 outside, where nothing can be blended any more.
GSE_INLINE void start_transmittance(int width, int height, const PixelGrid& grid, float* transmittance) {
    const F right = set(static_cast<float>(width)), bottom = set(static_cast<float>(height)), one = set(1.0f);
    for (int pixel = 0; pixel < TilePixels; pixel += F::W) {
        const M inside = (load(grid.x + pixel) <= right) & (load(grid.y + pixel) <= bottom);
        store(transmittance + pixel, only(inside, one));
    }
}

/// One Gaussian at W pixels. Forward and backward call this one function, so they take equal decisions.
struct Sample {
    F u, v;
    F alpha;    // 0 where the pair is too faint
    M touched;  // alpha >= 1/255
    M free;     // alpha below its limit (meaningful where touched)
};

GSE_INLINE Sample sample(const Record& r, F px, F py) {
    Sample s;
    const F dx = px - set(r.x), dy = py - set(r.y);
    s.u = fma(dy, set(r.l2), dx * set(r.l1));
    s.v = dy * set(r.l3);
    const F power = fnma(s.u, s.u, fnma(s.v, s.v, set(r.log2_opacity)));
    s.touched = power >= set(CutExponent);
    const F alpha = exp2_lanes(power);
    s.free = alpha <= set(Limit);
    s.alpha = only(s.touched, min(alpha, set(Limit)));
    return s;
}

/// Runs a list over W pixels. Returns how many entries it took until none of the pixels let light through. If
/// some still do (`alive`), it returns the length.
GSE_INLINE std::uint32_t blend_pixels(const BlendJob& job, const std::uint16_t* list, std::uint32_t length,
                                      int pixel, const PixelGrid& grid, bool& alive) {
    TileLight& light = *job.light;
    BlendScratch& scratch = *job.scratch;
    const F cut = set(CutTransmittance);
    F running = load(scratch.running + pixel);
    if (!any(running > cut)) return 0;
    const F px = load(grid.x + pixel), py = load(grid.y + pixel);
    F t = load(light.transmittance + pixel), depth = load(scratch.depth + pixel);
    F red = load(light.colour[0] + pixel), green = load(light.colour[1] + pixel),
      blue = load(light.colour[2] + pixel);
    I blended = load(scratch.blended + pixel);
    bool left = true;
    std::uint32_t i = 0;
    for (; left && i < length; ++i) {
        const Record& r = scratch.records[list[i]];
        const Sample s = sample(r, px, py);
        // `running` goes on shrinking behind the cut; it is monotone, so a finished pixel stays finished.
        const F after = fnma(s.alpha, running, running);
        const M live = after > cut;
        const F weight = only(live, s.alpha * running);
        red = fma(weight, set(r.colour[0]), red);
        green = fma(weight, set(r.colour[1]), green);
        blue = fma(weight, set(r.colour[2]), blue);
        depth = fma(weight, set(r.depth), depth);
        t = select(live, after, t);
        blended = count(blended, live & s.touched);
        running = after;
        left = any(live);
    }
    store(scratch.running + pixel, running);
    store(light.transmittance + pixel, t);
    store(light.colour[0] + pixel, red);
    store(light.colour[1] + pixel, green);
    store(light.colour[2] + pixel, blue);
    store(scratch.depth + pixel, depth);
    store(scratch.blended + pixel, blended);
    alive |= left;
    return i;
}

/// Copies a batch of records together and sorts its entries into one list per block.
GSE_INLINE void gather_batch(const BlendJob& job, std::uint32_t begin, std::uint32_t size,
                             std::uint32_t* lengths) {
    BlendScratch& scratch = *job.scratch;
    alignas(64) std::uint32_t blocks[BatchEntries];
    for (std::uint32_t i = 0; i < size; ++i) {
        const TileEntry& entry = job.entries[begin + i];
        if (begin + i + 24 < job.count)
            __builtin_prefetch(&record_at(job.records, job.entries[begin + i + 24].record));
        scratch.records[i] = record_at(job.records, entry.record);
        blocks[i] = entry.blocks;
    }
    for (int block = 0; block < 16; ++block) lengths[block] = 0;
#ifdef GSE_HAS_LISTS
    for (std::uint32_t i = size; i < ((size + 15u) & ~15u); ++i) blocks[i] = 0;
    for (std::uint32_t i = 0; i < size; i += 16) append_lists(blocks + i, i, scratch.lists, lengths);
#else
    for (std::uint32_t i = 0; i < size; ++i)
        for (std::uint32_t left = blocks[i]; left != 0; left &= left - 1) {
            const int block = __builtin_ctz(left);
            scratch.lists[block][lengths[block]++] = static_cast<std::uint16_t>(i);
        }
#endif
}

static void blend(const BlendJob& job) {
    BlendScratch& scratch = *job.scratch;
    TileLight& light = *job.light;
    PixelGrid grid;
    fill_grid(job.x, job.y, grid);
    start_transmittance(job.width, job.height, grid, light.transmittance);
    for (int pixel = 0; pixel < TilePixels; pixel += F::W) {
        store(scratch.running + pixel, load(light.transmittance + pixel));
        for (auto& channel : light.colour) store(channel + pixel, zero());
        store(scratch.depth + pixel, zero());
        for (int lane = 0; lane < F::W; ++lane) scratch.blended[pixel + lane] = 0;
    }
    for (int block = 0; block < 16; ++block)
        light.ends[block] = (job.blocks >> block & 1u) != 0 ? job.count : 0u;
    light.block_pairs = light.reached = 0;
    std::uint32_t alive = job.blocks;
    std::uint32_t lengths[16];
    for (std::uint32_t begin = 0; begin < job.count && alive != 0; begin += BatchEntries) {
        const std::uint32_t size = job.count - begin < BatchEntries ? job.count - begin : BatchEntries;
        gather_batch(job, begin, size, lengths);
        for (std::uint32_t left = alive; left != 0; left &= left - 1) {
            const int block = __builtin_ctz(left);
            bool any_alive = false;
            std::uint32_t taken = 0;
            for (int sub = 0; sub < Subs; ++sub) {
                const std::uint32_t by_sub = blend_pixels(job, scratch.lists[block], lengths[block],
                                                          block * 16 + sub * F::W, grid, any_alive);
                taken = by_sub > taken ? by_sub : taken;
            }
            light.block_pairs += taken;
            if (any_alive) continue;
            alive &= ~(1u << block);
            light.ends[block] = taken == 0 ? begin : begin + scratch.lists[block][taken - 1] + 1u;
        }
    }
    for (const std::uint32_t end : light.ends) light.reached = end > light.reached ? end : light.reached;
}
