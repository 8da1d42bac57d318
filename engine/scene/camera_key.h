// A place on a camera path.
#pragma once

#include "engine/scene/scene.h"

namespace gse {

/// One camera on the artist's path.
struct CameraKey {
    double time = 0;             // seconds
    Camera camera;
};

}  // namespace gse
