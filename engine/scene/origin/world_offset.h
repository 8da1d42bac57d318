// Offset between the coordinates of a file and those of its scene, for worlds that are far from their origin.
// A float holds UTM coordinates to half a metre only; the offset is taken off in double arithmetic.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/scene/camera_key.h"
#include "engine/scene/scene.h"

namespace gse {

/// Offset to take off positions [N,3]: their median in whole units. Zero for scenes that are not far from the
/// origin on any axis.
Vec3 world_offset(std::span<const double> positions);
/// True when a scene with positions [N,3] needs no other offset than this one.
bool suits_offset(std::span<const double> positions, const Vec3& offset);

inline bool has_offset(const Vec3& offset) { return offset != Vec3{}; }

/// The set with every position moved by `by`, in double arithmetic. Shares all arrays for zero.
GaussianSet moved(const GaussianSet& set, const Vec3& by);
/// Views of a world that is moved by `by`. They show what they showed.
std::vector<View> moved(std::vector<View> views, const Vec3& by);
Camera moved(Camera camera, const Vec3& by);
std::vector<CameraKey> moved(std::vector<CameraKey> keys, const Vec3& by);

/// "(455123, 5410987, 321)".
std::string offset_text(const Vec3& offset);

}  // namespace gse
