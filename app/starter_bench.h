// Measures a model on held-out synthetic scenes: does a word find its splats, does an edit reach the true target?
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>

#include "app/edit_job.h"

namespace gse::app {

struct StarterBenchParameters {
    int scenes = 12;
    int recolours = 3;
    int additions = 2;
    std::uint64_t seed = 1000;

    template <class Self, class F>
    static void visit_fields(Self& self, F&& f) {
        f("scenes", self.scenes, "Held-out scenes on which the object's word is located.", Range{0, 10000});
        f("recolours", self.recolours, "Bears to turn from red to blue.", Range{0, 10000});
        f("additions", self.additions, "Bears to put a hat on.", Range{0, 10000});
        f("seed", self.seed, "Seed of the scenes.");
    }
};

/// {"localization", "recolour", "add"} with a list of cases and their means.
nlohmann::ordered_json run_starter_bench(const StarterBenchParameters& parameters, const EditRecipe& settings,
                                         const JobControl& job);

}  // namespace gse::app
