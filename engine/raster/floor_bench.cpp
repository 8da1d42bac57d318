// Timing of the innermost loops and of memory, on all threads at once. Threads that share a core or a memory
// bus slow each other down, as in the rasterizer.
#include "engine/raster/floor_bench.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <utility>
#include <vector>

#include "engine/base/clock.h"
#include "engine/base/random.h"
#include "engine/raster/kernels.h"

namespace gse::raster {
namespace {

constexpr double LoopSeconds = 2e-3;  // of each loop and measurement, at least
// Between two looks at the clock, which cost as much as hundreds of records.
constexpr std::uint32_t LoopRounds = 256;
constexpr std::size_t MemoryBytes = std::size_t{128} << 20;  // more than caches hold
constexpr double StartSeconds = 0.05;                        // how long the threads wait for each other

enum Loop : std::size_t {
    Forward,
    Mask,
    Gather,
    SceneGather,
    Backward
};  // one Backward for each of FloorBlocks
constexpr std::size_t LoopCount = Backward + FloorBlocks.size();

/// Splats of some pixels within a few tiles, so faint that light is left behind all of them.
void fill_records(FloorScratch& scratch) {
    Random random(5);
    for (std::uint32_t i = 0; i < FloorRecords; ++i) {
        Record& record = scratch.records[i];
        record = {};
        record.x = static_cast<float>(random.uniform(8, 56));
        record.y = static_cast<float>(random.uniform(8, 56));
        record.l1 = record.l3 = 0.25f;
        record.l2 = 0.05f;
        record.log2_opacity = -6.5f;
        for (float& channel : record.colour) channel = static_cast<float>(random.uniform(0, 1));
        record.depth = 1;
        record.half_width = record.half_height = 5;  // sqrt(log2(255 o)) / l1, about
        record.lean = -1;
        record.row = i;
    }
    for (std::uint32_t pixel = 0; pixel < TilePixels; ++pixel) {
        scratch.backward.remaining[pixel] = static_cast<float>(random.uniform(0, 1));
        for (auto& channel : scratch.backward.d_colour)
            channel[pixel] = static_cast<float>(random.uniform(-1, 1));
    }
}

/// `blocks` neighbours of the 16 blocks of a tile, others for every record.
void fill_entries(FloorScratch& scratch, int blocks) {
    for (std::uint32_t i = 0; i < FloorRecords; ++i) {
        const std::uint32_t run = (1u << blocks) - 1u, turn = i * 5 % 16;
        scratch.entries[i] = {i, i, (run << turn | run >> (16 - turn)) & AllBlocks};
    }
}

/// Entries of any of so many records, for LoopRounds.
std::vector<TileEntry> any_entries(std::size_t records, std::uint64_t seed) {
    Random random(seed);
    std::vector<TileEntry> entries(std::size_t{LoopRounds} * FloorRecords);
    for (auto& entry : entries) {
        const auto record = static_cast<std::uint32_t>(random.below(records));
        entry = {record, record, 0xfu << record % 13};
    }
    return entries;
}

double loop_ns(const Kernels& kernels, FloorLoop loop, FloorScratch& scratch, const Record* records = nullptr,
               const TileEntry* entries = nullptr) {
    FloorJob job = {loop, LoopRounds, &scratch, records, entries, 0};
    kernels.floor(job);  // into the cache
    std::size_t work = 0;
    double seconds = 0;
    for (const double start = thread_seconds(); seconds < LoopSeconds; seconds = thread_seconds() - start) {
        kernels.floor(job);
        work += job.work;
    }
    return 1e9 * seconds / static_cast<double>(work);
}

double at_blocks(const KernelFloor& kernel, double blocks) {
    const double inverse = 1 / std::clamp(blocks, 1.0, static_cast<double>(FloorBlocks.back()));
    std::size_t i = 1;
    while (i + 1 < FloorBlocks.size() && inverse < 1.0 / FloorBlocks[i]) ++i;
    const double low = 1.0 / FloorBlocks[i], high = 1.0 / FloorBlocks[i - 1];
    const double share = (inverse - low) / (high - low);
    return kernel.backward_ns[i] + share * (kernel.backward_ns[i - 1] - kernel.backward_ns[i]);
}

}  // namespace

FloorStep floor_step(const KernelFloor& kernel, const FloorWork& work) {
    const double ms = 1e-6 / work.threads;
    const auto pairs = static_cast<double>(work.pairs), blocks = static_cast<double>(work.blocks);
    FloorStep step;
    step.forward_blend = blocks * kernel.forward_ns * ms;
    if (work.pairs > 0) step.backward_blend = blocks * at_blocks(kernel, blocks / pairs) * ms;
    step.lists = 2 * pairs * (kernel.mask_ns + kernel.scene_gather_ns) * ms;
    step.lists_in_cache = 2 * pairs * (kernel.mask_ns + kernel.gather_ns) * ms;
    constexpr std::size_t other_floats = 11;  // position, scale, rotation, opacity
    const auto bytes = static_cast<double>(work.splats * (other_floats + work.sh_floats) * sizeof(float));
    if (kernel.gigabytes_per_second > 0) step.parameters = bytes * 1e-6 / kernel.gigabytes_per_second;
    step.parameter_gradients = 2 * step.parameters;
    return step;
}

struct FloorBench::Data {
    std::vector<FloorScratch> scratch;            // per item of the loops, of which each thread takes one
    std::vector<Record> records;                  // as many as the scene's
    std::vector<std::vector<TileEntry>> entries;  // per item
    std::vector<std::array<double, LoopCount>> ns;
    std::vector<std::uint32_t> memory;
    std::vector<double> rates;        // bytes per nanosecond
    std::vector<std::uint32_t> sums;  // read, so that reading is not left out
    std::atomic<unsigned> waiting{0};

