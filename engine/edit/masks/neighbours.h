// Means over the pixels around a pixel.
#pragma once

#include "engine/base/image.h"

namespace gse::edit {

/// [H,W,1]: mean over each pixel and those of its eight neighbours that are in the picture.
Image mean_of_neighbours(const Image& image);

}  // namespace gse::edit
