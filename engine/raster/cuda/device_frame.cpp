// Launches of one view, in their order.
#include "engine/raster/cuda/device_frame.h"

#include <bit>
#include <limits>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/raster/viewpoint.h"

namespace gse::raster::cuda {

DeviceFrame::DeviceFrame(Device& device)
    : device_(device), scan_(device), depth_sort_(device), tile_sort_(device), position_(device),
      log_scale_(device), rotation_(device), opacity_logit_(device), sh_(device), values_(device),
      records_(device), keys_(device), pair_counts_(device), unusable_count_(device), begins_(device),
      pair_tiles_(device), pair_rows_(device), pair_begins_(device), slot_begins_(device), ranges_(device),
      colour_(device), transmittance_(device), depth_(device), blended_(device), slots_(device) {}

void DeviceFrame::prepare(const GaussianSpans& gaussians, const Camera& camera, const Settings& settings,
                          std::span<const float> values) {
    check_inputs(gaussians, camera);
    if (gaussians.size > MostPairs)
        throw Error(ErrorCode::Unsupported, "the scene has too many splats for the CUDA rasterizer",
                    "prune it");
    view_ = viewpoint_of(camera, with_depth_range(settings, gaussians, camera), gaussians.sh_degree);
    tile_count_ = blocks_for(static_cast<std::size_t>(camera.width), TileSize) *
                  blocks_for(static_cast<std::size_t>(camera.height), TileSize);
    rows_ = gaussians.size;
    pairs_ = unusable_ = 0;
    upload(gaussians);
    project(values.empty() ? nullptr : values_.upload(values));
    bin();
    sort_pairs();
}

void DeviceFrame::upload(const GaussianSpans& gaussians) {
    source_ = {position_.upload(gaussians.position),
               log_scale_.upload(gaussians.log_scale),
               rotation_.upload(gaussians.rotation),
               opacity_logit_.upload(gaussians.opacity_logit),
               sh_.upload(gaussians.sh),
               sh_floats(gaussians)};
}

void DeviceFrame::project(const float* values) {
    ProjectArguments args{};
    args.source = source_;
    args.view = view_;
    args.values = values;
    args.rows = static_cast<std::uint32_t>(rows_);
    args.records = records_.at_least(rows_);
    args.keys = keys_.at_least(rows_);
    args.pair_counts = pair_counts_.at_least(rows_);
    args.unusable = unusable_count_.zeros(1);
    device_.launch(kernels::project, blocks_for(rows_), args);
    std::uint32_t unusable = 0;
    unusable_count_.download({&unusable, 1});
    unusable_ = unusable;
}

void DeviceFrame::bin() {
    begins_.at_least(rows_);
    pair_begins_.at_least(rows_);
    const auto rows = static_cast<std::uint32_t>(rows_);
    const std::uint32_t* order = nullptr;
    if (rows_ > 0) {
        order = depth_sort_.sort(keys_.data(), rows_, std::numeric_limits<std::uint32_t>::digits).places;
        device_.launch(kernels::gather, blocks_for(rows_),
                       {pair_counts_.data(), order, begins_.data(), rows});
        pairs_ = scan_.total(begins_.data(), begins_.data(), rows_);
    }
    if (pairs_ > MostPairs)
        throw Error(ErrorCode::Unsupported, "the view has too many large splats to be drawn at this size",
                    "render a smaller image or prune the scene");
    EmitArguments args{};
    args.records = records_.data();
    args.order = order;
    args.begins = begins_.data();
    args.pair_counts = pair_counts_.data();
    args.rows = rows;
    args.width = view_.width;
    args.height = view_.height;
    args.pair_tiles = pair_tiles_.at_least(pairs_);
    args.pair_rows = pair_rows_.at_least(pairs_);
    args.pair_begins = pair_begins_.data();
    device_.launch(kernels::emit, blocks_for(rows_), args);
}

void DeviceFrame::sort_pairs() {
    TileRange* ranges = ranges_.zeros(tile_count_);
    entries_ = nullptr;
    if (pairs_ == 0) return;
    const auto bits = static_cast<std::uint32_t>(std::bit_width(tile_count_ - 1));
    const DeviceSort::Sorted sorted = tile_sort_.sort(pair_tiles_.data(), pairs_, bits);
    entries_ = sorted.places;
    device_.launch(kernels::ranges, blocks_for(pairs_),
                   {sorted.keys, static_cast<std::uint32_t>(pairs_), ranges});
}

TileLists DeviceFrame::lists() const {
    const auto columns =
        static_cast<std::uint32_t>(blocks_for(static_cast<std::size_t>(view_.width), TileSize));
    return {records_.data(), ranges_.data(), entries_, pair_rows_.data(), columns, view_.width, view_.height};
}

void DeviceFrame::blend(const std::array<float, 3>& background, int channels) {
    BlendArguments args{};
    args.lists = lists();
    for (std::size_t channel = 0; channel < 3; ++channel) args.background[channel] = background[channel];
    args.channels = channels;
    args.colour = colour_.at_least(pixel_count() * static_cast<std::size_t>(channels));
    args.transmittance = transmittance_.at_least(pixel_count());
    args.depth = depth_.at_least(pixel_count());
    args.blended = blended_.at_least(pixel_count());
    device_.launch(kernels::blend, tile_count_, args);
}

SlotTable DeviceFrame::assign_slots(std::size_t first_row, std::uint32_t floats) {
    GSE_CHECK(first_row <= rows_);
    const std::size_t rows = rows_ - first_row;
    SlotTable table{};
    table.pair_begins = pair_begins_.data();
    table.first_row = static_cast<std::uint32_t>(first_row);
    std::uint32_t* begins = slot_begins_.at_least(rows);
    const std::size_t slots = scan_.total(pair_counts_.data() + first_row, begins, rows);
    table.slot_begins = begins;
    table.slots = slots_.zeros(slots * floats);
    return table;
}

}  // namespace gse::raster::cuda
