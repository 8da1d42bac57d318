// Least time that forward and backward could take on this machine, from the work that was counted. It adds
// the innermost loops alone with everything in the first cache, the handling of lists, and memory bandwidth.
// Lists fetch a record per tile and Gaussian from where a scene's records lie.
#pragma once

#include <array>
#include <cstddef>
#include <memory>

#include "engine/base/thread_pool.h"

namespace gse::raster {

struct Kernels;

/// Blocks per (tile, Gaussian) for which the backward loop is timed. Its sums are added up once per (tile,
/// Gaussian).
inline constexpr std::array<int, 5> FloorBlocks{1, 2, 4, 8, 16};

/// Nanoseconds of one thread while all of them run, and their common reads from memory.
struct KernelFloor {
    double forward_ns = 0;                                 // per 4x4 block and Gaussian
    std::array<double, FloorBlocks.size()> backward_ns{};  // the same, by FloorBlocks
    double mask_ns = 0;                                    // per tile and Gaussian
    double gather_ns = 0;                                  // the same, of records in the first cache
    double scene_gather_ns = 0;  // the same, of as many records as the scene has, in any order
    double gigabytes_per_second = 0;
};

/// Counted work of a picture.
struct FloorWork {
    std::size_t splats = 0;
    std::size_t sh_floats = 48;         // per splat
    std::size_t pairs = 0, blocks = 0;  // ForwardOutput::pairs_reached, block_pairs
    unsigned threads = 1;
};

/// Milliseconds, with the work shared evenly among the threads.
struct FloorStep {
    double forward_blend = 0, backward_blend = 0;
    double lists = 0;           // block masks and a scene's records, forward and backward
    double lists_in_cache = 0;  // the same if all records lay in the first cache; not in the total
    double parameters = 0, parameter_gradients = 0;  // read once; read and written once
    double total() const { return forward_blend + backward_blend + lists + parameters + parameter_gradients; }
};

FloorStep floor_step(const KernelFloor& kernel, const FloorWork& work);

/// Times the loops, each for some milliseconds on all threads at once.
class FloorBench {
public:
    /// `records` is the number of drawn rows, each with one record.
    FloorBench(const Kernels& kernels, ThreadPool& pool, std::size_t records);
    ~FloorBench();
    /// Measures once more. The least times stay.
    void measure();
    const KernelFloor& least() const { return least_; }

private:
    struct Data;
    void measure_loops();
    void measure_bandwidth();

    const Kernels& kernels_;
    ThreadPool& pool_;
    std::unique_ptr<Data> data_;
    KernelFloor least_;
};

}  // namespace gse::raster
