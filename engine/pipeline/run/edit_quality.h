// Whether pictures that the model drew show what the sentence says, by the model's own image-text encoder.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/edit/interfaces/view_targets.h"
#include "engine/edit/request/request.h"
#include "engine/neural/api/api.h"

namespace gse::pipeline {

struct EditQuality {
    /// Mean cosine of the pictures' and the sentences' change; none when the model has no encoder to tell, or
    /// it does not know what the sentence says.
    std::optional<double> score;
    std::string verdict;  // the score in a sentence; empty without one
    bool warns = false;   // the pictures do not show the edit
    /// Where a new thing is one that the model draws and its encoder has no word for: the same of the thing
    /// that it has a word for and that the pictures show most. Says nothing of whether it is the right one,
    /// but what is like none is a lump. Of such a ground: how much of the way to its usual colour the
    /// pictures have gone (edit/usual_look.h).
    std::optional<double> likeness = {};

    /// Whether another way of drawing is worth a try.
    bool is_poor() const;
};

/// A picture before and after.
using PicturePair = std::pair<const Image*, const Image*>;

/// Of a validated request; `told`: the sentence as the model is told it. Pictures [H,W,3] in [0,1].
EditQuality judge(const neural::TextToImage& model, const edit::EditRequest& request, const std::string& told,
                  const std::vector<PicturePair>& pictures);

/// Of the redrawn views of a round that the fit uses, against the scene as they were drawn from.
EditQuality judge_targets(const neural::TextToImage& model, const edit::EditRequest& request,
                          const std::string& told, const edit::ViewTargets& round);

/// {"score", "verdict", "warns"}, and "likeness" where it was asked.
nlohmann::ordered_json verdict_to_json(const EditQuality& verdict);

}  // namespace gse::pipeline
