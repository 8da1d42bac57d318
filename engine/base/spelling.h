// Suggestions for words that are not known.
#pragma once

#include <string>
#include <vector>

namespace gse {

/// Levenshtein distance of two words as a share of the longer one's length: 0 = equal, 1 = nothing in common.
double spelling_distance(const std::string& a, const std::string& b);

/// Word of `known` that is spelled most like `word`. Empty when none shares at least half of it.
std::string nearest_word(const std::string& word, const std::vector<std::string>& known);

}  // namespace gse
