// What an edit is tried on for its time: a large scene is thinned out, its time follows from the number of
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

/// Every k-th labelled and every k-th other splat of `scene`, so that at most about `most` are left (the
/// first of each kind always is), and the plan with their label. The scene itself where it is no larger.
ProbeScene probe_scene(const GaussianSet& scene, const edit::EditPlan& plan, std::size_t most = MostProbed);

}  // namespace gse::pipeline
