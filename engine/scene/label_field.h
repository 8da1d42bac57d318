// Votes of a search's views on every Gaussian, apart from the threshold that makes a label of them.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "engine/math/vec.h"

namespace gse {

/// Votes of views over N Gaussians. A threshold never changes them.
struct LabelField {
    std::vector<float> probability;      // [N] in [0,1]: share of its blending weight inside the masks
    std::vector<double> coverage;        // [N] blending weight over all views, pixels
    std::vector<std::uint8_t> inferred;  // [N] or empty: 1 = the probability is that of its neighbours
    int views_used = 0;
};

/// Nature of a labelled thing, as far as it says which parts beside it are none of it.
enum class ThingNature : std::uint8_t {
    Other,
    Figure,  // it may stand on a pedestal
    Vessel,  // a plant may grow out of it
    Plant    // it may grow out of a vessel
};

/// Rule by which a field becomes a label, beside the threshold.
struct LabelRule {
    double least_coverage = 0.5;         // pixels: Gaussians of no more count as unseen
    double smoothness = 1.5;             // of the minimum cut, nats; 0 = no cut
    double island_share = 0;             // of the labelled ones: islands of no more take the label
    Vec3 up{0, -1, 0}, front{0, 0, -1};  // of the world: which way is down, for the ground below a thing
    ThingNature nature = ThingNature::Other;
};

/// A field with its rule: enough to make its label at any threshold.
struct FoundField {
    LabelField field;
    LabelRule rule;
};

}  // namespace gse
