// Shared arithmetic of the scene formats.
#include "engine/io/bytes/encoding.h"

#include <algorithm>

#include "engine/base/log.h"
#include "engine/scene/scene.h"

namespace gse::io {
namespace {

/// Axes that appear to an odd power in each basis function of bands 1 to 3 (3DGS order): bit 0 x, bit 1 y,
/// bit 2 z.
constexpr std::array<unsigned, 15> OddAxes = {
    2, 4, 1,             // y, z, x
    3, 6, 0, 5, 0,       // xy, yz, zz.., xz, xx-yy
    2, 7, 2, 4, 1, 4, 1  // y.., xyz, y.., z.., x.., z.., x..
};

int sign_of(unsigned odd_axes, const AxisSigns& signs) {
    return ((odd_axes & 1) != 0 ? signs.x : 1) * ((odd_axes & 2) != 0 ? signs.y : 1) *
           ((odd_axes & 4) != 0 ? signs.z : 1);
}

void scale_columns(std::vector<float>& values, std::size_t stride, std::span<const float> factors,
                   std::size_t offset) {
    for (std::size_t row = 0; row + stride <= values.size(); row += stride)
        for (std::size_t i = 0; i < factors.size(); ++i) values[row + offset + i] *= factors[i];
}

}  // namespace

float logit_from_opacity(double opacity) {
    const double inside = std::clamp(opacity, OpacityMargin, 1 - OpacityMargin);
    return static_cast<float>(std::log(inside / (1 - inside)));
}

const std::array<float, 256>& byte_logits() {
    static const std::array<float, 256> table = [] {
        std::array<float, 256> values{};
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] = logit_from_opacity(static_cast<double>(i) / 255);
        return values;
    }();
    return table;
}

double opacity_from_logit(double logit) { return 1 / (1 + std::exp(-logit)); }

std::array<double, 4> unit_quaternion(const float* q) {
    const double norm = std::sqrt(static_cast<double>(q[0]) * q[0] + static_cast<double>(q[1]) * q[1] +
                                  static_cast<double>(q[2]) * q[2] + static_cast<double>(q[3]) * q[3]);
    if (!(norm > 0) || !std::isfinite(norm)) return {1, 0, 0, 0};
    return {q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm};
}

void flip_axes(GaussianData& data, const AxisSigns& signs) {
    if (signs.identity()) return;
    const std::array<float, 3> position = {static_cast<float>(signs.x), static_cast<float>(signs.y),
                                           static_cast<float>(signs.z)};
    // S R S is a rotation for every flip S, and S D S = D for the axes of the ellipsoid.
    const std::array<float, 3> rotation = {position[1] * position[2], position[0] * position[2],
                                           position[0] * position[1]};
    scale_columns(data.position, 3, position, 0);
    scale_columns(data.rotation, 4, rotation, 1);
    std::vector<float> sh;
    for (std::size_t k = 0; k < rest_of_degree(data.sh_degree); ++k)
        sh.insert(sh.end(), 3, static_cast<float>(sign_of(OddAxes[k], signs)));
    if (!sh.empty()) scale_columns(data.sh, data.sh_stride(), sh, 3);
}

int degree_of_rest(std::size_t rest) {
    for (int degree = 0; degree <= MaxShDegree; ++degree)
        if (rest_of_degree(degree) == rest) return degree;
    return -1;
}

GaussianSet storable_rows(const GaussianSet& set, const char* format) {
    GaussianSet usable = drop_unusable(set);
    if (usable.size() != set.size())
        log::warning("{} splats with NaN or infinite values are left out; {} cannot hold them",
                     set.size() - usable.size(), format);
    return usable;
}

}  // namespace gse::io
