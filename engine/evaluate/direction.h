// Does the picture change the way the words change? Cosines in the space of a text-image encoder
// (method 6.1).
#pragma once

#include <span>

namespace gse::evaluate {

/// Changes of a normalised picture vector below this length count as no change: their direction is noise.
inline constexpr double LeastPictureChange = 1e-4;

/// Vectors of one edit; each is normalised before use, the differences are not.
struct DirectionVectors {
    std::span<const float> image_before, image_after;
    std::span<const float> text_before, text_after;
};

/// Cosine of two vectors of the same length; 0 when one of them is zero.
double cosine(std::span<const float> a, std::span<const float> b);

/// Signed cosine of the pictures' change and the sentences' change, in [-1,1]; 0 when nothing changed.
double direction_score(const DirectionVectors& vectors);

}  // namespace gse::evaluate
