// The painting thread and its orders.
#include "app/window/preview_native.h"

#include <algorithm>
#include <cmath>

#include "engine/base/log.h"

namespace gse::app {
namespace {

bool same_camera(const Camera& a, const Camera& b) {
    bool same = a.width == b.width && a.height == b.height && a.fx == b.fx && a.fy == b.fy && a.cx == b.cx &&
                a.cy == b.cy;
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) same = same && a.rotation(r, c) == b.rotation(r, c);
    return same && length(a.translation - b.translation) == 0;
}

bool same_picture(const PictureRequest& a, const PictureRequest& b) {
    return a.content == b.content && same_camera(a.camera, b.camera) && a.comparison == b.comparison &&
           a.set.shares_all_with(b.set) && a.values == b.values && a.antialiased == b.antialiased &&
           fields_to_json(a.settings) == fields_to_json(b.settings);
}

}  // namespace

NativePreview::NativePreview(std::function<void()> wake)
    : wake_(std::move(wake)), thread_([this](const std::stop_token& end) { loop(end); }) {}

NativePreview::~NativePreview() { thread_.request_stop(); }

/// An order that the painter has not begun is none.
void NativePreview::withdraw() {
    if (orders_.take()) --ordered_;
}

void NativePreview::receive() {
    for (auto& painted : pictures_.take()) {
        --ordered_;
        painted_full_ = painted.picture->full;
        painted_ = std::move(painted.request);
        ready_ = std::move(painted.picture);
        name_ = std::move(painted.painter);
    }
}

void NativePreview::want(const PictureRequest& request) {
    receive();
    withdraw();
    if (painted_ && same_picture(*painted_, request) && (painted_full_ || request.moving)) return;
    ++ordered_;
    orders_.put(request);
}

std::shared_ptr<const NativePicture> NativePreview::take() {
    receive();
    return std::exchange(ready_, nullptr);
}

bool NativePreview::painting() {
    receive();
    return ordered_ > 0 && !ready_;
}

bool NativePreview::busy() {
    receive();
    return ordered_ > 0 || ready_ || !painted_full_;
}

std::shared_ptr<NativePicture> PictureStore::take() {
    std::unique_ptr<NativePicture> picture = free_.pop().value_or(nullptr);
    if (!picture) picture = std::make_unique<NativePicture>();
    return {picture.release(), [store = shared_from_this()](NativePicture* used) {
                store->free_.push(std::unique_ptr<NativePicture>(used));
            }};
}

void NativePreview::loop(const std::stop_token& end) {
    NativePainter painter;
    preview::MovingScale moving_scale;
    const auto store = std::make_shared<PictureStore>();
    while (auto request = orders_.wait(end)) {
        const double scale = request->moving ? moving_scale.scale() : 1;
        const auto picture = store->take();
        const int width = std::max(1, static_cast<int>(std::lround(request->camera.width * scale)));
        const int height = std::max(1, static_cast<int>(std::lround(request->camera.height * scale)));
        painter.paint(*request, width, height, *picture);
        moving_scale.learn(picture->milliseconds + window_ms_, scale);
        pictures_.push({std::move(*request), picture, painter.name()});
        if (wake_) wake_();
    }
}

}  // namespace gse::app
