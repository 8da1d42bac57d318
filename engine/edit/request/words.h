// Sentences as lists of words: what counts as a word, phrases of several words, and the spelling the model is
// told.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace gse::edit {

/// What stands for one scene in the sentences of DreamBooth ("a * bear").
inline const std::string Identifier = "*";

/// Lower-case words of a sentence, without punctuation; "*" is a word of its own.
std::vector<std::string> words_of(const std::string& sentence);

/// The words with one space between them.
std::string joined(const std::vector<std::string>& words);

/// The sentence as the model is told it, whatever it is asked: one spelling for attention, guidance and
/// pictures.
std::string as_told(const std::string& sentence);

/// The sentence without "*": for a model that has not learned the scene, and for what it is to keep of
/// others.
std::string without_identifier(const std::string& sentence);

/// Whether the sentence has the words of the phrase ("bear", "teddy bear") one after the other. An empty
/// phrase is in none.
bool has_word(const std::string& sentence, const std::string& phrase);

/// Index of the first word of the phrase in the sentence's words, or their number when it is not there.
std::size_t first_word(const std::string& sentence, const std::string& phrase);

/// The words of the sentence, where each of the phrases is one entry ("a", "teddy bear"); of two that overlap
/// the longer.
std::vector<std::string> terms_of(const std::string& sentence, const std::vector<std::string>& phrases);

/// What things stand on or are in, not things: one in the place of another changes no shape.
bool is_ground(const std::string& word);
/// Of a phrase, by its last word.
bool names_ground(const std::string& phrase);

/// Phrases of a list: between commas, or, where there is no comma, every word for itself ("hat grass", "top
/// hat, grass").
std::vector<std::string> phrases_of(const std::string& list);

}  // namespace gse::edit
