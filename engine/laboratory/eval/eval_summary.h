// Means of an evaluation beside their goals, and tables to read.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace gse::bench {

/// Figures from the "edits" (and, where run, "ablations") of an evaluation: per figure {"value", "goal",
/// "met"}. A null value had nothing to be measured with. A failed edit counts as zero where it found, changed
/// and covered nothing. It is left out where keeping things unchanged is measured.
nlohmann::ordered_json eval_summary(const nlohmann::ordered_json& report);

/// One line per edit, the means, the ablations, the real scenes.
std::string eval_table(const nlohmann::ordered_json& report);

}  // namespace gse::bench
