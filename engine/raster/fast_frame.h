// One view prepared for blending: projected records, depth order and the tiles' lists. Keeps its memory
// between views.
#pragma once

#include <span>
#include <vector>

#include "engine/base/aligned.h"
#include "engine/base/thread_pool.h"
#include "engine/math/camera.h"
#include "engine/raster/depth_sort.h"
#include "engine/raster/kernels.h"
#include "engine/raster/rasterizer.h"

namespace gse::raster {

/// Bytes beyond which an array does not stay in a cache. It is written straight to memory, without fetching
/// its lines.
inline constexpr std::size_t CachedBytes = std::size_t{32} << 20;

/// Slot of partial gradients of one (tile, Gaussian).
struct alignas(64) PartialSlot {
    float sums[PartialStride];
};

class Frame {
public:
    Frame(const Kernels& kernels, ThreadPool& pool);

    /// Use of the colours of a view. Unwanted ones are left out if all are known to be finite. The drawn
    /// Gaussians are equal in both cases.
    enum class Colours { Wanted, Unwanted };
    void prepare(const GaussianSpans& gaussians, const Camera& camera, const Settings& settings,
                 std::span<const float> values = {}, Colours colours = Colours::Wanted);

    /// Blends every tile into lights(). Calls finish(tile, scratch) on its thread.
    using TileDone = void (*)(void* context, std::size_t tile, const BlendScratch& scratch);
    void blend(TileDone finish, void* context);

    /// Gives every drawn Gaussian of rows >= first_row its slots of partial sums.
    void assign_slots(std::size_t first_row);

    /// Calls body(begin, end, worker) over tiles.
    template <class Body> void for_tiles(const Body& body) {
        pool_.parallel_for(tile_count(), tile_chunk(), body);
    }

    std::size_t tile_count() const { return tile_columns_ * tile_rows_; }
    std::size_t tile_chunk() const;
    int tile_x(std::size_t tile) const { return static_cast<int>(tile % tile_columns_) * TileSize; }
    int tile_y(std::size_t tile) const { return static_cast<int>(tile / tile_columns_) * TileSize; }
    int width() const { return view_.width; }
    int height() const { return view_.height; }
    std::span<const TileEntry> entries(std::size_t tile) const {
        return {entries_.data() + offsets_[tile], offsets_[tile + 1] - offsets_[tile]};
    }
    /// The drawn records, front to back.
    std::span<const std::uint32_t> order() const { return order_; }
    std::size_t pair_count() const { return offsets_.empty() ? 0 : offsets_.back(); }
    std::size_t unusable_rows() const { return unusable_; }
    std::size_t drawn_rows() const { return drawn_; }
    TileLight& light(std::size_t tile) { return lights_[tile]; }
    const Record* records() const { return records_.data(); }
    const Viewpoint& view() const { return view_; }
    const Source& source() const { return source_; }
    std::size_t row_count() const { return rows_; }
    std::uint32_t first_active() const { return first_active_; }
    PartialSlot* slots() { return slots_.data(); }
    std::uint32_t first_slot() const { return first_slot_; }
    bool slots_past_caches() const {
        return (pair_count() - first_slot_) * sizeof(PartialSlot) > CachedBytes;
    }

    /// Places of a chunk's records. Rows are handled in chunks; a chunk's records lie densely at its first
    /// row's place.
    static constexpr std::size_t ChunkRows = 1024;
    std::size_t chunk_count() const { return (rows_ + ChunkRows - 1) / ChunkRows; }
    /// The chunk's records from first_active() on.
    std::span<const Record> active_records(std::size_t chunk) const;
    /// Pairs of a record. Places are in its chunk's; slot_shift(chunk) makes slots of them (modulo 2^32).
    const PairRange* ranges(const Record* record) const {
        return ranges_.data() + (record - records_.data());
    }
    std::uint32_t slot_shift(std::size_t chunk) const { return chunk_pairs_[chunk] - first_slot_; }

private:
    bool has_finite_colours(const GaussianSpans& gaussians);
    void project_chunk(std::size_t chunk);
    void bin_chunk(std::size_t chunk, unsigned worker);
    void collect_keys();
    template <class Body> void for_places(std::size_t begin, std::size_t end, const Body& body) const;
    void count_group(std::size_t group);
    void place_part(std::size_t part);
    void place_back_part(std::size_t part);
    void count_tiles();
    void fill_tiles();
    void blend_tiles(std::size_t begin, std::size_t end, unsigned worker);
    std::size_t part_begin(std::size_t part) const { return drawn_ * part / (2 * groups_); }
    std::uint32_t* first_places(std::size_t group) { return &tile_places_[2 * group * tile_count()]; }
    std::uint32_t* last_places(std::size_t group) { return first_places(group) + tile_count(); }

    const Kernels& kernels_;
    ThreadPool& pool_;
    DepthSort sort_;
    Viewpoint view_{};
    Source source_{};
    const float* values_ = nullptr;
    bool colours_ = true;
    std::size_t rows_ = 0, drawn_ = 0, unusable_ = 0, tile_columns_ = 0, tile_rows_ = 0;

    LineVector<Record> records_;                // [rows], with gaps
    LineVector<std::uint32_t> keys_;            // [rows], with the same gaps
    LineVector<PairRange> ranges_;              // [rows], with the same gaps; places in the chunk's pairs
    std::vector<std::vector<TilePair>> pairs_;  // per chunk
    std::vector<std::uint32_t> chunk_pairs_;    // [chunks + 1]: pairs of all chunks before
    std::vector<std::size_t> chunk_drawn_, chunk_unusable_, chunk_first_;
    std::span<const std::uint32_t> order_;  // records front to back
    // The depth order is put into the tiles in parts, in parallel. Two of them are a group: the first fills
    // the group's places in a tile from the front, the second from the back, so that only groups have to be
    // counted. One group needs no counting at all.
    std::size_t groups_ = 1;
    std::vector<std::uint32_t> tile_counts_;  // [threads][tiles], from binning
    std::vector<std::uint32_t> tile_places_;  // [groups][2][tiles]: counts, then first places and ends
    std::vector<std::size_t> offsets_;        // [tiles + 1] into entries_
    LineVector<TileEntry> entries_;
    LineVector<TileLight> lights_;
    std::vector<BlendScratch> scratch_;  // per worker
    TileDone finish_ = nullptr;
    void* finish_context_ = nullptr;
    std::uint32_t first_active_ = 0, first_slot_ = 0;
    LineVector<PartialSlot> slots_;
};

}  // namespace gse::raster
