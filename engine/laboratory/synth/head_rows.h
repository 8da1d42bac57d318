// Rows of a generated figure's head, by the shapes that it is built of: what searches for a head are measured
// with.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/laboratory/synth/synth.h"

namespace gse::synth {

/// [N] 0 or 1: rows of the shapes around the middle of the object's head, above its neck. For a thing without
/// a head they mean nothing.
std::vector<std::uint8_t> head_rows(const SynthScene& scene);

}  // namespace gse::synth
