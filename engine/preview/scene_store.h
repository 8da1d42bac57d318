// The scene on the device: chunks of rows, filled slice by slice while the old scene is still shown.
// Unchanged arrays are shared with the old scene. If only some rows changed, only those are sent.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "engine/scene/gaussian_set.h"
#include "engine/vulkan/resources.h"

namespace gse::preview {

/// Writes into device buffers: directly into mapped ones, through staging memory and recorded copies into
/// others.
class Uploader {
public:
    Uploader(vulkan::Device& device, bool always_stage) : device_(device), always_stage_(always_stage) {}

    /// Memory for `bytes` at `offset` of `target`, to be filled before flush().
    std::byte* reserve(const std::shared_ptr<vulkan::Buffer>& target, std::uint64_t offset,
                       std::uint64_t bytes);
    /// Bytes for parts of a buffer that frames under way may still read. Written when they are done.
    void replace(const std::shared_ptr<vulkan::Buffer>& target, std::span<const std::byte> bytes,
                 std::vector<vk::BufferCopy> parts);
    /// Records the copies that are due.
    void flush(vk::CommandBuffer commands);
    std::uint64_t sent_bytes() const { return sent_; }

private:
    struct Copy {
        std::shared_ptr<vulkan::Buffer> target;
        vulkan::Buffer staging;
        std::vector<vk::BufferCopy> parts;
    };
    vulkan::Device& device_;
    bool always_stage_;
    std::vector<Copy> copies_;
    std::uint64_t sent_ = 0;
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

    /// Begins to upload `set`. The shown scene changes when it is complete. Replaces an upload under way.
    void begin(const GaussianSet& set);
    /// Works for about `milliseconds`. Returns true when the shown scene has changed. Call flush()
    /// afterwards.
    bool advance(double milliseconds);
    bool busy() const { return static_cast<bool>(pending_); }
    /// One number per row of the shown scene, or none.
    void set_values(std::span<const float> values);
    void flush(vk::CommandBuffer commands) { uploader_.flush(commands); }

    const GaussianSet& shown() const { return shown_; }
    std::span<const SceneChunk> chunks() const { return chunks_; }
    std::uint64_t byte_size() const;
    /// Bytes sent to the device so far.
    std::uint64_t sent_bytes() const { return uploader_.sent_bytes(); }

private:
    /// Packed rows that replace others in a buffer.
    struct Patch {
        std::vector<std::byte> bytes;
        std::vector<vk::BufferCopy> parts;
    };
    struct Pending {
        GaussianSet set;
        std::vector<SceneChunk> chunks;
        bool geometry = false, harmonics = false;                // to be packed
        bool patches = false;                                    // into the buffers shown, changed rows only
        std::vector<Patch> geometry_patches, harmonics_patches;  // per chunk
        std::size_t next_row = 0;
    };
    std::shared_ptr<vulkan::Buffer> make(std::uint64_t bytes, vk::Format format, const char* name);
    void make_chunks(Pending& pending);
    void pack_slice(Pending& pending);
    void patch_slice(Pending& pending, const SceneChunk& chunk, std::size_t begin, std::size_t end) const;
    void apply_patches(Pending& pending);

    vulkan::Device& device_;
    Uploader uploader_;
    GaussianSet shown_;
    std::vector<SceneChunk> chunks_;
    std::unique_ptr<Pending> pending_;
};

}  // namespace gse::preview
