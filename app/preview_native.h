// The viewport painted by the own rasterizer on a thread of its own: newest request wins, resolution drops while moving.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/preview_host.h"
#include "app/scene_tools.h"
#include "engine/preview/resolve.h"

namespace gse::app {

struct NativePicture {
    std::vector<std::uint8_t> rgba;        // [height,width,4]
    int width = 0, height = 0;
    Camera camera;                         // at the size of the request, not of the picture
    std::shared_ptr<const Image> depth;    // [height,width,1] alpha-normalised, 0 = nothing
    double milliseconds = 0;
    bool full = false;                     // at the size asked for
};

/// Settings of the request in the preview's terms. Throws nothing: a colour that cannot be read is black.
preview::Display display_of(const PictureRequest& request);

/// One picture on the calling thread. Keeps its scratch between calls.
class NativePainter {
public:
    explicit NativePainter(unsigned threads = 0) : painter_(threads) {}
    /// At width x height; comparisons are put together from the columns of both sides.
    void paint(const PictureRequest& request, int width, int height, NativePicture& picture);
    std::string name() { return painter_.rasterizer().name(); }

private:
    void paint_part(const PictureRequest& request, bool original, const Camera& camera, int first_column,
                    NativePicture& picture);
    Painter painter_;
    Image values_;
    std::vector<std::uint8_t> part_;
};

class NativePreview {
public:
    /// `wake` is called from the painting thread when a picture is ready.
    explicit NativePreview(std::function<void()> wake);
    ~NativePreview();
    NativePreview(const NativePreview&) = delete;
    NativePreview& operator=(const NativePreview&) = delete;

    void want(const PictureRequest& request);
    /// The newest picture that has not been taken yet.
    std::optional<NativePicture> take();
    bool busy() const;
    std::string name() const { return name_; }

private:
    struct Wanted {
        PictureRequest request;
        bool valid = false;
    };
    void loop(const std::stop_token& end);
    void learn(const NativePicture& picture, bool moving);

    mutable std::mutex mutex_;
    std::condition_variable_any changed_;
    Wanted wanted_;
    std::optional<PictureRequest> painted_;   // what the newest picture shows
    bool painted_full_ = false, painting_ = false;
    std::optional<NativePicture> ready_;
    double moving_scale_ = 0.5;               // share of the full width while moving
    std::string name_;
    std::function<void()> wake_;
    std::jthread thread_;
};

}  // namespace gse::app
