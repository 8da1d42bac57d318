// Tiles in and out of the kernels' block order, and the chain rule of a chunk.
#include "engine/raster/fast_tiles.h"

#include <cstring>

namespace gse::raster {

void resize_output(int width, int height, ForwardOutput& output) {
    output.colour.resize(width, height, 3);
    output.alpha.resize(width, height, 1);
    output.depth.resize(width, height, 1);
    output.blended.resize(output.alpha.pixel_count());
}

void write_tile(const TileArea& tile, std::uint32_t blocks, const TileLight& light, const BlendScratch& scratch,
                const std::array<float, 3>& background, ForwardOutput& output) {
    for_pixels(tile, [&](std::size_t local, std::size_t pixel) {
        if ((blocks >> local / 16 & 1u) == 0) return;
        const float rest = light.transmittance[local];
        for (std::size_t channel = 0; channel < 3; ++channel)
            output.colour.data[pixel * 3 + channel] = light.colour[channel][local] + rest * background[channel];
        output.alpha.data[pixel] = 1.0f - rest;
        output.depth.data[pixel] = scratch.depth[local];
        output.blended[pixel] = scratch.blended[local];
    });
}

void load_slopes(const TileArea& tile, const TileLight& light, const PictureSlope& slope, BackwardScratch& scratch) {
    std::memset(scratch.remaining, 0, sizeof scratch.remaining);
    std::memset(scratch.d_colour, 0, sizeof scratch.d_colour);
    for_pixels(tile, [&](std::size_t local, std::size_t pixel) {
        const float rest = light.transmittance[local];
        float remaining = slope.alpha != nullptr ? -slope.alpha->data[pixel] * rest : 0.0f;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const float d = slope.colour->data[pixel * 3 + channel];
            scratch.d_colour[channel][local] = d;
            remaining += d * (light.colour[channel][local] + rest * slope.background[channel]);
        }
        scratch.remaining[local] = remaining;
    });
}

void resize_gradients(std::size_t rows, std::size_t sh_stride, Gradients& output) {
    output.position.resize(rows * 3);
    output.log_scale.resize(rows * 3);
    output.rotation.resize(rows * 4);
    output.opacity_logit.resize(rows);
    output.sh.resize(rows * sh_stride);
    output.mean2d_norm.resize(rows);
    output.visible.resize(rows);
}

void write_gradients(const Kernels& kernels, Frame& frame, std::size_t chunk, std::size_t first_row, Gradients& output) {
    const std::size_t stride = frame.source().sh_stride;
    const std::size_t begin = std::max(chunk * Frame::ChunkRows, first_row) - first_row;
    const std::size_t end = std::min((chunk + 1) * Frame::ChunkRows, frame.row_count()) - first_row;
    if (begin >= end) return;
    const auto clear = [&](auto& values, std::size_t width) {
        std::memset(values.data() + begin * width, 0, (end - begin) * width * sizeof values[0]);
    };
    clear(output.position, 3);
    clear(output.log_scale, 3);
    clear(output.rotation, 4);
    clear(output.opacity_logit, 1);
    clear(output.sh, stride);
    clear(output.mean2d_norm, 1);
    clear(output.visible, 1);
    const auto records = frame.active_records(chunk);
    const GradientJob job = {frame.source(),
                             &frame.view(),
                             records.data(),
                             records.data() + records.size(),
                             frame.ranges(records.data()),
                             frame.slot_shift(chunk),
                             frame.slots()->sums,
                             first_row,
                             {output.position.data(), output.log_scale.data(), output.rotation.data(),
                              output.opacity_logit.data(), output.sh.data(), output.mean2d_norm.data(),
                              output.visible.data()}};
    kernels.gradient(job);
}

}  // namespace gse::raster
