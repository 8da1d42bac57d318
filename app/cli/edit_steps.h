// The steps that an edit's sentence asks for, on the command line.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/engine_names.h"
#include "engine/base/disk_cache.h"
#include "engine/edit/request/sentence_plan.h"
#include "engine/pipeline/recipe/recipe.h"
#include "engine/pipeline/run/edit_job.h"

namespace gse::app {

/// Steps of a sentence. Without any, the sentence runs as it is typed.
struct EditSteps {
    language::plan::Plan plan;
    std::vector<edit::PlannedStep> steps;
    bool nothing_to_change = false;
};

/// Plans the recipe's sentence. `scene_words` ("red bear; grass") say what the scene shows; empty = the
/// source, and what pictures of the scene tell where they decide. A recipe whose target, mode or label was
/// chosen runs as it is. Throws Error (InvalidArgument): the sentence is refused, or a step cannot be done
/// and `partly` is false.
EditSteps steps_of_sentence(const EditRecipe& recipe, const std::string& scene_words, bool partly,
                            const JobControl& control, std::shared_ptr<DiskCache> cache);

/// The recipe of one step.
EditRecipe recipe_of_step(EditRecipe recipe, const edit::PlannedStep& step);

/// Scene, views and model that a job left, for the job of the next step.
pipeline::EditJobInput next_input(EditJob& job, std::vector<std::string> said);

/// {"plan": notation, "steps": [{"step", "prompt" or "reason"}, ...]}.
nlohmann::ordered_json plan_to_json(const EditSteps& steps);

}  // namespace gse::app
