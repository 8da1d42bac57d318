// How right labels are, by how sure their searches said they were.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace gse::bench {

/// Reliability of searches by word, a line per range of the confidence. A line holds the number of labels,
/// their mean IoU, and the share of labels whose IoU is at least 0.8. `drawn`: eval.json of each seed.
/// `scans`: report of `eval --real`, or null. Empty where there is neither.
std::string reliability_table(const std::vector<nlohmann::ordered_json>& drawn,
                              const nlohmann::ordered_json& scans);

}  // namespace gse::bench
