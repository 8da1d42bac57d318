// Working memory of a frame: records, sort and tile lists, pictures. Grows as needed, never shrinks, and
// allocates nothing once warm.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/preview/passes.h"
#include "engine/vulkan/resources.h"

namespace gse::preview {

/// Division of the work between the passes. Depends on the device and the picture's size.
struct Division {
    std::uint32_t tile = 8;    // pixels a side
    std::uint32_t group = 64;  // invocations of the passes whose invocations own a stretch each
    std::uint32_t sort_parts = 0, bin_parts = 0;
    std::uint32_t digit_bits = 8;
    std::uint32_t bin_rounds = 0;  // 0 = binning is done in one go (bin.comp)
    std::uint32_t sort_passes() const { return (32 + digit_bits - 1) / digit_bits; }
};

struct WorkspaceSize {
    std::size_t rows = 0;
    std::uint32_t width = 0, height = 0;
    std::uint64_t pairs = 0;
    std::uint64_t matrix = 0;  // entries
    bool depth = false, light = false;
};

class Workspace {
public:
    Workspace(vulkan::Device& device, Passes& passes);
    ~Workspace();

    /// Makes room. Returns true when the picture is another image than before.
    bool reserve(const WorkspaceSize& size);
    std::uint64_t pair_capacity() const { return pair_capacity_; }
    std::uint64_t largest_pair_capacity() const;
    std::uint64_t byte_size() const;

    vk::DescriptorSet set() const { return *set_; }
    vulkan::Texture& picture() { return picture_; }
    const vulkan::Texture& picture() const { return picture_; }
    enum Slot : std::size_t {
        Frame,
        RecordsA,
        RecordsB,
        Keys,
        SortedX,
        SortedY,
        Matrix,
        Blocks,
        Control,
        Pairs,
        Depths,
        Light,
        SlotCount
    };
    vulkan::Buffer& buffer(Slot slot) { return buffers_[slot]; }

private:
    void grow(Slot slot, std::uint64_t bytes, vk::Format texels = vk::Format::eUndefined);
    void write_set();

    vulkan::Device& device_;
    Passes& passes_;
    std::array<vulkan::Buffer, SlotCount> buffers_;
    vulkan::Texture picture_;
    vk::raii::DescriptorSet set_{nullptr};
    std::uint64_t pair_capacity_ = 0;
    bool set_stale_ = true;
};

}  // namespace gse::preview
