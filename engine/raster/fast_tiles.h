// Pixels of a tile and gradients of a chunk of rows, shared by the fast rasterizer and its view sessions.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "engine/raster/fast_frame.h"
#include "engine/raster/kernels.h"
#include "engine/raster/rasterizer.h"

namespace gse::raster {

/// First pixel of a tile and the size of the picture it belongs to.
struct TileArea {
    int x = 0, y = 0;
    int width = 0, height = 0;
};

inline TileArea tile_area(const Frame& frame, std::size_t tile) {
    return {frame.tile_x(tile), frame.tile_y(tile), frame.width(), frame.height()};
}

/// Calls body(local, pixel) for the pixels of a tile that are inside the image. `local` is in block order.
template <class Body> void for_pixels(const TileArea& tile, Body&& body) {
    const int columns = std::min(TileSize, tile.width - tile.x),
              rows = std::min(TileSize, tile.height - tile.y);
    for (int y = 0; y < rows; ++y) {
        const std::size_t line = static_cast<std::size_t>(tile.y + y) * static_cast<std::size_t>(tile.width) +
                                 static_cast<std::size_t>(tile.x);
        const int base = y / 4 * 64 + y % 4 * 4;
        for (int x = 0; x < columns; ++x)
            body(static_cast<std::size_t>(base + x / 4 * 16 + x % 4), line + static_cast<std::size_t>(x));
    }
}

/// Derivative of the loss by the picture. `alpha` may be null.
struct PictureSlope {
    const Image* colour = nullptr;
    const Image* alpha = nullptr;
    std::array<float, 3> background{};
};

/// Gives every array of the picture its size.
void resize_output(int width, int height, ForwardOutput& output);

/// Writes the blended pixels of these blocks of a tile into the picture.
void write_tile(const TileArea& tile, std::uint32_t blocks, const TileLight& light,
                const BlendScratch& scratch, const std::array<float, 3>& background, ForwardOutput& output);

/// Fills the inputs of the backward kernel for a tile: slopes, and the light weighted with them.
void load_slopes(const TileArea& tile, const TileLight& light, const PictureSlope& slope,
                 BackwardScratch& scratch);

/// Gives every array of the gradients its size. Nothing is cleared.
void resize_gradients(std::size_t rows, std::size_t sh_stride, Gradients& output);

/// Gradients of the rows of one chunk from `first_row` on, from the partial sums in the frame's slots. Rows
/// that were not drawn get zeros. Index 0 of the output belongs to `first_row`.
void write_gradients(const Kernels& kernels, Frame& frame, std::size_t chunk, std::size_t first_row,
                     Gradients& output);

}  // namespace gse::raster
