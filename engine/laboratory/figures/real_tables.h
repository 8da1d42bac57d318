// Tables of engine/FIGURES.md on scanned scenes.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace gse::bench {

/// Groups of runs in columns, refusals, up axes and fronts, and a line per task. `report`: eval.json of
/// `gseditpro-lab eval --real`. Runs that were stopped early have fewer tasks.
std::string real_tables(const nlohmann::ordered_json& report);

}  // namespace gse::bench
