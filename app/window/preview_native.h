// The viewport painted by the own rasterizer on a thread of its own: newest request wins, resolution drops
// while moving.
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

#include "app/cli/engine_names.h"
#include "app/window/preview_host.h"
#include "engine/pipeline/run/scene_tools.h"
#include "engine/preview/moving_scale.h"
#include "engine/preview/resolve.h"

namespace gse::app {

struct NativePicture {
    std::vector<std::uint8_t> rgba;  // [height,width,4]
    int width = 0, height = 0;
    Camera camera;  // at the size of the request, not of the picture
    Image depth;    // [height,width,1] alpha-normalised, 0 = nothing
    double milliseconds = 0;
    bool full = false;  // at the size asked for
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

/// Pictures that are used again: what the last holder lets go comes back, whichever thread that is.
class PictureStore : public std::enable_shared_from_this<PictureStore> {
public:
    std::shared_ptr<NativePicture> take();

private:
    std::mutex mutex_;
    std::vector<std::unique_ptr<NativePicture>> free_;
};

class NativePreview {
public:
    /// `wake` is called from the painting thread when a picture is ready.
    explicit NativePreview(std::function<void()> wake);
    ~NativePreview();
    NativePreview(const NativePreview&) = delete;
    NativePreview& operator=(const NativePreview&) = delete;

    void want(const PictureRequest& request);
    /// The newest picture that has not been taken yet, or null. Its memory is used again once nobody holds
    /// it.
    std::shared_ptr<const NativePicture> take();
    bool busy() const;
    bool painting() const;  // something is being painted or waits for it
    /// What the window needs for a frame beside the picture: the resolution while moving leaves room for it.
    void set_window_ms(double milliseconds);
    std::string name() const;

private:
    struct Wanted {
        PictureRequest request;
        bool valid = false;
    };
    void loop(const std::stop_token& end);

    mutable std::mutex mutex_;
    std::condition_variable_any changed_;
    Wanted wanted_;
    std::optional<PictureRequest> painted_;  // what the newest picture shows
    bool painted_full_ = false, painting_ = false;
    std::shared_ptr<const NativePicture> ready_;
    std::shared_ptr<PictureStore> store_ = std::make_shared<PictureStore>();
    preview::MovingScale moving_scale_;
    double window_ms_ = 0;
    std::string name_;
    std::function<void()> wake_;
    std::jthread thread_;
};

}  // namespace gse::app
