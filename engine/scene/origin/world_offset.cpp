// Medians of large coordinates, and moves by them.
#include "engine/scene/origin/world_offset.h"
#include "engine/math/quantile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace gse {
namespace {

// From here on a float's step is above a tenth of a millimetre in a world of metres.
constexpr double LeastOffset = 1000;
// Beyond it lie no coordinates of this earth, in millimetres neither.
constexpr double LargestOffset = 1e10;
constexpr std::size_t MostSamples = 100'000;

/// Median of the finite positions of an axis, of every so many rows in a large scene.
double median_of_axis(std::span<const double> positions, std::size_t axis) {
    const std::size_t rows = positions.size() / 3, step = rows / MostSamples + 1;
    std::vector<double> values;
    for (std::size_t row = 0; row < rows; row += step)
        if (const double value = positions[row * 3 + axis]; std::isfinite(value)) values.push_back(value);
    return values.empty() ? 0 : upper_median(values);
}

Vec3 median_of(std::span<const double> positions) {
    return {median_of_axis(positions, 0), median_of_axis(positions, 1), median_of_axis(positions, 2)};
}

double largest_of(const Vec3& at) { return std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)}); }

}  // namespace

Vec3 world_offset(std::span<const double> positions) {
    const Vec3 median = median_of(positions);
    const double far = largest_of(median);
    if (far < LeastOffset || far > LargestOffset) return {};
    return {std::round(median.x), std::round(median.y), std::round(median.z)};
}

bool suits_offset(std::span<const double> positions, const Vec3& offset) {
    return largest_of(offset) <= LargestOffset && largest_of(median_of(positions) - offset) < LeastOffset;
}

GaussianSet moved(const GaussianSet& set, const Vec3& by) {
    if (!has_offset(by)) return set;
    std::vector<float> positions(set.position().begin(), set.position().end());
    for (std::size_t i = 0; i < positions.size(); ++i)
        positions[i] = static_cast<float>(static_cast<double>(positions[i]) + by[static_cast<int>(i % 3)]);
    GaussianBuffers buffers = set.buffers();
    buffers.position = std::make_shared<const std::vector<float>>(std::move(positions));
    return GaussianSet(std::move(buffers));
}

Camera moved(Camera camera, const Vec3& by) {
    camera.translation = camera.translation - camera.rotation * by;
    return camera;
}

std::vector<View> moved(std::vector<View> views, const Vec3& by) {
    if (has_offset(by))
        for (View& view : views) view.camera = moved(view.camera, by);
    return views;
}

std::vector<CameraKey> moved(std::vector<CameraKey> keys, const Vec3& by) {
    if (has_offset(by))
        for (CameraKey& key : keys) key.camera = moved(key.camera, by);
    return keys;
}

std::string offset_text(const Vec3& offset) {
    return fmt::format("({}, {}, {})", offset.x, offset.y, offset.z);
}

}  // namespace gse
