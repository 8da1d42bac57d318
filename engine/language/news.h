// The news of a sentence: which of its words the scene does not show yet.
#pragma once

#include <string>
#include <vector>

#include "engine/language/sentence.h"

namespace gse::language {

/// Guess of the one new word of the sentence. It is the word that the source is "wearing", "with", "in" or
/// "made of", else the word before it ("golden" statue). If the sentence does not name the source, it is the
/// first object it names. Words that the scene shows already (`said`) are no news if the sentence has other
/// ones, of the source before those of what is around it.
std::string guessed_target(const Sentence& sentence, const std::string& source,
                           const std::vector<std::string>& said = {});

/// All that may be the news of the sentence: what describes the source, and the things it names,
/// guessed_target() first; not what was `said` already, where there is something else.
std::vector<std::string> possible_targets(const Sentence& sentence, const std::string& source,
                                          const std::vector<std::string>& said = {});

/// Words that hold for a scene after these edits, which are in the order of their application. They are the
/// words of their sentences, less those that a later edit replaced ("blue" of a bear that was made red
/// since).
std::vector<std::string> words_said(const std::vector<EditSentence>& applied);

}  // namespace gse::language
