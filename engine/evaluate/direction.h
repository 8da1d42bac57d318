// Agreement of the picture's change with the sentence's change (METHOD.md, Metrics). Cosines in the space of
// a text-image encoder.
#pragma once

#include <span>

namespace gse::evaluate {

/// Changes of a normalised picture vector below this length count as no change. Their direction is noise.
inline constexpr double LeastPictureChange = 1e-4;

/// Vectors of one edit. Each is normalised before use; the differences are not.
struct DirectionVectors {
    std::span<const float> image_before, image_after;
    std::span<const float> text_before, text_after;
};

/// Cosine of two vectors of equal length. 0 when one of them is zero.
double cosine(std::span<const float> a, std::span<const float> b);

/// Signed cosine of the pictures' change and the sentences' change, in [-1,1]. 0 when nothing changed.
double direction_score(const DirectionVectors& vectors);

}  // namespace gse::evaluate
