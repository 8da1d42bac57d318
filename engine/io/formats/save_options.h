// Options of writing a scene: format, columns of labels, version of a .spz file.
#pragma once

#include <span>
#include <string>

#include "engine/scene/scene.h"

namespace gse {

/// What to write beside the Gaussians.
struct SaveOptions {
    /// "ply", "compressed.ply", "splat", "spz" or "sog"; empty = from the file's name.
    std::string format = {};
    /// Optional columns of a 3DGS PLY, each empty or one value per row; written as floats after rot_3.
    std::span<const float> label = {};
    std::span<const float> label_weight = {};
    /// Takes `label` and `label_weight` from this label instead (must have one value per row).
    const Label* from_label = nullptr;
    /// Version of a .spz file: 3 is what most programs read, 4 the newest (smaller), 2 for the oldest ones
    /// (coarser rotations).
    int spz_version = 3;
};

}  // namespace gse
