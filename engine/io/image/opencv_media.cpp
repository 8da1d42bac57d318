// Image files by OpenCV's readers; MP4 and WebM by its FFmpeg. MP4 is H.264 if the system can encode it,
// MPEG-4 otherwise. WebM is VP9 or VP8.
#include <fmt/format.h>

#include <array>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/base/memory.h"
#include "engine/io/image/media.h"

namespace gse::io {
namespace {

/// OpenCV's blue-green-red rows to red-green-blue floats.
template <class T> void copy_pixels(const cv::Mat& from, double scale, Image& to) {
    const int channels = to.channels;
    float* out = to.data.data();
    for (int y = 0; y < to.height; ++y) {
        const T* row = from.ptr<T>(y);
        for (int x = 0; x < to.width; ++x, row += channels)
            for (int c = 0; c < channels; ++c) {
                const int source = channels >= 3 && c < 3 ? 2 - c : c;
                *out++ = static_cast<float>(static_cast<double>(row[source]) * scale);
            }
    }
}

cv::Mat decoded(std::span<const std::byte> bytes) {
    try {
        const cv::Mat raw(1, static_cast<int>(bytes.size()), CV_8U, const_cast<std::byte*>(bytes.data()));
        return cv::imdecode(raw, cv::IMREAD_UNCHANGED);
    } catch (const cv::Exception& failure) {
        if (failure.code == cv::Error::StsNoMem) throw out_of_memory();
        throw Error(ErrorCode::Malformed, "the image cannot be decoded (" + failure.err + ")");
    }
}

class OpenCvFilm final : public FilmEncoder {
public:
    /// Tries the codecs in order. OpenCV's complaints on stderr are no news to the user.
    bool open(const std::filesystem::path& file, double rate, FilmSize size) {
        const auto level = cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
        size_ = {size.width, size.height};
        bool opened = false;
        static constexpr std::array<const char*, 2> mp4{"avc1", "mp4v"}, webm{"VP90", "VP80"};
        for (const char* name : file.extension() == ".webm" ? webm : mp4) {
            try {
                opened = writer_.open(file.string(), cv::CAP_FFMPEG,
                                      cv::VideoWriter::fourcc(name[0], name[1], name[2], name[3]), rate,
                                      size_, true);
            } catch (const cv::Exception&) { opened = false; }
            codec_ = name;
            if (opened) break;
        }
        cv::utils::logging::setLogLevel(level);
        return opened;
    }
    void write(std::span<const std::uint8_t> frame) override {
        GSE_CHECK_EQ(frame.size(),
                     static_cast<std::size_t>(size_.width) * static_cast<std::size_t>(size_.height) * 3);
        writer_.write(cv::Mat(size_, CV_8UC3, const_cast<std::uint8_t*>(frame.data())));
    }
    const std::string& codec() const override { return codec_; }

private:
    cv::Size size_;
    cv::VideoWriter writer_;
    std::string codec_;
};

class OpenCvMedia final : public Media {
public:
    Image decode(std::span<const std::byte> file) override {
        const cv::Mat pixels = decoded(file);
        if (pixels.empty()) throw Error(ErrorCode::Malformed, "the file is no image that can be read");
        const int channels = pixels.channels();
        if (channels == 2 || channels > 4)
            throw Error(ErrorCode::Unsupported,
                        fmt::format("an image of {} channels is not handled", channels));
        Image image(pixels.cols, pixels.rows, channels);
        switch (pixels.depth()) {
            case CV_8U: copy_pixels<std::uint8_t>(pixels, 1.0 / 255, image); break;
            case CV_16U: copy_pixels<std::uint16_t>(pixels, 1.0 / 65535, image); break;
            case CV_32F: copy_pixels<float>(pixels, 1, image); break;
            default: throw Error(ErrorCode::Unsupported, "the pixel type of the image is not handled");
        }
        return image;
    }
    std::unique_ptr<FilmEncoder> open_film(const std::filesystem::path& file, FilmSize size,
                                           double frames_per_second) override {
        auto film = std::make_unique<OpenCvFilm>();
        if (!film->open(file, frames_per_second, size)) return nullptr;
        return film;
    }
};

}  // namespace
}  // namespace gse::io

extern "C" gse::io::Media* gse_media() {
    static gse::io::OpenCvMedia library;
    return &library;
}
