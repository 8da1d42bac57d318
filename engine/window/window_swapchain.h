// Surface images to draw the window into: creation, acquiring, presenting.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/vulkan/device.h"

namespace gse::window {

class Swapchain {
public:
    Swapchain(vulkan::Device& device, VkSurfaceKHR surface);

    /// Makes the images anew. Waits until the old ones are no longer used. Returns false when the window has
    /// no area.
    bool resize(std::uint32_t width, std::uint32_t height);
    bool fits(std::uint32_t width, std::uint32_t height) const;

    /// Next image to draw to. Nothing when the surface has changed and resize() is needed.
    std::optional<std::uint32_t> acquire(vk::Semaphore ready);
    /// Presents the image. Returns false when resize() is needed.
    bool present(std::uint32_t image);

    vk::RenderPass render_pass() const { return *render_pass_; }
    vk::Framebuffer framebuffer(std::uint32_t image) const { return *images_[image].framebuffer; }
    vk::Image image(std::uint32_t image) const { return images_[image].handle; }
    vk::Semaphore drawn(std::uint32_t image) const { return *images_[image].drawn; }
    vk::Extent2D extent() const { return extent_; }
    bool can_copy() const { return can_copy_; }
    bool is_bgra() const { return format_.format == vk::Format::eB8G8R8A8Unorm; }

private:
    struct Target {
        vk::Image handle;
        vk::raii::ImageView view{nullptr};
        vk::raii::Framebuffer framebuffer{nullptr};
        vk::raii::Semaphore drawn{nullptr};
    };
    void choose_format();
    void make_render_pass();
    void make_targets();

    vulkan::Device& device_;
    VkSurfaceKHR surface_;
    vk::SurfaceFormatKHR format_;
    vk::Extent2D extent_;
    bool can_copy_ = false, stale_ = true;
    vk::raii::RenderPass render_pass_{nullptr};
    vk::raii::SwapchainKHR swapchain_{nullptr};
    std::vector<Target> images_;
};

}  // namespace gse::window
