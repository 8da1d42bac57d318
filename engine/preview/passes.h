// Pipelines of the passes, made when first needed, and the layouts of their resources.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "engine/vulkan/pipeline.h"

namespace gse::preview {

enum class Pass {
    Project,
    SortCount,
    SortScatter,
    ScanBlocks,
    ScanSpine,
    ScanApply,
    BinCount,
    BinPlace,
    BinCountLimited,
    BinPlaceLimited,
    Blend,
    BlendPortable,
    Pick
};

class Passes {
public:
    explicit Passes(vulkan::Device& device);

    const vulkan::ComputePipeline& get(Pass pass, const std::vector<std::uint32_t>& constants);
    vk::DescriptorSetLayout frame_layout() const { return *frame_layout_; }
    vk::DescriptorSetLayout chunk_layout() const { return *chunk_layout_; }
    static constexpr std::uint32_t PushBytes = 16;

private:
    vulkan::Device& device_;
    vk::raii::DescriptorSetLayout frame_layout_{nullptr}, chunk_layout_{nullptr};
    std::map<std::pair<Pass, std::vector<std::uint32_t>>, vulkan::ComputePipeline> pipelines_;
};

/// Kinds of the bindings 0, 1, ... of the frame's set (frame.glsl).
std::span<const vk::DescriptorType> frame_bindings();

}  // namespace gse::preview
