// Plain double-precision implementations. Nothing here is in a hot loop.
#include "engine/evaluate/metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "engine/base/check.h"

namespace gse::evaluate {
namespace {

Overlap overlap_from_counts(double both, double predicted, double truth) {
    Overlap result;
    const double either = predicted + truth - both;
    result.iou = either > 0 ? both / either : 1;
    result.precision = predicted > 0 ? both / predicted : 1;
    result.recall = truth > 0 ? both / truth : 1;
    result.f1 = predicted + truth > 0 ? 2 * both / (predicted + truth) : 1;
    return result;
}

/// Mask pixels with a 4-neighbour outside the mask or outside the picture.
std::vector<std::array<int, 2>> outline(const Mask& mask) {
    std::vector<std::array<int, 2>> pixels;
    const auto filled = [&](int x, int y) {
        return x >= 0 && y >= 0 && x < mask.width && y < mask.height && mask.at(x, y) != 0;
    };
    for (int y = 0; y < mask.height; ++y)
        for (int x = 0; x < mask.width; ++x)
            if (filled(x, y) &&
                !(filled(x - 1, y) && filled(x + 1, y) && filled(x, y - 1) && filled(x, y + 1)))
                pixels.push_back({x, y});
    return pixels;
}

/// Share of `points` with a point of `others` within `tolerance`.
double matched_share(const std::vector<std::array<int, 2>>& points, const Mask& others, double tolerance) {
    if (points.empty()) return 1;
    const int reach = static_cast<int>(std::floor(tolerance));
    std::size_t matched = 0;
    for (const auto& [x, y] : points) {
        bool found = false;
        for (int dy = -reach; dy <= reach && !found; ++dy)
            for (int dx = -reach; dx <= reach && !found; ++dx) {
                if (dx * dx + dy * dy > tolerance * tolerance) continue;
                const int u = x + dx, v = y + dy;
                found = u >= 0 && v >= 0 && u < others.width && v < others.height && others.at(u, v) != 0;
            }
        matched += found ? 1 : 0;
    }
    return static_cast<double>(matched) / static_cast<double>(points.size());
}

Mask outline_mask(const std::vector<std::array<int, 2>>& pixels, int width, int height) {
    Mask mask(width, height);
    for (const auto& [x, y] : pixels) mask.at(x, y) = 1;
    return mask;
}

void check_same_size(const Image& a, const Image& b, const Region& region) {
    GSE_CHECK_EQ(a.data.size(), b.data.size());
    GSE_CHECK_EQ(a.width, b.width);
    GSE_CHECK(region.mask == nullptr || region.mask->data.size() == a.pixel_count());
}

/// Mean over the region of value(pixel, channel). 0 for an empty region.
template <class F> double region_mean(const Image& image, const Region& region, F&& value) {
    double sum = 0;
    std::size_t count = 0;
    const auto channels = static_cast<std::size_t>(image.channels);
    for (std::size_t pixel = 0; pixel < image.pixel_count(); ++pixel) {
        if (!region.contains(pixel)) continue;
        for (std::size_t c = 0; c < channels; ++c) sum += value(pixel * channels + c);
        count += channels;
    }
    return count > 0 ? sum / static_cast<double>(count) : 0;
}

constexpr int SsimRadius = 5;

std::array<double, 2 * SsimRadius + 1> ssim_window() {
    std::array<double, 2 * SsimRadius + 1> window{};
    double sum = 0;
    for (int i = -SsimRadius; i <= SsimRadius; ++i)
        sum += window[static_cast<std::size_t>(i + SsimRadius)] = std::exp(-i * i / (2 * 1.5 * 1.5));
    for (auto& weight : window) weight /= sum;
    return window;
}

/// Separable Gaussian blur of a plane with zero padding.
std::vector<double> blur(const std::vector<double>& plane, int width, int height) {
    const auto window = ssim_window();
    std::vector<double> rows(plane.size()), result(plane.size());
    const auto at = [width](int x, int y) { return static_cast<std::size_t>(y * width + x); };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int k = -SsimRadius; k <= SsimRadius; ++k)
                if (x + k >= 0 && x + k < width)
                    rows[at(x, y)] += window[static_cast<std::size_t>(k + SsimRadius)] * plane[at(x + k, y)];
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int k = -SsimRadius; k <= SsimRadius; ++k)
                if (y + k >= 0 && y + k < height)
                    result[at(x, y)] += window[static_cast<std::size_t>(k + SsimRadius)] * rows[at(x, y + k)];
    return result;
}

