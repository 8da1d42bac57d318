// The loss that keeps a picture as it was outside a mask: L1 and D-SSIM against a pseudo ground truth
// (GSEditPro 3.3).
#pragma once

#include <cstddef>
#include <vector>

#include "engine/base/image.h"

namespace gse::edit {

/// Weights of the two parts (METHOD.md, Preservation).
struct PreservationWeights {
    double l1 = 0.8;
    double ssim = 0.2;
    double multiplier = 10;
};

/// Weights for fits to redrawn views, which do not agree. The absolute difference alone fits their median.
constexpr PreservationWeights FitWeights{1, 0, 10};

/// Computes value and gradient for one view; keeps its scratch memory.
class PreservationLoss {
public:
    explicit PreservationLoss(const PreservationWeights& weights) : weights_(weights) {}

    /// Loss of `rendered` [H,W,3] against M * rendered + (1 - M) * original, the first factor detached; adds
    /// its gradient to `gradient` [H,W,3]. L1 and 1 - SSIM are means over all pixels and channels; `trust`
    /// [H,W,1] says how much a pixel's L1 counts, null = fully.
    double add_gradient(const Image& rendered, const Image& original, const Mask& may_change, Image& gradient,
                        const Image* trust = nullptr);

private:
    /// Pixels [x0,x1) x [y0,y1).
    struct Box {
        int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
        bool empty() const { return x0 >= x1 || y0 >= y1; }
        int width() const { return x1 - x0; }
        int height() const { return y1 - y0; }
    };
    static Box grown(const Box& box, int by, const Image& image);
    Box add_l1(const Image& rendered, const Image& original, const Mask& may_change, const Image* trust,
               Image& gradient, double& loss);
    void load(const Image& rendered, const Box& work, std::size_t channel);
    double differentiate(const Box& work, const Box& live);
    void ssim_gradient(const Image& rendered, const Box& changed, double scale, Image& gradient,
                       double& loss);

    PreservationWeights weights_;
    Image target_;
    std::vector<float> x_, y_, xx_, yy_, xy_, scratch_;
};

}  // namespace gse::edit
