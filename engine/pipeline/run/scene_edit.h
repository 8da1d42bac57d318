// The parts of one edit of a located scene.
#pragma once

#include <string>

#include "engine/edit/optimise/edit_loop.h"
#include "engine/neural/api/sds_parameters.h"
#include "engine/pipeline/run/loop.h"

namespace gse::pipeline {

/// One edit. Refers to all it names; `scene` is the one of the plan, in place of the context's.
struct SceneEdit {
    RunContext& context;
    const GaussianSet& scene;
    const Located& located;
    const edit::EditPlan& plan;
    const CheckedRecipe& recipe;
    const EditObserver& observer;
    const JobControl& control;
};

/// Tools without a lead, for an edit that is told `sentence`; `attention` and `segmenter` stay alive.
edit::EditTools tools_of(const SceneEdit& scene_edit, const language::EditSentence& sentence,
                         edit::AttentionSource& attention, edit::Segmenter& segmenter);

/// Takes over a result of a loop with these settings.
Edited finished(const SceneEdit& scene_edit, const edit::LoopSettings& settings, edit::EditResult result);

}  // namespace gse::pipeline
