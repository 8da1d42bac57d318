// The near plane from a sample of the depths in the picture.
#include "engine/scene/depth_range.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gse {
namespace {

constexpr std::size_t Samples = 1024;
// 0.2, the format's near plane, in a capture whose nearest things are 2 away.
constexpr double NearShare = 0.1;
constexpr double LeftOut = 0.02;      // floaters before the camera
constexpr float LeastLogit = -5.54f;  // opacity 1/255: fainter splats are not seen

struct Depths {
    std::array<double, Samples> values;
    std::size_t count = 0;

    double near_quantile() {
        const auto place = values.begin() + static_cast<std::ptrdiff_t>(LeftOut * static_cast<double>(count));
        std::nth_element(values.begin(), place, values.begin() + static_cast<std::ptrdiff_t>(count));
        return *place;
    }
};

}  // namespace

double fitted_near_plane(const GaussianSpans& gaussians, const Camera& camera) {
    Depths inside, ahead;
    const std::size_t step = (gaussians.size + Samples - 1) / Samples;
    for (std::size_t row = 0; row < gaussians.size; row += step) {
        if (!(gaussians.opacity_logit[row] >= LeastLogit)) continue;
        const auto position = gaussians.position.subspan(row * 3, 3);
        const Vec3 p = camera.to_camera({position[0], position[1], position[2]});
        if (!(p.z > 0) || !std::isfinite(p.x + p.y + p.z)) continue;
        ahead.values[ahead.count++] = p.z;
        const double x = camera.fx * p.x / p.z + camera.cx, y = camera.fy * p.y / p.z + camera.cy;
        if (x >= 0 && y >= 0 && x <= camera.width && y <= camera.height) inside.values[inside.count++] = p.z;
    }
    // Large splats reach into the picture from beside it.
    Depths& deciding = inside.count > 0 ? inside : ahead;
    return deciding.count > 0 ? NearShare * deciding.near_quantile() : 0;
}

}  // namespace gse
