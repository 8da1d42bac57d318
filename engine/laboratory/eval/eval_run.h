// Runs the suite of edits, its ablations and real scenes, and leaves figures and pictures in a folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/base/fields.h"
#include "engine/pipeline/run/edit_job.h"

namespace gse::bench {

/// Settings of an evaluation.
struct EvalParameters {
    std::uint64_t seed = 1;
    int edits = 30;
    std::string kinds = "recolour material add ground replace";
    std::string mode = "auto";
    int held_out_views = 12;
    bool oracle_views = false;
    bool ablations = false;
    int ablation_edits = 6;
    bool drawn_words = false;
    bool scanned = false;
    // Above the scores of pictures in which something else changed (`gseditpro-lab bench clip`).
    double success_direction = 0.25;
    int sheet_rows = 6;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("seed", self.seed, "Seed of the suite: which edits, and the scenes' shapes.");
        f("edits", self.edits, "Synthetic edits with ground truth.", Range{0, 10000});
        f("kinds", self.kinds,
          "Kinds of edits, in turn: recolour material add ground replace. Others are \"dye\" (colours that "
          "the bundled model does not look for) and \"compound\" (two or three changes in one sentence). "
          "Nothing is drawn for \"remove\", \"resize\", \"move\", \"rotate\" and \"duplicate\".");
        f("drawn_words", self.drawn_words,
          "Name added and replacing objects by words that the bundled model draws and does not look for.");
        f("scanned", self.scanned,
          "Begin replacements with scenes that lack the ground which no view of a scan shows.");
        f("mode", self.mode,
          "Mode the edits are asked for: auto, or right (modify, replace or add, as each needs).");
        f("held_out_views", self.held_out_views,
          "Views between those of the edit, on which the result is compared.", Range{1, 512});
        f("oracle_views", self.oracle_views,
          "An ablation: the edits are given cameras that know the scene's framing and front, and the word "
          "that is new.");
        f("ablations", self.ablations, "Also run the first edits without parts of the method, and compare.");
        f("ablation_edits", self.ablation_edits, "How many edits the ablations are run on.", Range{1, 10000});
        f("success_direction", self.success_direction,
          "A text-image direction above this counts as success (without a text-image encoder there is no "
          "such figure).",
          Range{-1, 1});
        f("sheet_rows", self.sheet_rows, "Edits on one contact sheet.", Range{1, 100});
    }
};

/// Other settings of the loop, with which every edit is repeated after its search.
struct EvalVariant {
    std::string name, meaning;
    nlohmann::ordered_json settings;  // of the request
};

struct EvalRun {
    EvalParameters parameters;
    pipeline::EditRecipe settings;      // model, machine, request (its words are the suite's), guidance
    std::vector<EvalVariant> variants;  // beside the ablations, and reported with them
    std::vector<std::string> scenes;    // real ones: "PATH" or "PATH:source:sentence:target"
};

/// Writes eval_NNN.png sheets into `folder` and returns what belongs into eval.json. Stopped early, it
/// returns what was reached with "stopped" true. Throws Error for wrong parameters, a model or a scene that
/// cannot be read.
nlohmann::ordered_json run_eval(const EvalRun& run, const std::filesystem::path& folder,
                                const JobControl& job);

}  // namespace gse::bench
