// Error of edits against their cost, by methods and settings: a Pareto picture over the evaluation's suite.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "engine/base/fields.h"
#include "engine/laboratory/bench/charts/subject.h"
#include "engine/pipeline/run/edit_job.h"

namespace gse::bench {

struct EditBenchParameters {
    std::uint64_t seed = 1;
    int edits = 12;
    std::string kinds = "recolour material add ground";
    std::string mode = "auto";
    int held_out_views = 12;
    bool oracle_views = false;
    std::string sds = "25 50 100 200 rest";
    std::string redraws = "draft 8x1x1 8x4x1 8x2x2 fine";

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("seed", self.seed, "Seed of the suite: which edits, and the scenes' shapes.");
        f("edits", self.edits, "Synthetic edits with ground truth.", Range{1, 10000});
        f("kinds", self.kinds, "Kinds of edits, in turn: recolour material add ground.");
        f("mode", self.mode, "Mode the edits are asked for: auto, or right (modify or add, as each needs).");
        f("held_out_views", self.held_out_views,
          "Views between those of the edit, on which the result is compared.", Range{1, 512});
        f("oracle_views", self.oracle_views,
          "The edits are given cameras that know the scene's framing and front, and the new word.");
        f("sds", self.sds,
          "Points of method sds: iterations, or \"rest\" (the default's, until no view changes any more), "
          "several with spaces between.");
        f("redraws", self.redraws,
          "Points of method views: views x steps x rounds, as 8x4x1, or a quality, several with spaces "
          "between.");
    }
};

/// Runs every edit of the suite as `eval` does, once per point after one search; the settings' own points are
/// among them and marked. Writes pareto.png and the evaluation's sheets into `folder` and returns {"curves",
/// "search", "evaluation", ...}. Throws Error for wrong parameters.
nlohmann::ordered_json bench_edit(const EditBenchParameters& parameters, const pipeline::EditRecipe& settings,
                                  const std::filesystem::path& folder, const JobControl& job);

/// Subject of a report of bench_edit(), with its picture; the evaluation is left out.
Subject edit_bench_subject(nlohmann::ordered_json report);

}  // namespace gse::bench
