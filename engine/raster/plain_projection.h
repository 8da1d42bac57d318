// Plain double-precision projection of one Gaussian to the image and the chain rule back to its raw
// parameters.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "engine/math/camera.h"
#include "engine/math/vec.h"
#include "engine/raster/rasterizer.h"

namespace gse::raster::plain {

/// N Gaussians in double precision. Finite differences need more digits than GaussianSpans has.
struct Inputs {
    std::size_t size = 0;
    int sh_degree = 0;
    std::span<const double> position, log_scale, rotation, opacity_logit, sh;
};

/// Pixel inputs of one Gaussian.
struct Splat {
    std::size_t row = 0;
    double x = 0, y = 0;                     // centre, pixels
    double a = 0, b = 0, c = 0;              // inverse covariance: sigma = 0.5 (a dx^2 + c dy^2) + b dx dy
    double half_width = 0, half_height = 0;  // pixels; outside this box alpha < 1/255
    double depth = 0;                        // z in the camera
    double opacity = 0;                      // after compensation
    std::array<double, 3> colour{};
};

/// Reason for which a row is not drawn, or none.
enum class Fate { Drawn, Culled, Unusable };

/// Gradient with respect to the values of a Splat.
struct SplatGradient {
    double x = 0, y = 0;
    double a = 0, b = 0, c = 0;
    double log_opacity = 0;  // with respect to ln(opacity)
    std::array<double, 3> colour{};
    bool blended = false;
};

/// Gradient with respect to the raw parameters of one row.
struct RowGradient {
    std::array<double, 3> position{};
    std::array<double, 3> log_scale{};
    std::array<double, 4> rotation{};
    double opacity_logit = 0;
    std::array<double, 48> sh{};  // coefficient-major
};

struct View {
    const Camera& camera;
    const Settings& settings;
    // The goldens need more digits than the settings have, and the eye of a matrix that is a rotation to 1e-8
    // only.
    double blur_px2 = static_cast<double>(settings.blur_px2);
    std::array<double, 3> background = {settings.background[0], settings.background[1],
                                        settings.background[2]};
    Vec3 eye = camera.centre();
};

Fate project(const Inputs& inputs, std::size_t row, const View& view, Splat& splat);
void project_backward(const Inputs& inputs, const View& view, std::size_t row, const SplatGradient& gradient,
                      RowGradient& result);

}  // namespace gse::raster::plain
