// Viewpoints of a scene: how many it takes, and one view shown in a picture of another shape.
#pragma once

#include <cstddef>

#include "engine/math/camera.h"

namespace gse {

/// Fewer stored views than this cannot tell front from back: an edit looks from an orbit of its own then.
constexpr std::size_t LeastViewpoints = 3;

/// The same view in a picture of another shape: what was visible stays visible.
Camera fitted(const Camera& from, int width, int height);

}  // namespace gse
