// Uploading scenes in slices.
#include "engine/preview/scene_store.h"

#include <algorithm>
#include <chrono>
#include <cstring>

#include "engine/base/check.h"
#include "engine/preview/changed_rows.h"
#include "engine/preview/packing.h"

namespace gse::preview {
namespace {

constexpr std::size_t SliceRows = 8192;  // about a millisecond of packing
constexpr std::uint64_t GeometryBytes = 48;

bool same_geometry(const GaussianSet& a, const GaussianSet& b) {
    return a.size() == b.size() && a.position().data() == b.position().data() &&
           a.log_scale().data() == b.log_scale().data() && a.rotation().data() == b.rotation().data() &&
           a.opacity_logit().data() == b.opacity_logit().data();
}

bool same_harmonics(const GaussianSet& a, const GaussianSet& b) {
    return a.size() == b.size() && a.sh_degree() == b.sh_degree() && a.sh().data() == b.sh().data();
}

}  // namespace

std::byte* Uploader::reserve(const std::shared_ptr<vulkan::Buffer>& target, std::uint64_t offset,
                             std::uint64_t bytes) {
    sent_ += bytes;
    if (!always_stage_ && target->mapped() != nullptr) return target->mapped() + offset;
    vulkan::Buffer staging(device_, {.size = bytes,
                                     .usage = vk::BufferUsageFlagBits::eTransferSrc,
                                     .home = vulkan::BufferHome::Upload,
                                     .name = "scene staging"});
    std::byte* memory = staging.mapped();
    copies_.push_back({target, std::move(staging), {vk::BufferCopy(0, offset, bytes)}});
    return memory;
}

void Uploader::replace(const std::shared_ptr<vulkan::Buffer>& target, std::span<const std::byte> bytes,
                       std::vector<vk::BufferCopy> parts) {
    sent_ += bytes.size();
    vulkan::Buffer staging(device_, {.size = bytes.size(),
                                     .usage = vk::BufferUsageFlagBits::eTransferSrc,
                                     .home = vulkan::BufferHome::Upload,
                                     .name = "changed rows"});
    std::memcpy(staging.mapped(), bytes.data(), bytes.size());
    copies_.push_back({target, std::move(staging), std::move(parts)});
}

void Uploader::flush(vk::CommandBuffer commands) {
    if (copies_.empty()) return;
    vulkan::compute_barrier(commands);  // what is replaced may still be read
    for (const auto& copy : copies_)
        commands.copyBuffer(copy.staging.handle(), copy.target->handle(), copy.parts);
    copies_.clear();
    vulkan::compute_barrier(commands);
}

std::shared_ptr<vulkan::Buffer> SceneStore::make(std::uint64_t bytes, vk::Format format, const char* name) {
    return std::make_shared<vulkan::Buffer>(
        device_, vulkan::BufferDescription{.size = bytes,
                                           .usage = vk::BufferUsageFlagBits::eTransferDst,
                                           .name = name,
                                           .texel_format = format});
}

void SceneStore::begin(const GaussianSet& set) {
    auto pending = std::make_unique<Pending>();
    pending->set = set;
    pending->geometry = !same_geometry(set, shown_);
    pending->harmonics = !same_harmonics(set, shown_);
    const bool comparable =
        set.size() > 0 && set.size() == shown_.size() && set.sh_degree() == shown_.sh_degree();
    pending->patches = comparable && !mostly_changed(shown_, set);
    if (pending->patches) {
        pending->chunks = chunks_;
        pending->geometry_patches.resize(chunks_.size());
        pending->harmonics_patches.resize(chunks_.size());
    } else {
        make_chunks(*pending);
    }
    if (!pending->geometry && !pending->harmonics) pending->next_row = set.size();
    pending_ = std::move(pending);
}

void SceneStore::make_chunks(Pending& pending) {
    const std::uint64_t row_bytes = harmonics_texels(pending.set.sh_degree()) * 8;
    for (std::size_t first = 0; first < pending.set.size(); first += ChunkRows) {
        SceneChunk chunk;
        chunk.first = first;
        chunk.count = std::min(ChunkRows, pending.set.size() - first);
        const SceneChunk* old = pending.set.size() == shown_.size() ? &chunks_[first / ChunkRows] : nullptr;
        chunk.geometry = pending.geometry
                             ? make(chunk.count * GeometryBytes, vk::Format::eR32G32B32A32Sfloat, "geometry")
                             : old->geometry;
        chunk.harmonics = pending.harmonics
                              ? make(chunk.count * row_bytes, vk::Format::eR16G16B16A16Sfloat, "harmonics")
                              : old->harmonics;
        if (old != nullptr) chunk.values = old->values;
        pending.chunks.push_back(std::move(chunk));
    }
}

void SceneStore::pack_slice(Pending& pending) {
    const std::size_t begin = pending.next_row;
    const SceneChunk& chunk = pending.chunks[begin / ChunkRows];
    const std::size_t end = std::min(begin + SliceRows, chunk.first + chunk.count), at = begin - chunk.first;
    pending.next_row = end;
    if (pending.patches) return patch_slice(pending, chunk, begin, end);
    if (pending.geometry) {
        auto* out = uploader_.reserve(chunk.geometry, at * GeometryBytes, (end - begin) * GeometryBytes);
        pack_geometry(pending.set, begin, end, reinterpret_cast<float*>(out));
    }
    if (pending.harmonics) {
        const std::uint64_t row_bytes = harmonics_texels(pending.set.sh_degree()) * 8;
        auto* out = uploader_.reserve(chunk.harmonics, at * row_bytes, (end - begin) * row_bytes);
        pack_harmonics(pending.set, begin, end, reinterpret_cast<std::uint16_t*>(out));
    }
}

void SceneStore::patch_slice(Pending& pending, const SceneChunk& chunk, std::size_t begin,
                             std::size_t end) const {
    std::vector<RowRun> runs;
    const auto append = [&](std::vector<Patch>& patches, std::uint64_t row_bytes, auto&& pack) {
        Patch& patch = patches[begin / ChunkRows];
        for (const auto& run : runs) {
            const std::uint64_t bytes = (run.end - run.begin) * row_bytes, at = patch.bytes.size();
            patch.bytes.resize(at + bytes);
            pack(run, patch.bytes.data() + at);
            patch.parts.emplace_back(at, (run.begin - chunk.first) * row_bytes, bytes);
        }
    };
    if (pending.geometry) {
        changed_geometry(shown_, pending.set, begin, end, runs);
        append(pending.geometry_patches, GeometryBytes, [&](const RowRun& run, std::byte* out) {
            pack_geometry(pending.set, run.begin, run.end, reinterpret_cast<float*>(out));
        });
    }
    if (!pending.harmonics) return;
    runs.clear();
    changed_harmonics(shown_, pending.set, begin, end, runs);
    append(pending.harmonics_patches, harmonics_texels(pending.set.sh_degree()) * 8,
           [&](const RowRun& run, std::byte* out) {
               pack_harmonics(pending.set, run.begin, run.end, reinterpret_cast<std::uint16_t*>(out));
           });
}

void SceneStore::apply_patches(Pending& pending) {
    for (std::size_t i = 0; i < pending.chunks.size(); ++i) {
        auto &geometry = pending.geometry_patches[i], &harmonics = pending.harmonics_patches[i];
        if (!geometry.parts.empty())
            uploader_.replace(pending.chunks[i].geometry, geometry.bytes, std::move(geometry.parts));
        if (!harmonics.parts.empty())
            uploader_.replace(pending.chunks[i].harmonics, harmonics.bytes, std::move(harmonics.parts));
    }
}

bool SceneStore::advance(double milliseconds) {
    if (!pending_) return false;
    const auto start = std::chrono::steady_clock::now();
    const std::chrono::duration<double, std::milli> budget(milliseconds);
    while (pending_->next_row < pending_->set.size()) {
        pack_slice(*pending_);
        if (std::chrono::steady_clock::now() - start > budget && pending_->next_row < pending_->set.size())
            return false;
    }
    if (pending_->patches) apply_patches(*pending_);
    // Values belong to rows; they stay when the number of rows does.
    for (std::size_t i = 0; i < pending_->chunks.size() && pending_->set.size() == shown_.size(); ++i)
        pending_->chunks[i].values = chunks_[i].values;
    shown_ = std::move(pending_->set);
    chunks_ = std::move(pending_->chunks);
    pending_.reset();
    return true;
}

void SceneStore::set_values(std::span<const float> values) {
    if (!values.empty()) GSE_CHECK_EQ(values.size(), shown_.size());
    for (auto& chunk : chunks_) {
        chunk.values.reset();
        if (values.empty()) continue;
        chunk.values = make(chunk.count * sizeof(float), vk::Format::eR32Sfloat, "values");
        std::memcpy(uploader_.reserve(chunk.values, 0, chunk.count * sizeof(float)),
                    values.data() + chunk.first, chunk.count * sizeof(float));
    }
}

std::uint64_t SceneStore::byte_size() const {
    std::uint64_t bytes = 0;
    for (const auto& chunk : chunks_)
        bytes += chunk.geometry->size() + chunk.harmonics->size() + (chunk.values ? chunk.values->size() : 0);
    return bytes;
}

}  // namespace gse::preview
