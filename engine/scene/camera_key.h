// Key of a camera path.
#pragma once

#include "engine/scene/scene.h"

namespace gse {

/// Course of time between a key and the next. The numbers are those of path files.
enum class Easing { Linear = 0, In = 1, Out = 2, InOut = 3 };

/// One camera on the artist's path.
struct CameraKey {
    double time = 0;  // seconds
    Camera camera;
    Easing easing = Easing::Linear;
};

}  // namespace gse
