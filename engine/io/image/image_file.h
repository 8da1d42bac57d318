// Image files: 8-bit display values to and from floats in [0,1].
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "engine/base/image.h"

namespace gse {

/// Reads PNG, JPEG, WebP and others: 1, 3 (red, green, blue) or 4 channels, values in [0,1]. Throws Error.
Image read_image(const std::filesystem::path& path);

/// Reads an image file in memory. Throws Error.
Image decode_image(std::span<const std::byte> bytes);

/// Keyword -> text (UTF-8) stored in the PNG. Keywords are 1-79 printable Latin-1 characters.
using PngText = std::map<std::string, std::string>;

/// Writes 1, 3 or 4 channels as 8-bit PNG: value * 255, rounded, clamped (NaN becomes 0). Atomic. Throws
/// Error.
void write_png(const std::filesystem::path& path, const Image& image, const PngText& text = {});

/// Writes the mask as 0 / 255 grey.
void write_mask_png(const std::filesystem::path& path, const Mask& mask);

/// True for a name that ends in .png, in any case.
bool names_png(const std::filesystem::path& path);

/// Reads an image as a mask. A grey value above one half is inside.
Mask read_mask(const std::filesystem::path& path);

/// The text chunks of a PNG (tEXt and uncompressed iTXt).
PngText read_png_text(const std::filesystem::path& path);

/// Width and height from a PNG or JPEG header, without decoding. Nothing for other files.
struct ImageSize {
    int width = 0;
    int height = 0;
};
std::optional<ImageSize> read_image_size(const std::filesystem::path& path);
std::optional<ImageSize> image_size(std::span<const std::byte> bytes);

}  // namespace gse
