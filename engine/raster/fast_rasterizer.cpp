// The fast float rasterizer: prepared frames, tiles blended by the kernels of one instruction set, threads.
#include <algorithm>
#include <cstring>
#include <vector>

#include "engine/base/check.h"
#include "engine/raster/fast_frame.h"
#include "engine/raster/fast_tiles.h"
#include "engine/raster/fast_view_session.h"
#include "engine/raster/kernels.h"
#include "engine/raster/rasterizer.h"

namespace gse::raster {
namespace {

class FastRasterizer final : public Rasterizer {
public:
    FastRasterizer(const Kernels& kernels, ThreadPool& pool)
        : kernels_(kernels), pool_(pool), frame_(kernels, pool), side_frame_(kernels, pool) {}

    void forward(const GaussianSpans& gaussians, const Camera& camera, const Settings& settings,
                 ForwardOutput& output) override {
        frame_.prepare(gaussians, camera, settings);
        slope_.background = settings.background;
        resize_output(camera.width, camera.height, output);
        output.pairs = frame_.pair_count();
        output.dropped_rows = frame_.unusable_rows();
        output_ = &output;
        frame_.blend(
            [](void* self, std::size_t tile, const BlendScratch& scratch) {
                static_cast<FastRasterizer*>(self)->write_tile(tile, scratch);
            },
            this);
        output.pairs_reached = output.block_pairs = 0;
        for (std::size_t tile = 0; tile < frame_.tile_count(); ++tile) {
            output.pairs_reached += frame_.light(tile).reached;
            output.block_pairs += frame_.light(tile).block_pairs;
        }
    }

    void backward(const Image& d_colour, const Image& d_alpha, std::size_t first_row,
                  Gradients& output) override {
        GSE_CHECK(first_row <= frame_.row_count());
        const std::size_t pixels =
            static_cast<std::size_t>(frame_.width()) * static_cast<std::size_t>(frame_.height());
        GSE_CHECK_EQ(d_colour.data.size(), pixels * 3);
        GSE_CHECK(d_alpha.data.empty() || d_alpha.data.size() == pixels);
        slope_.colour = &d_colour;
        slope_.alpha = d_alpha.data.empty() ? nullptr : &d_alpha;
        first_row_ = first_row;
        gradients_ = &output;
        resize_gradients(frame_.row_count() - first_row, frame_.source().sh_stride, output);
        frame_.assign_slots(first_row);
        grow_scratch();
        frame_.for_tiles([this](std::size_t begin, std::size_t end, unsigned worker) {
            for (std::size_t tile = begin; tile < end; ++tile) backward_tile(tile, scratch_[worker]);
        });
        const std::size_t first_chunk = first_row / Frame::ChunkRows;
        pool_.parallel_for(frame_.chunk_count() - std::min(first_chunk, frame_.chunk_count()), 2,
                           [this](std::size_t begin, std::size_t end, unsigned) {
                               const std::size_t skipped = first_row_ / Frame::ChunkRows;
                               for (std::size_t i = begin; i < end; ++i)
                                   write_gradients(kernels_, frame_, skipped + i, first_row_, *gradients_);
                           });
    }

    void contributions(const GaussianSpans& gaussians, const Camera& camera, const Settings& settings,
                       const Image& mask, std::span<double> masked, std::span<double> total) override {
        GSE_CHECK_EQ(masked.size(), gaussians.size);
        GSE_CHECK_EQ(total.size(), gaussians.size);
        GSE_CHECK(mask.width == camera.width && mask.height == camera.height && mask.channels == 1);
        side_frame_.prepare(gaussians, camera, settings, {}, Frame::Colours::Unwanted);
        side_frame_.assign_slots(0);
        grow_scratch();
        mask_ = &mask;
        masked_ = masked;
        total_ = total;
        side_frame_.for_tiles([this](std::size_t begin, std::size_t end, unsigned worker) {
            for (std::size_t tile = begin; tile < end; ++tile) contribute_tile(tile, scratch_[worker]);
        });
        pool_.parallel_for(side_frame_.chunk_count(), 2,
                           [this](std::size_t begin, std::size_t end, unsigned) {
                               for (std::size_t chunk = begin; chunk < end; ++chunk) add_contributions(chunk);
                           });
    }

