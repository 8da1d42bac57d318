// Swapchain: the images of the window.
#include "engine/window/window_swapchain.h"

#include <algorithm>

namespace gse::window {

Swapchain::Swapchain(vulkan::Device& device, VkSurfaceKHR surface) : device_(device), surface_(surface) {
    vulkan::guarded("preparing the window", [&] {
        choose_format();
        make_render_pass();
    });
}

void Swapchain::choose_format() {
    const auto formats = device_.physical().getSurfaceFormatsKHR(surface_);
    format_ = formats.front();
    // Panels and pictures hold sRGB values already, so a format that would encode them once more is not
    // wanted.
    for (const auto wanted : {vk::Format::eR8G8B8A8Unorm, vk::Format::eB8G8R8A8Unorm})
        for (const auto& format : formats)
            if (format.format == wanted) format_ = format;
}

void Swapchain::make_render_pass() {
    vk::AttachmentDescription colour;
    colour.format = format_.format;
    colour.loadOp = vk::AttachmentLoadOp::eClear;
    colour.storeOp = vk::AttachmentStoreOp::eStore;
    colour.stencilLoadOp = vk::AttachmentLoadOp::eDontCare;
    colour.stencilStoreOp = vk::AttachmentStoreOp::eDontCare;
    colour.finalLayout = vk::ImageLayout::ePresentSrcKHR;
    const vk::AttachmentReference reference(0, vk::ImageLayout::eColorAttachmentOptimal);
    vk::SubpassDescription subpass;
    subpass.pipelineBindPoint = vk::PipelineBindPoint::eGraphics;
    subpass.setColorAttachments(reference);
    const auto output = vk::PipelineStageFlagBits::eColorAttachmentOutput;
    const vk::SubpassDependency before(VK_SUBPASS_EXTERNAL, 0, output, output, {},
                                       vk::AccessFlagBits::eColorAttachmentWrite);
    const vk::SubpassDependency after(0, VK_SUBPASS_EXTERNAL, output, vk::PipelineStageFlagBits::eTransfer,
                                      vk::AccessFlagBits::eColorAttachmentWrite,
                                      vk::AccessFlagBits::eTransferRead);
    const vk::SubpassDependency dependencies[] = {before, after};
    render_pass_ =
        vk::raii::RenderPass(device_.handle(), vk::RenderPassCreateInfo({}, colour, subpass, dependencies));
}

bool Swapchain::fits(std::uint32_t width, std::uint32_t height) const {
    return !stale_ && extent_.width == width && extent_.height == height;
}

bool Swapchain::resize(std::uint32_t width, std::uint32_t height) {
    return vulkan::guarded("resizing the window", [&] {
        const auto surface = device_.physical().getSurfaceCapabilitiesKHR(surface_);
        vk::Extent2D extent = surface.currentExtent;
        if (extent.width == UINT32_MAX) {
            extent.width = std::clamp(width, surface.minImageExtent.width, surface.maxImageExtent.width);
            extent.height = std::clamp(height, surface.minImageExtent.height, surface.maxImageExtent.height);
        }
        if (extent.width == 0 || extent.height == 0) return false;
        device_.wait_idle();
        device_.queue().waitIdle();  // presenting has no serial number
        images_.clear();
        can_copy_ = static_cast<bool>(surface.supportedUsageFlags & vk::ImageUsageFlagBits::eTransferSrc);
        vk::SwapchainCreateInfoKHR info;
        info.surface = surface_;
        info.minImageCount = surface.minImageCount + 1;
        if (surface.maxImageCount > 0)
            info.minImageCount = std::min(info.minImageCount, surface.maxImageCount);
        info.imageFormat = format_.format;
        info.imageColorSpace = format_.colorSpace;
        info.imageExtent = extent;
        info.imageArrayLayers = 1;
        info.imageUsage = vk::ImageUsageFlagBits::eColorAttachment;
        if (can_copy_) info.imageUsage |= vk::ImageUsageFlagBits::eTransferSrc;
        info.preTransform = surface.currentTransform;
        info.compositeAlpha = vk::CompositeAlphaFlagBitsKHR::eOpaque;
        if (!(surface.supportedCompositeAlpha & info.compositeAlpha))
            info.compositeAlpha = vk::CompositeAlphaFlagBitsKHR::eInherit;
        info.presentMode = vk::PresentModeKHR::eFifo;
        info.clipped = VK_TRUE;
        info.oldSwapchain = *swapchain_;
        swapchain_ = vk::raii::SwapchainKHR(device_.handle(), info);
        extent_ = extent;
        make_targets();
        stale_ = false;
        return true;
    });
}

void Swapchain::make_targets() {
    for (const auto image : swapchain_.getImages()) {
        Target target;
        target.handle = static_cast<vk::Image>(image);
        const vk::ImageSubresourceRange range(vk::ImageAspectFlagBits::eColor, 0, 1, 0, 1);
        target.view = vk::raii::ImageView(
            device_.handle(), {{}, target.handle, vk::ImageViewType::e2D, format_.format, {}, range});
        const vk::ImageView view = *target.view;
        target.framebuffer = vk::raii::Framebuffer(
            device_.handle(), {{}, *render_pass_, 1, &view, extent_.width, extent_.height, 1});
        target.drawn = vk::raii::Semaphore(device_.handle(), vk::SemaphoreCreateInfo());
        images_.push_back(std::move(target));
    }
}

std::optional<std::uint32_t> Swapchain::acquire(vk::Semaphore ready) {
    return vulkan::guarded("drawing the window", [&]() -> std::optional<std::uint32_t> {
        try {
            const auto [result, image] = swapchain_.acquireNextImage(UINT64_MAX, ready);
            if (result == vk::Result::eSuboptimalKHR)
                stale_ = true;  // still drawn; made anew for the next frame
            return image;
        } catch (const vk::OutOfDateKHRError&) {
            stale_ = true;
            return std::nullopt;
        }
    });
}

bool Swapchain::present(std::uint32_t image) {
    return vulkan::guarded("showing the window", [&] {
        const vk::Semaphore ready = drawn(image);
        const vk::SwapchainKHR swapchain = *swapchain_;
        try {
            const auto result = device_.queue().presentKHR({ready, swapchain, image});
            if (result == vk::Result::eSuboptimalKHR) stale_ = true;
        } catch (const vk::OutOfDateKHRError&) { stale_ = true; }
        return !stale_;
    });
}

}  // namespace gse::window
