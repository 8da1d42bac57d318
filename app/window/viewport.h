// Who paints the viewport: the Vulkan renderer, or the own rasterizer where the Vulkan device is a processor.
#pragma once

#include <memory>
#include <string>

#include "app/engine_names.h"
#include "app/session/preview_host.h"
#include "app/window/preview_native.h"
#include "app/window/window_textures.h"
#include "engine/preview/splat_renderer.h"
#include "engine/window/window.h"

namespace gse::app {

enum class PreviewBackend { Auto, Vulkan, Native };

/// "auto", "vulkan" or "native". Throws Error.
PreviewBackend parse_backend(const std::string& text);

class Viewport : public PreviewHost, public DeviceClient {
public:
    Viewport(Window& window, PreviewBackend backend);
    ~Viewport() override;

    void want(const PictureRequest& request) override;
    PictureState state() override;
    /// Between begin_frame() and the panels: uploads the newest native picture, or records the compute work.
    void record();
    /// A picture is being made or uploaded: draw another frame soon.
    bool busy();
    /// True while the camera moves and the newest picture is still being painted, by threads that wake the
    /// window. Frames before that would show nothing new and take the processor from it.
    bool waits_for_picture();
    /// Time of a frame of the window beside the picture.
    void set_window_ms(double milliseconds);

    void drop_device() override;
    void make_device(vulkan::Device& device) override;

private:
    /// A renderer with the handle of its picture.
    struct Side {
        std::unique_ptr<preview::SplatRenderer> renderer;
        GaussianSet set;
        bool has_set = false;
        std::uint64_t revision = ~std::uint64_t{0};
        ui::TextureId texture = 0;
        double scale = 1;
    };
    bool native_wanted() const;
    void record_native();
    void record_vulkan();
    void render_side(Side& side, const GaussianSet& set, std::shared_ptr<const std::vector<float>> values);
    void forget(Side& side);
    /// False while the first scene of a side is on its way.
    static bool shows_scene(const Side& side);

    Window& window_;
    PreviewBackend backend_;
    NativePreview native_;
    StreamedPicture picture_;
    std::shared_ptr<const NativePicture> painted_, uploaded_;  // the newest one; what picture_ holds
    PictureRequest request_;
    PictureState state_;
    Side current_, original_;
    bool has_request_ = false, vulkan_busy_ = false;
    preview::MovingScale vulkan_scale_;
};

}  // namespace gse::app
