// The one splitter of sentences into words; phrases of several words.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "engine/language/lexicon.h"

namespace gse::language {

/// A piece of a sentence: a lower-case word, or one ASCII character that is neither blank nor part of a word.
struct Token {
    std::string text;
    bool is_word = true;
};

/// Words and marks in their order. A word holds letters, digits, "-" and inner "'"; its possessive "'s" is
/// dropped. Typographic marks and blanks count as plain ones; characters of which nothing is seen vanish, as
/// they do in the tokenizers of models.
std::vector<Token> tokens_of(std::string_view text);

/// Words of a text without its marks; the identifier counts as a word.
std::vector<std::string> words_of(std::string_view text);

/// The words with one blank between them.
std::string joined(const std::vector<std::string>& words);

/// Lower-case words with one blank between them: one spelling for attention, guidance and pictures.
std::string normalised_prompt(std::string_view text);

/// The normalised prompt without the identifier: for a model that has not learned the scene.
std::string without_identifier(std::string_view text);

/// Index in `words` at which the phrase's words follow one another; words.size() where they do not. An empty
/// phrase is nowhere.
std::size_t position_of(const std::vector<std::string>& words, std::string_view phrase);
std::size_t position_of(std::string_view text, std::string_view phrase);

/// Tells whether the text has the words of the phrase ("bear", "teddy bear") one after the other.
bool has_phrase(std::string_view text, std::string_view phrase);

/// The words, each of the phrases as one entry ("a", "teddy bear"); of two that overlap the longer.
std::vector<std::string> terms_of(const std::vector<std::string>& words,
                                  const std::vector<std::string>& phrases);

/// Last word of a phrase: "hat" of "top hat". Empty where there is none.
std::string head_word(std::string_view phrase);

/// Phrases of a list: between commas, or, where there is no comma, every word for itself ("hat grass", "top
/// hat, grass").
std::vector<std::string> phrases_of(std::string_view list);

/// Tells whether a vector has the word.
bool contains(const std::vector<std::string>& words, std::string_view word);

}  // namespace gse::language
