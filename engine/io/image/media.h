// What reads image files and encodes films, in plain types: a library of its own, which the first such file
// loads. OpenCV's readers and FFmpeg bring two hundred libraries along, 0.3 s for a program that may never
// see a picture.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "engine/base/image.h"

namespace gse::io {

/// A film as it is encoded. Goes before its file is looked at: only then everything is in it.
class FilmEncoder {
public:
    virtual ~FilmEncoder() = default;
    /// One frame: rows of blue, green, red bytes without gaps.
    virtual void write(std::span<const std::uint8_t> frame) = 0;
    /// Four letters of the codec in use.
    virtual const std::string& codec() const = 0;
};

/// Of a film, pixels; even.
struct FilmSize {
    int width = 0, height = 0;
};

class Media {
public:
    virtual ~Media() = default;
    /// Values in [0,1], 1, 3 (red, green, blue) or 4 channels. Throws Error (Malformed, Unsupported),
    /// OutOfMemory.
    virtual Image decode(std::span<const std::byte> file) = 0;
    /// Null where no codec opens the file. Its extension says which are tried.
    virtual std::unique_ptr<FilmEncoder> open_film(const std::filesystem::path& file, FilmSize size,
                                                   double frames_per_second) = 0;
};

/// Loads libgse_media.so on the first call. Throws Error where it is missing.
Media& media();

}  // namespace gse::io
