// Plans in plain words, for people.
#pragma once

#include <string>

#include "engine/language/plan/notation/plan.h"

namespace gse::language::plan {

/// One step: "colour: bear, blue", "add: hat (red), worn by bear".
std::string step_text(const Step& step);

}  // namespace gse::language::plan
