// RANSAC (Fischler and Bolles 1981), each plane refined on what lies on it.
#include "engine/heal/supports.h"

#include <algorithm>
#include <cmath>

#include "engine/math/eigen.h"

namespace gse::heal {
namespace {

constexpr std::size_t MostSamples = 3000;
constexpr std::size_t BodyPoints = 500;  // of a body, that distances are measured to
constexpr int Hypotheses = 400;
constexpr int Refinements = 4;
constexpr double NearShare = 0.25;        // of the thing's size: distance at which a row counts half
constexpr double LeastShare = 0.06;       // of the weight of all samples, on a plane
constexpr std::size_t LeastSamples = 16;  // on a plane
constexpr double FarthestShare = 0.4;     // of the thing's size: distance to the nearest row on a plane
constexpr double NormalShare = 0.7;       // of a row's weight, that its normal decides

double weight_on(const PlaneSample& sample, const Plane& plane, double tolerance) {
    const double away = plane.height(sample.at) / tolerance;
    if (std::abs(away) >= 1) return 0;
    const double along = dot(sample.normal, plane.normal);
    return sample.weight * (1 - away * away) * (1 - NormalShare + NormalShare * along * along);
}

Plane guessed(std::span<const PlaneSample> samples, Random& random) {
    const auto& first = samples[random.below(samples.size())];
    const auto& second = samples[random.below(samples.size())];
    const auto& third = samples[random.below(samples.size())];
    if (random.below(2) == 0) return {first.at, first.normal};
    return {first.at, normalized(cross(second.at - first.at, third.at - first.at))};
}

Plane refined(std::span<const PlaneSample> samples, const Plane& plane, double tolerance) {
    double sum = 0;
    Vec3 middle;
    for (const auto& sample : samples) {
        const double w = weight_on(sample, plane, tolerance);
        sum += w, middle += sample.at * w;
    }
    if (!(sum > 0)) return plane;
    middle /= sum;
    Mat3 spread;
    for (const auto& sample : samples) {
        const double w = weight_on(sample, plane, tolerance);
        if (!(w > 0)) continue;
        const Vec3 d = sample.at - middle;
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c) spread(r, c) += w / sum * d[r] * d[c];
    }
    const auto eigen = symmetric_eigen(spread);
    return {middle, eigen.axis[2]};
}

}  // namespace

std::vector<PlaneSample> plane_samples(std::span<const SurfaceRow> rows, const Body& body, double band) {
    std::vector<PlaneSample> samples;
    std::vector<std::size_t> near;
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (body.near(rows[i].at, band)) near.push_back(i);
    const std::size_t count = std::min(MostSamples, near.size());
    const std::size_t asked = std::min(BodyPoints, body.points.size());
    std::vector<double> weights;
    for (std::size_t k = 0; k < count; ++k) {
        const auto& row = rows[near[k * near.size() / count]];
        PlaneSample sample{near[k * near.size() / count], row.at, row.normal, row.weight, FarAway};
        for (std::size_t p = 0; p < asked; ++p) {
            const Vec3 d = row.at - body.points[p * body.points.size() / asked];
            sample.distance = std::min(sample.distance, dot(d, d));
        }
        sample.distance = std::sqrt(sample.distance);
        if (sample.distance > band) continue;
        weights.push_back(row.weight);
        samples.push_back(sample);
    }
    if (samples.empty()) return samples;
    const auto large = weights.begin() + static_cast<std::ptrdiff_t>(weights.size() * 9 / 10);
    std::nth_element(weights.begin(), large, weights.end());
    for (auto& sample : samples) {
        const double away = sample.distance / (NearShare * body.size);
        sample.weight = std::min(sample.weight, *large) / (1 + away * away);
    }
    return samples;
}

std::optional<Plane> find_plane(std::span<const PlaneSample> samples, double total_weight, double tolerance,
                                const Body& body, Random& random) {
    if (samples.size() < LeastSamples) return std::nullopt;
    const auto score = [&](const Plane& plane) {
        double sum = 0;
        for (const auto& sample : samples) sum += weight_on(sample, plane, tolerance);
        return sum;
    };
    Plane best;
    double most = 0;
    for (int i = 0; i < Hypotheses; ++i) {
        const Plane plane = guessed(samples, random);
        if (const double sum = score(plane); sum > most) most = sum, best = plane;
    }
    for (int i = 0; i < Refinements && most > 0; ++i) {
        const Plane plane = refined(samples, best, tolerance);
        if (const double sum = score(plane); sum >= most) most = sum, best = plane;
    }
    std::size_t on_it = 0;
    double nearest = FarAway;
    for (const auto& sample : samples)
        if (weight_on(sample, best, tolerance) > 0) {
            ++on_it;
            nearest = std::min(nearest, sample.distance);
        }
    if (on_it < LeastSamples || most < LeastShare * total_weight) return std::nullopt;
    if (nearest > FarthestShare * body.size) return std::nullopt;
    double side = 0;
    for (const auto& point : body.points) side += best.height(point) > 0 ? 1 : -1;
    if (side < 0) best.normal = -best.normal;
    return best;
}

}  // namespace gse::heal
