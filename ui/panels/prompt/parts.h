// Parts of the Prompt panel.
#pragma once

#include "ui/model/context.h"

namespace gse::ui {

/// Changes that the sentence asks for, each with a tick. Nothing for a sentence that is told as it is typed.
void draw_plan(Context& context);

/// Every setting of the recipe, each with its default.
void draw_advanced(Context& context);

}  // namespace gse::ui
