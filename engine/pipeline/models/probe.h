// Trial scene to measure an edit's time. A large scene is thinned out; its time follows from the number of
// splats.
#pragma once

#include <cstddef>

#include "engine/edit/optimise/edit_loop.h"

namespace gse::pipeline {

constexpr std::size_t MostProbed = 250'000;  // splats; more tell nothing new, and take their time and memory

struct ProbeScene {
    GaussianSet set;
    edit::EditPlan plan;
};

/// Every k-th labelled and every k-th other splat of `scene`, at most about `most`, and the plan with their
/// label. The first of each kind is always among them. The scene itself if it is no larger.
ProbeScene probe_scene(const GaussianSet& scene, const edit::EditPlan& plan, std::size_t most = MostProbed);

}  // namespace gse::pipeline
