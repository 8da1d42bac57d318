// A label at a threshold: votes of the views, opinions of neighbours, minimum cut, ground and other parts
// beside the thing.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/thread_pool.h"
#include "engine/scene/label_field.h"
#include "engine/scene/scene.h"

namespace gse::edit {

/// A label, and the rows [N] beside its thing (thing_parts.h); empty = none were found.
struct DecidedLabel {
    Label label;
    std::vector<std::uint8_t> beside;
};

/// The label of a field's N Gaussians at a threshold in [0,1], as a search with that threshold makes it. Its
/// weights are the field's probabilities; where neighbours or a support decide otherwise than the threshold
/// does, they lie a little beyond it. The result does not depend on the number of threads (null = one).
DecidedLabel decide_label(std::string name, const GaussianSet& set, const FoundField& found, double threshold,
                          ThreadPool* threads = nullptr);

}  // namespace gse::edit
