// Models that know a fixed list of words: what they cannot be asked for is refused before anything runs.
#pragma once

#include <string>
#include <vector>

#include "engine/edit/request/request.h"

namespace gse::edit {

/// Whether the model knows every word of the phrase; an empty list stands for a model that takes any word.
bool knows(const std::vector<std::string>& known, const std::string& phrase);

/// The first word of the phrase that the model does not know; empty = it knows all of them.
std::string unknown_word(const std::vector<std::string>& known, const std::string& phrase);

/// Known words that name or describe things ("bear", "golden"; not "the" or "wearing"), spelt nearly like
/// `word`, nearest first, at most `most`; empty when none is near.
std::vector<std::string> nearest_words(const std::string& word, const std::vector<std::string>& known,
                                       std::size_t most = 3);

/// "bear", "dog" or "cat": what to use instead of a word the model does not know; the nearest, else all that
/// name or describe things.
std::string words_to_use(const std::string& word, const std::vector<std::string>& known);

/// `known`, with `drawn` behind it: what a sentence may be made of for a model that draws more than it finds.
/// Empty where `known` is.
std::vector<std::string> promptable_vocabulary(const std::vector<std::string>& known,
                                               const std::vector<std::string>& drawn);

/// Throws Error (InvalidArgument) with the nearest known words when the source of a validated request is not
/// in `known`, or its target neither there nor in `drawn`, which can be made and not found. With a label made
/// by hand the source may be anything: nothing is looked for.
void require_known_words(const EditRequest& request, const std::vector<std::string>& known,
                         const std::vector<std::string>& drawn, bool labelled_by_hand);

}  // namespace gse::edit
