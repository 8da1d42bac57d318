// Preparing the fixed rows of a view.
#include "engine/raster/view_cache.h"

#include <algorithm>
#include <limits>

#include "engine/raster/conventions.h"
#include "engine/raster/fast_tiles.h"

namespace gse::raster {
namespace {

constexpr std::uint32_t Unused = 0xffffffff;

/// Marks the tiles within `margin` tiles of each of `tiles`.
void mark_around(std::span<const std::uint32_t> tiles, int margin, int columns, int rows,
                 std::vector<std::uint8_t>& marks) {
    for (const std::uint32_t tile : tiles) {
        const int x = static_cast<int>(tile) % columns, y = static_cast<int>(tile) / columns;
        const int x0 = std::max(0, x - margin), x1 = std::min(columns, x + margin + 1);
        for (int v = std::max(0, y - margin); v < std::min(rows, y + margin + 1); ++v)
            std::fill_n(marks.begin() + v * columns + x0, x1 - x0, std::uint8_t{1});
    }
}

}  // namespace

bool ViewCache::holds(const Camera& camera, const Settings& settings, float near_plane) const {
    return times_prepared_ > 0 && camera == camera_ && settings == settings_ &&
           (near_plane == near_plane_ || (near_plane > near_low_ && near_plane < near_high_));
}

bool ViewCache::covers(std::span<const std::uint32_t> tiles) const {
    return std::all_of(tiles.begin(), tiles.end(), [&](std::uint32_t tile) { return covered_[tile] != 0; });
}

std::size_t ViewCache::bytes() const {
    const auto held = [](const auto& values) { return values.capacity() * sizeof values[0]; };
    return held(records_) + held(depths_) + held(offsets_) + held(entries_) + held(covered_) +
           held(picture_.colour.data) + held(picture_.alpha.data) + held(picture_.depth.data) +
           held(picture_.blended);
}

bool ViewCache::prepare(const Job& job, Frame& frame) {
    const bool same_picture = holds(job.camera, job.settings, job.near_plane);
    if (!same_picture) {
        const int times = times_prepared_;
        clear();
        times_prepared_ = times;
        camera_ = job.camera;
        settings_ = job.settings;
    }
    project(job, frame);
    cover(job, frame);
    ++times_prepared_;
    std::vector<std::uint32_t> ranks;
    const std::size_t count = rank_records(frame, ranks);
    std::size_t entries = 0;
    for (std::size_t tile = 0; tile < frame.tile_count(); ++tile)
        if (covered_[tile] != 0) entries += frame.entries(tile).size();
    constexpr std::size_t pixel_bytes = 5 * sizeof(float) + sizeof(std::int32_t);
    const std::size_t pixels =
        static_cast<std::size_t>(frame.width()) * static_cast<std::size_t>(frame.height());
    const std::size_t needed = count * (sizeof(Record) + sizeof(float)) + entries * sizeof(FixedEntry) +
                               (frame.tile_count() + 1) * sizeof(std::uint32_t) + frame.tile_count() +
                               pixels * pixel_bytes;
    if (needed > job.budget || entries >= Unused) {
        clear();
        return false;
    }
    keep_lists(frame, ranks, count);
    if (!same_picture) keep_picture(frame);
    return true;
}

/// Projects with a nearer near plane if nothing lies between, so that the real one may come nearer without
/// harm. The real one follows the scene, and so moves with the rows that change.
void ViewCache::project(const Job& job, Frame& frame) {
    Settings settings = job.settings;
    near_plane_ = job.near_plane;
    settings.near_plane = near_low_ = std::max(0.5f * near_plane_, static_cast<float>(SmallestNear));
    frame.prepare(job.fixed, job.camera, settings);
    const auto depth = [&](std::size_t place) { return frame.records()[frame.order()[place]].depth; };
    std::size_t between = 0;
    while (between < frame.order().size() && depth(between) <= near_plane_) ++between;
    // Counted where they are in front: exact for one near plane only.
    const bool unusable = frame.unusable_rows() > 0;
    if (unusable) near_low_ = near_plane_;
    else if (between > 0) near_low_ = depth(between - 1);
    if (unusable || between > 0) {
        settings.near_plane = near_plane_;
        frame.prepare(job.fixed, job.camera, settings);
    }
    near_high_ = frame.order().empty() ? std::numeric_limits<float>::max() : depth(0);
    if (unusable) near_high_ = near_plane_;
}

/// Margin that doubles every time, so that spreading rows cannot ask for many preparations.
void ViewCache::cover(const Job& job, const Frame& frame) {
    const int columns = (frame.width() + TileSize - 1) / TileSize;
    covered_.resize(frame.tile_count(), 0);
    mark_around(job.tiles, 1 << std::min(times_prepared_, 10), columns,
                static_cast<int>(frame.tile_count()) / columns, covered_);
}

/// Numbers the records in the kept lists front to back. Returns their count.
std::size_t ViewCache::rank_records(const Frame& frame, std::vector<std::uint32_t>& ranks) const {
    ranks.assign(frame.row_count(), Unused);
    for (std::size_t tile = 0; tile < frame.tile_count(); ++tile) {
        if (covered_[tile] == 0) continue;
        for (const TileEntry& entry : frame.entries(tile)) ranks[entry.record] = 0;
    }
    std::uint32_t count = 0;
    for (const std::uint32_t record : frame.order())
        if (ranks[record] != Unused) ranks[record] = count++;
    return count;
}

void ViewCache::keep_lists(const Frame& frame, const std::vector<std::uint32_t>& ranks, std::size_t count) {
    records_ = std::vector<Record>(count);
    depths_ = std::vector<float>(count);
    for (std::size_t record = 0; record < ranks.size(); ++record) {
        if (ranks[record] == Unused) continue;
        records_[ranks[record]] = frame.records()[record];
        depths_[ranks[record]] = frame.records()[record].depth;
    }
    std::size_t total = 0;
    offsets_.resize(frame.tile_count() + 1);
    for (std::size_t tile = 0; tile < frame.tile_count(); ++tile) {
        offsets_[tile] = static_cast<std::uint32_t>(total);
        if (covered_[tile] != 0) total += frame.entries(tile).size();
    }
    offsets_.back() = static_cast<std::uint32_t>(total);
    entries_ = std::vector<FixedEntry>(total);
    for (std::size_t tile = 0; tile < frame.tile_count(); ++tile) {
        if (covered_[tile] == 0) continue;
        FixedEntry* to = entries_.data() + offsets_[tile];
        for (const TileEntry& entry : frame.entries(tile)) *to++ = {ranks[entry.record], entry.blocks};
    }
}

void ViewCache::keep_picture(Frame& frame) {
    resize_output(frame.width(), frame.height(), picture_);
    picture_.dropped_rows = frame.unusable_rows();
    struct Context {
        ViewCache* cache;
        Frame* frame;
    } context{this, &frame};
    frame.blend(
        [](void* at, std::size_t tile, const BlendScratch& scratch) {
            const Context& c = *static_cast<const Context*>(at);
            write_tile(tile_area(*c.frame, tile), AllBlocks, c.frame->light(tile), scratch,
                       c.cache->settings_.background, c.cache->picture_);
        },
        &context);
}

}  // namespace gse::raster
