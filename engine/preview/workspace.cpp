// Allocation of the frame's working memory and its descriptor set.
#include "engine/preview/workspace.h"

#include <algorithm>

#include "engine/base/error.h"
#include "shared.h"

namespace gse::preview {
namespace {

using Type = vk::DescriptorType;

constexpr std::array<const char*, Workspace::SlotCount> Names{"frame",    "records a", "records b", "keys",
                                                              "sorted x", "sorted y",  "matrix",    "blocks",
                                                              "control",  "pairs",     "depths",    "light"};

/// Buffer of each texel-buffer binding 13...
constexpr std::array<Workspace::Slot, 7> TexelSlots{
    Workspace::RecordsA, Workspace::RecordsB, Workspace::Keys, Workspace::SortedX,
    Workspace::SortedY,  Workspace::Matrix,   Workspace::Pairs};

}  // namespace

Workspace::Workspace(vulkan::Device& device, Passes& passes) : device_(device), passes_(passes) {
    grow(Frame, sizeof(shaders::FrameData));
    grow(Control, shaders::ControlWords * 4);
    grow(Depths, 16);
    grow(Light, 16);
}

Workspace::~Workspace() {
    if (*set_) device_.retire(std::move(set_));
}

std::uint64_t Workspace::largest_pair_capacity() const {
    return std::min<std::uint64_t>(device_.info().storage_range / 4, device_.info().texel_elements);
}

void Workspace::grow(Slot slot, std::uint64_t bytes, vk::Format texels) {
    auto& buffer = buffers_[slot];
    bytes = std::max<std::uint64_t>(bytes, 16);
    if (buffer && buffer.size() >= bytes) return;
    if (bytes > device_.info().storage_range)
        throw Error(ErrorCode::Unsupported, "the scene or the picture is too large for this graphics device",
                    "use --preview native");
    auto usage = vk::BufferUsageFlagBits::eStorageBuffer | vk::BufferUsageFlagBits::eTransferDst |
                 vk::BufferUsageFlagBits::eTransferSrc;
    if (slot == Frame)
        usage = vk::BufferUsageFlagBits::eUniformBuffer | vk::BufferUsageFlagBits::eTransferDst;
    buffer = {};  // the old one dies before the new one is there
    buffer =
        vulkan::Buffer(device_, {.size = bytes, .usage = usage, .name = Names[slot], .texel_format = texels});
    set_stale_ = true;
}

bool Workspace::reserve(const WorkspaceSize& size) {
    const std::uint64_t rows = std::max<std::size_t>(size.rows, 1);
    grow(RecordsA, rows * 16, vk::Format::eR32G32B32A32Sfloat);
    grow(RecordsB, rows * 16, vk::Format::eR32G32B32A32Sfloat);
    grow(Keys, rows * 4, vk::Format::eR32Uint);
    grow(SortedX, rows * 8, vk::Format::eR32G32Uint);
    grow(SortedY, rows * 8, vk::Format::eR32G32Uint);
    grow(Matrix, size.matrix * 4, vk::Format::eR32Uint);
    grow(Blocks,
         std::max<std::uint64_t>(size.matrix / shaders::ScanBlock + 1, 4096) * 4);  // also progress by part
    pair_capacity_ =
        std::max(pair_capacity_, std::clamp<std::uint64_t>(size.pairs, 1024, largest_pair_capacity()));
    grow(Pairs, pair_capacity_ * 4, vk::Format::eR32Uint);
    const std::uint64_t pixels = std::uint64_t{size.width} * size.height;
    if (size.depth) grow(Depths, pixels * 4);
    if (size.light) grow(Light, pixels * 24);
    const bool other = !picture_ || picture_.width() != size.width || picture_.height() != size.height;
    if (other) {
        if (size.width > device_.info().image_size || size.height > device_.info().image_size)
            throw Error(ErrorCode::Unsupported, "the picture is too large for this graphics device",
                        "use --preview native, or a smaller size");
        picture_ = vulkan::Texture(
            device_, {.width = size.width,
                      .height = size.height,
                      .usage = vk::ImageUsageFlagBits::eStorage | vk::ImageUsageFlagBits::eSampled |
                               vk::ImageUsageFlagBits::eTransferSrc,
                      .name = "preview"});
        set_stale_ = true;
    }
    if (set_stale_) write_set();
    return other;
}

void Workspace::write_set() {
    if (*set_) device_.retire(std::move(set_));
    set_ = device_.make_set(passes_.frame_layout());
    const auto types = frame_bindings();
    std::vector<vk::DescriptorBufferInfo> infos(types.size());
    std::vector<vk::BufferView> views(types.size());
    const vk::DescriptorImageInfo image({}, picture_.view(), vk::ImageLayout::eGeneral);
    std::vector<vk::WriteDescriptorSet> writes;
    for (std::uint32_t i = 0; i < types.size(); ++i) {
        vk::WriteDescriptorSet write(*set_, i, 0, 1, types[i]);
        if (types[i] == Type::eUniformTexelBuffer) {
            views[i] = buffers_[TexelSlots[i - 13]].view();
            write.pTexelBufferView = &views[i];
        } else if (types[i] == Type::eStorageImage) {
            write.pImageInfo = &image;
        } else {
            infos[i] = vk::DescriptorBufferInfo(buffers_[i].handle(), 0, VK_WHOLE_SIZE);
            write.pBufferInfo = &infos[i];
        }
        writes.push_back(write);
    }
    device_.handle().updateDescriptorSets(writes, {});
    set_stale_ = false;
}

std::uint64_t Workspace::byte_size() const {
    std::uint64_t bytes = std::uint64_t{picture_.width()} * picture_.height() * 4;
    for (const auto& buffer : buffers_) bytes += buffer.size();
    return bytes;
}

}  // namespace gse::preview
