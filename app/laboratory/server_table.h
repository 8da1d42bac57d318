// Ways to make a server's views agree, as a table: bench server and eval --server.
#pragma once

#include <filesystem>

#include "engine/base/progress.h"
#include "engine/laboratory/bench/server_bench.h"

namespace gse::app {

/// Measures on the bundled scene and prints the table. `output`: file for the figures as JSON; empty = none.
/// Throws Error as bench::bench_server().
void write_server_table(const bench::ServerBenchParameters& parameters, const std::filesystem::path& output,
                        const JobControl& job);

}  // namespace gse::app
