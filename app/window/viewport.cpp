// Both ways of painting, behind one picture.
#include "app/window/viewport.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/vulkan/device.h"

namespace gse::app {
PreviewBackend parse_backend(const std::string& text) {
    if (text == "auto") return PreviewBackend::Auto;
    if (text == "vulkan") return PreviewBackend::Vulkan;
    if (text == "native") return PreviewBackend::Native;
    throw Error(ErrorCode::InvalidArgument, "\"" + text + "\" is no way of painting the preview",
                "use auto, vulkan or native");
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
    state_.texture = state_.original = 0;
}

void Viewport::make_device(vulkan::Device&) {}

bool Viewport::native_wanted() const {
    if (backend_ != PreviewBackend::Auto) return backend_ == PreviewBackend::Native;
    const auto mode = static_cast<ui::DisplayMode>(request_.settings.mode);
    const bool shapes = mode == ui::DisplayMode::Centres || mode == ui::DisplayMode::Rings ||
                        mode == ui::DisplayMode::Ellipsoids;
    return window_.device().info().is_cpu && !shapes;  // other shapes than splats are the shaders' alone
}

void Viewport::want(const PictureRequest& request) {
    request_ = request;
    has_request_ = true;
    if (native_wanted()) native_.want(request);
}

PictureState Viewport::state() { return state_; }

bool Viewport::busy() { return has_request_ && (native_wanted() ? native_.busy() : vulkan_busy_); }

bool Viewport::waits_for_picture() {
    return has_request_ && request_.moving && native_wanted() && native_.painting();
}

void Viewport::set_window_ms(double milliseconds) { native_.set_window_ms(milliseconds); }

void Viewport::record() {
    if (!has_request_) return;
    if (native_wanted()) record_native();
    else record_vulkan();
}

void Viewport::record_native() {
    auto picture = native_.take();
    state_.busy = native_.busy();
    if (picture) painted_ = std::move(picture);
    else if (painted_ && picture_.id() != 0 && state_.busy)
        return;  // what is shown stays until the next picture is there
    if (!painted_) return;
    if (painted_ != uploaded_ || picture_.id() == 0)
        picture_.update(painted_->rgba, painted_->width, painted_->height);
    uploaded_ = painted_;
    state_.width = painted_->width;
    state_.height = painted_->height;
    state_.camera = painted_->camera;
    state_.depth = std::shared_ptr<const Image>(painted_, &painted_->depth);
    state_.render_ms = painted_->milliseconds;
    state_.original = 0;
    state_.texture = picture_.id();
    state_.renderer = "native " + native_.name();
}

void Viewport::render_side(Side& side, const GaussianSet& set,
                           std::shared_ptr<const std::vector<float>> values) {
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
    const double scale = request_.moving ? vulkan_scale_.scale() : 1.0;
    frame.camera =
        request_.camera.resized(std::max(1, static_cast<int>(std::lround(request_.camera.width * scale))),
                                std::max(1, static_cast<int>(std::lround(request_.camera.height * scale))));
    if (side.renderer->render(window_.commands(), frame)) side.scale = scale;
    if (side.texture == 0) side.texture = window_.add_texture(side.renderer->view());
    else if (side.renderer->revision() != side.revision)
        window_.replace_texture(side.texture, side.renderer->view());
    side.revision = side.renderer->revision();
}

bool Viewport::shows_scene(const Side& side) {
    return side.renderer && (side.renderer->size() > 0 || !side.renderer->uploading());
}

void Viewport::record_vulkan() {
    const bool held = original_.texture != 0 &&
                      (state_.texture == original_.texture || state_.original == original_.texture);
    render_side(current_, request_.set, request_.values);
    if (request_.comparison != ui::Comparison::None) render_side(original_, request_.original, nullptr);
    else if (original_.renderer && !held)
        forget(original_);  // its memory goes back, once no frame shows it any more
    vulkan_busy_ =
        current_.renderer->uploading() || current_.renderer->incomplete() ||
        (original_.renderer && (original_.renderer->uploading() || original_.renderer->incomplete()));
    state_.busy = vulkan_busy_;
    const bool has_original = shows_scene(original_);
    const bool shows_original = request_.comparison == ui::Comparison::Original && has_original;
    const Side& shown = shows_original ? original_ : current_;
    if (!shows_scene(shown) && state_.texture != 0)
        return;  // what is shown stays until the first picture is there
    state_.texture = shown.texture;
    state_.original = request_.comparison == ui::Comparison::Wipe && has_original ? original_.texture : 0;
    state_.width = shown.renderer->width();
    state_.height = shown.renderer->height();
    state_.camera = request_.camera;
    state_.depth = shown.renderer->depth();
    const auto statistics = shown.renderer->statistics();
    double passes = 0;
    for (const auto& [name, ms] : statistics.pass_ms) passes += ms;
    if (passes > 0 && passes != state_.render_ms) vulkan_scale_.learn(passes, shown.scale);
    if (passes > 0) state_.render_ms = passes;
    state_.renderer = "Vulkan: " + window_.device().info().name;
}

}  // namespace gse::app
