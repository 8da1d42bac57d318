// Located -> Edited: the edit loop with a run's model.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/edit/optimise/edit_loop.h"
#include "engine/pipeline/run/edit_quality.h"
#include "engine/pipeline/run/search.h"

namespace gse::pipeline {

/// Callbacks of a running edit; all may be empty.
struct EditObserver {
    edit::SnapshotCallback snapshot;
    double snapshot_seconds = 0;  // above 0: time between snapshots, instead of the request's iterations
    edit::IterationCallback iteration;
    std::optional<edit::EditSnapshot> start = {};  // goes on from there
    // These three: see edit::EditTools.
    std::function<std::optional<std::vector<std::uint8_t>>()> new_label = {};
    std::function<void(const edit::ViewTargets&)> targets = {};
    std::function<std::vector<edit::TargetOrder>()> target_orders = {};
    // Once, of the first views that were redrawn.
    std::function<void(const EditQuality&, const edit::ViewTargets&)> judged = {};
};

/// Outcome for the scene. A value.
struct Edited {
    edit::EditResult result;
    GaussianSet drawn;  // the result without what cannot be drawn
    std::vector<edit::ViewTargets>
        targets;  // of view guidance: every round that was fitted, as it was in the end
    std::optional<EditQuality> verdict;  // of view guidance: whether the first redrawn views show the edit
    std::vector<Mask> touched;  // where nothing is drawn: pixels of each view that may differ; else empty
    std::string key;  // of all that it follows from, beside scene, model and what the artist did meanwhile
    neural::NetworkUse use;  // what the loop has asked for
    double seconds = 0;      // that it took, with what the artist was waited for
};

/// The guidance's settings with the sentence before the edit, worked out from the edit's where none is
/// given.
neural::SdsParameters with_sentence_before(neural::SdsParameters guidance,
                                           const language::EditSentence& sentence);

/// Instruction for a model that edits pictures by instructions.
std::string told_to_editor(const edit::CheckedRequest& request);

/// The request in words that the model is told: where it has no word for a part that changes, the look of the
/// thing.
edit::CheckedRequest told_to_model(const neural::TextToImage& model, const edit::CheckedRequest& request);

/// Masks, label and seeds for the loop. The recipe counts for how far masks are grown.
edit::EditPlan plan_of(RunContext& context, const Located& located, const CheckedRecipe& recipe);

/// Runs the edit loop with the settings of `recipe`, which agrees with `located.recipe` in what search_key()
/// is of. Throws as edit::run_edit does.
Edited edit_scene(RunContext& context, const Located& located, const edit::EditPlan& plan,
                  const CheckedRecipe& recipe, const EditObserver& observer, const JobControl& control);
/// Loop with another scene in place of the context's. The plan is of that one.
Edited edit_scene(RunContext& context, const GaussianSet& scene, const Located& located,
                  const edit::EditPlan& plan, const CheckedRecipe& recipe, const EditObserver& observer,
                  const JobControl& control);

}  // namespace gse::pipeline
