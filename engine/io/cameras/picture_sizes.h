// Sizes of the pictures that a camera file names, for files that do not state them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "engine/io/cameras/any_case.h"
#include "engine/io/image/image_file.h"

namespace gse::io {

class PictureSizes {
public:
    /// `folder` holds the camera file; empty = no pictures.
    explicit PictureSizes(std::filesystem::path folder) : folder_(std::move(folder)) {}

    /// Size of the picture at `file_path`. Backslashes part folders as slashes do, and the ending may be
    /// missing or in another case. Paths of another machine are looked for by their last parts. Nothing where
    /// the picture is not there or cannot be read.
    std::optional<ImageSize> find(const std::string& file_path);

private:
    std::filesystem::path folder_;
    AnyCase files_;
};

}  // namespace gse::io
