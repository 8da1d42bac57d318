// Rotations, scales and spherical harmonics of Gaussians under a map, row by row.
#include "engine/scene/transform/transformed.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "engine/base/check.h"
#include "engine/math/eigen.h"
#include "engine/math/sh_projection.h"

namespace gse {
namespace {

constexpr double MapRounding = 8 * std::numeric_limits<double>::epsilon();  // of a few products in double
constexpr double ZeroNorm = 1e-12;  // shorter quaternions are drawn as the identity (raster/conventions.h)

double distance_from_identity(const Mat3& matrix) {
    double worst = 0;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            worst = std::max(worst, std::abs(matrix(row, column) - (row == column ? 1 : 0)));
    return worst;
}

Quat quaternion_of(const float* wxyz) { return Quat(wxyz[0], wxyz[1], wxyz[2], wxyz[3]); }

void write_quaternion(const Quat& q, float* wxyz) {
    wxyz[0] = static_cast<float>(q.w), wxyz[1] = static_cast<float>(q.x);
    wxyz[2] = static_cast<float>(q.y), wxyz[3] = static_cast<float>(q.z);
}

/// A map, taken apart once for all rows.
class RowMap {
public:
    RowMap(const Affine& affine, int sh_degree) : affine_(affine), sh_degree_(sh_degree) {
        const double determinant = affine.determinant();
        GSE_CHECK(determinant != 0 && std::isfinite(determinant));
        moves_ = !affine.is_identity();
        similar_ = affine.is_similarity();
        const Mat3 orthogonal =
            affine.linear == Mat3::identity() ? affine.linear : polar_factor(affine.linear);
        colours_turn_ = sh_degree > 0 && distance_from_identity(orthogonal) > MapRounding;
        if (colours_turn_) colours_ = sh_rotation(orthogonal, sh_degree);
        // A covariance is the same for a matrix and its negative, so that mirror images turn, too.
        const Mat3 proper = determinant < 0 ? Mat3(-orthogonal.columns) : orthogonal;
        turns_ = distance_from_identity(proper) > MapRounding;
        turn_ = turns_ ? quaternion(proper) : Quat(1, 0, 0, 0);
        const double factor = std::cbrt(std::abs(determinant));
        log_factor_ = std::abs(factor - 1) > MapRounding ? std::log(factor) : 0;
    }

    bool moves() const { return moves_; }
    bool scales() const { return !similar_ || log_factor_ != 0; }
    bool turns() const { return !similar_ || turns_; }
    bool colours_turn() const { return colours_turn_; }

    void move(float* position) const {
        const Vec3 moved = affine_({position[0], position[1], position[2]});
        for (int axis = 0; axis < 3; ++axis) position[axis] = static_cast<float>(moved[axis]);
    }

    /// `log_scale` may be null where scales() is false, `rotation` where turns() is.
    void shape(float* log_scale, float* rotation) const {
        if (!similar_) return stretch(log_scale, rotation);
        if (log_factor_ != 0)
            for (int axis = 0; axis < 3; ++axis)
                log_scale[axis] = static_cast<float>(static_cast<double>(log_scale[axis]) + log_factor_);
        if (!turns_) return;
        const Quat own = quaternion_of(rotation);
        write_quaternion(length(own) < ZeroNorm ? turn_ : turn_ * own, rotation);
    }

