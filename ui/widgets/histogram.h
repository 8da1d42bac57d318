// Histogram of values in [0,1] with a threshold to drag, and the count above it at once.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "ui/model/context.h"

namespace gse::ui {

/// Counts of one weight array. Recomputed only when another array is handed in.
class WeightHistogram {
public:
    static constexpr int Bins = 1024;
    void update(const std::shared_ptr<const std::vector<float>>& weight);
    /// Number of values above, to the resolution of a bin.
    std::size_t above(float threshold) const;
    const std::vector<std::uint32_t>& counts() const { return counts_; }

private:
    std::shared_ptr<const std::vector<float>> weight_;
    std::vector<std::uint32_t> counts_ = std::vector<std::uint32_t>(Bins);
    std::vector<std::size_t> above_ = std::vector<std::size_t>(Bins + 1);
};

/// Draws the histogram over the free width, `height` pixels high. True while the threshold is dragged;
/// `released` when let go. With `below`, values left of the threshold count.
struct ThresholdDrag {
    bool changed = false;
    bool released = false;
};
ThresholdDrag histogram(Context& context, std::string_view name, const WeightHistogram& data, float height,
                        float& threshold, bool below = false);

}  // namespace gse::ui
