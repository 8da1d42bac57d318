// Table of ways to make a server's views agree.
#include "app/laboratory/server_table.h"

#include <fmt/format.h>

#include "engine/base/file.h"
#include "engine/pipeline/models/installed.h"

namespace gse::app {

void write_server_table(const bench::ServerBenchParameters& parameters, const std::filesystem::path& output,
                        const JobControl& job) {
    const auto rows = bench::bench_server(pipeline::assets_path() / "scenes/bear/scene.ply", parameters, job);
    if (!output.empty()) write_file(output, bench::agreement_json(rows).dump(2) + "\n");
    fmt::print("{}", bench::agreement_text(rows));
}

}  // namespace gse::app
