// From one mask per view to one probability per Gaussian (METHOD.md, Label voting).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/raster/rasterizer.h"
#include "engine/scene/label_field.h"
#include "engine/scene/scene.h"

namespace gse::localize {

/// One view's vote. A failed view (nothing found in it) does not vote.
struct MaskedView {
    Camera camera;
    Image mask;  // [H,W,1] in [0,1], at the camera's size
    bool failed = false;
};

/// Votes of views, kept for as long as scene and settings stay, as far as their memory allows. A view that
/// comes again with an equal mask is not rendered again. Fields are equal to the last bit.
class VoteCache {
public:
    static constexpr std::size_t MostBytes = std::size_t{512} << 20;
    explicit VoteCache(std::size_t most_bytes = MostBytes) : most_bytes_(most_bytes) {}

    /// Throws Error when more than half of the views failed or none is left.
    LabelField back_project(const GaussianSpans& gaussians, std::span<const MaskedView> views,
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

/// Field from a single call. Throws Error when more than half of the views failed or none is left.
LabelField back_project(const GaussianSpans& gaussians, std::span<const MaskedView> views,
                        const raster::Settings& settings, raster::Rasterizer& rasterizer);

/// Label [N]: 1 where the probability is above the threshold, if the row is known. A row is known by a
/// coverage above `least_coverage` (pixels), or by its neighbours.
std::vector<std::uint8_t> bits(const LabelField& field, double threshold, double least_coverage);

}  // namespace gse::localize
