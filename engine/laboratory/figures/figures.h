// Measures what engine/FIGURES.md holds, and writes that page.
#pragma once

#include <filesystem>
#include <string>

#include "engine/base/fields.h"
#include "engine/base/progress.h"
#include "engine/pipeline/recipe/recipe.h"

namespace gse::bench {

struct FiguresParameters {
    std::string seeds = "1 2";
    std::string suites = "edits words searches encoder methods servers stability speed real";
    std::string real;
    std::string verdicts;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("seeds", self.seeds, "Seeds of the evaluations, with spaces between.");
        f("suites", self.suites,
          "Suites to measure: edits words searches encoder methods servers stability speed real. Results of "
          "the others are taken where the folder has them.");
        f("real", self.real,
          "Suite of scanned scenes with truth made by hand (JSON), as eval takes it; empty = it is not "
          "measured.");
        f("verdicts", self.verdicts,
          "Verdicts by eye on the edits of that suite: a JSON object of tasks. Each has a text for \"word\", "
          "\"box\" and \"click\" that begins with the verdict (\"success: a little pale\"). Empty = none.");
    }
};

struct FiguresRun {
    FiguresParameters parameters;
    pipeline::EditRecipe settings;  // model and machine
    std::filesystem::path
        results;  // a folder per evaluation and a file per bench, as their own commands leave them
};

/// Measures the results that `results` does not hold yet, keeps them there, and returns the page as Markdown.
/// Throws Error (InvalidArgument) for an unknown suite or a seed that is no number. Throws Error (Malformed)
/// for a result of other settings, and (Cancelled) on a stop request. Finished results stay.
std::string figures_page(const FiguresRun& run, const JobControl& job);

}  // namespace gse::bench
