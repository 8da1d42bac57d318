// Driver of the first half of the fast rasterizer: chunks of rows, depth order, counting placement into
// tiles.
#include "engine/raster/fast_frame.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "engine/base/error.h"
#include "engine/raster/viewpoint.h"

namespace gse::raster {
namespace {

/// Makes room. Memory grows and never shrinks.
template <class Values> void at_least(Values& values, std::size_t count) {
    if (values.size() < count) values.resize(count);
}

}  // namespace

Frame::Frame(const Kernels& kernels, ThreadPool& pool) : kernels_(kernels), pool_(pool), sort_(pool) {}

void Frame::prepare(const GaussianSpans& gaussians, const Camera& camera, const Settings& settings,
                    std::span<const float> values, Colours colours) {
    check_inputs(gaussians, camera);
    view_ = viewpoint_of(camera, with_depth_range(settings, gaussians, camera), gaussians.sh_degree);
    tile_columns_ = static_cast<std::size_t>((camera.width + TileSize - 1) / TileSize);
    tile_rows_ = static_cast<std::size_t>((camera.height + TileSize - 1) / TileSize);
    source_ = {gaussians.position.data(),      gaussians.log_scale.data(), gaussians.rotation.data(),
               gaussians.opacity_logit.data(), gaussians.sh.data(),        sh_floats(gaussians)};
    values_ = values.empty() ? nullptr : values.data();
    colours_ = colours == Colours::Wanted || !has_finite_colours(gaussians);
    rows_ = gaussians.size;
    at_least(records_, rows_);
    at_least(keys_, rows_);
    at_least(ranges_, rows_);
    at_least(pairs_, chunk_count());
    at_least(chunk_pairs_, chunk_count() + 1);
    at_least(chunk_drawn_, chunk_count());
    at_least(chunk_unusable_, chunk_count());
    at_least(chunk_first_, chunk_count());
    at_least(scratch_, pool_.thread_count());
    tile_counts_.assign(pool_.thread_count() * tile_count(), 0u);
    pool_.parallel_for(chunk_count(), 1, [this](std::size_t begin, std::size_t end, unsigned worker) {
        for (std::size_t chunk = begin; chunk < end; ++chunk) {
            project_chunk(chunk);
            bin_chunk(chunk, worker);
        }
    });
    collect_keys();
    fill_tiles();
}

/// True when all coefficients are finite. Looks at each at most once for as long as the answer is cached.
bool Frame::has_finite_colours(const GaussianSpans& gaussians) {
    // A colour is the sum of 16 coefficients, none counting more than 3 times.
    constexpr float largest = 1e30f;
    constexpr std::size_t piece = std::size_t{1} << 16;
    if (gaussians.colours_known == nullptr) return false;
    ColoursKnown known = *gaussians.colours_known;
    if (known == ColoursKnown::NotYet) {
        std::atomic<bool> all{true};
        pool_.parallel_for(gaussians.sh.size(), piece, [&](std::size_t begin, std::size_t end, unsigned) {
            bool small = true;
            for (std::size_t i = begin; i < end; ++i)
                small &= std::abs(gaussians.sh[i]) <= largest;  // no NaN is
            if (!small) all = false;
        });
        known = all ? ColoursKnown::Finite : ColoursKnown::NotAll;
        *gaussians.colours_known = known;
    }
    return known == ColoursKnown::Finite;
}

void Frame::project_chunk(std::size_t chunk) {
    const std::size_t begin = chunk * ChunkRows;
    ProjectJob job{};
    job.source = source_;
    job.view = &view_;
    job.values = values_;
    job.colours = colours_;
    job.begin = begin;
    job.end = std::min(begin + ChunkRows, rows_);
    job.records = records_.data() + begin;
    job.keys = keys_.data() + begin;
    kernels_.project(job);
    chunk_drawn_[chunk] = job.drawn;
    chunk_unusable_[chunk] = job.unusable;
}

/// Counts the tiles while the chunk's records are still in the cache.
void Frame::bin_chunk(std::size_t chunk, unsigned worker) {
    std::vector<TilePair>& pairs = pairs_[chunk];
    BinJob job{};
    job.records = records_.data() + chunk * ChunkRows;
    job.ranges = ranges_.data() + chunk * ChunkRows;
    job.end = chunk_drawn_[chunk];
    job.width = view_.width;
    job.height = view_.height;
    at_least(pairs, 4 * job.end);
    for (;;) {
        job.pairs = pairs.data();
        job.capacity = pairs.size();
        kernels_.bin(job);
        if (job.begin == job.end) break;
        at_least(pairs, 2 * pairs.size() + tile_count() + tile_rows_ + 4);  // room for any one Gaussian
    }
    chunk_pairs_[chunk] = static_cast<std::uint32_t>(job.written);
    std::uint32_t* counts = &tile_counts_[worker * tile_count()];
    for (std::size_t i = 0; i < job.written; ++i) ++counts[pairs[i].tile];
}

void Frame::collect_keys() {
    drawn_ = unusable_ = 0;
    std::size_t pairs = 0;
    for (std::size_t chunk = 0; chunk < chunk_count(); ++chunk) {
        chunk_first_[chunk] = drawn_;
        drawn_ += chunk_drawn_[chunk];
        unusable_ += chunk_unusable_[chunk];
        const std::uint32_t count = chunk_pairs_[chunk];
        chunk_pairs_[chunk] = static_cast<std::uint32_t>(pairs);
        pairs += count;
        if (pairs > MostPairs)
            throw Error(ErrorCode::Unsupported, "the view has too many large splats to be drawn at this size",
                        "render a smaller image or prune the scene");
    }
    chunk_pairs_[chunk_count()] = static_cast<std::uint32_t>(pairs);
    sort_.items(drawn_);
    pool_.parallel_for(chunk_count(), 32, [this](std::size_t begin, std::size_t end, unsigned) {
        std::vector<DepthSort::Item>& items = sort_.items(drawn_);
        for (std::size_t chunk = begin; chunk < end; ++chunk)
            for (std::size_t i = 0; i < chunk_drawn_[chunk]; ++i) {
                const std::size_t record = chunk * ChunkRows + i;
                items[chunk_first_[chunk] + i] = {keys_[record], static_cast<std::uint32_t>(record)};
            }
    });
}

void Frame::fill_tiles() {
    constexpr std::size_t worth_a_group = 8192;
    order_ = std::span(sort_.sort(drawn_)).first(drawn_);
    const std::size_t most = (std::size_t{pool_.thread_count()} + 1) / 2;
    groups_ = std::clamp<std::size_t>(drawn_ / worth_a_group, 1, most);
    at_least(tile_places_, 2 * groups_ * tile_count());
    at_least(entries_, chunk_pairs_[chunk_count()]);
    if (groups_ > 1)
        pool_.parallel_for(groups_, 1,
                           [this](std::size_t begin, std::size_t, unsigned) { count_group(begin); });
    count_tiles();
    pool_.parallel_for(2 * groups_, 1, [this](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t part = begin; part < end; ++part)
            if (part % 2 == 0) place_part(part);
            else place_back_part(part);
    });
}

