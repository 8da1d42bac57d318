// Options of writing a scene: format, columns of labels, choices of the format's own options.
#pragma once

#include <map>
#include <span>
#include <string>

#include "engine/scene/scene.h"

namespace gse {

/// Values of format options by their names ("spz_version"). An option that is not named has its default.
using FormatChoices = std::map<std::string, int>;

/// Settings of save_scene().
struct SaveOptions {
    /// Name of a format that can be written ("compressed.ply"). Empty = from the file's name.
    std::string format = {};
    /// Optional columns of a 3DGS PLY, each empty or one value per row. Written as floats after rot_3.
    std::span<const float> label = {};
    std::span<const float> label_weight = {};
    /// Label whose bits and weights replace `label` and `label_weight`. Must have one value per row.
    const Label* from_label = nullptr;
    /// Options of the format itself. Those of other formats are ignored.
    FormatChoices choices = {};
};

}  // namespace gse
