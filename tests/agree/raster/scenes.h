// Random scenes and comparisons for the tests of the rasterizer: the plain double version is the truth.
#pragma once

#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/random.h"
#include "engine/base/thread_pool.h"
#include "engine/raster/plain.h"
#include "engine/raster/rasterizer.h"
#include "engine/scene/gaussian_set.h"

namespace gse::test {

/// Knobs of a random scene in the box [-1.5, 1.5]^3 around the origin.
struct SceneRecipe {
    std::size_t count = 300;
    std::uint64_t seed = 1;
    int sh_degree = 3;
    double log_scale = -2.5;  // mean
    double log_scale_spread = 0.6;
    double stretch = 1.0;  // how far the three axes differ (natural log)
    double opacity = 0.5;  // mean logit
    double opacity_spread = 2.0;
};

inline GaussianData random_scene(const SceneRecipe& recipe) {
    GaussianData data;
    data.sh_degree = recipe.sh_degree;
    data.resize(recipe.count);
    Random random(recipe.seed);
    const auto fill = [&](std::vector<float>& values, double mean, double spread) {
        for (float& value : values) value = static_cast<float>(mean + spread * random.normal());
    };
    for (float& value : data.position) value = static_cast<float>(random.uniform(-1.5, 1.5));
    fill(data.log_scale, recipe.log_scale, recipe.stretch);
    for (std::size_t row = 0; row < recipe.count; ++row) {
        const double size = recipe.log_scale_spread * random.normal();
        for (std::size_t axis = 0; axis < 3; ++axis)
            data.log_scale[row * 3 + axis] += static_cast<float>(size);
    }
    fill(data.rotation, 0.0, 1.0);
    fill(data.opacity_logit, recipe.opacity, recipe.opacity_spread);
    fill(data.sh, 0.0, 0.25);
    for (std::size_t row = 0; row < recipe.count; ++row)
        for (std::size_t channel = 0; channel < 3; ++channel)
            data.sh[row * data.sh_stride() + channel] = static_cast<float>(random.normal());
    return data;
}

inline Camera test_camera(int width, int height, double distance = 4.0) {
    Camera camera = Camera::look_at({distance * 0.6, -distance * 0.3, -distance * 0.75}, {0, 0, 0},
                                    {0, -1, 0}, 0.9, width, height);
    camera.cx += 1.7;  // an off-centre principal point and two focal lengths, so that nothing can be mixed up
    camera.cy -= 2.3;
    camera.fy *= 1.07;
    return camera;
}

/// Scene and camera `factor` times as large: the same picture.
inline GaussianData scaled(GaussianData data, double factor) {
    for (float& value : data.position) value = static_cast<float>(factor * static_cast<double>(value));
    for (float& value : data.log_scale) value += static_cast<float>(std::log(factor));
    return data;
}

inline Camera scaled(Camera camera, double factor) {
    camera.translation = camera.translation * factor;
    return camera;
}

inline Image noise_image(int width, int height, int channels, std::uint64_t seed) {
    Image image(width, height, channels);
    Random random(seed);
    for (float& value : image.data) value = static_cast<float>(random.uniform(-1.0, 1.0));
    return image;
}

template <class A, class B> double relative_l2(const A& found, const B& expected) {
    if (found.size() != expected.size()) return INFINITY;
    double difference = 0, size = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        const double d = static_cast<double>(found[i]) - static_cast<double>(expected[i]);
        difference += d * d;
        size += static_cast<double>(expected[i]) * static_cast<double>(expected[i]);
    }
    return size > 0 ? std::sqrt(difference / size) : std::sqrt(difference);
}

/// Pixels at which a float version may decide a cut differently (1), from the plain version.
inline std::vector<std::uint8_t> ambiguous_pixels(const GaussianData& data, const Camera& camera,
                                                  const raster::Settings& settings) {
    const auto widen = [](const std::vector<float>& v) { return std::vector<double>(v.begin(), v.end()); };
    const auto position = widen(data.position), scale = widen(data.log_scale),
               rotation = widen(data.rotation), logit = widen(data.opacity_logit), sh = widen(data.sh);
    const raster::plain::Inputs inputs{data.size(), data.sh_degree, position, scale, rotation, logit, sh};
    raster::plain::SplatList list;
    raster::plain::Picture picture;
    const raster::Settings settled = raster::with_depth_range(settings, spans(data), camera);
    const raster::plain::View view{camera, settled};
    raster::plain::project_all(inputs, view, list);
    raster::plain::composite(list, view, picture);
    return picture.ambiguous;
}

/// Largest difference over the pixels that are not ambiguous.
template <class A>
double clear_error(const A& found, const A& expected, const std::vector<std::uint8_t>& ambiguous) {
    if (found.size() != expected.size()) return INFINITY;
    const std::size_t channels = expected.size() / ambiguous.size();
    double worst = 0;
    for (std::size_t i = 0; i < expected.size(); ++i)
        if (ambiguous[i / channels] == 0)
            worst =
                std::max(worst, std::abs(static_cast<double>(found[i]) - static_cast<double>(expected[i])));
    return worst;
}

/// No gradient from the ambiguous pixels, so that both versions differentiate the same decisions.
inline void blank(Image& image, const std::vector<std::uint8_t>& ambiguous) {
    const std::size_t channels = static_cast<std::size_t>(image.channels);
    for (std::size_t i = 0; i < image.data.size(); ++i)
        if (ambiguous[i / channels] != 0) image.data[i] = 0;
}

inline bool all_finite(std::span<const float> values) {
    for (const float value : values)
        if (!std::isfinite(value)) return false;
    return true;
}

inline bool all_finite(const raster::ForwardOutput& image) {
    return all_finite(image.colour.data) && all_finite(image.alpha.data) && all_finite(image.depth.data);
}

inline bool all_finite(const raster::Gradients& g) {
    return all_finite(g.position) && all_finite(g.log_scale) && all_finite(g.rotation) &&
           all_finite(g.opacity_logit) && all_finite(g.sh) && all_finite(g.mean2d_norm);
}

inline bool identical(const raster::Gradients& a, const raster::Gradients& b) {
    return a.position == b.position && a.log_scale == b.log_scale && a.rotation == b.rotation &&
           a.opacity_logit == b.opacity_logit && a.sh == b.sh && a.mean2d_norm == b.mean2d_norm &&
           a.visible == b.visible;
}

inline bool identical(const raster::ForwardOutput& a, const raster::ForwardOutput& b) {
    return a.colour.data == b.colour.data && a.alpha.data == b.alpha.data && a.depth.data == b.depth.data &&
           a.blended == b.blended && a.pairs == b.pairs && a.dropped_rows == b.dropped_rows;
}

}  // namespace gse::test
