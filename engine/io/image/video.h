// MP4 and WebM films (told by the file's extension) made of float images.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "engine/base/image.h"

namespace gse {

/// Writes frames to a temporary file beside `path`; finish() renames it. A writer that dies unfinished leaves
/// nothing.
class VideoWriter {
public:
    /// Every frame must be width x height. Odd sizes lose their last row or column, since MP4 needs even
    /// ones. Throws Error (Unsupported without OpenCV or a working codec, Unwritable).
    VideoWriter(const std::filesystem::path& path, int width, int height, double frames_per_second);
    ~VideoWriter();
    VideoWriter(const VideoWriter&) = delete;
    VideoWriter& operator=(const VideoWriter&) = delete;

    /// Adds one frame of 1, 3 or 4 channels in [0,1].
    void add(const Image& frame);
    /// Closes the film and gives it its name.
    void finish();
    /// Four letters of the codec in use.
    const std::string& codec() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace gse
