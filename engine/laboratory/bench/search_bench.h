// Measures how sure searches are: words that a synthetic scene shows against words that it does not show or
// that nobody knows.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>

#include "engine/base/fields.h"
#include "engine/pipeline/run/edit_job.h"

namespace gse::bench {

struct SearchBenchParameters {
    int scenes = 24;
    std::uint64_t seed = 11;
    double least_overlap = 0.5;
    bool ground = true;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("scenes", self.scenes, "Held-out scenes; half a dozen words are looked for in each.",
          Range{1, 10000});
        f("seed", self.seed, "Seed of the scenes and words.");
        f("least_overlap", self.least_overlap,
          "Overlap (IoU) with the true splats from which a search counts as right.", Range{0, 1});
        f("ground", self.ground,
          "Scenes with their ground; without it, things cut out of their surroundings.");
    }
};

/// {"summary": what thresholds refuse, "searches": one entry each}.
nlohmann::ordered_json bench_search(const SearchBenchParameters& parameters,
                                    const pipeline::EditRecipe& settings, const JobControl& job);

}  // namespace gse::bench
