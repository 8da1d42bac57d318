// Pictures of a healed hole against the truth, plain deletion and a plain colour.
#pragma once

#include <nlohmann/json.hpp>

#include "engine/base/image.h"

namespace gse::bench {

/// Picture [H,W,3] with the pixels of a mask in the mean colour of those around it.
Image mean_filled(const Image& picture, const Mask& hole);

/// PSNR of mean squared errors and mean SSIM within holes, pooled over pictures.
class HoleFigures {
public:
    /// Pixels of `hole` in pictures of the truth, without the labelled rows, and healed.
    void add(const Image& truth, const Image& deleted, const Image& healed, const Mask& hole);
    /// {"psnr_hole_db", "ssim_hole", and both with _deleted and _mean, "hole_share"}; null without a hole.
    nlohmann::ordered_json json() const;

private:
    struct Sums {
        double squared = 0, similar = 0;
        void add(const Image& shown, const Image& truth, const Mask& hole);
    };
    Sums healed_, deleted_, mean_;
    double pixels_ = 0, all_ = 0;
};

}  // namespace gse::bench
