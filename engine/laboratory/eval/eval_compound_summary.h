// Means of sentences with several changes, and their lines of the table.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace gse::bench {

/// Means over the edits of kind "compound" that did not fail, by name; empty without any.
/// "compound_lost_splats" counts splats of earlier steps that a later one changed without a label on them.
/// "compound_colour_error" is that of earlier steps as they ended, "..._at_end" after the later ones.
nlohmann::ordered_json compound_summary(const nlohmann::ordered_json& edits);

/// A line per step, and what was kept of it.
std::string compound_lines(const nlohmann::ordered_json& edits);

}  // namespace gse::bench
