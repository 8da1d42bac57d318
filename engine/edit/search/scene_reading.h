// Reading of a scene before a search: the new word of a sentence, and the best distance for the model
// (METHOD.md, Reading the scene).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "engine/edit/request/checked_request.h"
#include "engine/edit/search/vocabulary_ranker.h"

namespace gse::edit {

struct SceneReading {
    std::string target;  // the word that is new
    double fit = 0;      // mean cosine of the sentence before the edit with the pictures that fit best
    std::vector<std::size_t> distances;  // those that fit nearly as well, in their order
};

/// Compares the pictures of each distance with the sentence before the edit, for each of the `targets`. The
/// target whose absence fits best is new, or the first if the sentence with all of them fits better still.
///
/// `recognition` compares(). `pictures` has some of each distance, [H,W,3] in [0,1]; both lists have an
/// entry. `known` is for targets with words that the encoder is not told: none of
/// them is shown or missed. They are new unless the pictures clearly miss another. Empty = the encoder is
/// told all.
SceneReading read_scene(VocabularyRanker& recognition, const CheckedRequest& request,
                        const std::vector<std::string>& targets,
                        const std::vector<std::vector<Image>>& pictures,
                        const std::vector<std::string>& known = {});

}  // namespace gse::edit
