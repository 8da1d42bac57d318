// The fast float rasterizer: prepared frames, tiles blended by the kernels of one instruction set, threads.
#include <algorithm>
#include <cstring>
#include <vector>

#include "engine/base/check.h"
#include "engine/raster/fast_frame.h"
#include "engine/raster/kernels.h"
#include "engine/raster/rasterizer.h"

namespace gse::raster {
namespace {

/// Calls body(local, pixel) for the pixels of a tile that are inside the image; local is in block order.
template <class Body>
void for_pixels(const Frame& frame, std::size_t tile, Body&& body) {
    const int x0 = frame.tile_x(tile), y0 = frame.tile_y(tile);
    const int columns = std::min(TileSize, frame.width() - x0),
              rows = std::min(TileSize, frame.height() - y0);
    for (int y = 0; y < rows; ++y) {
        const std::size_t line = static_cast<std::size_t>(y0 + y) * static_cast<std::size_t>(frame.width()) +
                                 static_cast<std::size_t>(x0);
        const int base = y / 4 * 64 + y % 4 * 4;
        for (int x = 0; x < columns; ++x)
            body(static_cast<std::size_t>(base + x / 4 * 16 + x % 4), line + static_cast<std::size_t>(x));
    }
}

class FastRasterizer final : public Rasterizer {
public:
    FastRasterizer(const Kernels& kernels, ThreadPool& pool)
        : kernels_(kernels), pool_(pool), frame_(kernels, pool), side_frame_(kernels, pool) {}

    void forward(const GaussianSpans& gaussians, const Camera& camera, const Settings& settings,
                 ForwardOutput& output) override {
        frame_.prepare(gaussians, camera, settings, {});
        background_ = settings.background;
        output.colour.resize(camera.width, camera.height, 3);
        output.alpha.resize(camera.width, camera.height, 1);
        output.depth.resize(camera.width, camera.height, 1);
        output.blended.resize(output.alpha.pixel_count());
        output.pairs = frame_.pair_count();
        output.dropped_rows = frame_.unusable_rows();
        output_ = &output;
        frame_.blend(
            [](void* self, std::size_t tile, const BlendScratch& scratch) {
                static_cast<FastRasterizer*>(self)->write_tile(tile, scratch);
            },
            this);
    }

    void backward(const Image& d_colour, const Image& d_alpha, std::size_t first_row,
                  Gradients& output) override {
        GSE_CHECK(first_row <= frame_.row_count());
        const std::size_t pixels =
            static_cast<std::size_t>(frame_.width()) * static_cast<std::size_t>(frame_.height());
        GSE_CHECK_EQ(d_colour.data.size(), pixels * 3);
        GSE_CHECK(d_alpha.data.empty() || d_alpha.data.size() == pixels);
        d_colour_ = &d_colour;
        d_alpha_ = d_alpha.data.empty() ? nullptr : &d_alpha;
        first_row_ = first_row;
        gradients_ = &output;
        resize(output, frame_.row_count() - first_row);
        frame_.assign_slots(first_row);
        grow_scratch();
        frame_.for_tiles([this](std::size_t begin, std::size_t end, unsigned worker) {
            for (std::size_t tile = begin; tile < end; ++tile) backward_tile(tile, scratch_[worker]);
        });
        const std::size_t first_chunk = first_row / Frame::ChunkRows;
        pool_.parallel_for(frame_.chunk_count() - std::min(first_chunk, frame_.chunk_count()), 2,
                           [this](std::size_t begin, std::size_t end, unsigned) {
                               const std::size_t skipped = first_row_ / Frame::ChunkRows;
                               for (std::size_t i = begin; i < end; ++i) gradient_chunk(skipped + i);
                           });
    }

    void contributions(const GaussianSpans& gaussians, const Camera& camera, const Settings& settings,
                       const Image& mask, std::span<double> masked, std::span<double> total) override {
        GSE_CHECK_EQ(masked.size(), gaussians.size);
        GSE_CHECK_EQ(total.size(), gaussians.size);
        GSE_CHECK(mask.width == camera.width && mask.height == camera.height && mask.channels == 1);
        side_frame_.prepare(gaussians, camera, settings, {});
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
        side_frame_.prepare(gaussians, camera, settings, values);
        output.resize(camera.width, camera.height, 1);
        values_output_ = &output;
        side_frame_.blend([](void* self, std::size_t tile,
                             const BlendScratch&) { static_cast<FastRasterizer*>(self)->write_values(tile); },
                          this);
    }

    std::string name() const override { return kernels_.name; }

private:
    void grow_scratch() {
        if (scratch_.size() < pool_.thread_count()) scratch_.resize(pool_.thread_count());
    }

    void resize(Gradients& g, std::size_t rows) const {
        g.position.resize(rows * 3);
        g.log_scale.resize(rows * 3);
        g.rotation.resize(rows * 4);
        g.opacity_logit.resize(rows);
        g.sh.resize(rows * frame_.source().sh_stride);
        g.mean2d_norm.resize(rows);
        g.visible.resize(rows);
    }

