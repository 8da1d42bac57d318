// View session of the fast rasterizer. Fixed rows come from caches. The others are projected, merged in by
// depth, and blended in the blocks that they reach.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "engine/raster/fast_tiles.h"
#include "engine/raster/view_cache.h"
#include "engine/raster/view_session.h"

namespace gse::raster {

/// Parts that the session shares with its rasterizer, which must outlive it.
struct FastParts {
    Rasterizer& rasterizer;  // for the pictures that are rendered in full
    const Kernels& kernels;
    ThreadPool& pool;
    Frame& working_frame;  // not the one of its last forward()
};

class FastViewSession final : public ViewSession {
public:
    FastViewSession(const FastParts& parts, std::size_t views, std::size_t budget_bytes);

    void forward(std::size_t view, const GaussianSpans& gaussians, std::size_t first_row,
                 const Camera& camera, const Settings& settings, ForwardOutput& output) override;
    void backward(const Image& d_colour, const Image& d_alpha, Gradients& output) override;
    void forget() override;
    ViewSessionWork work() const override;

private:
    struct View {
        ViewCache cache;
        // Rendered in full until forget(): too large for the budget, or prepared too often.
        bool full = false;
    };
    /// Tile that a changing row reaches.
    struct LiveTile {
        std::uint32_t tile = 0;
        std::uint32_t blocks = 0;  // that are reached
        std::size_t begin = 0;     // of its list in merged_
        std::uint32_t count = 0;
    };

    bool continue_view(View& view, const GaussianSpans& gaussians, const Camera& camera,
                       const Settings& settings);
    bool prepare_view(View& view, const GaussianSpans& gaussians, const Camera& camera,
                      const Settings& settings, float near_plane);
    void find_live_tiles();
    void place_records();
    void merge(LiveTile& live);
    void blend_tile(std::size_t index, BlendScratch& scratch);
    void backward_tile(std::size_t index, BackwardScratch& scratch);
    void copy_picture(std::size_t begin, std::size_t end);

    FastParts parts_;
    std::vector<View> views_;
    std::size_t budget_ = 0;
    Frame frame_;                       // of the rows that change
    const ViewCache* cache_ = nullptr;  // of the last forward(); null = it was rendered in full
    std::size_t first_row_ = 0;
    int sh_degree_ = -1;
    std::vector<std::uint32_t> live_numbers_;  // of the live tiles
    std::vector<LiveTile> live_;
    std::vector<TileLight> lights_;  // per live tile
    std::vector<TileEntry> merged_;
    std::vector<std::uint32_t> places_;        // per record of frame_: fixed records that lie in front of it
    std::vector<BlendScratch> blend_scratch_;  // per worker
    std::vector<BackwardScratch> backward_scratch_;  // per worker
    PictureSlope slope_;
    ForwardOutput* output_ = nullptr;
    Gradients* gradients_ = nullptr;
    ViewSessionWork work_;
};

}  // namespace gse::raster
