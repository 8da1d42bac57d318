// Words of a cleaned sentence: split, in one spelling, slips of one letter mended; or what it is instead.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/language/plan/words/lexicon.h"

namespace gse::language::plan {

struct SentenceWords {
    std::vector<Word> words;
    std::string_view refused;          // language, not a sentence; else empty
    std::vector<std::string> unknown;  // words that are none, and near to none
};

/// `needed`: words of the scene and of the source, lower case; misspelt words are these before others.
SentenceWords sentence_words(std::string_view clean, std::span<const std::string> needed);

/// Words one slip away from `typed` (letter left out, doubled, wrong, swapped), likely ones first, at most
/// `most`: those of `needed`, then those of the lexicon.
std::vector<std::string> slips_of(std::string_view typed, std::span<const std::string> needed,
                                  std::size_t most);

}  // namespace gse::language::plan
