// World point of a pixel and its depth: the inverse of Camera's projection.
#pragma once

#include "engine/math/camera.h"

namespace gse {

/// World point at picture place (x, y) in pixels and depth z along the camera's axis. A pixel's centre is at
/// its index + 0.5.
inline Vec3 unprojected(const Camera& camera, double x, double y, double z) {
    return camera.rotation.transposed() *
               Vec3{(x - camera.cx) / camera.fx * z, (y - camera.cy) / camera.fy * z, z} +
           camera.centre();
}

}  // namespace gse
