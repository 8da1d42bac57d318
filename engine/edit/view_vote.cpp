// Half the mask, half the attention.
#include "engine/edit/view_vote.h"

#include <cmath>

namespace gse::edit {
namespace {

constexpr double AttentionShare = 0.5;      // of a vote: the attention itself, beside the mask cut out of it
constexpr double AttentionLevel = 0.85;     // of the threshold: attention that counts half
constexpr double AttentionSoftness = 0.05;  // how far from there it counts a quarter more or less
constexpr double RivalLead = 0.5;           // another thing that has so much more takes the pixel from the mask

/// Whether the attention is above a level, in [0,1].
double above(double attention, double level) {
    return 1 / (1 + std::exp((level - attention) / AttentionSoftness));
}

}  // namespace

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
        const double lost = view.lead.data.empty() ? 0 : above(view.lead.data[i], RivalLead);
        vote.data[i] =
            static_cast<float>((1 - AttentionShare) * (1 - lost) * vote.data[i] + AttentionShare * attention);
    }
    return vote;
}

}  // namespace gse::edit
