// Sentences with several changes: figures of each step, and of what the later ones left of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/laboratory/eval/eval_figures.h"
#include "engine/laboratory/eval/eval_sheet.h"
#include "engine/language/plan/notation/plan.h"
#include "engine/pipeline/run/edit_job.h"

namespace gse::bench {

/// Tools of a compound evaluation; all outlive it.
struct CompoundTools {
    EvalTools eval;
    const std::shared_ptr<neural::TextToImage>& model;
    ContactSheets& sheets;
    int held_out_views = 0;
};

/// Words of a spec's scene, as "red bear; blue hat; grass".
std::string scene_words_of(const synth::SceneSpec& spec);

/// A step of a plan as a case of its own, in a scene of that spec. Throws Error (InvalidArgument) for an
/// operation that the synthetic world does not have.
EvalCase case_of_step(const synth::SceneSpec& source, const language::plan::Step& step);

/// Parts of the rows of a result, [rows of its set]. What is new is of `part`; ground that an old thing hid
/// is ground. `before` holds the parts of the base.
std::vector<synth::Part> parts_after(const std::vector<synth::Part>& before, const edit::EditResult& result,
                                     synth::Part part);

/// Rows that a step was allowed to change, and what became of them.
struct KeptRows {
    std::size_t rows = 0;  // labelled by the step
    std::size_t met = 0;   // of these, labelled by a later step, too
    std::size_t lost = 0;  // of the others, gone or different in any bit at the end
};

/// One step's result, and the base's label of the step after it ([rows of the result's set]).
struct StepRows {
    const edit::EditResult* result = nullptr;
    std::vector<std::uint8_t> next_label;  // empty for the last step
};

/// Rows of step `k` at the end of all steps.
KeptRows kept_rows(const std::vector<StepRows>& steps, std::size_t k);

/// Runs the steps of a case of kind "compound" as `gseditpro edit` does, but keeps what is judged to have
/// failed. Figures: "steps", each with those of its kind and "judgement", and "kept" per step. Throws Error
/// where a step cannot be done.
nlohmann::ordered_json compound_figures(const EvalCase& edit, const pipeline::EditRecipe& recipe,
                                        const CompoundTools& tools, const JobControl& control);

}  // namespace gse::bench
