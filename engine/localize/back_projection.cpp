// Ratio of blending weights inside and everywhere, over all views.
#include "engine/localize/back_projection.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "engine/base/error.h"

namespace gse::localize {

namespace {

void require_votes(std::span<const MaskedView> views) {
    const auto failed = static_cast<std::size_t>(
        std::count_if(views.begin(), views.end(), [](const MaskedView& view) { return view.failed; }));
    if (views.empty() || failed * 2 > views.size())
        throw Error(ErrorCode::InvalidArgument,
                    fmt::format("the words were found in only {} of {} views", views.size() - failed, views.size()),
                    "name something the scene shows and the model knows, or lower the attention threshold");
}

LabelWeights weights_of(const std::vector<double>& masked, std::vector<double> total, int views_used) {
    constexpr double least_total = 1e-8;
    LabelWeights result;
    result.views_used = views_used;
    result.weight.resize(total.size());
    for (std::size_t row = 0; row < total.size(); ++row)
        result.weight[row] = static_cast<float>(std::clamp(masked[row] / std::max(total[row], least_total), 0.0, 1.0));
    result.evidence = std::move(total);
    return result;
}

}  // namespace

KeptVotes::Vote* KeptVotes::find(const Camera& camera) {
    const auto found = std::find_if(votes_.begin(), votes_.end(), [&](const Vote& vote) { return vote.camera == camera; });
    return found != votes_.end() ? &*found : nullptr;
}

std::size_t KeptVotes::Vote::bytes() const {
    return row.capacity() * (sizeof row[0] + sizeof masked[0] + sizeof total[0]) + mask.data.size() * sizeof mask.data[0];
}

KeptVotes::Vote KeptVotes::cast(const GaussianSpans& gaussians, const MaskedView& view, const raster::Settings& settings,
                                raster::Rasterizer& rasterizer) {
    masked_.resize(gaussians.size);
    total_.resize(gaussians.size);
    rasterizer.contributions(gaussians, view.camera, settings, view.mask, masked_, total_);
    Vote vote{view.camera, view.mask, {}, {}, {}};
    const auto shown = static_cast<std::size_t>(std::count_if(total_.begin(), total_.end(), [](double weight) { return weight != 0; }));
    vote.row.reserve(shown);
    vote.masked.reserve(shown);
    vote.total.reserve(shown);
    for (std::size_t row = 0; row < gaussians.size; ++row) {
        if (total_[row] == 0) continue;
        vote.row.push_back(static_cast<std::uint32_t>(row));
        vote.masked.push_back(masked_[row]);
        vote.total.push_back(total_[row]);
        masked_[row] = total_[row] = 0;
    }
    return vote;
}

/// In place of `old`, if there is one; not at all where that takes too much memory.
void KeptVotes::keep(Vote vote, Vote* old) {
    if (old != nullptr) bytes_ -= old->bytes();
    if (bytes_ + vote.bytes() > most_bytes_) vote = Vote{vote.camera, {}, {}, {}, {}};   // like no mask
    bytes_ += vote.bytes();
    if (old != nullptr)
        *old = std::move(vote);
    else
        votes_.push_back(std::move(vote));
}

LabelWeights KeptVotes::back_project(const GaussianSpans& gaussians, std::span<const MaskedView> views, const raster::Settings& settings,
                                     raster::Rasterizer& rasterizer) {
    require_votes(views);
    std::vector<double> masked(gaussians.size), total(gaussians.size);
    int used = 0;
    for (const auto& view : views) {
        if (view.failed) continue;
        ++used;
        Vote* kept = find(view.camera);
        const bool known = kept != nullptr && kept->mask.data == view.mask.data;
        Vote fresh;
        if (!known) fresh = cast(gaussians, view, settings, rasterizer);
        const Vote& vote = known ? *kept : fresh;
        for (std::size_t i = 0; i < vote.row.size(); ++i) {
            masked[vote.row[i]] += vote.masked[i];
            total[vote.row[i]] += vote.total[i];
        }
        if (!known) keep(std::move(fresh), kept);
    }
    return weights_of(masked, std::move(total), used);
}

LabelWeights back_project(const GaussianSpans& gaussians, std::span<const MaskedView> views,
                          const raster::Settings& settings, raster::Rasterizer& rasterizer) {
    require_votes(views);
    std::vector<double> masked(gaussians.size), total(gaussians.size);
    int used = 0;
    for (const auto& view : views) {
        if (view.failed) continue;
        rasterizer.contributions(gaussians, view.camera, settings, view.mask, masked, total);
        ++used;
    }
    return weights_of(masked, std::move(total), used);
}

Label label_from_weights(const std::string& name, const LabelWeights& weights, double tau, double least_evidence_px) {
    std::vector<std::uint8_t> bits(weights.weight.size());
    for (std::size_t row = 0; row < bits.size(); ++row) {
        const bool known = weights.evidence[row] > least_evidence_px ||
                           (!weights.inferred.empty() && weights.inferred[row] != 0);
        bits[row] = weights.weight[row] > tau && known ? 1 : 0;
    }
    Label label;
    label.name = name;
    label.weight = std::make_shared<const std::vector<float>>(weights.weight);
    label.bits = std::make_shared<const std::vector<std::uint8_t>>(std::move(bits));
    return label;
}

}  // namespace gse::localize
