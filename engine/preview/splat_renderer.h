// Draws Gaussians with Vulkan compute, by the image formation of engine/raster and in several display modes.
// Draws only when something has changed. Belongs to the thread of its device.
//
//   SplatRenderer renderer(device);
//   renderer.upload(set);  // slice by slice in render(), while the old scene is shown
//
// and in each frame:
//
//   renderer.render(window.commands(), request);  // records nothing when nothing changed
//   ImGui::Image(id of renderer.view());          // add the view again when revision() changes
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/image.h"
#include "engine/math/camera.h"
#include "engine/preview/display.h"
#include "engine/scene/gaussian_set.h"

namespace gse::vulkan {
class Device;
}

namespace gse::preview {

struct FrameRequest {
    Camera camera;  // width and height are the picture's
    Display display;
    bool want_depth = false;  // depth() is wanted for this picture
};

/// Cost and omissions of the newest finished picture. Known some frames after it was recorded.
struct FrameStatistics {
    std::uint32_t visible = 0;
    std::uint64_t pairs = 0;            // tile-splat pairs
    std::uint64_t dropped_pairs = 0;    // did not fit into a device's largest buffer
    std::uint32_t unfinished_rows = 0;  // left out because a software device gives up on long loops
    std::vector<std::pair<std::string, double>> pass_ms;  // device time; empty where the device has no clock
    double device_ms = 0;                                 // their sum
};

struct Pick {
    std::size_t row = 0;
    double depth = 0;  // camera z
};

struct RendererOptions {
    bool always_stage = false;        // upload as a discrete GPU needs it (tests)
    bool portable_blend = false;      // the blend pass that makes no use of subgroups (tests)
    bool many_parts = false;          // work divided as for a GPU (tests)
    std::uint64_t pair_capacity = 0;  // to begin with; 0 = from the scene's size
};

class SplatRenderer {
public:
    explicit SplatRenderer(vulkan::Device& device, const RendererOptions& options = {});
    ~SplatRenderer();
    SplatRenderer(const SplatRenderer&) = delete;
    SplatRenderer& operator=(const SplatRenderer&) = delete;

    /// Begins an upload, and replaces one under way. Only arrays that are other objects than the shown ones
    /// are sent. If most rows stay, only the rows that differ are sent.
    void upload(const GaussianSet& set);
    /// One number per row for labels, maps and tints; null = none. Waits for an upload of that size under
    /// way.
    void set_values(std::shared_ptr<const std::vector<float>> values);
    bool uploading() const;
    void finish_upload();  // waits

    /// Records the commands to show `request`, if it is not shown already. Returns true when it recorded
    /// something. Goes on with an upload for about `upload_ms`.
    bool render(VkCommandBuffer commands, const FrameRequest& request, double upload_ms = 4);
    /// Makes the next render() start from nothing.
    void invalidate();
    /// True when the last picture left something out because it met more pairs than expected. Render again;
    /// it does not skip.
    bool incomplete();

    VkImageView view() const;  // RGBA8, layout eShaderReadOnlyOptimal
    std::uint64_t revision() const;
    int width() const;
    int height() const;
    const Camera& camera() const;  // of the picture
    std::size_t size() const;      // rows of the scene shown
    std::uint64_t device_bytes() const;
    std::uint64_t sent_bytes() const;  // of scenes and values, to the device, so far
    FrameStatistics statistics();

    /// Newest depth that has arrived: [H,W,1] mean camera z of the visible splats, weighted by alpha T. 0 if
    /// alpha is under 0.3. Null at first.
    std::shared_ptr<const Image> depth();

    // The following submit their own commands and wait: for tests, export and clicks.
    /// Renders until complete and reads the picture: [H,W,4] RGBA in 0..1.
    Image draw(const FrameRequest& request);
    /// Sums per pixel before any colour mapping: [H,W,6] red, green, blue, alpha, depth, value.
    Image draw_light(const FrameRequest& request);
    /// Splat that contributes most at a pixel of the shown picture.
    std::optional<Pick> pick(int x, int y);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace gse::preview
