// Steps that a sentence asks for, as jobs one after another.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/base/disk_cache.h"
#include "engine/edit/request/sentence_plan.h"
#include "engine/edit/request/step_progress.h"
#include "engine/pipeline/recipe/recipe.h"
#include "engine/pipeline/run/edit_job.h"

namespace gse::pipeline {

/// Steps of a sentence. Without any, the sentence runs as it is typed.
struct EditSteps {
    language::plan::Plan plan;
    language::plan::SceneWords scene;  // before the first step
    std::vector<edit::PlannedStep> steps;
    bool nothing_to_change = false;
    language::plan::ModelAbility model = {};
};

/// Names of the labels of the recipe's scene, as sentences write them. The file is read only where the model
/// does not know each word of the sentence, and where the format keeps labels. Throws Error as load_scene()
/// does.
std::vector<std::string> names_in_scene(const EditRecipe& recipe);

/// The scene's words for a recipe: `given` ("red bear; grass"), else the source and what pictures of the
/// scene tell where they decide. Things that `labels` are named for are there, too.
language::plan::SceneWords words_of_scene(const EditRecipe& recipe, const std::string& given,
                                          const std::vector<std::string>& labels, const JobControl& control,
                                          std::shared_ptr<DiskCache> cache);

/// Takes the label of a project that is named like the recipe's source, where the model does not know that
/// word and nothing else says what may change. True where it did. Throws Error for a broken project.
bool take_named_label(EditRecipe& recipe);

/// Puts known words in the place of unknown ones of the same meaning, in source and sentence alike, and logs
/// them. Nothing where the recipe brings its label, or its source is known.
void take_known_words(EditRecipe& recipe);

/// False for a recipe whose target, mode or label was chosen: its sentence runs as it is.
bool has_steps(const EditRecipe& recipe);

/// Plans the sentence of a recipe that has_steps(). What one of `labels` is named for need not be found.
/// Throws Error (InvalidArgument): the sentence is refused, or a step cannot be done and `partly` is false.
EditSteps steps_of_sentence(const EditRecipe& recipe, const language::plan::SceneWords& scene, bool partly,
                            const std::vector<std::string>& labels = {});

/// Steps that name a word which the model in `folder` cannot find or draw become steps that cannot be done.
/// `request` has the settings. What one of `labels` is named for need not be found. `draws_any_word`: only
/// what is looked for has to be known. `finds_any_word`: and that only where something is added to what no
/// step before has found.
std::vector<edit::PlannedStep> known_to_model(std::vector<edit::PlannedStep> steps,
                                              const edit::EditRequest& request,
                                              const std::filesystem::path& folder,
                                              const std::vector<std::string>& labels = {},
                                              bool draws_any_word = false, bool finds_any_word = false);

/// The recipe of one step that has words.
EditRecipe recipe_of_step(EditRecipe recipe, const edit::PlannedStep& step);

/// The recipe of a sentence that is one edit, with its words completed. Throws Error as edit::check() does.
EditRecipe with_words(EditRecipe recipe);

/// Scene, views and model that a job left, for the job of the next step. `said`: words that earlier steps
/// brought along. `source`: thing that the next step is about. It is not looked for again where the job was
/// about it too.
EditJobInput next_input(EditJob& job, std::vector<std::string> said, const std::string& source);

/// {"plan": notation, "steps": [{"step", "text", "prompt" or "reason"}, ...]}.
nlohmann::ordered_json plan_to_json(const EditSteps& steps);

/// Steps in order, each on the scene that the steps taken before it came to.
class StepSequence {
public:
    /// Makes the job of the first step that is begun.
    using FirstJob = std::function<std::unique_ptr<EditJob>(EditRecipe recipe)>;

    StepSequence(EditRecipe recipe, EditSteps steps);
    std::size_t size() const { return steps_.size(); }
    /// A step in the words of the scene as it is by now. Without words it cannot be done.
    const edit::PlannedStep& step(std::size_t i) const { return steps_.step(i); }
    /// Job of a step that has words. Throws as EditJob's constructors do.
    std::unique_ptr<EditJob> job_of(std::size_t i, const FirstJob& first, const JobControl& control) const;
    /// Goes on from what a step's job came to.
    void take(std::size_t i, std::unique_ptr<EditJob> job);
    /// Goes on from the scene before a step. Later steps are described anew.
    void leave_out(std::size_t i) { steps_.leave_out(i); }
    /// Job of the last step taken; null before one was.
    EditJob* last() const { return job_.get(); }
    /// Number of steps taken.
    std::size_t taken() const { return taken_; }

private:
    EditRecipe recipe_;
    edit::StepProgress steps_;
    std::unique_ptr<EditJob> job_;
    std::vector<std::string> said_;
    std::size_t taken_ = 0;
};

}  // namespace gse::pipeline
