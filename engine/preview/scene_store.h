// The scene on the device: chunks of rows, filled slice by slice while the old scene is still shown; arrays
// that did not change are shared with it.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "engine/scene/gaussian_set.h"
#include "engine/vulkan/resources.h"

namespace gse::preview {

/// Writes into device buffers: directly where they are mapped, through staging memory and recorded copies
/// where not.
class Uploader {
public:
    Uploader(vulkan::Device& device, bool always_stage) : device_(device), always_stage_(always_stage) {}

    /// Memory for `bytes` at `offset` of `target`, to be filled before flush().
    std::byte* reserve(const std::shared_ptr<vulkan::Buffer>& target, std::uint64_t offset,
                       std::uint64_t bytes);
    /// Records the copies that are due.
    void flush(vk::CommandBuffer commands);

private:
    struct Copy {
        std::shared_ptr<vulkan::Buffer> target;
        vulkan::Buffer staging;
        std::uint64_t offset, bytes;
    };
    vulkan::Device& device_;
    bool always_stage_;
    std::vector<Copy> copies_;
};

/// Rows [first, first + count).
struct SceneChunk {
    std::size_t first = 0, count = 0;
    std::shared_ptr<vulkan::Buffer> geometry, harmonics, values;  // values: null = none
};

class SceneStore {
public:
    static constexpr std::size_t ChunkRows = 1u << 19;  // 50 MB of harmonics: under every limit of a binding

    SceneStore(vulkan::Device& device, bool always_stage)
        : device_(device), uploader_(device, always_stage) {}

    /// Begins to upload `set`; what is shown changes when it is complete. Replaces an upload under way.
    void begin(const GaussianSet& set);
    /// Works for about `milliseconds`; true when the shown scene has changed. Call flush() afterwards.
    bool advance(double milliseconds);
    bool busy() const { return static_cast<bool>(pending_); }
    /// One number per row of the shown scene, or none.
    void set_values(std::span<const float> values);
    void flush(vk::CommandBuffer commands) { uploader_.flush(commands); }

    const GaussianSet& shown() const { return shown_; }
    std::span<const SceneChunk> chunks() const { return chunks_; }
    std::uint64_t byte_size() const;

private:
    struct Pending {
        GaussianSet set;
        std::vector<SceneChunk> chunks;
        bool geometry = false, harmonics = false;  // to be packed
        std::size_t next_row = 0;
    };
    std::shared_ptr<vulkan::Buffer> make(std::uint64_t bytes, vk::Format format, const char* name);
    void make_chunks(Pending& pending);
    void pack_slice(Pending& pending);

    vulkan::Device& device_;
    Uploader uploader_;
    GaussianSet shown_;
    std::vector<SceneChunk> chunks_;
    std::unique_ptr<Pending> pending_;
};

}  // namespace gse::preview
