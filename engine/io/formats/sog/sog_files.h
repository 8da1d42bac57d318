// SOG scenes among files of a folder or a zip archive, and their WebP textures as bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/io/bytes/part_files.h"
#include "engine/scene/scene.h"

namespace gse::io {

/// Reads the scene that the file `meta` among these describes. Throws Error.
Scene read_sog(const PartFiles& files, const std::string& meta);
/// Reads the finest level of a streamed scene and its environment. `lod_meta` is its lod-meta.json. Throws
/// Error.
Scene read_sog_levels(const PartFiles& files, const std::string& lod_meta);

/// The archive's bytes must outlive the result.
std::unique_ptr<PartFiles> open_sog_archive(std::span<const std::byte> bytes);

/// RGBA texture, row-major. Texel i belongs to splat i.
struct Texture {
    std::size_t width = 0;
    std::size_t height = 0;
    std::vector<std::uint8_t> rgba;  // [height * width, 4]

    std::size_t texel_count() const { return width * height; }
    const std::uint8_t* texel(std::size_t index) const { return rgba.data() + index * 4; }
};

/// Decodes a WebP picture that lies in a scene of `stored_bytes`. `name` is for messages. Throws Error
/// (Malformed) or OutOfMemory.
Texture decode_webp(std::span<const std::byte> bytes, const std::string& name, std::uint64_t stored_bytes);
/// Lossless WebP picture of the texture. Every byte comes back, those of transparent texels too. Sides of 1
/// to 16383. Equal textures give equal bytes. Throws Error (Foreign).
std::string encode_webp(const Texture& texture);

}  // namespace gse::io
