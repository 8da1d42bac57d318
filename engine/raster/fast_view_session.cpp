// Continuation of a prepared view. The kernels see the entries of a full preparation in their order, less
// those without effect. Every bit of the result is equal. In forward and backward, blocks of 4x4 pixels that
// no changing row reaches are left out altogether.
//
// Runs of fixed rows before the first and behind the last changing row of a tile are walked, not kept as
// composited pixels. Pixels behind depend on the place where the transmittance is cut, so keeping them would
// not be exact. In the gradient, pixels before would be rounded otherwise. The gain would be small for 7 KB a
// tile (SKIPS.md, E4).
#include "engine/raster/fast_view_session.h"

#include <algorithm>
#include <new>

#include "engine/base/check.h"

namespace gse::raster {
namespace {

// Share of the rows; larger ones leave too little to save (`gseditpro-lab bench raster --skips`).
constexpr double MostChanging = 0.6;
// Views whose near plane or reach asks for more are rendered in full.
constexpr int MostPreparations = 8;

template <class T> void grow_to(std::vector<T>& values, std::size_t count) {
    if (values.size() < count) values.resize(count);
}

GaussianSpans rows_of(const GaussianSpans& all, std::size_t begin, std::size_t end) {
    const auto part = [&](std::span<const float> values, std::size_t stride) {
        return values.subspan(begin * stride, (end - begin) * stride);
    };
    const std::size_t sh = static_cast<std::size_t>(sh_coefficient_count(all.sh_degree)) * 3;
    return {end - begin,           all.sh_degree,
            part(all.position, 3), part(all.log_scale, 3),
            part(all.rotation, 4), part(all.opacity_logit, 1),
            part(all.sh, sh)};
}

}  // namespace

FastViewSession::FastViewSession(const FastParts& parts, std::size_t views, std::size_t budget_bytes)
    : parts_(parts), views_(views), budget_(budget_bytes), frame_(parts.kernels, parts.pool) {}

void FastViewSession::forget() {
    for (View& view : views_) view = {};
    cache_ = nullptr;
}

ViewSessionWork FastViewSession::work() const {
    ViewSessionWork work = work_;
    for (const View& view : views_) work.kept_bytes += view.cache.bytes();
    return work;
}

void FastViewSession::forward(std::size_t view, const GaussianSpans& gaussians, std::size_t first_row,
                              const Camera& camera, const Settings& settings, ForwardOutput& output) {
    GSE_CHECK(view < views_.size());
    GSE_CHECK(first_row <= gaussians.size);
    if (first_row != first_row_ || gaussians.sh_degree != sh_degree_) forget();
    first_row_ = first_row;
    sh_degree_ = gaussians.sh_degree;
    slope_.background = settings.background;
    output_ = &output;
    const double changing = static_cast<double>(gaussians.size - first_row);
    const bool worth_it = budget_ > 0 && changing <= MostChanging * static_cast<double>(gaussians.size);
    cache_ = nullptr;
    if (worth_it && !views_[view].full && continue_view(views_[view], gaussians, camera, settings)) {
        cache_ = &views_[view].cache;
        ++work_.continued;
    } else {
        parts_.rasterizer.forward(gaussians, camera, settings, output);
        ++work_.full;
    }
}

/// Returns false when the view has to be rendered in full.
bool FastViewSession::continue_view(View& view, const GaussianSpans& gaussians, const Camera& camera,
                                    const Settings& settings) {
    Settings settled = with_depth_range(settings, gaussians, camera);
    frame_.prepare(rows_of(gaussians, first_row_, gaussians.size), camera, settled);
    find_live_tiles();
    if (!view.cache.holds(camera, settings, settled.near_plane) || !view.cache.covers(live_numbers_))
        if (!prepare_view(view, gaussians, camera, settings, settled.near_plane)) return false;
    cache_ = &view.cache;
    place_records();
    resize_output(camera.width, camera.height, *output_);
    parts_.pool.parallel_for(
        output_->blended.size(), 16384,
        [this](std::size_t begin, std::size_t end, unsigned) { copy_picture(begin, end); });
    grow_to(blend_scratch_, parts_.pool.thread_count());
    parts_.pool.parallel_for(live_.size(), frame_.tile_chunk(),
                             [this](std::size_t begin, std::size_t end, unsigned worker) {
                                 for (std::size_t i = begin; i < end; ++i)
                                     blend_tile(i, blend_scratch_[worker]);
                             });
    output_->pairs = 0;
    for (const LiveTile& live : live_) output_->pairs += live.count;
    output_->dropped_rows = cache_->picture().dropped_rows + frame_.unusable_rows();
    return true;
}

bool FastViewSession::prepare_view(View& view, const GaussianSpans& gaussians, const Camera& camera,
                                   const Settings& settings, float near_plane) {
    std::size_t others = 0;
    for (const View& other : views_)
        if (&other != &view) others += other.cache.bytes();
    const GaussianSpans fixed = rows_of(gaussians, 0, first_row_);
    const std::size_t budget = budget_ > others ? budget_ - others : 0;
    try {
        if (view.cache.times_prepared() < MostPreparations &&
            view.cache.prepare({fixed, camera, settings, near_plane, live_numbers_, budget},
                               parts_.working_frame)) {
            ++work_.prepared;
            return true;
        }
    } catch (const std::bad_alloc&) {  // less memory than the budget says
    }
    view.cache.clear();
    view.full = true;
    return false;
}

void FastViewSession::find_live_tiles() {
    live_.clear();
    live_numbers_.clear();
    for (std::size_t tile = 0; tile < frame_.tile_count(); ++tile) {
        if (frame_.entries(tile).empty()) continue;
        live_.push_back({static_cast<std::uint32_t>(tile)});
        live_numbers_.push_back(static_cast<std::uint32_t>(tile));
    }
}

/// Merges both depth orders. At equal depth the fixed rows, whose numbers are smaller, come first. Also lays
/// out the lists.
void FastViewSession::place_records() {
    grow_to(places_, frame_.row_count());
    const std::span<const float> depths = cache_->depths();
    std::uint32_t place = 0;
    for (const std::uint32_t record : frame_.order()) {
        const float depth = frame_.records()[record].depth;
        while (place < depths.size() && depths[place] <= depth) ++place;
        places_[record] = place;
    }
    std::size_t total = 0;
    for (LiveTile& live : live_) {
        live.begin = total;
        total += frame_.entries(live.tile).size() + cache_->entries(live.tile).size();
    }
    grow_to(merged_, total);
    grow_to(lights_, live_.size());
}

/// Merged list of the tile, front to back. Fixed rows that share no block with a changing row are left out.
void FastViewSession::merge(LiveTile& live) {
    const auto split = static_cast<std::uint32_t>(cache_->records().size());
    const auto changing = frame_.entries(live.tile);
    const auto fixed = cache_->entries(live.tile);
    live.blocks = 0;
    for (const TileEntry& entry : changing) live.blocks |= entry.blocks;
    TileEntry* to = merged_.data() + live.begin;
    std::size_t at = 0;
    const auto take_fixed = [&](std::uint32_t before) {
        for (; at < fixed.size() && fixed[at].record < before; ++at) {
            const std::uint32_t blocks = fixed[at].blocks & live.blocks;
            if (blocks != 0) *to++ = {fixed[at].record, 0, blocks};
        }
    };
    for (const TileEntry& entry : changing) {
        take_fixed(places_[entry.record]);
        *to++ = {entry.record + split, entry.slot, entry.blocks};
    }
    take_fixed(split);
    live.count = static_cast<std::uint32_t>(to - (merged_.data() + live.begin));
}

void FastViewSession::copy_picture(std::size_t begin, std::size_t end) {
    const ForwardOutput& from = cache_->picture();
    const auto copy = [&](const auto& values, auto& to, std::size_t stride) {
        std::copy_n(values.data() + begin * stride, (end - begin) * stride, to.data() + begin * stride);
    };
    copy(from.colour.data, output_->colour.data, 3);
    copy(from.alpha.data, output_->alpha.data, 1);
    copy(from.depth.data, output_->depth.data, 1);
    copy(from.blended, output_->blended, 1);
}

void FastViewSession::blend_tile(std::size_t index, BlendScratch& scratch) {
    LiveTile& live = live_[index];
    merge(live);
    const TileArea area = tile_area(frame_, live.tile);
    const BlendJob job = {
        {cache_->records().data(), frame_.records(), static_cast<std::uint32_t>(cache_->records().size())},
        merged_.data() + live.begin,
        live.count,
        live.blocks,
        area.x,
        area.y,
        area.width,
        area.height,
        &lights_[index],
        &scratch};
    parts_.kernels.blend(job);
    write_tile(area, live.blocks, lights_[index], scratch, slope_.background, *output_);
}

void FastViewSession::backward(const Image& d_colour, const Image& d_alpha, Gradients& output) {
    if (cache_ == nullptr) return parts_.rasterizer.backward(d_colour, d_alpha, first_row_, output);
    const std::size_t pixels =
        static_cast<std::size_t>(frame_.width()) * static_cast<std::size_t>(frame_.height());
    GSE_CHECK_EQ(d_colour.data.size(), pixels * 3);
    GSE_CHECK(d_alpha.data.empty() || d_alpha.data.size() == pixels);
    slope_.colour = &d_colour;
    slope_.alpha = d_alpha.data.empty() ? nullptr : &d_alpha;
    gradients_ = &output;
    resize_gradients(frame_.row_count(), frame_.source().sh_stride, output);
    frame_.assign_slots(0);
    grow_to(backward_scratch_, parts_.pool.thread_count());
    parts_.pool.parallel_for(live_.size(), frame_.tile_chunk(),
                             [this](std::size_t begin, std::size_t end, unsigned worker) {
                                 for (std::size_t i = begin; i < end; ++i)
                                     backward_tile(i, backward_scratch_[worker]);
                             });
    parts_.pool.parallel_for(frame_.chunk_count(), 2, [this](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t i = begin; i < end; ++i) write_gradients(parts_.kernels, frame_, i, 0, *gradients_);
    });
}

void FastViewSession::backward_tile(std::size_t index, BackwardScratch& scratch) {
    const LiveTile& live = live_[index];
    const TileArea area = tile_area(frame_, live.tile);
    load_slopes(area, lights_[index], slope_, scratch);
    const auto split = static_cast<std::uint32_t>(cache_->records().size());
    parts_.kernels.backward({{cache_->records().data(), frame_.records(), split},
                             merged_.data() + live.begin,
                             live.count,
                             area.x,
                             area.y,
                             area.width,
                             area.height,
                             lights_[index].ends,
                             &scratch,
                             split,
                             frame_.first_slot(),
                             frame_.slots()->sums,
                             frame_.slots_past_caches()});
}

}  // namespace gse::raster
