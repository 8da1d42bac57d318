// Drawn scenes that were cut out of their surroundings.
#pragma once

#include "engine/laboratory/synth/synth.h"

namespace gse::synth {

/// The scene without the rows of its ground, and their parts.
SynthScene without_ground(SynthScene scene);

}  // namespace gse::synth
