// Words of a vocabulary that describe pictures of one thing best, by the model's own picture encoder.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/base/image.h"
#include "engine/edit/search/vocabulary_ranker.h"

namespace gse::edit {

/// Words of a vocabulary that name or describe, by their place in a sentence.
struct WordKinds {
    std::vector<std::string> things, looks, worn, grounds;
};
WordKinds kinds_of(const std::vector<std::string>& known);

/// A word against all others of its kind.
struct WordLead {
    double lead = 0;   // mean cosine with the pictures, less that of the best other word
    double fit = 0;    // mean cosine of the best word's sentence: low where pictures are like no trained ones
    std::string best;  // the word that fits best, which may be the word itself; empty = nothing worn
};

/// Compares a thing's word, or that of something worn, with the others of its kind in one sentence. What else
/// the pictures show is read off them first, since a sentence that leaves it out fits nothing well. For worn
/// things the sentence without any is compared too.
///
/// Words that the encoder hardly tells from `word` (glasses, sunglasses) do not count. `recognition` is
/// available(), `pictures` has an entry. Nothing for a word of another kind.
std::optional<WordLead> lead_of(VocabularyRanker& recognition, const std::string& word,
                                const std::vector<Image>& pictures);

}  // namespace gse::edit
