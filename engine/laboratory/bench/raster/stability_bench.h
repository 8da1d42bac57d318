// gseditpro-lab bench stability: error of the rasterizer's kernels on scenes that are hard on them, by cause.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/fields.h"
#include "engine/base/progress.h"
#include "engine/laboratory/bench/charts/subject.h"
#include "engine/laboratory/bench/raster/stability.h"

namespace gse::bench {

struct StabilityParameters {
    int scenes = 20;
    std::uint64_t seed = 1;
    std::string causes = "all";
    std::string kernels = "all";

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("scenes", self.scenes, "Scenes per cause and instruction set.", Range{1, 1e6});
        f("seed", self.seed, "Seed of the first; the others follow.");
        f("causes", self.causes,
          "Causes that make scenes hard: all, or names of the table with commas between them.");
        f("kernels", self.kernels,
          "Instruction sets: all that run here, or some of scalar avx2 avx512; cuda only where it is named.");
    }
};

/// One scene under one instruction set.
struct StabilityRecord {
    std::string cause, kernels;
    std::uint64_t seed = 0;
    double clear_share = 0;
    Disagreement error;
};

/// Decades of an error: the first holds all below 1e-9, the last all from 0.1 on and what is not a number.
constexpr std::size_t ErrorDecades = 10;
std::size_t error_decade(double error);

/// Every cause, seed and instruction set. Throws Error for wrong parameters, and when stopped.
std::vector<StabilityRecord> measure_stability(const StabilityParameters& parameters, const JobControl& job);

/// The histograms of picture and gradient error by cause, with the worst scene of each.
Subject bench_stability(const StabilityParameters& parameters, const JobControl& job);

}  // namespace gse::bench
