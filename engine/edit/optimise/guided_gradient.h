// The gradient of a guidance on a picture, brought to the strength of the preservation loss.
#pragma once

#include <vector>

#include "engine/edit/optimise/edit_loop.h"

namespace gse::edit {

/// Euclidean norm of all values.
double norm(const Image& image);

/// Asks a guidance, keeps its gradient inside the mask and calibrates it. Refers to all it is given.
class GuidedGradient {
public:
    /// `guidance` may be null where nothing is ever added.
    GuidedGradient(Guidance* guidance, const LoopSettings& settings)
        : guidance_(guidance), settings_(settings) {}

    /// Adds the gradient to `gradient` [H,W,3] and notes in `record` what the guidance tells. Adds nothing
    /// and returns false where it is not finite. `rendered` [H,W,3]: the picture before it was clamped;
    /// `mask`: where it may change. Throws Error as the guidance does.
    bool add(const GuidanceInput& input, const Image& rendered, const Mask& mask, Image& gradient,
             IterationRecord& record);
    /// Factor of the gradient; 0 = nothing was calibrated yet.
    double scale() const { return scale_; }

private:
    void gate(const Image& rendered, const Mask& mask, Image& gradient) const;
    double calibrated_weight(double norm, std::size_t values);

    Guidance* guidance_;
    const LoopSettings& settings_;
    std::vector<double> norms_;  // of the first gradients
    double scale_ = 0;
};

}  // namespace gse::edit
