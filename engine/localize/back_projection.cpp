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
        throw Error(
            ErrorCode::InvalidArgument,
            fmt::format("the words were found in only {} of {} views", views.size() - failed, views.size()),
            "name something the scene shows and the model knows, or lower the attention threshold");
}

LabelField field_of(const std::vector<double>& masked, std::vector<double> total, int views_used) {
    constexpr double least_total = 1e-8;
    LabelField result;
    result.views_used = views_used;
    result.probability.resize(total.size());
    for (std::size_t row = 0; row < total.size(); ++row)
        result.probability[row] =
            static_cast<float>(std::clamp(masked[row] / std::max(total[row], least_total), 0.0, 1.0));
    result.coverage = std::move(total);
    return result;
}

}  // namespace

VoteCache::Vote* VoteCache::find(const Camera& camera) {
    const auto found =
        std::find_if(votes_.begin(), votes_.end(), [&](const Vote& vote) { return vote.camera == camera; });
    return found != votes_.end() ? &*found : nullptr;
}

std::size_t VoteCache::Vote::bytes() const {
    return row.size() * RowBytes + mask.data.size() * sizeof mask.data[0];
}

/// Vote of the view on every row, in masked_ and total_. Returns how many rows it shows.
std::size_t VoteCache::cast(const GaussianSpans& gaussians, const MaskedView& view,
                            const raster::Settings& settings, raster::Rasterizer& rasterizer) {
    masked_.assign(gaussians.size, 0);
    total_.assign(gaussians.size, 0);
    rasterizer.contributions(gaussians, view.camera, settings, view.mask, masked_, total_);
    return static_cast<std::size_t>(
        std::count_if(total_.begin(), total_.end(), [](double weight) { return weight != 0; }));
}

/// Keeps the votes for the rows that are shown, in place of earlier ones of the camera's view.
void VoteCache::keep(const MaskedView& view, std::size_t shown, Vote* old) {
    if (old != nullptr) bytes_ -= old->bytes();
    Vote vote;
    vote.camera = view.camera;
    if (bytes_ + shown * Vote::RowBytes + view.mask.data.size() * sizeof view.mask.data[0] <= most_bytes_) {
        vote.mask = view.mask;
        vote.row.reserve(shown);
        vote.masked.reserve(shown);
        vote.total.reserve(shown);
        for (std::size_t row = 0; row < total_.size(); ++row) {
            if (total_[row] == 0) continue;
            vote.row.push_back(static_cast<std::uint32_t>(row));
            vote.masked.push_back(masked_[row]);
            vote.total.push_back(total_[row]);
        }
    }
    bytes_ += vote.bytes();
    if (old != nullptr) *old = std::move(vote);
    else if (!vote.mask.data.empty()) votes_.push_back(std::move(vote));
}

LabelField VoteCache::back_project(const GaussianSpans& gaussians, std::span<const MaskedView> views,
                                   const raster::Settings& settings, raster::Rasterizer& rasterizer) {
    require_votes(views);
    std::vector<double> masked(gaussians.size), total(gaussians.size);
    int used = 0;
    for (const auto& view : views) {
        if (view.failed) continue;
        ++used;
        Vote* known = find(view.camera);
        if (known != nullptr && known->mask.data == view.mask.data) {
            for (std::size_t i = 0; i < known->row.size(); ++i) {
                masked[known->row[i]] += known->masked[i];
                total[known->row[i]] += known->total[i];
            }
            continue;
        }
        const std::size_t shown = cast(gaussians, view, settings, rasterizer);
        for (std::size_t row = 0; row < total.size(); ++row) {
            masked[row] += masked_[row];
            total[row] += total_[row];
        }
        keep(view, shown, known);
    }
    return field_of(masked, std::move(total), used);
}

LabelField back_project(const GaussianSpans& gaussians, std::span<const MaskedView> views,
                        const raster::Settings& settings, raster::Rasterizer& rasterizer) {
    require_votes(views);
    std::vector<double> masked(gaussians.size), total(gaussians.size);
    int used = 0;
    for (const auto& view : views) {
        if (view.failed) continue;
        rasterizer.contributions(gaussians, view.camera, settings, view.mask, masked, total);
        ++used;
    }
    return field_of(masked, std::move(total), used);
}

std::vector<std::uint8_t> bits(const LabelField& field, double threshold, double least_coverage) {
    std::vector<std::uint8_t> result(field.probability.size());
    for (std::size_t row = 0; row < result.size(); ++row) {
        const bool known =
            field.coverage[row] > least_coverage || (!field.inferred.empty() && field.inferred[row] != 0);
        result[row] = field.probability[row] > threshold && known ? 1 : 0;
    }
    return result;
}

}  // namespace gse::localize
