// Tiles in and out of the kernels' block order, and the chain rule of a chunk.
#include "engine/raster/fast_tiles.h"

#include <cstring>

namespace gse::raster {
namespace {

/// Four pixels of one row of a block: neighbours in the picture and in block order.
using Quad = float __attribute__((vector_size(16)));

Quad load_quad(const float* from) {
    Quad quad;
    std::memcpy(&quad, from, sizeof quad);
    return quad;
}

void store_quad(float* to, Quad quad) { std::memcpy(to, &quad, sizeof quad); }

/// Red, green and blue of four pixels -> r g b r g b ...
void store_interleaved(const Quad* colour, float* to) {
    const Quad &r = colour[0], &g = colour[1], &b = colour[2];
    const Quad low = __builtin_shufflevector(r, g, 0, 4, 1, 5),
               high = __builtin_shufflevector(r, g, 2, 6, 3, 7);
    store_quad(to, __builtin_shufflevector(low, b, 0, 1, 4, 2));
    store_quad(to + 4,
               __builtin_shufflevector(__builtin_shufflevector(low, b, 3, 5, 3, 5), high, 0, 1, 4, 5));
    store_quad(to + 8, __builtin_shufflevector(b, high, 2, 6, 7, 3));
}

void load_interleaved(const float* from, Quad* colour) {
    const Quad a = load_quad(from), b = load_quad(from + 4), c = load_quad(from + 8);
    colour[0] = __builtin_shufflevector(__builtin_shufflevector(a, b, 0, 3, 6, 6), c, 0, 1, 2, 5);
    colour[1] = __builtin_shufflevector(__builtin_shufflevector(a, b, 1, 4, 7, 7), c, 0, 1, 2, 6);
    colour[2] = __builtin_shufflevector(__builtin_shufflevector(a, b, 2, 5, 5, 5), c, 0, 1, 4, 7);
}

bool is_whole(const TileArea& tile) {
    return tile.x + TileSize <= tile.width && tile.y + TileSize <= tile.height;
}

/// for_pixels(), four at once, for a tile inside the picture.
template <class Body> void for_quads(const TileArea& tile, Body&& body) {
    for (std::size_t y = 0; y < TileSize; ++y) {
        const std::size_t line =
            (static_cast<std::size_t>(tile.y) + y) * static_cast<std::size_t>(tile.width) +
            static_cast<std::size_t>(tile.x);
        for (std::size_t x = 0; x < TileSize; x += 4) body(y / 4 * 64 + y % 4 * 4 + x * 4, line + x);
    }
}

/// True when the coefficients' gradients exceed the caches, and each row's are whole cache lines.
bool is_past_caches(const Frame& frame, const Gradients& output) {
    constexpr std::size_t line_floats = CacheLine / sizeof(float);
    const std::size_t stride = frame.source().sh_stride;
    return output.sh.size() * sizeof(float) > CachedBytes && stride % line_floats == 0 &&
           static_cast<std::size_t>(frame.view().sh_count) * 3 == stride;
}

}  // namespace

void resize_output(int width, int height, ForwardOutput& output) {
    output.colour.resize(width, height, 3);
    output.alpha.resize(width, height, 1);
    output.depth.resize(width, height, 1);
    output.blended.resize(output.alpha.pixel_count());
}

void write_tile(const TileArea& tile, std::uint32_t blocks, const TileLight& light,
                const BlendScratch& scratch, const std::array<float, 3>& background, ForwardOutput& output) {
    const auto touched = [&](std::size_t local) { return (blocks >> local / 16 & 1u) != 0; };
    if (is_whole(tile))
        return for_quads(tile, [&](std::size_t local, std::size_t pixel) {
            if (!touched(local)) return;
            const Quad rest = load_quad(light.transmittance + local);
            Quad colour[3];
            for (std::size_t channel = 0; channel < 3; ++channel)
                colour[channel] = load_quad(light.colour[channel] + local) + rest * background[channel];
            store_interleaved(colour, output.colour.data.data() + pixel * 3);
            store_quad(output.alpha.data.data() + pixel, 1.0f - rest);
            store_quad(output.depth.data.data() + pixel, load_quad(scratch.depth + local));
            std::memcpy(output.blended.data() + pixel, scratch.blended + local, sizeof(std::int32_t) * 4);
        });
    for_pixels(tile, [&](std::size_t local, std::size_t pixel) {
        if (!touched(local)) return;
        const float rest = light.transmittance[local];
        for (std::size_t channel = 0; channel < 3; ++channel)
            output.colour.data[pixel * 3 + channel] =
                light.colour[channel][local] + rest * background[channel];
        output.alpha.data[pixel] = 1.0f - rest;
        output.depth.data[pixel] = scratch.depth[local];
        output.blended[pixel] = scratch.blended[local];
    });
}

void load_slopes(const TileArea& tile, const TileLight& light, const PictureSlope& slope,
                 BackwardScratch& scratch) {
    if (is_whole(tile))
        return for_quads(tile, [&](std::size_t local, std::size_t pixel) {
            const Quad rest = load_quad(light.transmittance + local);
            Quad remaining =
                slope.alpha != nullptr ? -load_quad(slope.alpha->data.data() + pixel) * rest : Quad{};
            Quad d[3];
            load_interleaved(slope.colour->data.data() + pixel * 3, d);
            for (std::size_t channel = 0; channel < 3; ++channel) {
                store_quad(scratch.d_colour[channel] + local, d[channel]);
                remaining += d[channel] *
                             (load_quad(light.colour[channel] + local) + rest * slope.background[channel]);
            }
            store_quad(scratch.remaining + local, remaining);
        });
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

void write_gradients(const Kernels& kernels, Frame& frame, std::size_t chunk, std::size_t first_row,
                     Gradients& output) {
    const std::size_t begin = std::max(chunk * Frame::ChunkRows, first_row);
    const std::size_t end = std::min((chunk + 1) * Frame::ChunkRows, frame.row_count());
    if (begin >= end) return;
    const auto records = frame.active_records(chunk);
    const GradientJob job = {
        frame.source(),
        &frame.view(),
        records.data(),
        records.data() + records.size(),
        frame.ranges(records.data()),
        frame.slot_shift(chunk),
        frame.slots()->sums,
        begin,
        end,
        first_row,
        {output.position.data(), output.log_scale.data(), output.rotation.data(), output.opacity_logit.data(),
         output.sh.data(), output.mean2d_norm.data(), output.visible.data()},
        is_past_caches(frame, output)};
    kernels.gradient(job);
}

}  // namespace gse::raster
