// Lines and means of edits that remove, resize, move, turn and copy.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace gse::bench {

/// Figures of summaries, by name: means, of errors and counts the largest; nothing without such edits.
/// `edits` are those of a report.
nlohmann::ordered_json rearranged_summary(const nlohmann::ordered_json& edits);

/// A line per edit and one per kind.
std::string rearranged_lines(const nlohmann::ordered_json& edits);

}  // namespace gse::bench
