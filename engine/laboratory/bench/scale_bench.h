// gseditpro-lab bench scale: how time and memory grow with splats, pixels, views and the labelled share.
#pragma once

#include <cstdint>
#include <string>

#include "engine/base/fields.h"
#include "engine/laboratory/bench/charts/subject.h"
#include "engine/pipeline/run/edit_job.h"

namespace gse::bench {

struct ScaleBenchParameters {
    std::uint64_t seed = 0;
    std::string splats = "1000 3000 10000 30000 100000 300000 1000000 3000000";
    std::string sizes = "64 128 256 512 1024 2048";
    std::string views = "4 8 16 32 64 96";
    std::string shares = "0.01 0.03 0.1 0.3 1";
    int usual_splats = 100000;
    int usual_size = 512;
    int repetitions = 3;
    double limit_seconds = 30;
    int limit_mb = 8192;
    bool search = true;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("seed", self.seed, "Seed of the generated scenes.");
        f("splats", self.splats, "Numbers of splats.");
        f("sizes", self.sizes, "Sides of the picture, pixels.");
        f("views", self.views,
          "Numbers of views of a search, and of a back-projection of masks onto splats.");
        f("shares", self.shares, "Labelled shares of the splats, for the backward pass.");
        f("usual_splats", self.usual_splats, "Splats where something else grows.", Range{1, 2e7});
        f("usual_size", self.usual_size, "Side of the picture where something else grows, pixels.",
          Range{16, 8192});
        f("repetitions", self.repetitions, "Timed runs of a point, after one to warm up; the least counts.",
          Range{1, 1000});
        f("limit_seconds", self.limit_seconds,
          "Points that would take longer, all runs together, are left out.", Range{0.001, 1e6});
        f("limit_mb", self.limit_mb, "Points that would take more memory are left out, MiB.", Range{1, 1e7});
        f("search", self.search, "Also search with growing numbers of views (asks the model).");
    }
};

/// Measures wall times and the peak of memory above what the process held before, on generated scenes. Growth
/// exponents are slopes of least-squares lines through the logarithms, over all points and over the larger
/// half. Throws Error for wrong parameters, a model that cannot be read, and when stopped.
Subject bench_scale(const ScaleBenchParameters& parameters, const pipeline::EditRecipe& settings,
                    const JobControl& job);

}  // namespace gse::bench
