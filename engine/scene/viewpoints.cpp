// Fits a view into another picture.
#include "engine/scene/viewpoints.h"

#include <algorithm>

namespace gse {

Camera fitted(const Camera& from, int width, int height) {
    const double scale =
        std::min(static_cast<double>(width) / from.width, static_cast<double>(height) / from.height);
    Camera camera = from;
    camera.width = width;
    camera.height = height;
    camera.fx *= scale;
    camera.fy *= scale;
    camera.cx = width / 2.0 + (from.cx - from.width / 2.0) * scale;
    camera.cy = height / 2.0 + (from.cy - from.height / 2.0) * scale;
    return camera;
}

}  // namespace gse
