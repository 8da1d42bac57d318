// The door of this room: a sentence becomes a plan.
#pragma once

#include <string_view>

#include "engine/language/plan/notation/plan.h"
#include "engine/language/plan/words/scene_words.h"

namespace gse::language::plan {

/// Reads what a careful person takes the sentence to ask for in that scene. `source`: what the user typed as
/// the thing that the scene is about; may be empty. Pure; never throws for a text. Words that were not
/// understood and could matter make a refusal.
Plan plan_sentence(std::string_view sentence, const SceneWords& scene, std::string_view source);

}  // namespace gse::language::plan
