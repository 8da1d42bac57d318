// Rendering, resolving and the painting thread.
#include "app/window/preview_native.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "engine/base/log.h"

namespace gse::app {
namespace {

using Clock = std::chrono::steady_clock;

constexpr float LeastSolid = 0.3f;  // of a pixel, to have a depth that can be picked

/// Distance to the middle of the splats: the middle of the depth colours.
float depth_scale(const GaussianSet& set, const Camera& camera) {
    constexpr std::size_t samples = 4096;
    const std::size_t step = std::max<std::size_t>(set.size() / samples, 1);
    const auto position = set.position();
    Vec3 sum;
    double count = 0;
    for (std::size_t row = 0; row < set.size(); row += step) {
        const Vec3 place{position[row * 3], position[row * 3 + 1], position[row * 3 + 2]};
        if (!std::isfinite(place.x + place.y + place.z)) continue;
        sum = sum + place;
        count += 1;
    }
    return static_cast<float>(std::max(length((count > 0 ? sum / count : sum) - camera.centre()), 1e-12));
}

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

preview::Display display_of(const PictureRequest& request) {
    preview::Display display;
    display.mode = static_cast<preview::Mode>(std::clamp(request.settings.mode, 0, 9));
    display.sh_degree = request.settings.sh_degree;
    display.antialiased = request.antialiased;
    try {
        display.background = parse_colour(request.settings.background);
    } catch (const Error&) { display.background = {0, 0, 0}; }
    const bool tints = display.mode == preview::Mode::Labels || request.settings.tint_labels;
    display.tint_strength = tints && request.values ? request.settings.tint_strength : 0;
    return display;
}

void NativePainter::paint_part(const PictureRequest& request, bool original, const Camera& camera,
                               int first_column, NativePicture& picture) {
    const auto& set = original ? request.original : request.set;
    preview::Display display = display_of(request);
    const bool has_values = !original && request.values && request.values->size() == set.size();
    if (!has_values) {
        display.tint_strength = 0;
        if (preview::needs_value(display)) display.mode = preview::Mode::Beauty;
    }
    raster::Settings settings;  // over black: the resolve adds the background
    settings.sh_degree = display.sh_degree;
    settings.antialiased = display.antialiased;
    const bool wants_value = preview::needs_value(display);
    if (wants_value)
        painter_.rasterizer().forward_values(set.spans(), camera, settings, *request.values, values_);
    const auto& light = painter_.paint(set.spans(), camera, settings);
    const float middle = display.mode == preview::Mode::Depth ? depth_scale(set, camera) : 1.0f;
    preview::resolve({&light.colour, &light.alpha, &light.depth, wants_value ? &values_ : nullptr}, display,
                     middle, painter_.pool(), part_);
    for (int y = 0; y < camera.height; ++y) {
        const auto row = static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width);
        std::copy_n(&part_[row * 4], static_cast<std::size_t>(camera.width) * 4,
                    &picture.rgba[(static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                                   static_cast<std::size_t>(first_column)) *
                                  4]);
        for (int x = 0; x < camera.width; ++x) {
            const float alpha = light.alpha.data[row + static_cast<std::size_t>(x)];
            picture.depth.at(first_column + x, y, 0) =
                alpha > LeastSolid ? light.depth.data[row + static_cast<std::size_t>(x)] / alpha : 0.0f;
        }
    }
}

void NativePainter::paint(const PictureRequest& request, int width, int height, NativePicture& picture) {
    const auto start = Clock::now();
    picture.width = width;
    picture.height = height;
    picture.camera = request.camera;
    picture.full = width == request.camera.width && height == request.camera.height;
    picture.rgba.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4);
    picture.depth.resize(width, height, 1);
    Camera whole = request.camera.resized(width, height);
    whole.fy = request.camera.fy * height /
               request.camera.height;  // rounding of the height must not bend the picture
    whole.cy = request.camera.cy * height / request.camera.height;
    const int split =
        request.comparison == ui::Comparison::Original ? width
        : request.comparison == ui::Comparison::Wipe
            ? std::clamp(static_cast<int>(std::lround(request.settings.wipe * static_cast<float>(width))), 0,
                         width)
            : 0;
    // Columns of one camera are a camera themselves: only what is shown is rendered.
    if (split > 0) {
        Camera left = whole;
        left.width = split;
        paint_part(request, true, left, 0, picture);
    }
    if (split < width) {
        Camera right = whole;
        right.width = width - split;
        right.cx -= split;
        paint_part(request, false, right, split, picture);
    }
    picture.milliseconds = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

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
