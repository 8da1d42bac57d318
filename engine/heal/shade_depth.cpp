// Generalised least squares over the channels, then reweighted least squares with total variation.
#include "engine/heal/shade_depth.h"

#include <algorithm>
#include <cmath>

namespace gse::heal {
namespace {

constexpr double NoiseFloor = 0.02;  // standard deviation of a channel's logarithm beside the texture's
constexpr double LargestTint = 1.3;  // of a channel; its inverse is the least
// Weights of the total variation over the noise, in turn.
constexpr std::array Smoothness{0.03, 0.06, 0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0};
// Root mean square beyond that is smooth enough: at most, of the noise, and at least.
constexpr double CalmDepth = 0.02, CalmShare = 0.25, LeastCalm = 0.004;
constexpr double LeastContrastKept = 0.8;         // of the mean near the thing, after smoothing
constexpr double LeastStep = 0.01;                // in logarithms, below which steps count by their squares
constexpr double DeepShare = 0.7;                 // of the deepest shadow, from which the tint is measured
constexpr double LeastDepth = 0.13;               // that has a tint
constexpr double MostLoss = 1.6;                  // factor of a depth that smoothing made too small
constexpr int DepthRounds = 8, DepthSweeps = 40;  // of the weights, and of the sums between
constexpr double DepthRelax = 1.0;                // over-relaxation

double mean(const Vec3& v) { return (v.x + v.y + v.z) / 3; }

/// Covariance of the channels over some rows, with the noise's floor.
Mat3 covariance(const std::vector<ShadeRow>& rows, const std::vector<std::uint32_t>& some) {
    Mat3 sum;
    double all = 0;
    for (const auto i : some) all += rows[i].trust;
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) {
            sum(r, c) = r == c ? NoiseFloor * NoiseFloor : 0;
            for (const auto i : some) sum(r, c) += rows[i].trust * rows[i].off[r] * rows[i].off[c] / all;
        }
    return sum;
}

/// Solution of m v = right for a symmetric positive matrix.
Vec3 solved(Mat3 m, Vec3 right) {
    for (int k = 0; k < 3; ++k)
        for (int r = k + 1; r < 3; ++r) {
            const double factor = m(r, k) / m(k, k);
            for (int c = k; c < 3; ++c) m(r, c) -= factor * m(k, c);
            right[r] -= factor * right[k];
        }
    for (int k = 2; k >= 0; --k) {
        for (int c = k + 1; c < 3; ++c) right[k] -= m(k, c) * right[c];
        right[k] /= m(k, k);
    }
    return right;
}

class Smoother {
public:
    explicit Smoother(const std::vector<ShadeRow>& rows) : rows_(rows), weights_(rows.size()) {}

