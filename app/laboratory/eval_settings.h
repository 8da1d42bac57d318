// The options of `eval` and `bench edit` that set how the suite's edits are made.
#pragma once

#include <CLI/CLI.hpp>

#include "app/engine_names.h"
#include "engine/pipeline/run/edit_job.h"

namespace gse::app {

/// Model, machine, and every field of the request and the guidance that the suite does not set itself.
void add_eval_settings(CLI::App& command, EditRecipe& settings);
/// Sets what the command line leaves open as the model states it.
void apply_eval_model(const CLI::App& command, EditRecipe& settings);

}  // namespace gse::app
