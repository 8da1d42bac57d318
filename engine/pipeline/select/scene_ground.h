// Ground of a scene by its shape, where no word finds it.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/progress.h"
#include "engine/math/vec.h"
#include "engine/scene/gaussian_set.h"

namespace gse::pipeline {

/// Rows [N] of the flat that the things of a scene stand on, with what lies below it (localize::ground_seed).
/// No row where there is none. Throws Error (Cancelled).
std::vector<std::uint8_t> scene_ground(const GaussianSet& set, const Vec3& up, const JobControl& control);

/// The flat of the scene where `label` [N] is most of it, else the label. Throws Error (Cancelled).
std::vector<std::uint8_t> whole_ground(const GaussianSet& set, std::vector<std::uint8_t> label,
                                       const Vec3& up, const JobControl& control);

}  // namespace gse::pipeline
