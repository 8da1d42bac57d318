// Mean change inside a mask from one visit of a view to the next.
#include "engine/edit/optimise/convergence.h"

#include <algorithm>
#include <cmath>

namespace gse::edit {
namespace {

constexpr double RestMemory = 0.98;  // share of the mean change that stays, a step

}  // namespace

bool ConvergenceDetector::visit(std::size_t view, const Image& shown, const Mask& mask) {
    Image& last = last_[view];
    if (last.data.size() == shown.data.size()) {
        double sum = 0;
        std::size_t count = 0;
        for (std::size_t i = 0; i < mask.data.size(); ++i) {
            if (mask.data[i] == 0) continue;
            ++count;
            for (std::size_t c = 0; c < 3; ++c) sum += std::abs(shown.data[i * 3 + c] - last.data[i * 3 + c]);
        }
        change_[view] = count > 0 ? sum / (3.0 * static_cast<double>(count)) : 0;
        mean_ = RestMemory * mean_ + (1 - RestMemory) * change_[view];
        weight_ = RestMemory * weight_ + (1 - RestMemory);
    }
    last = shown;
    const bool all_seen = std::all_of(change_.begin(), change_.end(), [this](double change) {
        return change >= 0 && change < least_change_;
    });
    return all_seen && mean_ / weight_ < least_change_;
}

}  // namespace gse::edit
