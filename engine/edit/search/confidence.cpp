// Agreement of the views, attention inside the masks, share of the scene, and one figure of them.
#include "engine/edit/search/confidence.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace gse::edit {
namespace {

/// Share of what is seen that all views have one opinion of: 1 when every splat is always or never inside the
/// masks, 0 when all are half the time. The ground that is no part of the scene counts as one splat, as that
/// of other scenes does, which is never what was looked for.
double agreement_of(const localize::LabelWeights& weights, const GroundEvidence& ground) {
    double decided = std::max(0.0, ground.seen - 2 * ground.inside), all = ground.seen;
    for (std::size_t row = 0; row < weights.weight.size(); ++row) {
        decided += weights.evidence[row] * std::abs(2.0 * weights.weight[row] - 1);
        all += weights.evidence[row];
    }
    return all > 0 ? decided / all : 0;
}

double share_of(const localize::LabelWeights& weights, const std::vector<std::uint8_t>& bits,
                const GroundEvidence& ground) {
    double labelled = 0, all = ground.seen;
    for (std::size_t row = 0; row < bits.size(); ++row) {
        labelled += bits[row] != 0 ? weights.evidence[row] : 0;
        all += weights.evidence[row];
    }
    return all > 0 ? labelled / all : 0;
}

/// Mean over the views; one that found nothing has no attention inside, one that was left out does not count.
struct Attention {
    double inside = 0;  // share of the attention inside the masks
    double focus =
        0;  // attention per pixel inside, over that inside and outside: 0.5 = as strong outside as inside
};

Attention attention_of(const std::vector<ViewEvidence>& views) {
    Attention mean;
    const auto out = std::count_if(views.begin(), views.end(),
                                   [](const auto& view) { return view.step == ViewStep::LeftOut; });
    for (const auto& view : views) {
        if (view.failed) continue;
        double inside = 0, all = 0, area = 0;
        for (std::size_t i = 0; i < view.map.data.size(); ++i) {
            const bool in = view.mask.data[i] != 0;
            inside += in ? view.map.data[i] : 0;
            all += view.map.data[i];
            area += in ? 1 : 0;
        }
        const double rest = static_cast<double>(view.map.data.size()) - area;
        if (!(all > 0) || !(area > 0)) continue;
        const double dense = inside / area, thin = rest > 0 ? (all - inside) / rest : 0;
        mean.inside += inside / all;
        mean.focus += dense / (dense + thin);
    }
    const auto count = static_cast<double>(std::max<std::ptrdiff_t>(1, std::ssize(views) - out));
    return {mean.inside / count, mean.focus / count};
}

/// 0 at one half, where nothing is said, to 1.
double above_half(double value) { return std::clamp(2 * value - 1, 0.0, 1.0); }

}  // namespace

GroundEvidence ground_seen(const std::vector<ViewEvidence>& views, const std::vector<Image>& grounds) {
    GroundEvidence ground;
    for (std::size_t v = 0; v < grounds.size(); ++v)
        for (std::size_t i = 0; !views[v].failed && i < grounds[v].data.size(); ++i) {
            ground.seen += grounds[v].data[i];
            ground.inside += views[v].mask.data[i] != 0 ? grounds[v].data[i] : 0;
        }
    return ground;
}

Confidence confidence_of(const std::vector<ViewEvidence>& views, const localize::LabelWeights& weights,
                         const Label& label, double recognition, const GroundEvidence& ground) {
    Confidence confidence;
    const Attention attention = attention_of(views);
    confidence.agreement = agreement_of(weights, ground);
    confidence.attention = attention.inside;
    confidence.share = share_of(weights, *label.bits, ground);
    confidence.recognition = recognition;
    // Each part can refuse: views at odds, attention all over the picture, a word that others fit better.
    confidence.value =
        above_half(confidence.agreement) * above_half(attention.focus) * (recognition < 0 ? 1 : recognition);
    return confidence;
}

}  // namespace gse::edit