    void forward_values(const GaussianSpans& gaussians, const Camera& camera, const Settings& settings,
                        std::span<const float> values, Image& output) override {
        GSE_CHECK_EQ(values.size(), gaussians.size);
        side_frame_.prepare(gaussians, camera, settings, values, Frame::Colours::Unwanted);
        output.resize(camera.width, camera.height, 1);
        values_output_ = &output;
        side_frame_.blend([](void* self, std::size_t tile,
                             const BlendScratch&) { static_cast<FastRasterizer*>(self)->write_values(tile); },
                          this);
    }

    std::unique_ptr<ViewSession> view_session(std::size_t views, std::size_t budget_bytes) override {
        return std::make_unique<FastViewSession>(FastParts{*this, kernels_, pool_, side_frame_}, views,
                                                 budget_bytes);
    }

    std::string name() const override { return kernels_.name; }

private:
    void grow_scratch() {
        if (scratch_.size() < pool_.thread_count()) scratch_.resize(pool_.thread_count());
    }

    void write_tile(std::size_t tile, const BlendScratch& scratch) {
        raster::write_tile(tile_area(frame_, tile), AllBlocks, frame_.light(tile), scratch, slope_.background,
                           *output_);
    }

    void write_values(std::size_t tile) {
        const TileLight& light = side_frame_.light(tile);
        for_pixels(tile_area(side_frame_, tile), [&](std::size_t local, std::size_t pixel) {
            values_output_->data[pixel] = light.colour[0][local];
        });
    }

    BackwardJob tile_job(Frame& frame, std::size_t tile, const std::uint32_t* ends,
                         BackwardScratch& scratch) const {
        const auto list = frame.entries(tile);
        return {{frame.records(), nullptr, NoSplit},
                list.data(),
                static_cast<std::uint32_t>(list.size()),
                frame.tile_x(tile),
                frame.tile_y(tile),
                frame.width(),
                frame.height(),
                ends,
                &scratch,
                frame.first_active(),
                frame.first_slot(),
                frame.slots()->sums,
                frame.slots_past_caches()};
    }

    void backward_tile(std::size_t tile, BackwardScratch& scratch) {
        load_slopes(tile_area(frame_, tile), frame_.light(tile), slope_, scratch);
        kernels_.backward(tile_job(frame_, tile, frame_.light(tile).ends, scratch));
    }

    void contribute_tile(std::size_t tile, BackwardScratch& scratch) {
        std::memset(scratch.mask, 0, sizeof scratch.mask);
        for_pixels(tile_area(side_frame_, tile),
                   [&](std::size_t local, std::size_t pixel) { scratch.mask[local] = mask_->data[pixel]; });
        kernels_.contribute(tile_job(side_frame_, tile, nullptr, scratch));
    }

    void add_contributions(std::size_t chunk) {
        for (const Record& record : side_frame_.active_records(chunk)) {
            const PairRange range = *side_frame_.ranges(&record);
            const PartialSlot* slot = side_frame_.slots() + (range.begin + side_frame_.slot_shift(chunk));
            double weight = 0, masked = 0;
            for (std::uint32_t pair = 0; pair < range.count; ++pair) {
                weight += static_cast<double>(slot[pair].sums[SumWeight]);
                masked += static_cast<double>(slot[pair].sums[SumMasked]);
            }
            total_[record.row] += weight;
            masked_[record.row] += masked;
        }
    }

    const Kernels& kernels_;
    ThreadPool& pool_;
    Frame frame_;       // of the last forward(), for backward()
    Frame side_frame_;  // of contributions() and forward_values(), which leave forward's state alone
    std::vector<BackwardScratch> scratch_;  // per worker

    // Arguments of the call under way, here so that the loops' bodies capture one pointer and allocate
    // nothing.
    ForwardOutput* output_ = nullptr;
    Image* values_output_ = nullptr;
    PictureSlope slope_;
    const Image* mask_ = nullptr;
    std::span<double> masked_, total_;
    Gradients* gradients_ = nullptr;
    std::size_t first_row_ = 0;
};

}  // namespace

std::unique_ptr<Rasterizer> make_fast_rasterizer(ThreadPool& pool) { return make_fast_rasterizer(pool, ""); }

std::unique_ptr<Rasterizer> make_fast_rasterizer(ThreadPool& pool, const std::string& kernels) {
    return std::make_unique<FastRasterizer>(choose_kernels(kernels.c_str()), pool);
}

}  // namespace gse::raster
