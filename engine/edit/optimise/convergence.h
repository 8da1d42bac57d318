// The test whether an edit still changes what is seen of it.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/base/image.h"

namespace gse::edit {

/// Tells when an edit has converged. The measure is the mean absolute change inside the mask between two
/// visits of a view, as an exponential mean (0.98 a step, corrected for its start). It must have been below
/// `LoopSettings::early_stop_change` for every view.
class ConvergenceDetector {
public:
    ConvergenceDetector(std::size_t views, double least_change)
        : last_(views), change_(views, -1), least_change_(least_change) {}
    /// This view is never drawn.
    void ignore(std::size_t view) { change_[view] = 0; }
    /// A view was drawn. Returns true when the edit has come to rest.
    bool visit(std::size_t view, const Image& shown, const Mask& mask);

private:
    std::vector<Image> last_;
    std::vector<double> change_;  // of the last two visits, -1 = not visited twice yet
    double mean_ = 0, weight_ = 0;
    double least_change_;
};

}  // namespace gse::edit
