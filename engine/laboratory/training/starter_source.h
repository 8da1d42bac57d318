// Training pictures of the starter model: synthetic scenes drawn with the program's own rasterizer.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "engine/base/image.h"
#include "engine/base/random.h"
#include "engine/laboratory/starter/starter_trainer.h"

namespace gse::training {

inline constexpr int LatentCell = 4;  // pixels per latent cell

/// Pictures 2k and 2k+1 share a scene: where it has an accessory, 2k+1 is the same view without it.
std::unique_ptr<StarterSource> make_starter_source(std::uint64_t seed);
/// Mix of the scenes of make_shape_source().
struct ShapeMix {
    double restyled = 0;      // share of them with StarterSource::restyled()
    double more = 0;          // share of them with synth::more_object_words() and so on
    bool more_looks = false;  // of these only materials, colours and grounds
};

/// Pictures to learn drawing from: accessories are always shown, and every caption says exactly from where.
std::unique_ptr<StarterSource> make_shape_source(std::uint64_t seed, const ShapeMix& mix = {});

/// Black, grey or a pale tint.
std::array<float, 3> random_background(Random& random);
/// Values in [0,1] as bytes.
std::vector<std::uint8_t> to_bytes(const Image& image);

}  // namespace gse::training
