// gseditpro-lab bench raster: error against time of the rasterizer, per instruction set and number of
// threads.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/fields.h"
#include "engine/base/progress.h"
#include "engine/laboratory/bench/charts/subject.h"

namespace gse::bench {

struct RasterSweepParameters {
    int splats = 100000;
    std::uint64_t seed = 0;
    int width = 512, height = 512;
    int views = 4;
    int repetitions = 5;
    std::string kernels = "all";
    std::string thread_counts = "1 2";
    std::string floor_cases = "100000@512x512 500000@512x512 100000@1024x768";

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("splats", self.splats, "Splats of the generated scene.", Range{1, 2e7});
        f("seed", self.seed, "Its seed.");
        f("width", self.width, "Picture width.", Range{1, 8192});
        f("height", self.height, "Picture height.", Range{1, 8192});
        f("views", self.views, "How many cameras to use.", Range{1, 1000});
        f("repetitions", self.repetitions, "Timed rounds over them, after one to warm up.", Range{1, 10000});
        f("kernels", self.kernels,
          "Instruction sets: all that run here, or some of scalar avx2 avx512; cuda only where it is named.");
        f("thread_counts", self.thread_counts, "Numbers of threads; one per core is always among them.");
        f("floor_cases", self.floor_cases,
          "Scenes and pictures, SPLATS@WIDTHxHEIGHT, for which forward and backward are compared with the "
          "floor of this machine.");
    }
};

/// The instruction sets that a list names: "all" that run here, or some of them and "cuda". Throws Error
/// (InvalidArgument).
std::vector<std::string> kernels_in_list(const std::string& list);

/// Measures forward and backward pass over a generated scene (synth/timing_scene.h): wall time per picture,
/// least of the rounds. Errors are the largest of a pixel and the relative one of the gradient, both to the
/// plain double version. Throws Error for wrong parameters, and when stopped.
Subject bench_raster_sweep(const RasterSweepParameters& parameters, const JobControl& job);

}  // namespace gse::bench
