// ImGui's draw lists on Vulkan.
#include "engine/window/window_imgui.h"

#include <imgui.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <utility>

#include "shaders/panels_frag.h"
#include "shaders/panels_vert.h"

namespace gse::window {
namespace {

struct Push {
    float scale[2], offset[2];
};

/// Next handle. Handles are never used twice, not even by the renderer of a device that is opened again.
std::uint64_t next_id() {
    static std::uint64_t last = 0;
    return ++last;
}

vk::raii::Sampler make_sampler(vulkan::Device& device, vk::Filter filter) {
    vk::SamplerCreateInfo info;
    info.magFilter = info.minFilter = filter;
    info.addressModeU = info.addressModeV = info.addressModeW = vk::SamplerAddressMode::eClampToEdge;
    info.maxLod = VK_LOD_CLAMP_NONE;
    return vk::raii::Sampler(device.handle(), info);
}

/// Makes room for `bytes`, with some to spare. The old buffer dies when the device is done with it.
void reserve(vulkan::Device& device, vulkan::Buffer& buffer, std::size_t bytes, vk::BufferUsageFlags usage) {
    if (buffer.size() >= bytes && buffer) return;
    buffer = vulkan::Buffer(device, {.size = bytes + bytes / 2 + 4096,
                                     .usage = usage,
                                     .home = vulkan::BufferHome::Upload,
                                     .name = "panels"});
}

}  // namespace

ImGuiRenderer::ImGuiRenderer(vulkan::Device& device, vk::RenderPass render_pass) : device_(device) {
    vulkan::guarded("preparing the panels", [&] {
        smooth_ = make_sampler(device, vk::Filter::eLinear);
        sharp_ = make_sampler(device, vk::Filter::eNearest);
        const vk::DescriptorSetLayoutBinding binding(0, vk::DescriptorType::eCombinedImageSampler, 1,
                                                     vk::ShaderStageFlagBits::eFragment);
        set_layout_ =
            vk::raii::DescriptorSetLayout(device.handle(), vk::DescriptorSetLayoutCreateInfo({}, binding));
        const vk::PushConstantRange range(vk::ShaderStageFlagBits::eVertex, 0, sizeof(Push));
        layout_ =
            vk::raii::PipelineLayout(device.handle(), vk::PipelineLayoutCreateInfo({}, *set_layout_, range));
        make_pipeline(render_pass);
    });
    auto& io = ImGui::GetIO();
    io.BackendRendererName = "gseditpro";
    io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
}

ImGuiRenderer::~ImGuiRenderer() {
    ImGui::GetIO().Fonts->SetTexID(nullptr);
    for (auto& [id, texture] : textures_) device_.retire(std::move(texture.set));
}

void ImGuiRenderer::make_pipeline(vk::RenderPass render_pass) {
    const vk::raii::ShaderModule vertex(device_.handle(),
                                        {{}, sizeof(shaders::panels_vert), shaders::panels_vert});
    const vk::raii::ShaderModule fragment(device_.handle(),
                                          {{}, sizeof(shaders::panels_frag), shaders::panels_frag});
    const vk::PipelineShaderStageCreateInfo stages[] = {
        {{}, vk::ShaderStageFlagBits::eVertex, *vertex, "main"},
        {{}, vk::ShaderStageFlagBits::eFragment, *fragment, "main"}};
    const vk::VertexInputBindingDescription binding(0, sizeof(ImDrawVert));
    const vk::VertexInputAttributeDescription attributes[] = {
        {0, 0, vk::Format::eR32G32Sfloat, offsetof(ImDrawVert, pos)},
        {1, 0, vk::Format::eR32G32Sfloat, offsetof(ImDrawVert, uv)},
        {2, 0, vk::Format::eR8G8B8A8Unorm, offsetof(ImDrawVert, col)}};
    const vk::PipelineVertexInputStateCreateInfo input({}, binding, attributes);
    const vk::PipelineInputAssemblyStateCreateInfo assembly({}, vk::PrimitiveTopology::eTriangleList);
    const vk::PipelineViewportStateCreateInfo viewport({}, 1, nullptr, 1, nullptr);
    vk::PipelineRasterizationStateCreateInfo raster;
    raster.lineWidth = 1;
    const vk::PipelineMultisampleStateCreateInfo samples;
    using Factor = vk::BlendFactor;
    using Component = vk::ColorComponentFlagBits;
    const vk::PipelineColorBlendAttachmentState over(
        VK_TRUE, Factor::eSrcAlpha, Factor::eOneMinusSrcAlpha, vk::BlendOp::eAdd, Factor::eOne,
        Factor::eOneMinusSrcAlpha, vk::BlendOp::eAdd,
        Component::eR | Component::eG | Component::eB | Component::eA);
    vk::PipelineColorBlendStateCreateInfo blend;
    blend.setAttachments(over);
    const vk::DynamicState dynamic[] = {vk::DynamicState::eViewport, vk::DynamicState::eScissor};
    const vk::PipelineDynamicStateCreateInfo dynamics({}, dynamic);
    vk::GraphicsPipelineCreateInfo info;
    info.setStages(stages);
    info.pVertexInputState = &input;
    info.pInputAssemblyState = &assembly;
    info.pViewportState = &viewport;
    info.pRasterizationState = &raster;
    info.pMultisampleState = &samples;
    info.pColorBlendState = &blend;
    info.pDynamicState = &dynamics;
    info.layout = *layout_;
    info.renderPass = render_pass;
    pipeline_ = vk::raii::Pipeline(device_.handle(), device_.pipeline_cache(), info);
}

vk::raii::DescriptorSet ImGuiRenderer::make_texture_set(vk::ImageView view, bool smooth) {
    auto set = device_.make_set(*set_layout_);
    const vk::DescriptorImageInfo image(smooth ? *smooth_ : *sharp_, view,
                                        vk::ImageLayout::eShaderReadOnlyOptimal);
    const vk::WriteDescriptorSet write(*set, 0, 0, vk::DescriptorType::eCombinedImageSampler, image);
    device_.handle().updateDescriptorSets(write, {});
    return set;
}

std::uint64_t ImGuiRenderer::add_texture(vk::ImageView view, bool smooth) {
    const std::uint64_t id = next_id();
    textures_.emplace(id, Texture{make_texture_set(view, smooth), smooth});
    return id;
}

void ImGuiRenderer::replace_texture(std::uint64_t id, vk::ImageView view) {
    Texture& texture = textures_.at(id);
    auto set = make_texture_set(view, texture.smooth);  // frames in flight still read the old one
    device_.retire(std::exchange(texture.set, std::move(set)));
}

void ImGuiRenderer::remove_texture(std::uint64_t id) {
    const auto found = textures_.find(id);
    if (found == textures_.end()) return;
    device_.retire(std::move(found->second.set));
    textures_.erase(found);
}

void ImGuiRenderer::upload_fonts(vk::CommandBuffer commands) {
    unsigned char* pixels = nullptr;
    int width = 0, height = 0;
    ImGui::GetIO().Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
    const std::size_t bytes = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4;
    const vulkan::Buffer staging(device_, {.size = bytes,
                                           .usage = vk::BufferUsageFlagBits::eTransferSrc,
                                           .home = vulkan::BufferHome::Upload,
                                           .name = "fonts"});
    std::memcpy(staging.mapped(), pixels, bytes);
    font_ = vulkan::Texture(device_,
                            {.width = static_cast<std::uint32_t>(width),
                             .height = static_cast<std::uint32_t>(height),
                             .usage = vk::ImageUsageFlagBits::eSampled | vk::ImageUsageFlagBits::eTransferDst,
                             .name = "fonts"});
    font_.copy_from(commands, staging);
    if (font_id_ != 0) remove_texture(font_id_);
    font_id_ = add_texture(font_.view(), true);
    ImGui::GetIO().Fonts->SetTexID(reinterpret_cast<ImTextureID>(font_id_));
    ImGui::GetIO().Fonts->ClearTexData();
}

void ImGuiRenderer::copy_geometry(const ImDrawData& data, std::size_t slot) {
    const auto vertex_bytes = static_cast<std::size_t>(data.TotalVtxCount) * sizeof(ImDrawVert);
    const auto index_bytes = static_cast<std::size_t>(data.TotalIdxCount) * sizeof(ImDrawIdx);
    reserve(device_, vertices_[slot], vertex_bytes, vk::BufferUsageFlagBits::eVertexBuffer);
    reserve(device_, indices_[slot], index_bytes, vk::BufferUsageFlagBits::eIndexBuffer);
    auto* vertex = vertices_[slot].as<ImDrawVert>().data();
    auto* index = indices_[slot].as<ImDrawIdx>().data();
    for (int i = 0; i < data.CmdListsCount; ++i) {
        const ImDrawList& list = *data.CmdLists[i];
        vertex = std::copy(list.VtxBuffer.begin(), list.VtxBuffer.end(), vertex);
        index = std::copy(list.IdxBuffer.begin(), list.IdxBuffer.end(), index);
    }
}

void ImGuiRenderer::draw(vk::CommandBuffer commands, const ImDrawData& data, std::size_t slot) {
    const float width = data.DisplaySize.x * data.FramebufferScale.x,
                height = data.DisplaySize.y * data.FramebufferScale.y;
    if (width <= 0 || height <= 0 || data.TotalVtxCount == 0) return;
    copy_geometry(data, slot);
    commands.bindPipeline(vk::PipelineBindPoint::eGraphics, *pipeline_);
    commands.setViewport(0, vk::Viewport(0, 0, width, height, 0, 1));
    commands.bindVertexBuffers(0, vertices_[slot].handle(), vk::DeviceSize{0});
    commands.bindIndexBuffer(indices_[slot].handle(), 0,
                             sizeof(ImDrawIdx) == 2 ? vk::IndexType::eUint16 : vk::IndexType::eUint32);
    Push push;
    push.scale[0] = 2.0f / data.DisplaySize.x;
    push.scale[1] = 2.0f / data.DisplaySize.y;
    push.offset[0] = -1.0f - data.DisplayPos.x * push.scale[0];
    push.offset[1] = -1.0f - data.DisplayPos.y * push.scale[1];
    commands.pushConstants(*layout_, vk::ShaderStageFlagBits::eVertex, 0, sizeof(push), &push);
    draw_lists(commands, data);
}

void ImGuiRenderer::draw_lists(vk::CommandBuffer commands, const ImDrawData& data) {
    const float width = data.DisplaySize.x * data.FramebufferScale.x,
                height = data.DisplaySize.y * data.FramebufferScale.y;
    std::uint32_t first_vertex = 0, first_index = 0;
    vk::DescriptorSet bound;
    for (int i = 0; i < data.CmdListsCount; ++i) {
        const ImDrawList& list = *data.CmdLists[i];
        for (const ImDrawCmd& command : list.CmdBuffer) {
            if (command.UserCallback != nullptr) {
                if (command.UserCallback != ImDrawCallback_ResetRenderState)
                    command.UserCallback(&list, &command);
                continue;
            }
            const ImVec4& clip = command.ClipRect;
            const float left = std::max((clip.x - data.DisplayPos.x) * data.FramebufferScale.x, 0.0f);
            const float top = std::max((clip.y - data.DisplayPos.y) * data.FramebufferScale.y, 0.0f);
            const float right = std::min((clip.z - data.DisplayPos.x) * data.FramebufferScale.x, width);
            const float bottom = std::min((clip.w - data.DisplayPos.y) * data.FramebufferScale.y, height);
            if (right <= left || bottom <= top || command.ElemCount == 0) continue;
            const auto texture = textures_.find(reinterpret_cast<std::uint64_t>(command.GetTexID()));
            if (texture == textures_.end()) continue;  // gone meanwhile
            const vk::DescriptorSet set = *texture->second.set;
            commands.setScissor(
                0, vk::Rect2D(
                       {static_cast<std::int32_t>(left), static_cast<std::int32_t>(top)},
                       {static_cast<std::uint32_t>(right - left), static_cast<std::uint32_t>(bottom - top)}));
            if (set != bound)
                commands.bindDescriptorSets(vk::PipelineBindPoint::eGraphics, *layout_, 0, set, {});
            bound = set;
            commands.drawIndexed(command.ElemCount, 1, first_index + command.IdxOffset,
                                 static_cast<std::int32_t>(first_vertex + command.VtxOffset), 0);
        }
        first_vertex += static_cast<std::uint32_t>(list.VtxBuffer.Size);
        first_index += static_cast<std::uint32_t>(list.IdxBuffer.Size);
    }
}

}  // namespace gse::window