/// SSIM map of one channel.
std::vector<double> ssim_plane(const Image& a, const Image& b, int channel) {
    constexpr double c1 = 1e-4, c2 = 9e-4;
    const std::size_t count = a.pixel_count();
    std::array<std::vector<double>, 5> planes;
    for (auto& plane : planes) plane.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        const auto index = i * static_cast<std::size_t>(a.channels) + static_cast<std::size_t>(channel);
        const double x = a.data[index], y = b.data[index];
        planes[0][i] = x;
        planes[1][i] = y;
        planes[2][i] = x * x;
        planes[3][i] = y * y;
        planes[4][i] = x * y;
    }
    for (auto& plane : planes) plane = blur(plane, a.width, a.height);
    std::vector<double> map(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double mx = planes[0][i], my = planes[1][i];
        const double vx = planes[2][i] - mx * mx, vy = planes[3][i] - my * my, cov = planes[4][i] - mx * my;
        map[i] = (2 * mx * my + c1) * (2 * cov + c2) / ((mx * mx + my * my + c1) * (vx + vy + c2));
    }
    return map;
}

/// A row of each of two sets.
struct RowPair {
    std::size_t a = 0, b = 0;
    bool same_bits(std::span<const float> in_a, std::span<const float> in_b, std::size_t stride) const {
        return std::memcmp(in_a.data() + a * stride, in_b.data() + b * stride, stride * sizeof(float)) == 0;
    }
    bool same(const GaussianSet& in_a, const GaussianSet& in_b) const {
        const auto sh_stride = static_cast<std::size_t>(sh_coefficient_count(in_a.sh_degree())) * 3;
        return same_bits(in_a.position(), in_b.position(), 3) &&
               same_bits(in_a.log_scale(), in_b.log_scale(), 3) &&
               same_bits(in_a.rotation(), in_b.rotation(), 4) &&
               same_bits(in_a.opacity_logit(), in_b.opacity_logit(), 1) &&
               same_bits(in_a.sh(), in_b.sh(), sh_stride);
    }
};

/// Difference of two values. A value that is not finite counts as wholly different, never as equal.
double value_difference(const Image& a, const Image& b, std::size_t i) {
    const double difference = static_cast<double>(a.data[i]) - b.data[i];
    return std::isfinite(difference) ? difference : 1;
}

/// Largest channel difference of a pixel.
double pixel_difference(const Image& a, const Image& b, std::size_t pixel) {
    double largest = 0;
    for (int c = 0; c < a.channels; ++c) {
        const auto i = pixel * static_cast<std::size_t>(a.channels) + static_cast<std::size_t>(c);
        largest = std::max(largest, std::abs(value_difference(a, b, i)));
    }
    return largest;
}

}  // namespace

Overlap row_overlap(std::span<const std::uint8_t> predicted, std::span<const std::uint8_t> truth,
                    std::span<const double> weights) {
    GSE_CHECK_EQ(predicted.size(), truth.size());
    GSE_CHECK(weights.empty() || weights.size() == truth.size());
    double both = 0, found = 0, wanted = 0;
    for (std::size_t row = 0; row < truth.size(); ++row) {
        const double weight = weights.empty() ? 1 : weights[row];
        if (predicted[row] != 0) found += weight;
        if (truth[row] != 0) wanted += weight;
        if (predicted[row] != 0 && truth[row] != 0) both += weight;
    }
    return overlap_from_counts(both, found, wanted);
}

Overlap mask_overlap(const Mask& predicted, const Mask& truth) {
    return row_overlap(predicted.data, truth.data);
}

double boundary_f(const Mask& predicted, const Mask& truth, double tolerance_px) {
    GSE_CHECK_EQ(predicted.data.size(), truth.data.size());
    const auto found = outline(predicted), wanted = outline(truth);
    if (found.empty() != wanted.empty()) return 0;
    const double precision =
        matched_share(found, outline_mask(wanted, truth.width, truth.height), tolerance_px);
    const double recall = matched_share(wanted, outline_mask(found, truth.width, truth.height), tolerance_px);
    return precision + recall > 0 ? 2 * precision * recall / (precision + recall) : 0;
}

double boundary_tolerance_px(int width, int height) {
    return std::max(1.0, BoundaryToleranceShare * std::hypot(width, height));
}

double psnr_db(const Image& a, const Image& b, const Region& region) {
    check_same_size(a, b, region);
    const double error = region_mean(a, region, [&](std::size_t i) {
        const double difference = value_difference(a, b, i);
        return difference * difference;
    });
    return error > 0 ? std::min(PsnrLimitDb, -10 * std::log10(error)) : PsnrLimitDb;
}

