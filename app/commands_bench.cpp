// gseditpro bench.
#include "app/cli.h"

namespace gse::app {

void add_bench_command(CLI::App&, CommandContext&) {}

}  // namespace gse::app
