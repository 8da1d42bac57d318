// The commands of gseditpro-lab, which only developers use.
#pragma once

#include "app/cli/cli.h"
#include "app/engine_names.h"

namespace gse::bench {}
namespace gse::training {}

namespace gse::app {

using namespace bench;
using namespace training;

void add_synth_command(CLI::App& app, CommandContext& context);
void add_training_command(CLI::App& app, CommandContext& context);  // train-starter
void add_bench_command(CLI::App& app, CommandContext& context);
void add_eval_command(CLI::App& app, CommandContext& context);
void add_figures_command(CLI::App& app, CommandContext& context);

}  // namespace gse::app
