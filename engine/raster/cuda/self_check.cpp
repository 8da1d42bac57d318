// The built-in scene and its comparison with the plain version.
#include "engine/raster/cuda/self_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/random.h"
#include "engine/raster/bench_tools.h"
#include "engine/raster/plain.h"
#include "engine/scene/gaussian_set.h"

namespace gse::raster {
namespace {

// Float sums of up to a few hundred terms below 1, as tests/agree/raster holds the fast version to; 2^x of a
// CUDA device is good to 2^-22 only, which is why these are a little wider.
constexpr double ImageLimit = 2e-5;
constexpr double DepthLimit = 2e-4;
constexpr double GradientLimit = 2e-4;
// Ambiguous pixels are not left out here, and each may move one weight of 1/255.
constexpr double ContributionLimit = 1e-3;

constexpr int CheckWidth = 75, CheckHeight = 53;  // whole and cut tiles

/// Scene with several batches of Gaussians per tile: some opaque, some needles, one row without meaning, two
/// at one depth.
GaussianData check_scene() {
    constexpr std::size_t rows = 600;
    GaussianData data;
    data.sh_degree = 3;
    data.resize(rows);
    Random random(20231117);
    for (float& value : data.position) value = static_cast<float>(random.uniform(-1.5, 1.5));
    for (float& value : data.log_scale) value = static_cast<float>(-2.2 + 0.9 * random.normal());
    for (float& value : data.rotation) value = static_cast<float>(random.normal());
    for (float& value : data.opacity_logit) value = static_cast<float>(0.5 + 2 * random.normal());
    for (float& value : data.sh) value = static_cast<float>(0.25 * random.normal());
    for (std::size_t axis = 0; axis < 3; ++axis) data.position[3 + axis] = data.position[axis];
    data.position[6] = NAN;
    return data;
}

Camera check_camera() {
    Camera camera = Camera::look_at({2.4, -1.2, -3}, {0, 0, 0}, {0, -1, 0}, 0.9, CheckWidth, CheckHeight);
    camera.cx += 1.7;
    camera.fy *= 1.07;
    return camera;
}

Settings check_settings() {
    Settings settings;
    settings.antialiased = true;
    settings.background = {0.3f, 0.6f, 0.9f};
    settings.negative_colour_slope = 0.01f;
    return settings;
}

std::vector<std::uint8_t> doubtful_pixels(const GaussianData& data, const Camera& camera,
                                          const Settings& settings) {
    const auto widen = [](const std::vector<float>& values) {
        return std::vector<double>(values.begin(), values.end());
    };
    const auto position = widen(data.position), scale = widen(data.log_scale),
               rotation = widen(data.rotation), logit = widen(data.opacity_logit), sh = widen(data.sh);
    const plain::Inputs inputs{data.size(), data.sh_degree, position, scale, rotation, logit, sh};
    const Settings settled = with_depth_range(settings, spans(data), camera);
    const plain::View view{camera, settled};
    plain::SplatList list;
    plain::Picture picture;
    plain::project_all(inputs, view, list);
    plain::composite(list, view, picture);
    return picture.ambiguous;
}

struct Shown {
    ForwardOutput image;
    Image values;
    Gradients gradients;
    std::vector<double> masked, total;
};

/// A picture of numbers between -1 and 1, 0 where pixels are doubtful.
Image slope_image(int channels, const std::vector<std::uint8_t>& doubtful, std::uint64_t seed) {
    Image image(CheckWidth, CheckHeight, channels);
    Random random(seed);
    for (std::size_t i = 0; i < image.data.size(); ++i) {
        const auto value = static_cast<float>(random.uniform(-1.0, 1.0));
        image.data[i] = doubtful[i / static_cast<std::size_t>(channels)] != 0 ? 0.0f : value;
    }
    return image;
}

Shown show(Rasterizer& rasterizer, const GaussianData& data, const std::vector<std::uint8_t>& doubtful) {
    const Camera camera = check_camera();
    const Settings settings = check_settings();
    const Image d_colour = slope_image(3, doubtful, 1), d_alpha = slope_image(1, doubtful, 2);
    Shown shown;
    shown.masked.resize(data.size());
    shown.total.resize(data.size());
    rasterizer.forward(spans(data), camera, settings, shown.image);
    rasterizer.contributions(spans(data), camera, settings, d_alpha, shown.masked, shown.total);
    rasterizer.forward_values(spans(data), camera, settings, data.opacity_logit, shown.values);
    rasterizer.backward(d_colour, d_alpha, 0, shown.gradients);
    return shown;
}

/// Largest difference outside the doubtful pixels. Infinite for a NaN or another size.
double worst(const std::vector<float>& found, const std::vector<float>& expected,
             const std::vector<std::uint8_t>& doubtful) {
    if (found.size() != expected.size()) return INFINITY;
    const std::size_t channels = expected.size() / doubtful.size();
    double result = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        if (doubtful[i / channels] != 0) continue;
        const double difference = std::abs(static_cast<double>(found[i]) - static_cast<double>(expected[i]));
        if (!(difference <= result)) result = std::isfinite(difference) ? difference : INFINITY;
    }
    return result;
}

template <class Values> double distance(const Values& found, const Values& expected) {
    double difference = 0, size = 0;
    if (found.size() != expected.size()) return INFINITY;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        const auto value = static_cast<double>(expected[i]), d = static_cast<double>(found[i]) - value;
        difference += d * d;
        size += value * value;
    }
    const double result = std::sqrt(difference / std::max(size, 1e-30));
    return std::isfinite(result) ? result : INFINITY;
}

