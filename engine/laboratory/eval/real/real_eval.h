// Runs the tasks of a suite of scanned scenes, and leaves figures and contact sheets in a folder.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/base/fields.h"
#include "engine/base/progress.h"
#include "engine/pipeline/recipe/recipe.h"

namespace gse::bench {

/// Settings of an evaluation on scanned scenes.
struct RealParameters {
    std::string real;
    std::string real_modes = "word box click";
    std::string real_only;
    std::vector<std::string> real_root;
    int real_rows = 8;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("real", self.real,
          "Suite of scanned scenes with truth made by hand (JSON). It is measured in place of the edits of "
          "generated scenes.");
        f("real_modes", self.real_modes,
          "Ways to make each edit of --real: word, upright, box, click. A word is the sentence alone. The "
          "others add the true up axis: upright where the program guesses another. A box surrounds the "
          "thing, a click points at it.");
        f("real_only", self.real_only, "Tasks of --real whose name contains this; empty = all.");
        f("real_root", self.real_root,
          "Folder of scenes in place of the one that the suite of --real names, as NAME=FOLDER. It may be "
          "given several times.");
        f("real_rows", self.real_rows, "Tasks of --real on one contact sheet.", Range{1, 100});
    }
};

struct RealRun {
    RealParameters parameters;
    pipeline::EditRecipe settings;  // model, machine, request (its words are the suite's), guidance
};

/// Writes real_NNN.png sheets into `folder` and returns what belongs into eval.json. Stopped early, it
/// returns what was reached with "stopped" true. Throws Error for wrong parameters, a suite or a scene that
/// cannot be read, and where no task has such a name.
nlohmann::ordered_json run_real(const RealRun& run, const std::filesystem::path& folder,
                                const JobControl& job);

}  // namespace gse::bench
