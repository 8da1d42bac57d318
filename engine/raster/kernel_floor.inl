// Kernel part 7: the innermost loops of blending alone, with everything in the first cache, and records
// gathered from a scene's memory. Pictures are made with these loops, so a faster kernel lowers the floor,
// too.

/// Every block of a tile takes all records, from full transmittance.
static std::size_t floor_forward(FloorScratch& scratch, const PixelGrid& grid) {
    const BlendJob job = {{scratch.records, nullptr, NoSplit},
                          scratch.entries,
                          FloorRecords,
                          AllBlocks,
                          0,
                          0,
                          TileSize,
                          TileSize,
                          &scratch.light,
                          &scratch.blend};
    bool alive = false;
    std::size_t taken = 0;
    for (int pixel = 0; pixel < TilePixels; pixel += F::W) {
        store(scratch.blend.running + pixel, set(1.0f));
        taken += blend_pixels(job, scratch.blend.lists[0], FloorRecords, pixel, grid, alive);
    }
    return taken / Subs;
}

static std::size_t floor_backward(FloorScratch& scratch, const PixelGrid& grid) {
    for (int pixel = 0; pixel < TilePixels; pixel += F::W)
        store(scratch.backward.transmittance + pixel, set(1.0f));
    std::size_t blocks = 0;
    for (std::uint32_t i = 0; i < FloorRecords; ++i) {
        Sums sums;
        sum_record(scratch.records[i], scratch.entries[i].blocks, grid, scratch.backward, sums);
        store_sums(sums.s, &scratch.partials[i * PartialStride]);
        blocks += static_cast<std::size_t>(__builtin_popcount(scratch.entries[i].blocks));
    }
    return blocks;
}

static std::size_t floor_mask(FloorScratch& scratch) {
    BinJob job = {scratch.records,   0, FloorRecords,  4 * TileSize, 4 * TileSize, scratch.pairs,
                  16 * FloorRecords, 0, scratch.ranges};
    bin(job);
    return job.written;
}

static std::size_t floor_gather(FloorScratch& scratch) {
    const BlendJob job = {{scratch.records, nullptr, NoSplit},
                          scratch.entries,
                          FloorRecords,
                          AllBlocks,
                          0,
                          0,
                          TileSize,
                          TileSize,
                          &scratch.light,
                          &scratch.blend};
    std::uint32_t lengths[16];
    gather_batch(job, 0, FloorRecords, lengths);
    return FloorRecords;
}

/// Loop over a scene's records, which lie in the second or third cache, or in memory.
static std::size_t floor_scene_gather(const FloorJob& floor, std::uint32_t round) {
    FloorScratch& scratch = *floor.scratch;
    const BlendJob job = {{floor.records, nullptr, NoSplit},
                          floor.entries,
                          floor.rounds * FloorRecords,
                          AllBlocks,
                          0,
                          0,
                          TileSize,
                          TileSize,
                          &scratch.light,
                          &scratch.blend};
    std::uint32_t lengths[16];
    gather_batch(job, round * FloorRecords, FloorRecords, lengths);
    return FloorRecords;
}

static void floor_loops(FloorJob& job) {
    FloorScratch& scratch = *job.scratch;
    PixelGrid grid;
    fill_grid(0, 0, grid);
    for (std::uint32_t i = 0; i < FloorRecords; ++i)
        scratch.blend.lists[0][i] = static_cast<std::uint16_t>(i);
    for (std::uint32_t i = 0; i < FloorRecords; ++i) scratch.blend.records[i] = scratch.records[i];
    job.work = 0;
    for (std::uint32_t round = 0; round < job.rounds; ++round) {
        if (job.loop == FloorLoop::Forward) job.work += floor_forward(scratch, grid);
        if (job.loop == FloorLoop::Backward) job.work += floor_backward(scratch, grid);
        if (job.loop == FloorLoop::Mask) job.work += floor_mask(scratch);
        if (job.loop == FloorLoop::Gather) job.work += floor_gather(scratch);
        if (job.loop == FloorLoop::SceneGather) job.work += floor_scene_gather(job, round);
    }
}
