// MP4 and WebM through OpenCV's FFmpeg, on a thread of their own while the next frames are painted: H.264 where the system can encode it, MPEG-4 elsewhere; VP9 or VP8 for WebM.
#include "engine/io/video.h"

#include <fmt/core.h>
#include <sys/statvfs.h>

#include <array>
#include <cerrno>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/pending_file.h"
#include "engine/io/encoding.h"
#include "engine/io/film_check.h"

#ifdef GSE_HAVE_OPENCV
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>
#endif

namespace gse {

#ifdef GSE_HAVE_OPENCV

struct VideoWriter::State {
    explicit State(const std::filesystem::path& name) : path(name), file(name) {}

    std::filesystem::path path;
    PendingFile file;
    int width = 0, height = 0;  // of the frames handed in
    cv::Size size;              // of the film: even
    cv::VideoWriter writer;
    std::string codec;
    bool finished = false;

    /// Hands a frame (blue-green-red) to the encoder; waits when it has enough to do. Throws what encoding has thrown.
    void hand_over(cv::Mat frame) {
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return waiting.size() < MostWaiting || failure; });
        if (failure) std::rethrow_exception(failure);
        waiting.push_back(std::move(frame));
        changed.notify_all();
    }
    /// Returns when all frames are encoded. Throws what encoding has thrown.
    void end() {
        {
            const std::lock_guard lock(mutex);
            ended = true;
            changed.notify_all();
        }
        if (encoder.joinable()) encoder.join();
        if (failure) std::rethrow_exception(failure);
    }
    void start() {
        encoder = std::jthread([this](const std::stop_token& stop) { encode(stop); });
    }

private:
    static constexpr std::size_t MostWaiting = 4;

    void encode(const std::stop_token& stop) {
        while (true) {
            std::unique_lock lock(mutex);
            changed.wait(lock, stop, [&] { return !waiting.empty() || ended; });
            if (stop.stop_requested() || waiting.empty()) return;
            const cv::Mat frame = std::move(waiting.front());
            waiting.pop_front();
            changed.notify_all();
            lock.unlock();
            try {
                write(frame);
            } catch (...) {
                lock.lock();
                failure = std::current_exception();
                changed.notify_all();
                return;
            }
        }
    }
    void write(const cv::Mat& frame) {
        writer.write(frame);
        // The encoder passes over a full disk; without this the rest of a long film would be made for nothing.
        struct statvfs disk {};
        if (statvfs(file.temporary().c_str(), &disk) == 0 && disk.f_blocks > 0 && disk.f_bfree == 0)
            throw write_error("the film", ENOSPC, path);
    }

    std::mutex mutex;
    std::condition_variable_any changed;
    std::deque<cv::Mat> waiting;
    bool ended = false;
    std::exception_ptr failure;
    std::jthread encoder;   // ends before what it uses goes
};

namespace {

constexpr std::size_t ProbeBytes = std::size_t{1} << 20;

/// Tries the codecs in order; OpenCV says on stderr what it misses, which is no news to the user.
bool open_any_codec(cv::VideoWriter& writer, const std::filesystem::path& file, double rate, cv::Size size,
                    std::string& codec) {
    const auto level = cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    bool opened = false;
    static constexpr std::array<const char*, 2> mp4{"avc1", "mp4v"}, webm{"VP90", "VP80"};
    for (const char* name : file.extension() == ".webm" ? webm : mp4) {
        try {
            opened =
                writer.open(file.string(), cv::CAP_FFMPEG,
                            cv::VideoWriter::fourcc(name[0], name[1], name[2], name[3]), rate, size, true);
        } catch (const cv::Exception&) {
            opened = false;
        }
        codec = name;
        if (opened) break;
    }
    cv::utils::logging::setLogLevel(level);
    return opened;
}

}  // namespace

VideoWriter::VideoWriter(const std::filesystem::path& path, int width, int height, double frames_per_second) {
    if (width < 2 || height < 2 || !(frames_per_second > 0))
        throw Error(ErrorCode::InvalidArgument,
                    fmt::format("a film of {} x {} pixels at {} frames per second cannot be made", width,
                                height, frames_per_second));
    state_ = std::make_unique<State>(path);
    state_->width = width;
    state_->height = height;
    state_->size = {width / 2 * 2, height / 2 * 2};
    if (!open_any_codec(state_->writer, state_->file.temporary(), frames_per_second, state_->size, state_->codec)) {
        state_->file.write(std::string(ProbeBytes, '\0'));  // if the disk is the reason, this says so
        throw Error(ErrorCode::Unwritable, "the film cannot be written: no codec opens this file",
                    "name it .mp4 or .webm, and check that OpenCV has FFmpeg", path);
    }
    state_->start();
}

VideoWriter::~VideoWriter() = default;  // the writer closes its file before that disappears

void VideoWriter::add(const Image& frame) {
    GSE_CHECK(!state_->finished);
    GSE_CHECK_EQ(frame.width, state_->width);
    GSE_CHECK_EQ(frame.height, state_->height);
    const int colours = frame.channels >= 3 ? 3 : 1;
    cv::Mat picture(state_->size, CV_8UC3);
    for (int y = 0; y < picture.rows; ++y) {
        std::uint8_t* out = picture.ptr<std::uint8_t>(y);
        for (int x = 0; x < picture.cols; ++x)
            for (int c = 2; c >= 0; --c)
                *out++ = io::to_byte(static_cast<double>(frame.at(x, y, colours == 3 ? c : 0)) * 255);
    }
    state_->hand_over(std::move(picture));
}

void VideoWriter::finish() {
    GSE_CHECK(!state_->finished);
    state_->end();
    state_->writer.release();
    if (!io::film_is_whole(FileBytes(state_->file.temporary()).bytes())) {
        state_->file.write(std::string(ProbeBytes, '\0'));  // as above
        throw Error(ErrorCode::Unwritable, "the film was not written whole", "check the free space of the disk and write it again",
                    state_->path);
    }
    state_->file.commit();
    state_->finished = true;
}

const std::string& VideoWriter::codec() const { return state_->codec; }

#else

struct VideoWriter::State {
    std::string codec;
};

VideoWriter::VideoWriter(const std::filesystem::path& path, int, int, double) {
    throw Error(ErrorCode::Unsupported, "this build writes no films", "build it with GSE_OPENCV=ON", path);
}
VideoWriter::~VideoWriter() = default;
void VideoWriter::add(const Image&) {}
void VideoWriter::finish() {}
const std::string& VideoWriter::codec() const { return state_->codec; }

#endif

}  // namespace gse
