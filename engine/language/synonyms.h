// Other words for a known one, so that an unknown noun need not be pointed at.
#pragma once

#include <string>
#include <vector>

namespace gse::language {

/// Word of a phrase that another one stands in for.
struct OtherWord {
    std::string typed;  // "puppy"
    std::string known;  // "dog"
};

/// A phrase in words that a model knows.
struct KnownPhrase {
    std::string text;
    std::vector<OtherWord> replaced;  // in their order
};

/// The known word that `word` is another name of, in the singular or plural; empty where there is none, or
/// where the word is known itself. Words share a synset of WordNet, or one names a direct kind or the young
/// of the other that looks like it. "seal" is no "bear".
std::string known_synonym(const std::string& word, const std::vector<std::string>& known);

/// The phrase with every unknown word that has a known synonym replaced. All else of it stays as it is
/// written.
KnownPhrase in_known_words(const std::string& phrase, const std::vector<std::string>& known);

/// `Looks for "dog": "puppy" is another word for it`.
std::string other_word_text(const OtherWord& word);

}  // namespace gse::language
