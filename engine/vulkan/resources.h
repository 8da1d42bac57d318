// Buffers and images that clean up after themselves. The object on the device lives until the device is done
// with it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "engine/vulkan/device.h"

namespace gse::vulkan {

/// Use of a buffer; decides the kind of memory.
enum class BufferHome {
    Device,    // fastest for shaders; mapped too where the device's memory is the host's
    Upload,    // written by the CPU, read by the device
    Readback,  // written by the device, read by the CPU
};

struct BufferDescription {
    std::uint64_t size = 0;  // bytes
    vk::BufferUsageFlags usage;
    BufferHome home = BufferHome::Device;
    const char* name = "";
    vk::Format texel_format = vk::Format::eUndefined;  // set: also a uniform texel buffer of this format
};

class Buffer {
public:
    Buffer() = default;
    Buffer(Device& device, const BufferDescription& description);
    ~Buffer();
    Buffer(Buffer&&) noexcept = default;
    Buffer& operator=(Buffer&& other) noexcept;

    explicit operator bool() const { return state_ != nullptr; }
    vk::Buffer handle() const;
    vk::BufferView view() const;
    std::uint64_t size() const;
    /// The memory as the CPU sees it; null if it does not.
    std::byte* mapped() const;
    template <class T> std::span<T> as() const {
        return {reinterpret_cast<T*>(mapped()), size() / sizeof(T)};
    }

private:
    struct State;
    void release();
    Device* device_ = nullptr;
    std::shared_ptr<State> state_;
};

struct ImageDescription {
    std::uint32_t width = 0, height = 0;
    vk::Format format = vk::Format::eR8G8B8A8Unorm;
    vk::ImageUsageFlags usage;
    const char* name = "";
};

/// A 2D colour image with one level. Remembers its layout.
class Texture {
public:
    Texture() = default;
    Texture(Device& device, const ImageDescription& description);
    ~Texture();
    Texture(Texture&&) noexcept = default;
    Texture& operator=(Texture&& other) noexcept;

    explicit operator bool() const { return state_ != nullptr; }
    vk::Image handle() const;
    vk::ImageView view() const;
    std::uint32_t width() const { return width_; }
    std::uint32_t height() const { return height_; }
    /// Records a change of layout that waits for all earlier use and lets all later use wait for it.
    void transition(vk::CommandBuffer commands, vk::ImageLayout layout);
    /// Records a copy of tightly packed pixels. Leaves the image ready for sampling.
    void copy_from(vk::CommandBuffer commands, const Buffer& source, std::uint64_t offset = 0);
    /// Records a copy into a buffer. Leaves the image in its layout.
    void copy_to(vk::CommandBuffer commands, const Buffer& target);

private:
    struct State;
    void release();
    Device* device_ = nullptr;
    std::uint32_t width_ = 0, height_ = 0;
    vk::ImageLayout layout_ = vk::ImageLayout::eUndefined;
    std::shared_ptr<State> state_;
};

/// Barrier: later commands see all writes of earlier ones (compute, transfer, indirect, fragment, host).
void full_barrier(vk::CommandBuffer commands);
/// Barrier: later compute shaders and indirect dispatches see writes of compute shaders and copies.
void compute_barrier(vk::CommandBuffer commands);

}  // namespace gse::vulkan