double gradient_distance(const Gradients& found, const Gradients& expected) {
    if (found.visible != expected.visible) return INFINITY;
    return std::max(
        {distance(found.position, expected.position), distance(found.log_scale, expected.log_scale),
         distance(found.rotation, expected.rotation), distance(found.opacity_logit, expected.opacity_logit),
         distance(found.sh, expected.sh), distance(found.mean2d_norm, expected.mean2d_norm)});
}

bool same_bits(const Shown& a, const Shown& b) {
    const Gradients &g = a.gradients, &h = b.gradients;
    return a.image.colour.data == b.image.colour.data && a.image.blended == b.image.blended &&
           a.values.data == b.values.data && a.masked == b.masked && g.position == h.position &&
           g.log_scale == h.log_scale && g.rotation == h.rotation && g.opacity_logit == h.opacity_logit &&
           g.sh == h.sh && g.mean2d_norm == h.mean2d_norm && g.visible == h.visible;
}

}  // namespace

bool SelfCheck::passed() const {
    return image <= ImageLimit && depth <= DepthLimit && counts == 0 && gradient <= GradientLimit &&
           contributions <= ContributionLimit && repeats;
}

std::string SelfCheck::figures() const {
    return fmt::format(
        "picture {:.1e} (limit {:.0e}), depth {:.1e} ({:.0e}), other counts in {} pixels (0), gradients "
        "{:.1e} ({:.0e}), "
        "contributions {:.1e} ({:.0e}), {}",
        image, ImageLimit, depth, DepthLimit, counts, gradient, GradientLimit, contributions,
        ContributionLimit, repeats ? "repeatable" : "not repeatable");
}

SelfCheck check_against_plain(Rasterizer& rasterizer) {
    const GaussianData data = check_scene();
    const auto doubtful = doubtful_pixels(data, check_camera(), check_settings());
    const Shown expected = show(*make_plain_rasterizer(), data, doubtful);
    const Shown found = show(rasterizer, data, doubtful);
    SelfCheck check;
    check.image = std::max({worst(found.image.colour.data, expected.image.colour.data, doubtful),
                            worst(found.image.alpha.data, expected.image.alpha.data, doubtful),
                            worst(found.values.data, expected.values.data, doubtful)});
    check.depth = worst(found.image.depth.data, expected.image.depth.data, doubtful);
    for (std::size_t pixel = 0; pixel < doubtful.size(); ++pixel)
        if (doubtful[pixel] == 0 && found.image.blended[pixel] != expected.image.blended[pixel])
            ++check.counts;
    if (found.image.dropped_rows != expected.image.dropped_rows) check.counts = doubtful.size();
    check.gradient = gradient_distance(found.gradients, expected.gradients);
    check.contributions =
        std::max(distance(found.masked, expected.masked), distance(found.total, expected.total));
    check.repeats = same_bits(found, show(rasterizer, data, doubtful));
    return check;
}

void require_agreement(Rasterizer& rasterizer, const std::string& what) {
    const SelfCheck check = check_against_plain(rasterizer);
    if (!check.passed())
        throw Error(
            ErrorCode::Unsupported,
            fmt::format("{} draws a test scene otherwise than the processor does: {}", what, check.figures()),
            "use the rasterizer \"cpu\", and report these figures");
}

}  // namespace gse::raster
