// Signs that a plan misses what its sentence says.
#pragma once

#include <span>
#include <string_view>

#include "engine/language/plan/notation/plan.h"
#include "engine/language/plan/words/lexicon.h"
#include "engine/language/plan/words/scene_words.h"

namespace gse::language::plan {

/// Reason to refuse the plan rather than to guess; empty where every word that matters is in it.
std::string_view doubt(std::span<const Word> words, const SceneWords& scene, const Plan& plan);

}  // namespace gse::language::plan