    /// Minimises sum (value - depth)^2 / 2 + weight * sum |step|, with a soft absolute value for both.
    void smooth(const std::vector<double>& value, double weight, double noise, std::vector<double>& depth) {
        depth = value;
        for (int round = 0; round < DepthRounds; ++round) {
            const double least = std::max(LeastStep, noise * std::pow(0.5, round));
            for (std::size_t i = 0; i < rows_.size(); ++i)
                for (std::size_t k = 0; k < rows_[i].count; ++k) {
                    const double step = depth[i] - depth[rows_[i].beside[k]];
                    weights_[i][k] = weight / std::sqrt(step * step + least * least);
                }
            for (int sweep = 0; sweep < DepthSweeps; ++sweep)
                for (std::size_t i = 0; i < rows_.size(); ++i) {
                    const double off = (value[i] - depth[i]) / (2 * noise);
                    const double trust = rows_[i].trust / std::sqrt(1 + off * off);
                    double sum = trust * value[i], all = trust + 1e-9;
                    for (std::size_t k = 0; k < rows_[i].count; ++k)
                        sum += weights_[i][k] * depth[rows_[i].beside[k]], all += weights_[i][k];
                    depth[i] += DepthRelax * (sum / all - depth[i]);
                }
        }
    }

private:
    const std::vector<ShadeRow>& rows_;
    std::vector<std::array<double, 12>> weights_;
};

double spread_of(const std::vector<double>& depth, const std::vector<std::uint32_t>& some) {
    double sum = 0;
    for (const auto i : some) sum += std::min(depth[i] * depth[i], 1.0);
    return std::sqrt(sum / static_cast<double>(some.size()));
}

double mean_of(const std::vector<double>& depth, const std::vector<std::uint32_t>& some) {
    double sum = 0;
    for (const auto i : some) sum += depth[i];
    return some.empty() ? 0 : sum / static_cast<double>(some.size());
}

/// Factor that gives the depth back what smoothing took.
double loss(const std::vector<ShadeRow>& rows, const std::vector<double>& value,
            const std::vector<double>& depth) {
    double both = 1e-9, squared = 1e-9, deepest = 0;
    for (const auto d : depth) deepest = std::min(deepest, d);
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (depth[i] < 0.5 * deepest)
            both += rows[i].trust * value[i] * depth[i], squared += rows[i].trust * depth[i] * depth[i];
    return std::clamp(both / squared, 1.0, MostLoss);
}

/// Depth by the mixture of channels with the least noise, smoothed as little as leaves it calm beyond.
ShadeDepth measured(const std::vector<ShadeRow>& rows, const Mat3& noise, const Vec3& tint,
                    Smoother& smoother, const std::vector<std::uint32_t>& beyond,
                    const std::vector<std::uint32_t>& near) {
    ShadeDepth shade;
    shade.tint = tint;
    const Vec3 mixture = solved(noise, tint);
    const double certainty = dot(mixture, tint), deviation = 1 / std::sqrt(certainty);
    shade.noise = deviation;
    std::vector<double> value;
    for (const auto& row : rows) value.push_back(dot(mixture, row.off) / certainty);
    double used = 0;
    const double contrast = mean_of(value, near);
    std::vector<double> depth;
    for (const double smoothness : Smoothness) {
        smoother.smooth(value, 0.5 * smoothness * deviation, deviation, depth);
        if (!shade.depth.empty() && mean_of(depth, near) > LeastContrastKept * contrast) break;
        used = smoothness;
        shade.depth = depth;
        shade.spread = spread_of(shade.depth, beyond);
        if (shade.spread < std::clamp(CalmShare * deviation, LeastCalm, CalmDepth)) break;
    }
    std::vector<double> again(value.size());
    for (std::size_t i = 0; i < value.size(); ++i) again[i] = 2 * value[i] - shade.depth[i];
    smoother.smooth(again, 0.5 * used * deviation, deviation, shade.depth);
    shade.spread = spread_of(shade.depth, beyond);
    const double factor = loss(rows, value, shade.depth);
    for (auto& d : shade.depth) d *= factor;
    return shade;
}

}  // namespace

ShadeDepth shade_depth(const std::vector<ShadeRow>& rows, const std::vector<std::uint32_t>& beyond,
                       const std::vector<std::uint32_t>& near) {
    const Mat3 noise = covariance(rows, beyond);
    Mat3 plain;
    for (int k = 0; k < 3; ++k) plain(k, k) = noise(0, 0) + noise(1, 1) + noise(2, 2);
    Smoother smoother(rows);
    ShadeDepth shade = measured(rows, plain, Vec3(1), smoother, beyond, near);
    double deepest = 0;
    for (const auto i : near) deepest = std::min(deepest, shade.depth[i]);
    if (deepest > -LeastDepth) return shade;
    Vec3 sum;
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (shade.depth[i] < DeepShare * deepest) sum += rows[i].off * rows[i].trust;
    Vec3 tint = sum / mean(sum);
    for (int c = 0; c < 3; ++c) tint[c] = std::clamp(tint[c], 1 / LargestTint, LargestTint);
    return measured(rows, noise, tint / mean(tint), smoother, beyond, near);
}

}  // namespace gse::heal
