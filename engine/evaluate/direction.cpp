// Cosines of differences, in double.
#include "engine/evaluate/direction.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/check.h"

namespace gse::evaluate {
namespace {

double length(std::span<const double> vector) {
    double sum = 0;
    for (const double value : vector) sum += value * value;
    return std::sqrt(sum);
}

std::vector<double> unit(std::span<const float> vector) {
    std::vector<double> result(vector.begin(), vector.end());
    const double size = length(result);
    if (size > 0)
        for (auto& value : result) value /= size;
    return result;
}

/// Difference of the unit vectors.
std::vector<double> change(std::span<const float> before, std::span<const float> after) {
    GSE_CHECK_EQ(before.size(), after.size());
    const auto from = unit(before);
    auto result = unit(after);
    for (std::size_t i = 0; i < result.size(); ++i) result[i] -= from[i];
    return result;
}

double cosine_of(std::span<const double> a, std::span<const double> b) {
    GSE_CHECK_EQ(a.size(), b.size());
    const double sizes = length(a) * length(b);
    if (!(sizes > 0)) return 0;
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return std::clamp(sum / sizes, -1.0, 1.0);
}

}  // namespace

double cosine(std::span<const float> a, std::span<const float> b) { return cosine_of(unit(a), unit(b)); }

double direction_score(const DirectionVectors& vectors) {
    const auto picture = change(vectors.image_before, vectors.image_after);
    if (length(picture) < LeastPictureChange) return 0;
    return cosine_of(picture, change(vectors.text_before, vectors.text_after));
}

}  // namespace gse::evaluate
