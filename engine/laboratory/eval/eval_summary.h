// Means of an evaluation beside their goals, and tables to read.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace gse::bench {

/// From the "edits" (and, where run, "ablations") of an evaluation: per figure {"value", "goal", "met"};
/// value null = there was nothing to measure it with. A failed edit has found, changed and covered nothing:
/// it counts as zero there; what it would have kept unchanged is no merit and is left out.
nlohmann::ordered_json eval_summary(const nlohmann::ordered_json& report);

/// One line per edit, the means, the ablations, the real scenes.
std::string eval_table(const nlohmann::ordered_json& report);

}  // namespace gse::bench