/// Calls body(record, its range, its pairs) for places of the depth order from `begin` to `end`, which may be
/// the lower one. Memory of a record is prefetched some records before.
template <class Body> void Frame::for_places(std::size_t begin, std::size_t end, const Body& body) const {
    constexpr std::size_t far_ahead = 48, ahead = 20;
    const std::size_t count = begin < end ? end - begin : begin - end;
    const auto record_at = [&](std::size_t i) { return order_[begin < end ? begin + i : begin - 1 - i]; };
    const auto pairs_of = [&](std::uint32_t record) {
        return pairs_[record / ChunkRows].data() + ranges_[record].begin;
    };
    for (std::size_t i = 0; i < count; ++i) {
        if (i + far_ahead < count) __builtin_prefetch(&ranges_[record_at(i + far_ahead)]);
        if (i + ahead < count) __builtin_prefetch(pairs_of(record_at(i + ahead)));
        const std::uint32_t record = record_at(i);
        body(record, ranges_[record], pairs_of(record));
    }
}

void Frame::count_group(std::size_t group) {
    std::uint32_t* counts = first_places(group);
    std::fill_n(counts, tile_count(), 0u);
    for_places(part_begin(2 * group), part_begin(2 * group + 2),
               [&](std::uint32_t, const PairRange& range, const TilePair* pair) {
                   for (std::uint32_t i = 0; i < range.count; ++i) ++counts[pair[i].tile];
               });
}

