// Ratio of blending weights inside and everywhere, over all views.
#include "engine/localize/back_projection.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "engine/base/error.h"

namespace gse::localize {

LabelWeights back_project(const GaussianSpans& gaussians, std::span<const MaskedView> views,
                          const raster::Settings& settings, raster::Rasterizer& rasterizer) {
    const auto failed = static_cast<std::size_t>(
        std::count_if(views.begin(), views.end(), [](const MaskedView& view) { return view.failed; }));
    if (views.empty() || failed * 2 > views.size())
        throw Error(ErrorCode::InvalidArgument,
                    fmt::format("the words were found in only {} of {} views", views.size() - failed, views.size()),
                    "name something the scene shows and the model knows, or lower the attention threshold");
    constexpr double least_total = 1e-8;
    std::vector<double> masked(gaussians.size), total(gaussians.size);
    LabelWeights result;
    for (const auto& view : views) {
        if (view.failed) continue;
        rasterizer.contributions(gaussians, view.camera, settings, view.mask, masked, total);
        ++result.views_used;
    }
    result.weight.resize(gaussians.size);
    for (std::size_t row = 0; row < gaussians.size; ++row)
        result.weight[row] = static_cast<float>(std::clamp(masked[row] / std::max(total[row], least_total), 0.0, 1.0));
    result.evidence = std::move(total);
    return result;
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
