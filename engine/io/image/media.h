// Readers of image files and encoders of films, in plain types. They are a library of their own, loaded on
// demand. OpenCV's readers and FFmpeg bring two hundred libraries along, which most commands do not need.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "engine/base/image.h"

namespace gse::io {

/// Film as it is encoded. Destroy it before its file is read: only then everything is in it.
class FilmEncoder {
public:
    virtual ~FilmEncoder() = default;
    /// One frame: rows of blue, green, red bytes without gaps.
    virtual void write(std::span<const std::uint8_t> frame) = 0;
    /// Four letters of the codec in use.
    virtual const std::string& codec() const = 0;
};

/// Size of a film in pixels; even.
struct FilmSize {
    int width = 0, height = 0;
};

class Media {
public:
    virtual ~Media() = default;
    /// Decodes an image: values in [0,1], 1, 3 (red, green, blue) or 4 channels. Throws Error (Malformed,
    /// Unsupported), OutOfMemory.
    virtual Image decode(std::span<const std::byte> file) = 0;
    /// Opens an encoder, or null if no codec opens the file. Its extension says which are tried.
    virtual std::unique_ptr<FilmEncoder> open_film(const std::filesystem::path& file, FilmSize size,
                                                   double frames_per_second) = 0;
};

/// Loads libgse_media.so on the first call. Throws Error if it is missing.
Media& media();

}  // namespace gse::io
