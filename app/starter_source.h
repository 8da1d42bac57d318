// Training pictures of the starter model: synthetic scenes drawn with the program's own rasterizer.
#pragma once

#include <memory>

#include "engine/neural/starter_trainer.h"

namespace gse::app {

/// Pictures 2k and 2k+1 share a scene: where it has an accessory, 2k+1 is the same view without it.
std::unique_ptr<neural::StarterSource> make_starter_source(std::uint64_t seed);

}  // namespace gse::app
