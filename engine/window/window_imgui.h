// Renderer of Dear ImGui's output with any number of textures. The stock backend of ImGui 1.86 knows only the
// font's.
#pragma once

#include <cstdint>
#include <unordered_map>

#include "engine/vulkan/device.h"
#include "engine/vulkan/resources.h"

struct ImDrawData;

namespace gse::window {

class ImGuiRenderer {
public:
    static constexpr std::size_t FramesInFlight = 2;

    ImGuiRenderer(vulkan::Device& device, vk::RenderPass render_pass);
    ~ImGuiRenderer();

    /// Records the upload of the font atlas of the current context.
    void upload_fonts(vk::CommandBuffer commands);
    /// Copies vertices and records the drawing. `slot` counts the frames in flight, whose buffers must be
    /// free again.
    void draw(vk::CommandBuffer commands, const ImDrawData& data, std::size_t slot);

    std::uint64_t add_texture(vk::ImageView view, bool smooth);
    /// Puts another image under an existing handle. Earlier drawings with it still show something.
    void replace_texture(std::uint64_t id, vk::ImageView view);
    void remove_texture(std::uint64_t id);

private:
    void make_pipeline(vk::RenderPass render_pass);
    void copy_geometry(const ImDrawData& data, std::size_t slot);
    void draw_lists(vk::CommandBuffer commands, const ImDrawData& data);

    vulkan::Device& device_;
    vk::raii::Sampler smooth_{nullptr}, sharp_{nullptr};
    vk::raii::DescriptorSetLayout set_layout_{nullptr};
    vk::raii::PipelineLayout layout_{nullptr};
    vk::raii::Pipeline pipeline_{nullptr};
    struct Texture {
        vk::raii::DescriptorSet set;
        bool smooth = true;
    };
    vk::raii::DescriptorSet make_texture_set(vk::ImageView view, bool smooth);
    std::unordered_map<std::uint64_t, Texture> textures_;
    vulkan::Texture font_;
    std::uint64_t font_id_ = 0;
    vulkan::Buffer vertices_[FramesInFlight], indices_[FramesInFlight];
};

}  // namespace gse::window
