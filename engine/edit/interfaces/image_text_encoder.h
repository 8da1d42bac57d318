// Agreement of a picture and a sentence, by a pair of encoders into one space (CLIP structure). Absent
// without weights.
#pragma once

#include <string>
#include <vector>

#include "engine/base/image.h"

namespace gse::edit {

/// Two encoders whose vectors are compared by their angle.
class ImageTextEncoder {
public:
    virtual ~ImageTextEncoder() = default;
    /// Vector of a picture [H,W,3] in [0,1] of any size. Its length is equal for every picture and sentence.
    virtual std::vector<float> image(const Image& image) = 0;
    /// Vector of a sentence.
    virtual std::vector<float> text(const std::string& sentence) = 0;
    /// Viewing direction of a picture's object: a share for each of equal sectors of azimuths. The first
    /// sector has the front in its middle; the next lies to its left. They sum to 1. Empty if the model has
    /// not learned to tell.
    virtual std::vector<float> viewpoint(const Image&) { return {}; }
};

}  // namespace gse::edit
