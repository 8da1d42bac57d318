// How sure a search is of what it found.
#pragma once

#include "engine/edit/search/locate.h"

namespace gse::edit {

/// What the masks of views that voted hold of the ground in them (ViewRenders::grounds).
GroundEvidence ground_seen(const std::vector<ViewEvidence>& views, const std::vector<Image>& grounds);

/// From the views' masks and attention and what they were fused into; `recognition` as in Confidence.
Confidence confidence_of(const std::vector<ViewEvidence>& views, const localize::LabelWeights& weights,
                         const Label& label, double recognition, const GroundEvidence& ground = {});

}  // namespace gse::edit
