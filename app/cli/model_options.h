// The options that say which model a command loads, and with what.
#pragma once

#include <CLI/CLI.hpp>

#include "engine/pipeline/recipe/recipe.h"

namespace gse::app {

/// --model, --lora (any number of times), --taesd, --segmenter, --text-segmenter, --precision.
void add_model_options(CLI::App& command, pipeline::JobParameters& job);

}  // namespace gse::app
