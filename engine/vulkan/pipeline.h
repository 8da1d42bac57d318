// Compute pipelines made from SPIR-V that is compiled into the program.
#pragma once

#include <cstdint>
#include <span>

#include "engine/vulkan/device.h"

namespace gse::vulkan {

struct ComputeDescription {
    std::span<const std::uint32_t> code;
    std::span<const vk::DescriptorSetLayout> sets;
    std::uint32_t push_bytes = 0;
    std::span<const std::uint32_t> constants;  // specialisation constants with ids 0, 1, ...
    const char* name = "";
};

class ComputePipeline {
public:
    ComputePipeline(Device& device, const ComputeDescription& description);

    vk::PipelineLayout layout() const { return *layout_; }
    void bind(vk::CommandBuffer commands, std::span<const vk::DescriptorSet> sets) const;
    template <class T> void push(vk::CommandBuffer commands, const T& values) const {
        commands.pushConstants(*layout_, vk::ShaderStageFlagBits::eCompute, 0, sizeof(T), &values);
    }

private:
    vk::raii::PipelineLayout layout_{nullptr};
    vk::raii::Pipeline pipeline_{nullptr};
};

}  // namespace gse::vulkan
