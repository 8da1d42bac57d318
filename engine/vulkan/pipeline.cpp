// Creation and binding of compute pipelines.
#include "engine/vulkan/pipeline.h"

#include <vector>

namespace gse::vulkan {

ComputePipeline::ComputePipeline(Device& device, const ComputeDescription& description) {
    guarded("preparing a shader", [&] {
        const vk::PushConstantRange range(vk::ShaderStageFlagBits::eCompute, 0, description.push_bytes);
        vk::PipelineLayoutCreateInfo layout;
        layout.setLayoutCount = static_cast<std::uint32_t>(description.sets.size());
        layout.pSetLayouts = description.sets.data();
        layout.pushConstantRangeCount = description.push_bytes > 0 ? 1 : 0;
        layout.pPushConstantRanges = &range;
        layout_ = vk::raii::PipelineLayout(device.handle(), layout);
        const vk::raii::ShaderModule module(device.handle(),
                                            {{}, description.code.size_bytes(), description.code.data()});
        std::vector<vk::SpecializationMapEntry> entries;
        for (std::uint32_t id = 0; id < description.constants.size(); ++id)
            entries.push_back({id, id * 4, 4});
        const vk::SpecializationInfo constants(static_cast<std::uint32_t>(entries.size()), entries.data(),
                                               description.constants.size_bytes(),
                                               description.constants.data());
        const vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *module, "main",
                                                      &constants);
        pipeline_ = vk::raii::Pipeline(device.handle(), device.pipeline_cache(),
                                       vk::ComputePipelineCreateInfo({}, stage, *layout_));
        device.name(vk::ObjectType::ePipeline,
                    reinterpret_cast<std::uint64_t>(static_cast<VkPipeline>(*pipeline_)), description.name);
    });
}

void ComputePipeline::bind(vk::CommandBuffer commands, std::span<const vk::DescriptorSet> sets) const {
    commands.bindPipeline(vk::PipelineBindPoint::eCompute, *pipeline_);
    if (sets.empty()) return;
    commands.bindDescriptorSets(
        vk::PipelineBindPoint::eCompute, *layout_, 0,
        vk::ArrayProxy<const vk::DescriptorSet>(static_cast<std::uint32_t>(sets.size()), sets.data()), {});
}

}  // namespace gse::vulkan
