// From where a scene shows its front, by the model's own picture encoder.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/edit/search/vocabulary_ranker.h"

namespace gse::edit {

/// "front view", "side view" or "back view" of a camera at an azimuth (radians, 0 = front). `sided`: of eight
/// sectors of 45 degrees each, from "front view" by "front left view" (at positive azimuths) and "left side
/// view" to "front right view".
std::string view_words(double azimuth, bool sided);

/// An azimuth between the middles of two of the eight sides: their words, and how far it is from the first to
/// the second, in [0,1).
struct SideBlend {
    std::string words, next_words;
    double share = 0;
};
SideBlend side_blend(double azimuth);

struct FrontReading {
    double azimuth = 0;  // of the cameras that see the front, radians in [-pi, pi)
    double lead = 0;     // how much better the pictures fit it: see below
    bool clear = false;  // the lead is large enough to go by
    bool sure = false;   // even where somebody else says otherwise: of viewpoints, larger than of anything
                         // photographed
};

/// The azimuth with which the words for the sides fit the pictures best. A picture may like all words more
/// than another does, and a word all pictures: only what is left without either counts. `recognition`
/// compares(); `sentence`: what the scene shows, without such words; `pictures`: three at least, all around,
/// each seen at its entry of `azimuths` (radians). The lead is the mean difference of cosines from its
/// opposite.
FrontReading front_by_words(VocabularyRanker& recognition, const std::string& sentence,
                            const std::vector<Image>& pictures, const std::vector<double>& azimuths);

/// The azimuth from which the pictures were most likely taken as they look: largest mean logarithm of the
/// shares that `seen` (one ImageTextEncoder::viewpoint() per picture) gives the sector in which each camera
/// would be. The lead is over the mean of all fronts.
FrontReading front_by_viewpoints(const std::vector<std::vector<float>>& seen,
                                 const std::vector<double>& azimuths);

/// By viewpoints where the model has learned to tell them and they are clear, else by words.
FrontReading read_front(VocabularyRanker& recognition, const std::string& sentence,
                        const std::vector<Image>& pictures, const std::vector<double>& azimuths);

/// Of what pictures showed and of the side from which somebody labelled the thing, the front; nothing where
/// none is known.
std::optional<double> chosen_front(const std::optional<FrontReading>& read,
                                   const std::optional<double>& looked_from);

}  // namespace gse::edit
