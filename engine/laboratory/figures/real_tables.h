// Tables of engine/FIGURES.md on scanned scenes.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace gse::bench {

/// Groups of runs in columns, refusals, up axes and fronts, and a line per task. `report`: eval.json of
/// `gseditpro-lab eval --real`. Runs that were stopped early have fewer tasks. `verdicts`: by eye, task ->
/// {"word" | "box" | "click": text}, counted by the text before a colon. Throws Error (Malformed) for others.
std::string real_tables(const nlohmann::ordered_json& report,
                        const nlohmann::ordered_json& verdicts = nlohmann::ordered_json::object());

}  // namespace gse::bench
