// Viewpoints of a scene: how many it takes, and a view in a picture of another shape.
#pragma once

#include <cstddef>

#include "engine/math/camera.h"

namespace gse {

/// Least number of stored views that tell front from back. With fewer, an edit looks from an orbit of its
/// own.
constexpr std::size_t LeastViewpoints = 3;

/// The view in a picture of another shape. Everything visible stays visible.
Camera fitted(const Camera& from, int width, int height);

}  // namespace gse