    void write_tile(std::size_t tile, const BlendScratch& scratch) {
        const TileLight& light = frame_.light(tile);
        for_pixels(frame_, tile, [&](std::size_t local, std::size_t pixel) {
            const float rest = light.transmittance[local];
            for (std::size_t channel = 0; channel < 3; ++channel)
                output_->colour.data[pixel * 3 + channel] =
                    light.colour[channel][local] + rest * background_[channel];
            output_->alpha.data[pixel] = 1.0f - rest;
            output_->depth.data[pixel] = scratch.depth[local];
            output_->blended[pixel] = scratch.blended[local];
        });
    }

    void write_values(std::size_t tile) {
        const TileLight& light = side_frame_.light(tile);
        for_pixels(side_frame_, tile, [&](std::size_t local, std::size_t pixel) {
            values_output_->data[pixel] = light.colour[0][local];
        });
    }

    BackwardJob tile_job(Frame& frame, std::size_t tile, BackwardScratch& scratch) const {
        const auto list = frame.entries(tile);
        return {frame.records(),    list.data(),        static_cast<std::uint32_t>(list.size()),
                frame.tile_x(tile), frame.tile_y(tile), frame.width(),
                frame.height(),     &scratch,           frame.first_active(),
                frame.slots()->sums};
    }

    void backward_tile(std::size_t tile, BackwardScratch& scratch) {
        const TileLight& light = frame_.light(tile);
        std::memset(scratch.remaining, 0, sizeof scratch.remaining);
        std::memset(scratch.d_colour, 0, sizeof scratch.d_colour);
        for_pixels(frame_, tile, [&](std::size_t local, std::size_t pixel) {
            const float rest = light.transmittance[local];
            float remaining = d_alpha_ != nullptr ? -d_alpha_->data[pixel] * rest : 0.0f;
            for (std::size_t channel = 0; channel < 3; ++channel) {
                const float d = d_colour_->data[pixel * 3 + channel];
                scratch.d_colour[channel][local] = d;
                remaining += d * (light.colour[channel][local] + rest * background_[channel]);
            }
            scratch.remaining[local] = remaining;
        });
        kernels_.backward(tile_job(frame_, tile, scratch));
    }

    void gradient_chunk(std::size_t chunk) {
        Gradients& g = *gradients_;
        const std::size_t stride = frame_.source().sh_stride;
        const std::size_t begin = std::max(chunk * Frame::ChunkRows, first_row_) - first_row_;
        const std::size_t end = std::min((chunk + 1) * Frame::ChunkRows, frame_.row_count()) - first_row_;
        if (begin >= end) return;
        const auto clear = [&](auto& values, std::size_t width) {
            std::memset(values.data() + begin * width, 0, (end - begin) * width * sizeof values[0]);
        };
        clear(g.position, 3);
        clear(g.log_scale, 3);
        clear(g.rotation, 4);
        clear(g.opacity_logit, 1);
        clear(g.sh, stride);
        clear(g.mean2d_norm, 1);
        clear(g.visible, 1);
        const auto records = frame_.active_records(chunk);
        const GradientJob job = {
            frame_.source(),
            &frame_.view(),
            records.data(),
            records.data() + records.size(),
            frame_.slots()->sums,
            first_row_,
            {g.position.data(), g.log_scale.data(), g.rotation.data(), g.opacity_logit.data(), g.sh.data(),
             g.mean2d_norm.data(), g.visible.data()}};
        kernels_.gradient(job);
    }

    void contribute_tile(std::size_t tile, BackwardScratch& scratch) {
        std::memset(scratch.mask, 0, sizeof scratch.mask);
        for_pixels(side_frame_, tile,
                   [&](std::size_t local, std::size_t pixel) { scratch.mask[local] = mask_->data[pixel]; });
        kernels_.contribute(tile_job(side_frame_, tile, scratch));
    }

    void add_contributions(std::size_t chunk) {
        for (const Record& record : side_frame_.active_records(chunk)) {
            const PartialSlot* slot = side_frame_.slots() + record.partial_begin;
            double weight = 0, masked = 0;
            for (std::uint32_t pair = 0; pair < record.pair_count; ++pair) {
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
    std::array<float, 3> background_{};

    // Arguments of the call under way, here so that the loops' bodies capture one pointer and allocate
    // nothing.
    ForwardOutput* output_ = nullptr;
    Image* values_output_ = nullptr;
    const Image* d_colour_ = nullptr;
    const Image* d_alpha_ = nullptr;
    const Image* mask_ = nullptr;
    std::span<double> masked_, total_;
    Gradients* gradients_ = nullptr;
    std::size_t first_row_ = 0;
};

}  // namespace

std::unique_ptr<Rasterizer> make_fast_rasterizer(ThreadPool& pool) {
    return make_fast_rasterizer(pool, "");
}

std::unique_ptr<Rasterizer> make_fast_rasterizer(ThreadPool& pool, const std::string& kernels) {
    return std::make_unique<FastRasterizer>(choose_kernels(kernels.c_str()), pool);
}

}  // namespace gse::raster
