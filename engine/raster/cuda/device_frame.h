// One view prepared for blending in a device's memory: projected records, pairs sorted by tile, depth and
// row, and the tiles' lists.
#pragma once

#include <array>
#include <span>

#include "engine/raster/cuda/device_sort.h"
#include "engine/raster/rasterizer.h"

namespace gse::raster::cuda {

class DeviceFrame {
public:
    explicit DeviceFrame(Device& device);

    /// Uploads, projects, bins and sorts. `values`, if not empty, replaces the colours (in the red channel).
    /// Throws Error.
    void prepare(const GaussianSpans& gaussians, const Camera& camera, const Settings& settings,
                 std::span<const float> values);

    /// Gives every pair of rows >= first_row its slot of `floats` zeros.
    SlotTable assign_slots(std::size_t first_row, std::uint32_t floats);

    /// Blends all tiles. The pictures stay in the device's memory.
    void blend(const std::array<float, 3>& background, int channels);

    std::size_t row_count() const { return rows_; }
    std::size_t pair_count() const { return pairs_; }
    std::size_t unusable_rows() const { return unusable_; }
    std::size_t tile_count() const { return tile_count_; }
    std::size_t pixel_count() const {
        return static_cast<std::size_t>(view_.width) * static_cast<std::size_t>(view_.height);
    }
    const Viewpoint& view() const { return view_; }
    const Source& source() const { return source_; }
    TileLists lists() const;
    const Record* records() const { return records_.data(); }
    const std::uint32_t* pair_counts() const { return pair_counts_.data(); }
    const DeviceArray<float>& colour() const { return colour_; }
    const DeviceArray<float>& transmittance() const { return transmittance_; }
    const DeviceArray<float>& depth() const { return depth_; }
    const DeviceArray<std::int32_t>& blended() const { return blended_; }

private:
    void upload(const GaussianSpans& gaussians);
    void project(const float* values);
    void bin();
    void sort_pairs();

    Device& device_;
    Viewpoint view_{};
    Source source_{};  // in the device's memory
    std::size_t rows_ = 0, pairs_ = 0, unusable_ = 0, tile_count_ = 0;
    DeviceScan scan_;
    DeviceSort depth_sort_, tile_sort_;
    DeviceArray<float> position_, log_scale_, rotation_, opacity_logit_, sh_, values_;
    DeviceArray<Record> records_;
    DeviceArray<std::uint32_t> keys_, pair_counts_, unusable_count_, begins_, pair_tiles_, pair_rows_,
        pair_begins_, slot_begins_;
    DeviceArray<TileRange> ranges_;
    const std::uint32_t* entries_ = nullptr;
    DeviceArray<float> colour_, transmittance_, depth_;
    DeviceArray<std::int32_t> blended_;
    DeviceArray<float> slots_;
};

}  // namespace gse::raster::cuda
