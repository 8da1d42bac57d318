// Checks of every camera reader: focal lengths, sizes and poses that no camera has are refused.
#pragma once

#include <string>

#include "engine/math/camera.h"

namespace gse::io {

inline constexpr int LargestImageSide = 100000;  // pixels

/// Throws Error (Malformed) for intrinsics that no camera has. `hint` says what to do about it.
void check_intrinsics(const Camera& camera, const std::string& which, const char* hint = "");

/// Throws Error (Malformed) unless everything is finite and the rotation is orthonormal within a hundredth.
void check_pose(const Camera& camera, const std::string& which, const char* hint = "");

/// Check of intrinsics and pose, for readers that leave single cameras out. Mirrored poses are refused too:
/// their pictures would be mirrored. Throws Error (Malformed) whose message is the reason alone.
void check_camera(const Camera& camera);

}  // namespace gse::io