/// Counts -> the tiles' ranges and those of each group in them.
void Frame::count_tiles() {
    offsets_.resize(tile_count() + 1);
    std::size_t place = 0;
    for (std::size_t tile = 0; tile < tile_count(); ++tile) {
        offsets_[tile] = place;
        for (std::size_t group = 0; group < groups_; ++group) {
            std::uint32_t count = first_places(group)[tile];
            if (groups_ == 1) {
                count = 0;
                for (unsigned worker = 0; worker < pool_.thread_count(); ++worker)
                    count += tile_counts_[worker * tile_count() + tile];
            }
            first_places(group)[tile] = static_cast<std::uint32_t>(place);
            place += count;
            last_places(group)[tile] = static_cast<std::uint32_t>(place);
        }
    }
    offsets_[tile_count()] = place;
}

void Frame::place_part(std::size_t part) {
    std::uint32_t* places = first_places(part / 2);
    for_places(part_begin(part), part_begin(part + 1),
               [&](std::uint32_t record, const PairRange& range, const TilePair* pair) {
                   const std::uint32_t slot = chunk_pairs_[record / ChunkRows] + range.begin;
                   for (std::uint32_t i = 0; i < range.count; ++i)
                       entries_[places[pair[i].tile]++] = {record, slot + i, pair[i].blocks};
               });
}

void Frame::place_back_part(std::size_t part) {
    std::uint32_t* places = last_places(part / 2);
    for_places(part_begin(part + 1), part_begin(part),
               [&](std::uint32_t record, const PairRange& range, const TilePair* pair) {
                   const std::uint32_t slot = chunk_pairs_[record / ChunkRows] + range.begin;
                   for (std::uint32_t i = 0; i < range.count; ++i)
                       entries_[--places[pair[i].tile]] = {record, slot + i, pair[i].blocks};
               });
}

std::size_t Frame::tile_chunk() const {
    return std::clamp<std::size_t>(tile_count() / (std::size_t{16} * pool_.thread_count()), 1, 8);
}

void Frame::blend(TileDone finish, void* context) {
    at_least(lights_, tile_count());
    finish_ = finish;
    finish_context_ = context;
    for_tiles(
        [this](std::size_t begin, std::size_t end, unsigned worker) { blend_tiles(begin, end, worker); });
}

void Frame::blend_tiles(std::size_t begin, std::size_t end, unsigned worker) {
    BlendScratch& scratch = scratch_[worker];
    for (std::size_t tile = begin; tile < end; ++tile) {
        const auto list = entries(tile);
        const BlendJob job = {{records_.data(), nullptr, NoSplit},
                              list.data(),
                              static_cast<std::uint32_t>(list.size()),
                              AllBlocks,
                              tile_x(tile),
                              tile_y(tile),
                              view_.width,
                              view_.height,
                              &lights_[tile],
                              &scratch};
        kernels_.blend(job);
        finish_(finish_context_, tile, scratch);
    }
}

std::span<const Record> Frame::active_records(std::size_t chunk) const {
    const std::size_t begin = chunk * ChunkRows, end = begin + chunk_drawn_[chunk];
    const std::size_t first = std::clamp<std::size_t>(first_active_, begin, end);
    return {records_.data() + first, end - first};
}

void Frame::assign_slots(std::size_t first_row) {
    const std::size_t chunk = first_row / ChunkRows;
    first_active_ = static_cast<std::uint32_t>(rows_);
    if (chunk < chunk_count()) {
        const Record* begin = records_.data() + chunk * ChunkRows;
        const Record* end = begin + chunk_drawn_[chunk];
        const Record* first = std::lower_bound(
            begin, end, first_row, [](const Record& record, std::size_t row) { return record.row < row; });
        first_active_ = static_cast<std::uint32_t>(first - records_.data());
    }
    const std::uint32_t end = chunk_pairs_[chunk_count()];
    first_slot_ = end;
    if (chunk < chunk_count()) {
        const auto active = active_records(chunk);
        first_slot_ =
            active.empty() ? chunk_pairs_[chunk + 1] : chunk_pairs_[chunk] + ranges(active.data())->begin;
    }
    at_least(slots_, std::max<std::size_t>(end - first_slot_, 1));
}

}  // namespace gse::raster
