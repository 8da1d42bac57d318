// How well a picture and a sentence agree, by a pair of encoders into one space (CLIP structure); absent
// without weights.
#pragma once

#include <string>
#include <vector>

#include "engine/base/image.h"

namespace gse::edit {

/// Two encoders whose vectors can be compared by their angle.
class ImageTextEncoder {
public:
    virtual ~ImageTextEncoder() = default;
    /// Vector of a picture [H,W,3] in [0,1] of any size; its length is the same for every picture and
    /// sentence.
    virtual std::vector<float> image(const Image& image) = 0;
    /// Vector of a sentence.
    virtual std::vector<float> text(const std::string& sentence) = 0;
    /// From where a picture shows the thing in it: the share of each of equal sectors of azimuths, of which
    /// the first has the front in its middle and the next lies to the left of that. They sum to 1. Empty
    /// where the model has not learned to tell.
    virtual std::vector<float> viewpoint(const Image&) { return {}; }
};

}  // namespace gse::edit
