// Sentences for models of a fixed vocabulary.
#pragma once

#include <string>
#include <vector>

namespace gse::neural {

/// The sentence without words that are not in `known` (lower case), its punctuation reduced to commas.
/// `signs`: characters that are words of their own, and stay.
std::string filter_to_vocabulary(const std::string& sentence, const std::vector<std::string>& known,
                                 const std::string& signs = {});

}  // namespace gse::neural
