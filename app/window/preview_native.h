// The viewport painted by the own rasterizer on a thread of its own: newest request wins, resolution drops
// while moving.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/engine_names.h"
#include "app/session/preview_host.h"
#include "app/session/shown_picture.h"
#include "engine/base/mailbox.h"
#include "engine/base/shared_queue.h"
#include "engine/preview/moving_scale.h"

namespace gse::app {

/// Pictures that are used again: what the last holder lets go comes back, whichever thread that is.
class PictureStore : public std::enable_shared_from_this<PictureStore> {
public:
    std::shared_ptr<NativePicture> take();

private:
    SharedQueue<std::unique_ptr<NativePicture>> free_;
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
    bool busy();
    bool painting();  // something is being painted or waits for it
    /// Time that the window needs for a frame beside the picture: the resolution while moving leaves room.
    void set_window_ms(double milliseconds) { window_ms_ = milliseconds; }
    const std::string& name() const { return name_; }  // of the painter, once there was a picture

private:
    /// A picture on its way to the window.
    struct Painted {
        PictureRequest request;
        std::shared_ptr<const NativePicture> picture;
        std::string painter;
    };
    void loop(const std::stop_token& end);
    void withdraw();
    void receive();

    // Roads between the threads
    Mailbox<PictureRequest> orders_;
    SharedQueue<Painted> pictures_;
    std::atomic<double> window_ms_ = 0;
    std::function<void()> wake_;
    // The window's thread
    int ordered_ = 0;                        // orders that no picture has come of yet
    std::optional<PictureRequest> painted_;  // that the newest picture shows
    bool painted_full_ = false;
    std::shared_ptr<const NativePicture> ready_;
    std::string name_;
    std::jthread thread_;
};

}  // namespace gse::app
