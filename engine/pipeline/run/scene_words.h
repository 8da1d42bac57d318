// Words of a scene as the model's picture encoder sees it: colour or material of the source, and the ground.
#pragma once

#include "engine/base/progress.h"
#include "engine/language/plan/words/scene_words.h"
#include "engine/pipeline/run/run_context.h"

namespace gse::pipeline {

/// Adds to `scene` what pictures of the views show of the request's source. It gets the one word for colour
/// or material that fits best, and the scene the ground that fits best, in place of an assumed one. Only
/// words that the model knows are compared (VocabularyRanker::fit()). The scene as it is where the model has
/// no encoder or takes any word. Throws Error (Cancelled) on a stop request.
language::plan::SceneWords scene_words_shown(RunContext& context, const CheckedRecipe& recipe,
                                             const Views& views, language::plan::SceneWords scene,
                                             const JobControl& control);

}  // namespace gse::pipeline
