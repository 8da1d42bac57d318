// Cases and comparisons for the CUDA kernels, on the processor and on a device.
#pragma once

#include "tests/agree/raster/cases.h"

namespace gse::test {

/// All that a rasterizer is asked for, of one scene and view.
struct Everything {
    raster::ForwardOutput image;
    raster::Gradients gradients;
    std::vector<double> masked, total;
    Image values;
};

inline Everything run(raster::Rasterizer& rasterizer, const GaussianData& data, const Camera& camera,
                      const raster::Settings& settings, std::size_t first_row = 0) {
    Everything all;
    const Image d_colour = noise_image(camera.width, camera.height, 3, 1),
                d_alpha = noise_image(camera.width, camera.height, 1, 2);
    all.masked.resize(data.size());
    all.total.resize(data.size());
    rasterizer.forward(spans(data), camera, settings, all.image);
    rasterizer.contributions(spans(data), camera, settings, d_alpha, all.masked, all.total);
    rasterizer.forward_values(spans(data), camera, settings, data.opacity_logit, all.values);
    rasterizer.backward(d_colour, d_alpha, first_row, all.gradients);
    return all;
}

inline bool identical(const Everything& a, const Everything& b) {
    return identical(a.image, b.image) && identical(a.gradients, b.gradients) && a.masked == b.masked &&
           a.total == b.total && a.values.data == b.values.data;
}

/// Every case of the vector kernels, and what is special about tiles, sorting and culling.
inline std::vector<Case> device_cases() {
    std::vector<Case> all = cases();
    all.push_back({"one splat", {.count = 1, .seed = 13, .log_scale = -1}, 40, 40, {}});
    all.push_back({"no splat", {.count = 0, .seed = 14}, 33, 17, {}});
    all.push_back({"one pixel", {.count = 50, .seed = 15}, 1, 1, {}});
    all.push_back({"one tile", {.count = 900, .seed = 16}, 16, 16, {}});
    all.push_back({"huge splats", {.count = 40, .seed = 17, .log_scale = 1.5}, 70, 50, {}});
    all.push_back({"tiny splats", {.count = 3000, .seed = 18, .log_scale = -8}, 70, 50, {}});
    raster::Settings between;
    between.near_plane = 3.2f;
    between.far_plane = 4.4f;
    all.push_back({"between two planes", {.count = 500, .seed = 19}, 64, 48, between});
    raster::Settings antialiased;
    antialiased.antialiased = true;
    all.push_back({"antialiased", {.count = 3000, .seed = 20, .log_scale = -4.5}, 90, 61, antialiased});
    return all;
}

}  // namespace gse::test
