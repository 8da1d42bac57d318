// The loss that keeps a picture as it was outside a mask: L1 and D-SSIM against a pseudo ground truth (GSEditPro 3.3).
#pragma once

#include <vector>

#include "engine/base/image.h"

namespace gse::edit {

/// Weights of the two parts (method 2.5).
struct PreservationWeights {
    double l1 = 0.8;
    double ssim = 0.2;
    double multiplier = 10;
};

/// Computes value and gradient for one view; keeps its scratch memory.
class Preservation {
public:
    explicit Preservation(const PreservationWeights& weights) : weights_(weights) {}

    /// Loss of `rendered` [H,W,3] against M * rendered + (1 - M) * original, the first factor detached; adds its
    /// gradient to `gradient` [H,W,3]. L1 and 1 - SSIM are means over all pixels and channels.
    double add_gradient(const Image& rendered, const Image& original, const Mask& may_change, Image& gradient);

private:
    void ssim_gradient(const Image& rendered, int channel, double scale, Image& gradient, double& loss);

    PreservationWeights weights_;
    Image target_;
    std::vector<double> x_, y_, xx_, yy_, xy_, scratch_;
};

/// Blurs a plane [height,width] with the 11-tap Gaussian window of SSIM (sigma 1.5), zero padding; in place.
void ssim_blur(std::vector<double>& plane, std::vector<double>& scratch, int width, int height);

}  // namespace gse::edit