    /// `sh` [K,3].
    void turn_colours(float* sh) const {
        std::array<double, MaxShCoefficients> before{};
        for (int band = 1; band <= sh_degree_; ++band) {
            const auto first = static_cast<std::size_t>(sh_coefficient_count(band - 1)),
                       end = static_cast<std::size_t>(sh_coefficient_count(band));
            for (std::size_t channel = 0; channel < 3; ++channel) {
                for (std::size_t k = first; k < end; ++k) before[k] = sh[k * 3 + channel];
                for (std::size_t to = first; to < end; ++to) {
                    double sum = 0;
                    for (std::size_t from = first; from < end; ++from)
                        sum += colours_[to][from] * before[from];
                    sh[to * 3 + channel] = static_cast<float>(sum);
                }
            }
        }
    }

private:
    /// New axes are the left singular vectors of A R diag(s), whose square is the covariance.
    void stretch(float* log_scale, float* rotation) const {
        const double largest = std::max({log_scale[0], log_scale[1], log_scale[2]});
        const Quat own = quaternion_of(rotation);
        if (!std::isfinite(largest) || !std::isfinite(length(own)) || std::isnan(log_scale[0]) ||
            std::isnan(log_scale[1]) || std::isnan(log_scale[2]))
            return;
        Mat3 root = affine_.linear * (length(own) < ZeroNorm ? Mat3::identity() : rotation_matrix(own));
        for (int axis = 0; axis < 3; ++axis)
            root.columns[axis] *= std::exp(static_cast<double>(log_scale[axis]) - largest);
        const LeftSingular parts = left_singular(root);
        for (std::size_t axis = 0; axis < 3; ++axis)
            log_scale[axis] = static_cast<float>(std::log(parts.value[axis]) + largest);
        write_quaternion(quaternion(Mat3::from_columns(parts.axis[0], parts.axis[1], parts.axis[2])),
                         rotation);
    }

    Affine affine_;
    int sh_degree_;
    bool moves_ = false, similar_ = false, turns_ = false, colours_turn_ = false;
    Quat turn_{1, 0, 0, 0};
    double log_factor_ = 0;
    ShRotation colours_{};
};

/// Arrays of a set, copied when they are first written.
struct CopiedColumn {
    GaussianSet::Buffer shared;
    std::vector<float> own;

    float* writable() {
        if (own.empty()) own.assign(shared->begin(), shared->end());
        return own.data();
    }
    GaussianSet::Buffer finish() {
        return own.empty() ? shared : std::make_shared<const std::vector<float>>(std::move(own));
    }
};

}  // namespace

GaussianData transformed(GaussianData data, const Affine& affine) {
    if (affine.is_identity()) return data;
    const RowMap map(affine, data.sh_degree);
    for (std::size_t row = 0; row < data.size(); ++row) {
        map.move(&data.position[row * 3]);
        map.shape(&data.log_scale[row * 3], &data.rotation[row * 4]);
        if (map.colours_turn()) map.turn_colours(&data.sh[row * data.sh_stride()]);
    }
    return data;
}

GaussianSet transformed(const GaussianSet& set, std::span<const std::uint8_t> rows, const Affine& affine) {
    GSE_CHECK_EQ(rows.size(), set.size());
    const bool any = std::any_of(rows.begin(), rows.end(), [](std::uint8_t row) { return row != 0; });
    if (!any || affine.is_identity()) return set;
    const RowMap map(affine, set.sh_degree());
    const GaussianBuffers before = set.buffers();
    CopiedColumn position{before.position, {}}, log_scale{before.log_scale, {}},
        rotation{before.rotation, {}}, sh{before.sh, {}};
    float* const positions = map.moves() ? position.writable() : nullptr;
    float* const log_scales = map.scales() ? log_scale.writable() : nullptr;
    float* const rotations = map.turns() ? rotation.writable() : nullptr;
    float* const colours = map.colours_turn() ? sh.writable() : nullptr;
    const std::size_t stride = before.sh->size() / set.size();
    for (std::size_t row = 0; row < rows.size(); ++row) {
        if (rows[row] == 0) continue;
        if (positions != nullptr) map.move(positions + row * 3);
        if (log_scales != nullptr || rotations != nullptr)
            map.shape(log_scales != nullptr ? log_scales + row * 3 : nullptr,
                      rotations != nullptr ? rotations + row * 4 : nullptr);
        if (colours != nullptr) map.turn_colours(colours + row * stride);
    }
    return GaussianSet(GaussianBuffers{set.sh_degree(), position.finish(), log_scale.finish(),
                                       rotation.finish(), before.opacity_logit, sh.finish()});
}

GaussianSet transformed(const GaussianSet& set, const Affine& affine) {
    return transformed(set, std::vector<std::uint8_t>(set.size(), 1), affine);
}

}  // namespace gse
