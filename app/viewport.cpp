// Both ways of painting, behind one picture.
#include "app/viewport.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "engine/base/error.h"
#include "engine/vulkan/device.h"

namespace gse::app {
namespace {

constexpr double MovingMs = 45;
constexpr double LeastScale = 0.15;

}  // namespace

PreviewBackend parse_backend(const std::string& text) {
    if (text == "auto") return PreviewBackend::Auto;
    if (text == "vulkan") return PreviewBackend::Vulkan;
    if (text == "native") return PreviewBackend::Native;
    throw Error(ErrorCode::InvalidArgument, "\"" + text + "\" is no way of painting the preview", "use auto, vulkan or native");
}

Viewport::Viewport(Window& window, PreviewBackend backend)
    : window_(window), backend_(backend), native_([] { Window::wake(); }), picture_(window) {
    window_.add_client(this);
}

Viewport::~Viewport() {
    window_.remove_client(this);
    forget(current_);
    forget(original_);
}

void Viewport::forget(Side& side) {
    if (side.texture != 0) window_.remove_texture(side.texture);
    side = {};
}

void Viewport::drop_device() {
    forget(current_);
    forget(original_);
}

void Viewport::make_device(vulkan::Device&) {}

bool Viewport::native_wanted() const {
    if (backend_ != PreviewBackend::Auto) return backend_ == PreviewBackend::Native;
    const auto mode = static_cast<ui::DisplayMode>(request_.settings.mode);
    const bool shapes = mode == ui::DisplayMode::Centres || mode == ui::DisplayMode::Rings || mode == ui::DisplayMode::Ellipsoids;
    return window_.device().info().is_cpu && !shapes;   // other shapes than splats are the shaders' alone
}

void Viewport::want(const PictureRequest& request) {
    request_ = request;
    has_request_ = true;
    if (native_wanted()) native_.want(request);
}

PictureState Viewport::state() { return state_; }

bool Viewport::busy() const { return has_request_ && (native_wanted() ? native_.busy() : vulkan_busy_); }

void Viewport::record() {
    if (!has_request_) return;
    if (native_wanted()) record_native();
    else record_vulkan();
}

void Viewport::record_native() {
    if (auto picture = native_.take()) {
        picture_.update(picture->rgba, picture->width, picture->height);
        state_.width = picture->width;
        state_.height = picture->height;
        state_.camera = picture->camera;
        state_.depth = std::move(picture->depth);
        state_.render_ms = picture->milliseconds;
    }
    state_.original = 0;
    state_.texture = picture_.id();
    state_.renderer = "native " + native_.name();
    state_.busy = native_.busy();
}

void Viewport::render_side(Side& side, const GaussianSet& set, std::shared_ptr<const std::vector<float>> values) {
    if (!side.renderer) side.renderer = std::make_unique<preview::SplatRenderer>(window_.device());
    if (!side.has_set || !side.set.shares_all_with(set)) {
        side.renderer->upload(set);
        side.set = set;
        side.has_set = true;
    }
    side.renderer->set_values(values && values->size() == set.size() ? std::move(values) : nullptr);
    preview::FrameRequest frame;
    frame.display = display_of(request_);
    frame.want_depth = true;
    const double scale = request_.moving && vulkan_ms_ > MovingMs
                             ? std::clamp(std::sqrt(MovingMs / vulkan_ms_), LeastScale, 1.0)
                             : 1.0;
    frame.camera = request_.camera.resized(std::max(1, static_cast<int>(std::lround(request_.camera.width * scale))),
                                           std::max(1, static_cast<int>(std::lround(request_.camera.height * scale))));
    const auto start = std::chrono::steady_clock::now();
    if (side.renderer->render(window_.commands(), frame)) {
        side.scale = scale;
        (void)start;
    }
    if (side.renderer->revision() != side.revision || side.texture == 0) {
        if (side.texture != 0) window_.remove_texture(side.texture);
        side.texture = window_.add_texture(side.renderer->view());
        side.revision = side.renderer->revision();
    }
}

void Viewport::record_vulkan() {
    render_side(current_, request_.set, request_.values);
    if (request_.comparison != ui::Comparison::None) render_side(original_, request_.original, nullptr);
    else if (original_.renderer) forget(original_);   // its memory goes back
    const bool shows_original = request_.comparison == ui::Comparison::Original && original_.texture != 0;
    const Side& shown = shows_original ? original_ : current_;
    state_.texture = shown.texture;
    state_.original = request_.comparison == ui::Comparison::Wipe ? original_.texture : 0;
    state_.width = shown.renderer->width();
    state_.height = shown.renderer->height();
    state_.camera = request_.camera;
    state_.depth = shown.renderer->depth();
    const auto statistics = shown.renderer->statistics();
    double passes = 0;
    for (const auto& [name, ms] : statistics.pass_ms) passes += ms;
    if (passes > 0) {
        state_.render_ms = passes;
        vulkan_ms_ = passes / (shown.scale * shown.scale);
    }
    state_.renderer = "Vulkan: " + window_.device().info().name;
    vulkan_busy_ = current_.renderer->uploading() || current_.renderer->incomplete() ||
                   (original_.renderer && (original_.renderer->uploading() || original_.renderer->incomplete()));
    state_.busy = vulkan_busy_;
}

}  // namespace gse::app
