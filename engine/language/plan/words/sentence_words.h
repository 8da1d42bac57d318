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

/// Word one slip away from `typed` (letter left out, doubled, wrong, swapped): one of `needed`, else one of
/// the lexicon; empty where there is none.
std::string mended(std::string_view typed, std::span<const std::string> needed, bool needed_only = false);

}  // namespace gse::language::plan
