// Scenes whose files hold sizes and opacities where 3DGS files hold their logarithms and logits.
#pragma once

#include <string>

#include "engine/scene/scene.h"

namespace gse::io {

/// Attributes that hold, or may hold, values as they are drawn with.
struct ActivatedValues {
    bool sizes = false, opacities = false;

    bool any() const { return sizes || opacities; }
};

/// Attributes whose values look like sizes and opacities: no size is negative, every opacity lies between 0
/// and 1.
ActivatedValues looks_activated(const GaussianSpans& set);

/// Sentence for a scene that looks so. Names the option that reads it right.
std::string activated_text(ActivatedValues values);

/// The scene with logarithms and logits in place of sizes and opacities, as far as the values can be such.
/// Throws Error (InvalidArgument) when neither can.
Scene with_raw_values(Scene scene);

}  // namespace gse::io
