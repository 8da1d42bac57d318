// The options of `edit` and `eval` that let the model learn the scene first.
#pragma once

#include <CLI/CLI.hpp>

#include "app/engine_names.h"
#include "engine/pipeline/run/edit_job.h"

namespace gse::app {

/// --dreambooth and every field of DreamBoothParameters as --dreambooth-NAME.
void add_dreambooth_options(CLI::App& command, EditRecipe& recipe);

}  // namespace gse::app
