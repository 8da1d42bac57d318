// Checks of every camera reader: focal lengths, sizes and poses that no camera has are refused.
#pragma once

#include <fmt/core.h>

#include <cmath>
#include <string>

#include "engine/base/error.h"
#include "engine/math/camera.h"

namespace gse::io {

inline constexpr int LargestImageSide = 100000;  // pixels

/// Throws Error (Malformed) for intrinsics that no camera has. `hint` says what to do about it.
inline void check_intrinsics(const Camera& camera, const std::string& which, const char* hint = "") {
    if (camera.width < 1 || camera.height < 1 || camera.width > LargestImageSide ||
        camera.height > LargestImageSide)
        throw Error(
            ErrorCode::Malformed,
            fmt::format("the camera {} has an image size of {} x {}", which, camera.width, camera.height),
            hint);
    const bool valid = std::isfinite(camera.fx) && std::isfinite(camera.fy) && camera.fx > 0 &&
                       camera.fy > 0 && std::isfinite(camera.cx) && std::isfinite(camera.cy);
    if (!valid)
        throw Error(ErrorCode::Malformed,
                    fmt::format("the camera {} has focal lengths {} and {} and centre ({}, {})", which,
                                camera.fx, camera.fy, camera.cx, camera.cy),
                    hint);
}

/// Throws Error (Malformed) unless everything is finite and the rotation is orthonormal within a hundredth.
inline void check_pose(const Camera& camera, const std::string& which, const char* hint = "") {
    const Vec3& t = camera.translation;
    bool valid = std::isfinite(t.x) && std::isfinite(t.y) && std::isfinite(t.z);
    const Mat3 product = camera.rotation * camera.rotation.transposed();
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            valid = valid && std::abs(product(row, column) - (row == column ? 1 : 0)) < 0.01;
    if (!valid)
        throw Error(ErrorCode::Malformed,
                    fmt::format("the camera \"{}\" has no valid rotation and position", which), hint);
}

}  // namespace gse::io
