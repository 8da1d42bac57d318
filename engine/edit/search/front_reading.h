// Front of a scene, read by the model's own picture encoder.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/edit/search/vocabulary_ranker.h"

namespace gse::edit {

/// "front view", "side view" or "back view" of a camera at an azimuth (radians, 0 = front). `sided` gives
/// eight sectors of 45 degrees each. They go from "front view" by "front left view" (at positive azimuths)
/// and "left side view" to "front right view".
std::string view_words(double azimuth, bool sided);

/// Azimuth between the middles of two of the eight sides: their words, and its place from the first to the
/// second, in [0,1).
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

/// Azimuth with which the words for the sides fit the pictures best. A picture may like all words more than
/// another does, and a word all pictures. Only the rest without either counts. The lead is the mean
/// difference of cosines from its opposite.
///
/// `recognition` compares(). `sentence` describes the scene, without such words. `pictures` are three at
/// least, all around, each seen at its entry of `azimuths` (radians).
FrontReading front_by_words(VocabularyRanker& recognition, const std::string& sentence,
                            const std::vector<Image>& pictures, const std::vector<double>& azimuths);

/// Azimuth from which the pictures were most likely taken. It has the largest mean logarithm of the shares
/// that `seen` gives the sectors of the cameras. `seen` holds one ImageTextEncoder::viewpoint() per picture.
/// The lead is over the mean of all fronts.
FrontReading front_by_viewpoints(const std::vector<std::vector<float>>& seen,
                                 const std::vector<double>& azimuths);

/// Front by viewpoints if the model has learned to tell them and they are clear, else by words.
FrontReading read_front(VocabularyRanker& recognition, const std::string& sentence,
                        const std::vector<Image>& pictures, const std::vector<double>& azimuths);

/// Front out of the pictures' one and the side from which somebody labelled the object. Nothing if none is
/// known.
std::optional<double> chosen_front(const std::optional<FrontReading>& read,
                                   const std::optional<double>& looked_from);

}  // namespace gse::edit
