// Half the mask, half the attention.
#include "engine/edit/masks/view_vote.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"

namespace gse::edit {
namespace {

constexpr double AttentionShare = 0.5;      // of a vote: the attention itself, beside the mask cut out of it
constexpr double AttentionLevel = 0.85;     // of the threshold: attention that counts half
constexpr double AttentionSoftness = 0.05;  // how far from there it counts a quarter more or less
constexpr double LeastCoverageShare = 0.2;  // of the mean coverage of the rows that are seen at all
// Share of the attention that a word draws at most in most views. Views below it do not vote: sunglasses from
// behind draw little, hats and scarves draw much from any side (METHOD.md, Label voting).
constexpr double FaintShare = 0.6;
constexpr double DecidingMargin = 0.5;  // another thing that has so much more takes the pixel from the mask

/// Tells whether the attention is above a level, in [0,1].
double above(double attention, double level) {
    return 1 / (1 + std::exp((level - attention) / AttentionSoftness));
}

}  // namespace

float largest_value(const Image& map) {
    float largest = 0;
    for (const float value : map.data)
        if (std::isfinite(value)) largest = std::max(largest, value);
    return largest;
}

std::vector<std::size_t> faint_views(const std::vector<float>& peaks) {
    std::vector<std::size_t> faint;
    if (peaks.empty()) return faint;
    auto sorted = peaks;
    std::sort(sorted.begin(), sorted.end());
    const double usual = sorted[sorted.size() * 3 / 4],
                 least = std::min<double>(FaintShare * usual, sorted[sorted.size() / 2]);
    for (std::size_t v = 0; v < peaks.size(); ++v)
        if (peaks[v] < least) faint.push_back(v);
    return faint;
}

Image mask_image(const Mask& mask) {
    Image image(mask.width, mask.height, 1);
    for (std::size_t i = 0; i < mask.data.size(); ++i) image.data[i] = mask.data[i] != 0 ? 1.0f : 0.0f;
    return image;
}

Image vote_of(const ViewEvidence& view, double threshold) {
    Image vote = mask_image(view.mask);
    if (view.failed || view.trusted) return vote;
    for (std::size_t i = 0; i < vote.data.size(); ++i) {
        const double attention = above(view.map.data[i], AttentionLevel * threshold);
        const double lost =
            view.competitor_margin.data.empty() ? 0 : above(view.competitor_margin.data[i], DecidingMargin);
        vote.data[i] =
            static_cast<float>((1 - AttentionShare) * (1 - lost) * vote.data[i] + AttentionShare * attention);
    }
    return vote;
}

void suppress_competitors(ViewEvidence& view, const std::vector<Image>& maps, bool strict) {
    if (maps.size() < 2) return;
    view.competitor_margin = Image(view.map.width, view.map.height, 1);
    for (std::size_t i = 0; i < view.map.data.size(); ++i) {
        for (std::size_t rival = 1; rival < maps.size(); ++rival)
            view.competitor_margin.data[i] =
                std::max(view.competitor_margin.data[i], maps[rival].data[i] - view.map.data[i]);
        if (strict && view.competitor_margin.data[i] > 0) view.map.data[i] = 0;
    }
}

void require_views(const std::vector<std::size_t>& excluded, std::size_t count) {
    for (const auto view : excluded)
        if (view >= count)
            throw Error(ErrorCode::InvalidArgument,
                        fmt::format("view {} is to be left out, but the last one is {}", view, count - 1),
                        "correct excluded_views, or leave it empty");
}

void exclude_views(std::vector<ViewEvidence>& views, const std::vector<std::size_t>& excluded) {
    require_views(excluded, views.size());
    for (const auto view : excluded) {
        views[view].failed = true;
        views[view].step = ViewStep::LeftOut;
    }
}

double least_coverage(const LabelField& field, double asked) {
    double sum = 0;
    std::size_t seen = 0;
    for (const double coverage : field.coverage) {
        sum += coverage;
        seen += coverage > 0 ? 1 : 0;
    }
    return seen == 0 ? 0 : std::min(asked, LeastCoverageShare * sum / static_cast<double>(seen));
}

}  // namespace gse::edit
