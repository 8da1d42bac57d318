// Means of an evaluation on scanned scenes, and a table to read.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace gse::bench {

/// Result below which a run is looked at: of the label's IoU, the share of new splats in place, and the share
/// of the truth that visibly changes.
constexpr double LeastIou = 0.5, LeastPlace = 0.3, LeastSeenChange = 0.2;

/// Figures from the "tasks" and "scenes" of run_real():
/// - "groups": by word of known nouns, by word of unknown nouns, upright, by box. Means and medians are over
///   runs in which something was made; an addition without a new splat has a place share of 0.
/// - "silent": runs that are done, not amber, and below one of the limits, with what is low.
/// - "up": scenes whose up axis is guessed right, guessed wrong, or asked for.
/// - "front": by mode, runs in which the front was read about the true up axis, and their errors in degrees.
nlohmann::ordered_json real_summary(const nlohmann::ordered_json& report);

/// One line per run, the summary, and where each task is on the sheets.
std::string real_table(const nlohmann::ordered_json& report);

}  // namespace gse::bench
