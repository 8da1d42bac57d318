// Pipelines and layouts.
#include "engine/preview/passes.h"

#include <array>
#include <cstring>

#include "shaders/bin_count_comp.h"
#include "shaders/bin_count_limited_comp.h"
#include "shaders/bin_place_comp.h"
#include "shaders/bin_place_limited_comp.h"
#include "shaders/blend_comp.h"
#include "shaders/blend_portable_comp.h"
#include "shaders/pick_comp.h"
#include "shaders/project_comp.h"
#include "shaders/scan_apply_comp.h"
#include "shaders/scan_blocks_comp.h"
#include "shaders/scan_spine_comp.h"
#include "shaders/sort_count_comp.h"
#include "shaders/sort_scatter_comp.h"

namespace gse::preview {
namespace {

using Type = vk::DescriptorType;

constexpr auto FrameBindings = [] {
    std::array<Type, 20> types{};
    types[0] = Type::eUniformBuffer;
    for (std::size_t i = 1; i <= 11; ++i) types[i] = Type::eStorageBuffer;
    types[12] = Type::eStorageImage;
    for (std::size_t i = 13; i < 20; ++i) types[i] = Type::eUniformTexelBuffer;
    return types;
}();

constexpr std::array<Type, 3> ChunkBindings{Type::eUniformTexelBuffer, Type::eUniformTexelBuffer,
                                            Type::eUniformTexelBuffer};

struct Code {
    std::span<const std::uint32_t> words;
    const char* name;
};

Code code_of(Pass pass) {
    switch (pass) {
        case Pass::Project: return {shaders::project_comp, "project"};
        case Pass::SortCount: return {shaders::sort_count_comp, "sort count"};
        case Pass::SortScatter: return {shaders::sort_scatter_comp, "sort scatter"};
        case Pass::ScanBlocks: return {shaders::scan_blocks_comp, "scan blocks"};
        case Pass::ScanSpine: return {shaders::scan_spine_comp, "scan spine"};
        case Pass::ScanApply: return {shaders::scan_apply_comp, "scan apply"};
        case Pass::BinCount: return {shaders::bin_count_comp, "bin count"};
        case Pass::BinPlace: return {shaders::bin_place_comp, "bin place"};
        case Pass::BinCountLimited: return {shaders::bin_count_limited_comp, "bin count in rounds"};
        case Pass::BinPlaceLimited: return {shaders::bin_place_limited_comp, "bin place in rounds"};
        case Pass::Blend: return {shaders::blend_comp, "blend"};
        case Pass::BlendPortable: return {shaders::blend_portable_comp, "blend portable"};
        case Pass::Pick: return {shaders::pick_comp, "pick"};
    }
    return {};
}

vk::raii::DescriptorSetLayout make_layout(vulkan::Device& device, std::span<const Type> types) {
    std::vector<vk::DescriptorSetLayoutBinding> bindings;
    for (std::uint32_t i = 0; i < types.size(); ++i)
        bindings.push_back({i, types[i], 1, vk::ShaderStageFlagBits::eCompute});
    return vk::raii::DescriptorSetLayout(device.handle(), vk::DescriptorSetLayoutCreateInfo({}, bindings));
}

}  // namespace

std::span<const vk::DescriptorType> frame_bindings() { return FrameBindings; }

Passes::Passes(vulkan::Device& device) : device_(device) {
    vulkan::guarded("preparing the preview", [&] {
        frame_layout_ = make_layout(device, FrameBindings);
        chunk_layout_ = make_layout(device, ChunkBindings);
    });
}

const vulkan::ComputePipeline& Passes::get(Pass pass, const std::vector<std::uint32_t>& constants) {
    const auto found = pipelines_.find({pass, constants});
    if (found != pipelines_.end()) return found->second;
    const std::array<vk::DescriptorSetLayout, 2> sets{*frame_layout_, *chunk_layout_};
    const auto code = code_of(pass);
    vulkan::ComputeDescription description;
    description.code = code.words;
    description.sets = {sets.data(), pass == Pass::Project ? 2u : 1u};
    description.push_bytes = PushBytes;
    description.constants = constants;
    description.name = code.name;
    return pipelines_.try_emplace({pass, constants}, vulkan::ComputePipeline(device_, description))
        .first->second;
}

}  // namespace gse::preview
