// Pixels of an attention map above a threshold, drawn over the render. Fast enough to follow a slider.
#pragma once

#include "engine/base/image.h"

namespace gse::ui {

struct ThresholdPicture {
    Image picture;     // [H,W,3] the render: kept parts tinted with a rim, the rest darkened
    double share = 0;  // of the pixels, kept
};

/// `map` is [h,w,1] in [0,1]. At another size than the render's, the nearest value counts. Non-finite values
/// are not kept.
ThresholdPicture threshold_picture(const Image& render, const Image& map, double threshold);

}  // namespace gse::ui
