// Films, encoded on a thread of their own while the next frames are painted.
#include "engine/io/image/video.h"

#include <fmt/core.h>
#include <sys/statvfs.h>

#include <cerrno>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/pending_file.h"
#include "engine/io/bytes/encoding.h"
#include "engine/io/image/film_check.h"
#include "engine/io/image/media.h"

namespace gse {

struct VideoWriter::State {
    explicit State(const std::filesystem::path& name) : path(name), file(name) {}

    std::filesystem::path path;
    PendingFile file;
    int width = 0, height = 0;                // of the frames handed in
    io::FilmSize size;                        // of the film: even
    std::unique_ptr<io::FilmEncoder> writer;  // closes its file before that disappears
    std::string codec;
    bool finished = false;

    using Frame = std::vector<std::uint8_t>;  // rows of blue, green, red

    /// Hands a frame to the encoder. Waits when it has enough to do. Rethrows errors of the encoding.
    void hand_over(Frame frame) {
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return waiting.size() < MostWaiting || failure; });
        if (failure) std::rethrow_exception(failure);
        waiting.push_back(std::move(frame));
        changed.notify_all();
    }
    /// Returns when all frames are encoded. Rethrows errors of the encoding.
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
            const Frame frame = std::move(waiting.front());
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
    void write(const Frame& frame) {
        writer->write(frame);
        // The encoder passes over a full disk; without this the rest of a long film would be made for
        // nothing.
        struct statvfs disk {};
        if (statvfs(file.temporary().c_str(), &disk) == 0 && disk.f_blocks > 0 && disk.f_bfree == 0)
            throw write_error("the film", ENOSPC, path);
    }

    std::mutex mutex;
    std::condition_variable_any changed;
    std::deque<Frame> waiting;
    bool ended = false;
    std::exception_ptr failure;
    std::jthread encoder;  // ends before what it uses goes
};

namespace {

constexpr std::size_t ProbeBytes = std::size_t{1} << 20;

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
    state_->writer = io::media().open_film(state_->file.temporary(), state_->size, frames_per_second);
    if (!state_->writer) {
        state_->file.write(std::string(ProbeBytes, '\0'));  // if the disk is the reason, this says so
        throw Error(ErrorCode::Unwritable, "the film cannot be written: no codec opens this file",
                    "name it .mp4 or .webm, and check that OpenCV has FFmpeg", path);
    }
    state_->codec = state_->writer->codec();
    state_->start();
}

VideoWriter::~VideoWriter() = default;

void VideoWriter::add(const Image& frame) {
    GSE_CHECK(!state_->finished);
    GSE_CHECK_EQ(frame.width, state_->width);
    GSE_CHECK_EQ(frame.height, state_->height);
    const int colours = frame.channels >= 3 ? 3 : 1;
    const auto [width, height] = state_->size;
    State::Frame picture;
    picture.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 2; c >= 0; --c)
                picture.push_back(
                    io::to_byte(static_cast<double>(frame.at(x, y, colours == 3 ? c : 0)) * 255));
    state_->hand_over(std::move(picture));
}

void VideoWriter::finish() {
    GSE_CHECK(!state_->finished);
    state_->end();
    state_->writer.reset();
    if (!io::film_is_whole(FileBytes(state_->file.temporary()).bytes())) {
        state_->file.write(std::string(ProbeBytes, '\0'));  // as above
        throw Error(ErrorCode::Unwritable, "the film was not written whole",
                    "check the free space of the disk and write it again", state_->path);
    }
    state_->file.commit();
    state_->finished = true;
}

const std::string& VideoWriter::codec() const { return state_->codec; }

}  // namespace gse
