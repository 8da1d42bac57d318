// Part of a view that is redrawn by itself, so that a small object gets more of the model's few pixels.
#pragma once

#include "engine/edit/interfaces/interfaces.h"

namespace gse::edit {

/// A square of a picture's pixels.
struct ViewSection {
    int left = 0, top = 0, side = 0;
};

/// Square around the mask of a square picture, of which the mask takes SectionShare. The whole picture if
/// little would be left out, or if the mask is empty.
ViewSection section_around(const Mask& mask);
constexpr double SectionShare = 0.6;  // of the square's side, for the longer side of what is in it
constexpr double LeastSection = 0.3;  // of the picture's side
constexpr double LargestSection = 0.8;

/// View through that part of its picture. All pictures are cut, and the camera's principal point is moved
/// along.
EditView cut_out_section(const EditView& view, const ViewSection& section);

/// Picture with that part (of the section's size) replaced.
Image with_section(Image picture, const Image& part, const ViewSection& section);

}  // namespace gse::edit
