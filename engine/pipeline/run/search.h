// Views -> Located: the splats of the scene that an edit is about.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/edit/search/locate.h"
#include "engine/edit/search/second_look.h"
#include "engine/pipeline/run/run_context.h"
#include "engine/pipeline/run/views.h"

namespace gse::pipeline {

/// Orders of the artist beyond the recipe.
struct Hints {
    std::vector<std::uint8_t> label;  // [N] made by hand: says where when the words do not; empty = none
    std::vector<std::string> said;    // words that the scene is known to show: no news
    // [N] the source, as an earlier search found it: it is not looked for again. Empty = it is.
    std::vector<std::uint8_t> found = {};
    std::string label_doubt = {};  // reason to check the label; empty = none is known
    bool label_alone = false;      // the label says where, whatever the words find
    bool by_differences = false;  // the server of the run is asked where the thing is, and not the model here
};

/// Tells whether a recipe has its thing looked for by what its server changes; `known`: words of the model,
/// empty = any. Throws Error (InvalidArgument) where that is asked for an edit whose change is not the thing.
bool searches_by_differences(const CheckedRecipe& recipe, const std::vector<std::string>& known);

/// Pictures that such a search asks for, and once more where it looks from nearer.
int pictures_of_differences(const CheckedRecipe& recipe);

/// Result of a search. A value: another threshold or a corrected label makes another one.
struct Located {
    Views views;                      // where it was found from
    CheckedRecipe recipe;             // for which: with the word that the pictures said is new
    std::vector<std::uint8_t> label;  // by hand, where that alone says what may change; empty = the words did
    edit::LocateResult result;
    bool target_read = false;               // the pictures said which word is new, and not the recipe
    std::string key;                        // of all that it follows from, beside the scene and the model
    std::vector<std::uint8_t> within = {};  // [N] the thing, where a part of it was looked for
    bool by_differences = false;            // the server's changes told where it is
    std::string label_doubt = {};           // reason to check the label that was found; empty = none

    bool found() const { return result.problem == edit::SearchProblem::None; }
    bool by_label() const { return !label.empty(); }
};

/// Searches a scene. Finds the new word if it is open, looks from all views, moves in on the found label and
/// looks again. With a label made by hand, unknown words are not looked for, and one that is not found does
/// no harm. A search without a result is a result too: see found().
///
/// Excluded views of the recipe count among those that the search ends
/// with. Throws Error (Cancelled) on a stop request, and for failures of the tools.
Located locate(RunContext& context, const CheckedRecipe& recipe, const Views& views, const Hints& hints,
               const JobControl& control);

/// Search from its own views for a recipe of equal search_key(): other thresholds. Networks are only asked
/// new questions.
Located locate_again(RunContext& context, const Located& located, const CheckedRecipe& recipe,
                     const JobControl& control);

/// Search with a label made by hand, [N] 0 or 1, which alone is the scope of the edit.
Located locate_by_label(RunContext& context, const Located& located, std::vector<std::uint8_t> label,
                        const JobControl& control);

/// The label corrected by hand, [N] 0 or 1 (modify mode).
Located with_label(const Located& located, const std::vector<std::uint8_t>& bits);

/// Finding of a search, for a second look at it. Refers to its arguments.
edit::Finding finding_of(const RunContext& context, const Located& located);

/// Question that a recipe puts to its views. Refers to its arguments.
edit::LocateInput question(const RunContext& context, const CheckedRecipe& recipe, const Views& views,
                           const std::vector<std::uint8_t>* label);

}  // namespace gse::pipeline
