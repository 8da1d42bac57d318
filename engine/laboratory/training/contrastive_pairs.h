// Pictures of the image-text encoder: groups of synthetic scenes that differ in a word or two, seen from one
// place.
#pragma once

#include <memory>

#include "engine/laboratory/starter/starter_trainer.h"

namespace gse::training {

/// Group g is pictures 4g .. 4g+3; no combination of object, material and accessory is a held-out one.
std::unique_ptr<ContrastivePairs> make_contrastive_pairs(std::uint64_t seed);

}  // namespace gse::training
