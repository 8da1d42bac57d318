// Things that are removed, resized, moved, turned and copied by a sentence, against the true scenes.
#pragma once

#include <nlohmann/json.hpp>

#include "engine/laboratory/eval/eval_compound.h"

namespace gse::bench {

/// Runs a case of rearranged_kinds() as `gseditpro edit` does, but keeps what is judged to have failed.
/// "rearranged" of the result holds the figures of the kind. Throws Error where the step cannot be done.
nlohmann::ordered_json rearranged_figures(const EvalCase& edit, const pipeline::EditRecipe& recipe,
                                          const CompoundTools& tools, const JobControl& control);

}  // namespace gse::bench
