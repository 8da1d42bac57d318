// Edits in which nothing is drawn: a thing is removed and its hole healed, or it is moved, turned, resized,
// copied.
#pragma once

#include "engine/pipeline/run/scene_edit.h"

namespace gse::pipeline {

/// Removes or transforms what the plan labels (EditPlan::label, [N]). No network is asked. The result has
/// iterations = 1. Rows that healing lays are marked as EditResult::hole_fill. Throws Error (InvalidArgument)
/// where nothing is labelled, or the change cannot be made.
Edited rearranged_scene(const SceneEdit& scene_edit);

}  // namespace gse::pipeline
