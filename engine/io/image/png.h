// PNG without a picture library: a small encoder with text chunks, and a reader of headers and text.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "engine/io/image/image_file.h"

namespace gse::io {

/// 8-bit pixels, interleaved. Channels are 1 (grey), 3 or 4.
struct BytePixels {
    int width = 0;
    int height = 0;
    int channels = 0;
    std::span<const std::uint8_t> data;
};

std::string encode_png(const BytePixels& pixels, const PngText& text);
/// Text chunks of a PNG. Broken chunks end the search.
PngText parse_png_text(std::span<const std::byte> bytes);
/// Size of a PNG or JPEG from its header.
std::optional<ImageSize> parse_image_size(std::span<const std::byte> bytes);

}  // namespace gse::io
