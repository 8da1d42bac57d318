// Region, clicks, segmenters, and who is believed.
#include "engine/edit/masks/word_mask.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/base/check.h"
#include "engine/edit/request/scales.h"
#include "engine/localize/clusters.h"
#include "engine/localize/points.h"

namespace gse::edit {
namespace {

// The table in word_mask.h says how these were chosen.
constexpr std::size_t LeastRegionCells = 4;
constexpr double LargestMaskShare = 0.9;
constexpr double LargestMaskGrowth = 4;
constexpr double LeastOverlapIou = 0.1;

/// The attention on the grid where clusters and clicks are found.
struct SmallMap {
    Image map;
    Mask region;
};

SmallMap small_map(const Image& map, double threshold, const SearchSettings& settings) {
    const int height = std::max(1, ClusterGrid * map.height / map.width);
    SmallMap small{localize::resize_image(map, ClusterGrid, height), {}};
    small.region = localize::clean_clusters(localize::threshold_map(small.map, threshold), small.map,
                                            {settings.dbscan_eps, settings.dbscan_min_samples},
                                            settings.min_cluster_mass);
    return small;
}

bool has_attention(const Image& map) {
    return std::any_of(map.data.begin(), map.data.end(), [](float value) { return value > 0; });
}

void fail(WordMask& found, ViewStep step) {
    found.step = step;
    found.branch = "none";
    found.captured = 0;
    std::fill(found.mask.data.begin(), found.mask.data.end(), std::uint8_t{0});
}

std::vector<PointPrompt> clicks_in(const SmallMap& small, const Image& map, const SearchSettings& settings) {
    localize::PointParameters parameters;
    parameters.positive = settings.positive_points;
    parameters.negative = settings.negative_points;
    const double scale_x = static_cast<double>(map.width) / small.map.width;
    const double scale_y = static_cast<double>(map.height) / small.map.height;
    std::vector<PointPrompt> clicks;
    for (const auto& point : localize::choose_points(small.map, small.region, parameters))
        clicks.push_back({point.x * scale_x, point.y * scale_y, point.positive});
    return clicks;
}

bool sane(const Mask& mask, const Mask& region) {
    const auto area = static_cast<double>(mask.count());
    return area > 0 && area <= LargestMaskShare * static_cast<double>(mask.data.size()) &&
           area <= LargestMaskGrowth * static_cast<double>(region.count());
}

void accept(WordMask& found, Mask mask, double captured, const char* branch) {
    found.mask = std::move(mask);
    found.captured = captured;
    found.branch = branch;
}

/// Refines the region that was found: text segmenter, clicks, or the region itself (METHOD.md, Masks in a
/// view).
void refine(WordMask& found, const Image& picture, const Image& map, const std::string& word,
            const SearchSettings& settings, const WordMaskTools& tools) {
    std::optional<Mask> from_text;
    double text_mass = 0;
    if (tools.text_segmenter != nullptr) {
        auto [mask, score] = tools.text_segmenter->segment(picture, word);
        if (score >= LeastTextScore && mask.data.size() == found.region.data.size() && mask.count() > 0) {
            text_mass = localize::captured_mass(map, found.region, mask);
            from_text = std::move(mask);
        }
    }
    const auto accept_text = [&] {
        accept(found, std::move(*from_text), text_mass, "text");
        found.trusted = true;
    };
    const bool text_fits = from_text && text_mass >= settings.min_segment_attention;
    if (text_fits && localize::mask_iou(*from_text, found.region) >= LeastOverlapIou) return accept_text();
    if (tools.segmenter != nullptr) {
        Mask mask = tools.segmenter->segment(picture, found.points, bounds_of(found.region), map);
        mask = localize::clean_clusters(mask, map, {1.5, 1}, settings.min_cluster_mass);
        const double mass = localize::captured_mass(map, found.region, mask);
        if (sane(mask, found.region) && mass >= std::max(settings.min_segment_attention, text_mass)) {
            found.trusted = tools.segmenter->trusted();
            return accept(found, std::move(mask), mass, "points");
        }
    }
    if (text_fits) accept_text();
}

}  // namespace

BoxPrompt bounds_of(const Mask& mask) {
    BoxPrompt box{static_cast<double>(mask.width), static_cast<double>(mask.height), 0, 0};
    for (int y = 0; y < mask.height; ++y)
        for (int x = 0; x < mask.width; ++x) {
            if (mask.at(x, y) == 0) continue;
            box.x0 = std::min(box.x0, static_cast<double>(x));
            box.y0 = std::min(box.y0, static_cast<double>(y));
            box.x1 = std::max(box.x1, x + 1.0);
            box.y1 = std::max(box.y1, y + 1.0);
        }
    return box;
}

std::size_t normalise_maximum(Image& map) {
    std::size_t broken = 0;
    float largest = 0;
    for (auto& value : map.data) {
        if (!std::isfinite(value)) ++broken, value = 0;
        value = std::max(0.0f, value);
        largest = std::max(largest, value);
    }
    if (largest > 0)
        for (auto& value : map.data) value /= largest;
    return broken;
}

WordMask find_word_mask(const Image& picture, const Image& map, double threshold, const std::string& word,
                        const SearchSettings& settings, const WordMaskTools& tools, bool refines) {
    GSE_CHECK(picture.width == map.width && picture.height == map.height);
    const SmallMap small = small_map(map, threshold, settings);
    WordMask found;
    found.region = localize::resize_mask(small.region, map.width, map.height);
    found.mask = found.region;
    found.branch = "attention";
    found.captured = 1;
    const bool everything = static_cast<double>(found.region.count()) >
                            LargestMaskShare * static_cast<double>(found.region.data.size());
    if (everything) fail(found, ViewStep::Everything);
    else if (small.region.count() < LeastRegionCells)
        fail(found, has_attention(map) ? ViewStep::TooLittle : ViewStep::NoAttention);
    if (!refines || !found.found()) return found;
    found.points = clicks_in(small, map, settings);
    refine(found, picture, map, word, settings, tools);
    return found;
}

}  // namespace gse::edit
