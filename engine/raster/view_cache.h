// Fixed rows of one view: their records front to back, the lists of tiles that changing rows can reach, and
// the picture without changing rows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/math/camera.h"
#include "engine/raster/fast_frame.h"
#include "engine/raster/rasterizer.h"

namespace gse::raster {

/// Entry of a tile's list of fixed records, front to back. Record numbers ascend.
struct FixedEntry {
    std::uint32_t record;
    std::uint32_t blocks;
};

class ViewCache {
public:
    /// True when everything kept is for this camera and these settings. `near_plane` is the near plane that
    /// they give (with_depth_range).
    bool holds(const Camera& camera, const Settings& settings, float near_plane) const;
    /// True when the lists of all these tiles are kept.
    bool covers(std::span<const std::uint32_t> tiles) const;

    /// Prepares the view: `frame` (working memory) projects, sorts and bins `fixed`. The lists of `tiles`, of
    /// their neighbours and of all that were kept before stay. Returns false, and keeps nothing, when that
    /// takes more than `budget` bytes.
    struct Job {
        const GaussianSpans& fixed;
        const Camera& camera;
        const Settings& settings;
        float near_plane = 0;
        std::span<const std::uint32_t> tiles;
        std::size_t budget = 0;
    };
    bool prepare(const Job& job, Frame& frame);

    /// Frees the memory.
    void clear() { *this = {}; }
    /// Memory held.
    std::size_t bytes() const;

    std::span<const Record> records() const { return records_; }
    /// Rows of the records, ascending.
    std::span<const float> depths() const { return depths_; }
    std::span<const FixedEntry> entries(std::size_t tile) const {
        return {entries_.data() + offsets_[tile], offsets_[tile + 1] - offsets_[tile]};
    }
    const ForwardOutput& picture() const { return picture_; }
    /// Number of preparations since clear().
    int times_prepared() const { return times_prepared_; }

private:
    void project(const Job& job, Frame& frame);
    void cover(const Job& job, const Frame& frame);
    std::size_t rank_records(const Frame& frame, std::vector<std::uint32_t>& ranks) const;
    void keep_lists(const Frame& frame, const std::vector<std::uint32_t>& ranks, std::size_t count);
    void keep_picture(Frame& frame);

    Camera camera_;
    Settings settings_;
    // Any near plane strictly between the last two leaves out the same rows as the first.
    float near_plane_ = 0, near_low_ = 0, near_high_ = 0;
    int times_prepared_ = 0;
    std::vector<Record> records_;
    std::vector<float> depths_;
    std::vector<std::uint32_t> offsets_;  // [tiles + 1] into entries_
    std::vector<FixedEntry> entries_;
    std::vector<std::uint8_t> covered_;  // [tiles]
    ForwardOutput picture_;              // dropped_rows: of the fixed rows
};

}  // namespace gse::raster
