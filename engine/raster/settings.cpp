// Settings that follow the scene.
#include <algorithm>
#include <limits>

#include "engine/raster/conventions.h"
#include "engine/raster/rasterizer.h"
#include "engine/scene/depth_range.h"

namespace gse::raster {

Settings with_depth_range(const Settings& settings, const GaussianSpans& gaussians, const Camera& camera) {
    Settings result = settings;
    const auto smallest = static_cast<float>(SmallestNear);
    if (settings.near_plane > 0) {
        result.near_plane = std::max(settings.near_plane, smallest);
    } else {
        const auto fitted = static_cast<float>(fitted_near_plane(gaussians, camera));
        result.near_plane = fitted > 0 ? fitted : smallest;
    }
    if (!(settings.far_plane > 0)) result.far_plane = std::numeric_limits<float>::max();
    return result;
}

}  // namespace gse::raster
