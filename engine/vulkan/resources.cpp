// Creation, layout changes and copies of buffers and images. One allocation each: there are tens of them, not
// thousands.
#include "engine/vulkan/resources.h"

#include <algorithm>

namespace gse::vulkan {
namespace {

using Memory = vk::MemoryPropertyFlagBits;

vk::MemoryPropertyFlags wanted_memory(BufferHome home) {
    switch (home) {
        case BufferHome::Device: return Memory::eDeviceLocal;
        case BufferHome::Upload: return {};
        case BufferHome::Readback: return Memory::eHostCached;
    }
    return {};
}

vk::MemoryPropertyFlags required_memory(BufferHome home) {
    return home == BufferHome::Device ? vk::MemoryPropertyFlags{}
                                      : Memory::eHostVisible | Memory::eHostCoherent;
}

}  // namespace

struct Buffer::State {
    vk::raii::Buffer buffer{nullptr};
    vk::raii::DeviceMemory memory{nullptr};
    vk::raii::BufferView view{nullptr};
    std::uint64_t size = 0;
    std::byte* mapped = nullptr;
};

Buffer::Buffer(Device& device, const BufferDescription& description)
    : device_(&device), state_(std::make_shared<State>()) {
    guarded("making a buffer", [&] {
        State& state = *state_;
        state.size = std::max<std::uint64_t>(description.size, 16);
        auto usage = description.usage;
        const bool texels = description.texel_format != vk::Format::eUndefined;
        if (texels) usage |= vk::BufferUsageFlagBits::eUniformTexelBuffer;
        state.buffer = vk::raii::Buffer(device.handle(), {{}, state.size, usage});
        const auto needs = state.buffer.getMemoryRequirements();
        const auto type = device.memory_type(needs.memoryTypeBits, wanted_memory(description.home),
                                             required_memory(description.home));
        state.memory = vk::raii::DeviceMemory(device.handle(), {needs.size, type});
        state.buffer.bindMemory(*state.memory, 0);
        const auto flags = device.physical().getMemoryProperties().memoryTypes[type].propertyFlags;
        if ((flags & Memory::eHostVisible) && (flags & Memory::eHostCoherent))
            state.mapped = static_cast<std::byte*>(state.memory.mapMemory(0, VK_WHOLE_SIZE));
        if (texels)
            state.view = vk::raii::BufferView(
                device.handle(), {{}, *state.buffer, description.texel_format, 0, VK_WHOLE_SIZE});
        device.name(vk::ObjectType::eBuffer,
                    reinterpret_cast<std::uint64_t>(static_cast<VkBuffer>(*state.buffer)), description.name);
    });
}

Buffer::~Buffer() { release(); }

Buffer& Buffer::operator=(Buffer&& other) noexcept {
    if (this == &other) return *this;
    release();
    device_ = other.device_;
    state_ = std::move(other.state_);
    return *this;
}

void Buffer::release() {
    if (state_) device_->retire(std::move(state_));
    state_.reset();
}

vk::Buffer Buffer::handle() const { return state_ ? *state_->buffer : vk::Buffer(); }
vk::BufferView Buffer::view() const { return state_ ? *state_->view : vk::BufferView(); }
std::uint64_t Buffer::size() const { return state_ ? state_->size : 0; }
std::byte* Buffer::mapped() const { return state_ ? state_->mapped : nullptr; }

struct Texture::State {
    vk::raii::Image image{nullptr};
    vk::raii::DeviceMemory memory{nullptr};
    vk::raii::ImageView view{nullptr};
};

Texture::Texture(Device& device, const ImageDescription& description)
    : device_(&device), width_(description.width), height_(description.height),
      state_(std::make_shared<State>()) {
    guarded("making an image", [&] {
        State& state = *state_;
        const vk::Extent3D extent(width_, height_, 1);
        state.image = vk::raii::Image(device.handle(), {{},
                                                        vk::ImageType::e2D,
                                                        description.format,
                                                        extent,
                                                        1,
                                                        1,
                                                        vk::SampleCountFlagBits::e1,
                                                        vk::ImageTiling::eOptimal,
                                                        description.usage});
        const auto needs = state.image.getMemoryRequirements();
        const auto type = device.memory_type(needs.memoryTypeBits, Memory::eDeviceLocal, {});
        state.memory = vk::raii::DeviceMemory(device.handle(), {needs.size, type});
        state.image.bindMemory(*state.memory, 0);
        const vk::ImageSubresourceRange range(vk::ImageAspectFlagBits::eColor, 0, 1, 0, 1);
        state.view = vk::raii::ImageView(
            device.handle(), {{}, *state.image, vk::ImageViewType::e2D, description.format, {}, range});
        device.name(vk::ObjectType::eImage,
                    reinterpret_cast<std::uint64_t>(static_cast<VkImage>(*state.image)), description.name);
    });
}

Texture::~Texture() { release(); }

Texture& Texture::operator=(Texture&& other) noexcept {
    if (this == &other) return *this;
    release();
    device_ = other.device_;
    width_ = other.width_;
    height_ = other.height_;
    layout_ = other.layout_;
    state_ = std::move(other.state_);
    return *this;
}

void Texture::release() {
    if (state_) device_->retire(std::move(state_));
    state_.reset();
}

vk::Image Texture::handle() const { return state_ ? *state_->image : vk::Image(); }
vk::ImageView Texture::view() const { return state_ ? *state_->view : vk::ImageView(); }

void Texture::transition(vk::CommandBuffer commands, vk::ImageLayout layout) {
    const auto any = vk::AccessFlagBits::eMemoryRead | vk::AccessFlagBits::eMemoryWrite;
    const vk::ImageSubresourceRange range(vk::ImageAspectFlagBits::eColor, 0, 1, 0, 1);
    const vk::ImageMemoryBarrier barrier(any, any, layout_, layout, VK_QUEUE_FAMILY_IGNORED,
                                         VK_QUEUE_FAMILY_IGNORED, handle(), range);
    commands.pipelineBarrier(vk::PipelineStageFlagBits::eAllCommands, vk::PipelineStageFlagBits::eAllCommands,
                             {}, {}, {}, barrier);
    layout_ = layout;
}

void Texture::copy_from(vk::CommandBuffer commands, const Buffer& source, std::uint64_t offset) {
    transition(commands, vk::ImageLayout::eTransferDstOptimal);
    const vk::ImageSubresourceLayers layers(vk::ImageAspectFlagBits::eColor, 0, 0, 1);
    const vk::BufferImageCopy region(offset, 0, 0, layers, {}, {width_, height_, 1});
    commands.copyBufferToImage(source.handle(), handle(), vk::ImageLayout::eTransferDstOptimal, region);
    transition(commands, vk::ImageLayout::eShaderReadOnlyOptimal);
}

void Texture::copy_to(vk::CommandBuffer commands, const Buffer& target) {
    const auto before = layout_;
    transition(commands, vk::ImageLayout::eTransferSrcOptimal);
    const vk::ImageSubresourceLayers layers(vk::ImageAspectFlagBits::eColor, 0, 0, 1);
    const vk::BufferImageCopy region(0, 0, 0, layers, {}, {width_, height_, 1});
    commands.copyImageToBuffer(handle(), vk::ImageLayout::eTransferSrcOptimal, target.handle(), region);
    transition(commands, before);
    full_barrier(commands);
}

void full_barrier(vk::CommandBuffer commands) {
    const vk::MemoryBarrier barrier(vk::AccessFlagBits::eMemoryWrite,
                                    vk::AccessFlagBits::eMemoryRead | vk::AccessFlagBits::eMemoryWrite);
    commands.pipelineBarrier(vk::PipelineStageFlagBits::eAllCommands,
                             vk::PipelineStageFlagBits::eAllCommands | vk::PipelineStageFlagBits::eHost, {},
                             barrier, {}, {});
}

void compute_barrier(vk::CommandBuffer commands) {
    const vk::MemoryBarrier barrier(vk::AccessFlagBits::eShaderWrite | vk::AccessFlagBits::eTransferWrite,
                                    vk::AccessFlagBits::eShaderRead | vk::AccessFlagBits::eShaderWrite |
                                        vk::AccessFlagBits::eIndirectCommandRead |
                                        vk::AccessFlagBits::eTransferRead |
                                        vk::AccessFlagBits::eTransferWrite);
    const auto stages = vk::PipelineStageFlagBits::eComputeShader | vk::PipelineStageFlagBits::eTransfer;
    commands.pipelineBarrier(stages, stages | vk::PipelineStageFlagBits::eDrawIndirect, {}, barrier, {}, {});
}

}  // namespace gse::vulkan