    /// Returns when all threads are here, or have been waited for long enough.
    void start_together(unsigned threads) {
        ++waiting;
        for (const double start = wall_seconds();
             waiting < threads && wall_seconds() - start < StartSeconds;) {}
    }
};

FloorBench::FloorBench(const Kernels& kernels, ThreadPool& pool, std::size_t records)
    : kernels_(kernels), pool_(pool), data_(std::make_unique<Data>()) {
    const unsigned threads = pool.thread_count();
    data_->scratch.resize(threads);
    for (FloorScratch& scratch : data_->scratch) fill_records(scratch);
    data_->records.resize(std::max<std::size_t>(records, 1));
    for (std::size_t i = 0; i < data_->records.size(); ++i)
        data_->records[i] = data_->scratch[0].records[i % FloorRecords];
    for (unsigned i = 0; i < threads; ++i) data_->entries.push_back(any_entries(data_->records.size(), i));
    data_->ns.resize(threads);
    data_->rates.resize(threads);
    data_->sums.resize(threads);
    data_->memory.assign(MemoryBytes / sizeof(std::uint32_t), 1);
}

FloorBench::~FloorBench() = default;

void FloorBench::measure_loops() {
    data_->waiting = 0;
    pool_.parallel_for(pool_.thread_count(), 1, [this](std::size_t item, std::size_t, unsigned) {
        FloorScratch& scratch = data_->scratch[item];
        auto& ns = data_->ns[item];
        data_->start_together(pool_.thread_count());
        fill_entries(scratch, 4);
        ns[Forward] = loop_ns(kernels_, FloorLoop::Forward, scratch);
        ns[Mask] = loop_ns(kernels_, FloorLoop::Mask, scratch);
        ns[Gather] = loop_ns(kernels_, FloorLoop::Gather, scratch);
        ns[SceneGather] = loop_ns(kernels_, FloorLoop::SceneGather, scratch, data_->records.data(),
                                  data_->entries[item].data());
        for (std::size_t i = 0; i < FloorBlocks.size(); ++i) {
            fill_entries(scratch, FloorBlocks[i]);
            ns[Backward + i] = loop_ns(kernels_, FloorLoop::Backward, scratch);
        }
    });
}

void FloorBench::measure_bandwidth() {
    data_->waiting = 0;
    pool_.parallel_for(pool_.thread_count(), 1, [this](std::size_t item, std::size_t, unsigned) {
        const std::size_t threads = pool_.thread_count(), size = data_->memory.size();
        data_->start_together(pool_.thread_count());
        const double start = thread_seconds();
        const std::size_t begin = size * item / threads, end = size * (item + 1) / threads;
        std::uint32_t sum = 0;
        for (std::size_t i = begin; i < end; ++i) sum += data_->memory[i];
        data_->sums[item] = sum;
        data_->rates[item] =
            static_cast<double>((end - begin) * sizeof sum) * 1e-9 / (thread_seconds() - start);
    });
}

void FloorBench::measure() {
    measure_loops();
    measure_bandwidth();
    const auto keep = [&](double& least, std::size_t loop) {
        double mean = 0;
        for (const auto& ns : data_->ns) mean += ns[loop] / static_cast<double>(data_->ns.size());
        least = least > 0 ? std::min(least, mean) : mean;
    };
    keep(least_.forward_ns, Forward);
    keep(least_.mask_ns, Mask);
    keep(least_.gather_ns, Gather);
    keep(least_.scene_gather_ns, SceneGather);
    for (std::size_t i = 0; i < FloorBlocks.size(); ++i) keep(least_.backward_ns[i], Backward + i);
    double rate = 0;
    for (const double part : data_->rates) rate += part;
    least_.gigabytes_per_second = std::max(least_.gigabytes_per_second, rate);
}

}  // namespace gse::raster
