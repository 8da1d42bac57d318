// What a scene shows of a sentence before anything is looked for: which of its words is new, and from which
// distance the model knows the scene best.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "engine/edit/request/request.h"
#include "engine/edit/search/vocabulary_ranker.h"

namespace gse::edit {

struct SceneReading {
    std::string target;  // the word that is new
    double fit = 0;      // mean cosine of the sentence before the edit with the pictures that fit best
    std::vector<std::size_t> distances;  // those that fit nearly as well, in their order
};

/// Compares the pictures of each distance with the sentence as it was before the edit, for each of the
/// `targets`: the one whose absence fits best is new, or the first where the sentence with all of them fits
/// better still. `recognition` compares(); `pictures`: some of each distance, [H,W,3] in [0,1]; both lists
/// have an entry. A validated request. `known`: of targets with other words, which the encoder is not told,
/// none is shown or missed; they are new unless the pictures clearly miss another. Empty = it is told all.
SceneReading read_scene(VocabularyRanker& recognition, const EditRequest& request,
                        const std::vector<std::string>& targets,
                        const std::vector<std::vector<Image>>& pictures,
                        const std::vector<std::string>& known = {});

}  // namespace gse::edit
