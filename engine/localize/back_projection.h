// From one mask per view to one weight per Gaussian (METHOD.md, Label voting).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/raster/rasterizer.h"
#include "engine/scene/scene.h"

namespace gse::localize {

/// Votes of the views on every row.
struct LabelWeights {
    std::vector<float> weight;     // [N] sum(alpha T M) / sum(alpha T) over the views used, in [0,1]
    std::vector<double> evidence;  // [N] sum(alpha T) in pixels
    std::vector<std::uint8_t>
        inferred;  // [N] or empty: 1 = no view saw the row, its neighbours decided (spread.h)
    int views_used = 0;
};

/// One view's vote. A failed view (nothing found in it) does not vote.
struct MaskedView {
    Camera camera;
    Image mask;  // [H,W,1] in [0,1], at the camera's size
    bool failed = false;
};

/// Votes of views, kept for as long as scene and settings stay, as far as their memory allows. A view that
/// comes again with an equal mask is not rendered again. Weights are equal to the last bit.
class VoteCache {
public:
    static constexpr std::size_t MostBytes = std::size_t{512} << 20;
    explicit VoteCache(std::size_t most_bytes = MostBytes) : most_bytes_(most_bytes) {}

    /// Throws Error when more than half of the views failed or none is left.
    LabelWeights back_project(const GaussianSpans& gaussians, std::span<const MaskedView> views,
                              const raster::Settings& settings, raster::Rasterizer& rasterizer);

private:
    struct Vote {
        Camera camera;
        Image mask;
        std::vector<std::uint32_t> row;     // those it shows
        std::vector<double> masked, total;  // of these
        static constexpr std::size_t RowBytes = sizeof(std::uint32_t) + 2 * sizeof(double);
        std::size_t bytes() const;
    };
    Vote* find(const Camera& camera);
    std::size_t cast(const GaussianSpans& gaussians, const MaskedView& view, const raster::Settings& settings,
                     raster::Rasterizer& rasterizer);
    void keep(const MaskedView& view, std::size_t shown, Vote* old);

    std::size_t most_bytes_, bytes_ = 0;
    std::vector<Vote> votes_;
    std::vector<double> masked_, total_;  // of one view
};

/// Weights from a single call. Throws Error when more than half of the views failed or none is left.
LabelWeights back_project(const GaussianSpans& gaussians, std::span<const MaskedView> views,
                          const raster::Settings& settings, raster::Rasterizer& rasterizer);

/// Rows with weight > tau become the label if they were seen (evidence > least_evidence_px) or their
/// neighbours decided. The weights stay for display.
Label label_from_weights(const std::string& name, const LabelWeights& weights, double tau,
                         double least_evidence_px);

}  // namespace gse::localize
