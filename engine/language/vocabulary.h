// Models of a fixed vocabulary: what of a sentence they are told, what is left out, and words near to that.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gse::language {

/// A word as a model of a fixed vocabulary takes it.
struct VocabularyMatch {
    std::vector<std::string> kept;      // the word itself, or the known parts of a hyphenated one
    std::vector<std::string> left_out;  // its other parts; the whole word where no part is known
};

VocabularyMatch match_word(const std::string& word, const std::vector<std::string>& known);

/// The sentence as a model of the words `known` (lower case) is told it: known words, and commas between
/// them. `signs`: characters that are words of their own, and stay.
std::string filter_to_vocabulary(std::string_view sentence, const std::vector<std::string>& known,
                                 std::string_view signs = {});

/// Tells whether every word of the phrase is in `known`, as it is written; an empty list stands for a model
/// that takes any word.
bool vocabulary_contains(const std::vector<std::string>& known, std::string_view phrase);

/// The first word of the phrase that is not in `known`; empty where all are, or `known` is empty.
std::string unknown_word(const std::vector<std::string>& known, std::string_view phrase);

/// Known words to say instead of `word`, at most `most`, each naming or describing something. Its singular or
/// plural if that is known; else words of its meaning, then of its kind; else those one letter away from it.
/// Empty where none is: words that share letters by chance mean something else.
std::vector<std::string> nearest_words(const std::string& word, const std::vector<std::string>& known,
                                       std::size_t most = 3);

/// The words that are no looks: neither colours nor materials nor states.
std::vector<std::string> things_among(std::vector<std::string> known);

/// "bear", "dog" or "cat": what to use instead of a word the model does not know; the nearest, else all that
/// name or describe things.
std::string words_to_use(const std::string& word, const std::vector<std::string>& known);

/// `known`, with `generated` behind it: the words of sentences for a model that draws more than it finds.
/// Empty where `known` is.
std::vector<std::string> promptable_vocabulary(const std::vector<std::string>& known,
                                               const std::vector<std::string>& generated);

}  // namespace gse::language