double mean_absolute_error(const Image& a, const Image& b, const Region& region) {
    check_same_size(a, b, region);
    return region_mean(a, region, [&](std::size_t i) { return std::abs(value_difference(a, b, i)); });
}

double ssim(const Image& a, const Image& b, const Region& region) {
    check_same_size(a, b, region);
    double sum = 0;
    std::size_t count = 0;
    for (int channel = 0; channel < a.channels; ++channel) {
        const auto map = ssim_plane(a, b, channel);
        for (std::size_t pixel = 0; pixel < map.size(); ++pixel) {
            if (!region.contains(pixel)) continue;
            sum += map[pixel];
            ++count;
        }
    }
    return count > 0 ? sum / static_cast<double>(count) : 1;
}

double gradient_energy(const Image& image, const Region& region) {
    check_same_size(image, image, region);
    const auto width = static_cast<std::size_t>(image.width),
               channels = static_cast<std::size_t>(image.channels);
    double sum = 0;
    std::size_t count = 0;
    for (int y = 0; y + 1 < image.height; ++y)
        for (int x = 0; x + 1 < image.width; ++x) {
            const auto pixel = static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
            if (!region.contains(pixel) || !region.contains(pixel + 1) || !region.contains(pixel + width))
                continue;
            for (int c = 0; c < image.channels; ++c) {
                const double value = image.at(x, y, c), across = image.at(x + 1, y, c) - value,
                             down = image.at(x, y + 1, c) - value;
                sum += across * across + down * down;
            }
            count += channels;
        }
    return count > 0 ? sum / static_cast<double>(count) : 0;
}

double leak_rate(const Image& a, const Image& b, const Region& region, double threshold) {
    check_same_size(a, b, region);
    std::size_t leaked = 0, count = 0;
    for (std::size_t pixel = 0; pixel < a.pixel_count(); ++pixel) {
        if (!region.contains(pixel)) continue;
        leaked += pixel_difference(a, b, pixel) > threshold ? 1 : 0;
        ++count;
    }
    return count > 0 ? static_cast<double>(leaked) / static_cast<double>(count) : 0;
}

Mask changed_pixels(const Image& a, const Image& b, double threshold) {
    check_same_size(a, b, {});
    Mask mask(a.width, a.height);
    for (std::size_t pixel = 0; pixel < a.pixel_count(); ++pixel)
        mask.data[pixel] = pixel_difference(a, b, pixel) > threshold ? 1 : 0;
    return mask;
}

double mean_colour_error(const Image& a, const Image& b, const Region& region) {
    check_same_size(a, b, region);
    std::array<double, 4> sum{};
    std::size_t count = 0;
    for (std::size_t pixel = 0; pixel < a.pixel_count(); ++pixel) {
        if (!region.contains(pixel)) continue;
        for (int c = 0; c < a.channels; ++c) {
            const auto i = pixel * static_cast<std::size_t>(a.channels) + static_cast<std::size_t>(c);
            sum[static_cast<std::size_t>(c)] += value_difference(a, b, i);
        }
        ++count;
    }
    double square = 0;
    for (const double difference : sum) square += difference * difference;
    return count > 0 ? std::sqrt(square) / static_cast<double>(count) : 0;
}

std::size_t changed_rows(const GaussianSet& before, const GaussianSet& after,
                         std::span<const std::uint8_t> counted) {
    GSE_CHECK_EQ(before.sh_degree(), after.sh_degree());
    GSE_CHECK_EQ(counted.size(), before.size());
    std::size_t changed = 0;
    for (std::size_t row = 0; row < before.size(); ++row) {
        if (counted[row] == 0) continue;
        changed += row < after.size() && RowPair{row, row}.same(before, after) ? 0 : 1;
    }
    return changed;
}

std::size_t drifted_rows(const GaussianSet& before, const GaussianSet& after,
                         std::span<const std::int64_t> before_to_after, std::span<const std::uint8_t> label) {
    GSE_CHECK_EQ(before.sh_degree(), after.sh_degree());
    GSE_CHECK_EQ(before_to_after.size(), before.size());
    GSE_CHECK_EQ(label.size(), before.size());
    std::size_t drifted = 0;
    for (std::size_t row = 0; row < before.size(); ++row) {
        if (label[row] != 0) continue;
        const std::int64_t now = before_to_after[row];
        const auto to = static_cast<std::size_t>(now);
        drifted += now >= 0 && to < after.size() && RowPair{row, to}.same(before, after) ? 0 : 1;
    }
    return drifted;
}

}  // namespace gse::evaluate
