// Training pictures of the starter model: synthetic scenes drawn with the program's own rasterizer.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "engine/base/image.h"
#include "engine/base/random.h"
#include "engine/neural/starter_trainer.h"

namespace gse::training {

inline constexpr int LatentCell = 4;   // pixels per latent cell

/// Pictures 2k and 2k+1 share a scene: where it has an accessory, 2k+1 is the same view without it.
std::unique_ptr<neural::StarterSource> make_starter_source(std::uint64_t seed);
/// Pictures to learn drawing from: accessories are always shown, and every caption says exactly from where. `restyled`: share of the scenes
/// with StarterSource::restyled(); `more`: share of those with synth::more_object_words() and so on.
std::unique_ptr<neural::StarterSource> make_shape_source(std::uint64_t seed, double restyled = 0, double more = 0);

/// Black, grey or a pale tint.
std::array<float, 3> random_background(Random& random);
/// Values in [0,1] as bytes.
std::vector<std::uint8_t> to_bytes(const Image& image);

}  // namespace gse::training
