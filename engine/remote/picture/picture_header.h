// Facts of a picture file from its first bytes, read before any library decodes it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace gse::remote {

enum class PictureFormat { Png, Jpeg, Webp };

struct PictureHeader {
    PictureFormat format = PictureFormat::Png;
    std::uint32_t width = 0, height = 0;  // pixels
};

/// Largest pictures that are taken from a server.
struct PictureLimits {
    std::uint32_t side = 4096;
    std::uint64_t pixels = std::uint64_t{16} << 20;
};

/// Reads the header of a PNG, JPEG or WebP file, whatever its name says. Throws Error (Malformed) for other
/// formats, damaged headers, animations, sizes of 0, and pictures beyond the limits.
PictureHeader read_picture_header(std::span<const std::byte> bytes, const PictureLimits& limits);

}  // namespace gse::remote
