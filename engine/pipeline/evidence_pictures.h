// What a search saw, as pictures for the window.
#pragma once

#include <memory>

#include "engine/base/image.h"

namespace gse::pipeline {

/// Attention in false colour (dark blue to yellow) over a dimmed render.
std::shared_ptr<const Image> coloured_map(const Image& render, const Image& map);

/// The mask tinted over a dimmed render.
std::shared_ptr<const Image> masked_picture(const Image& render, const Mask& mask);

}  // namespace gse::pipeline
