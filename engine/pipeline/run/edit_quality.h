// Judgement of drawn pictures against the sentence, by the model's own image-text encoder.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/edit/interfaces/view_targets.h"
#include "engine/language/sentence.h"
#include "engine/neural/api/api.h"

namespace gse::pipeline {

struct EditQuality {
    /// Mean cosine of the pictures' and the sentences' change. None when the model has no encoder, or the
    /// encoder does not know the sentence's words.
    std::optional<double> score;
    std::string verdict;  // the score in a sentence; empty without one
    bool warns = false;   // the pictures do not show the edit
    /// Similarity to a known thing, for a new thing that the encoder has no word for. It is the score of the
    /// known thing that the pictures show most. It does not say that the thing is the right one, but a result
    /// like none is a lump. For such a ground: share of the way to its usual colour
    /// (edit/target_views/strategies/default_ground_colour.h).
    std::optional<double> likeness = {};
    /// Share of the redrawn thing that has the colour or material asked for, where the encoder does not know
    /// such scenes: there its score says nothing.
    std::optional<double> look = {};

    /// True when another way of drawing is worth a try.
    bool is_poor() const;
};

/// Least EditQuality::look of an edit that shows what was asked.
inline constexpr double LeastLook = 0.4;

/// A picture before and after.
using PicturePair = std::pair<const Image*, const Image*>;

/// Quality of pictures [H,W,3] in [0,1]. `told` is the prompt as the model is told it.
EditQuality judge(const neural::TextToImage& model, const language::EditSentence& sentence,
                  const std::string& told, const std::vector<PicturePair>& pictures);

/// Quality of the redrawn views of a round that the fit uses, against the scene as they were drawn from.
EditQuality judge_targets(const neural::TextToImage& model, const language::EditSentence& sentence,
                          const edit::ViewTargets& round);

/// JSON {"score", "verdict", "warns"}, and "likeness" and "look" where they were asked.
nlohmann::ordered_json verdict_to_json(const EditQuality& verdict);

}  // namespace gse::pipeline
