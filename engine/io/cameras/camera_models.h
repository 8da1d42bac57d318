// Camera models by the names that COLMAP and nerfstudio give them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "engine/math/camera.h"

namespace gse::io {

/// Throws Error (Unsupported) for a model in capitals that has no focal length: panoramas and parallel
/// projection.
void refuse_without_lens(std::string_view model);

/// Camera model of `params` numbers. The first `focals` are focal lengths, then cx, cy (unless spherical).
struct ColmapModel {
    std::string_view name;
    std::size_t params;
    std::size_t focals;  // 1 = fx is fy; 0 = no pinhole at all
    bool perspective;    // a pinhole when everything after cx, cy is zero
};
inline constexpr std::size_t MostColmapParams = 16;

/// Model by COLMAP's number or name. Throws Error (Unsupported) for one that is not known.
const ColmapModel& colmap_model(std::int32_t number);
const ColmapModel& colmap_model(std::string_view name);

/// Intrinsics only. The pose comes from the image.
struct Intrinsics {
    Camera camera;
    bool distorted = false;
    bool panorama = false;  // shown as a pinhole of 90 degrees
};

/// Intrinsics from a model's `params` numbers. Throws Error (Malformed) whose message is the reason alone.
Intrinsics colmap_intrinsics(const ColmapModel& model, double width, double height,
                             std::span<const double> params);

}  // namespace gse::io
