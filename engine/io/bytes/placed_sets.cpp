// Similarities of splats, and sets one behind the other.
#include "engine/io/bytes/placed_sets.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/memory.h"
#include "engine/io/bytes/encoding.h"
#include "engine/math/sh_projection.h"

namespace gse::io {
namespace {

void append_padded(const std::vector<float>& from, std::size_t from_stride, std::vector<float>& to,
                   std::size_t to_stride) {
    for (std::size_t i = 0; i < from.size(); i += from_stride) {
        to.insert(to.end(), from.begin() + static_cast<std::ptrdiff_t>(i),
                  from.begin() + static_cast<std::ptrdiff_t>(i + from_stride));
        to.insert(to.end(), to_stride - from_stride, 0.0f);
    }
}

GaussianSet concatenate(const std::vector<GaussianSet>& parts) {
    if (parts.size() == 1) return parts.front();
    GaussianData all;
    for (const GaussianSet& part : parts) all.sh_degree = std::max(all.sh_degree, part.sh_degree());
    for (const GaussianSet& part : parts) {
        const GaussianData data = part.to_data();
        append_padded(data.position, 3, all.position, 3);
        append_padded(data.log_scale, 3, all.log_scale, 3);
        append_padded(data.rotation, 4, all.rotation, 4);
        append_padded(data.opacity_logit, 1, all.opacity_logit, 1);
        append_padded(data.sh, data.sh_stride(), all.sh, all.sh_stride());
    }
    return GaussianSet(std::move(all));
}

void turn_colours(GaussianData& data, const Mat3& rotation) {
    if (data.sh_degree == 0) return;
    const ShRotation matrix = sh_rotation(rotation, data.sh_degree);
    const auto count = static_cast<std::size_t>(sh_coefficient_count(data.sh_degree));
    std::array<double, MaxShCoefficients> turned{};
    for (std::size_t row = 0; row < data.size(); ++row)
        for (std::size_t channel = 0; channel < 3; ++channel) {
            float* sh = data.sh.data() + row * data.sh_stride() + channel;
            for (std::size_t to = 1; to < count; ++to) {
                turned[to] = 0;
                for (std::size_t from = 1; from < count; ++from)
                    turned[to] += matrix[to][from] * static_cast<double>(sh[from * 3]);
            }
            for (std::size_t to = 1; to < count; ++to) sh[to * 3] = static_cast<float>(turned[to]);
        }
}

}  // namespace

bool Placement::identity() const {
    constexpr double Rounding = 1e-6;  // of single precision, in which places are written
    return length(position) < Rounding && length(scale - Vec3{1, 1, 1}) < Rounding &&
           length(Vec3{rotation.x, rotation.y, rotation.z}) < Rounding;
}

void place(GaussianData& data, const Placement& placement) {
    if (placement.identity()) return;
    const Mat3 rotation = rotation_matrix(placement.rotation);
    for (std::size_t row = 0; row < data.size(); ++row) {
        float *position = data.position.data() + row * 3, *wxyz = data.rotation.data() + row * 4;
        const Vec3 moved =
            rotation * (Vec3{position[0], position[1], position[2]} * placement.scale) + placement.position;
        const auto own = unit_quaternion(wxyz);
        const Quat turned = placement.rotation * Quat(own[0], own[1], own[2], own[3]);
        for (int axis = 0; axis < 3; ++axis) {
            position[axis] = static_cast<float>(moved[axis]);
            data.log_scale[row * 3 + static_cast<std::size_t>(axis)] +=
                static_cast<float>(std::log(placement.scale[axis]));
        }
        const std::array<double, 4> parts{turned.w, turned.x, turned.y, turned.z};
        std::transform(parts.begin(), parts.end(), wxyz,
                       [](double part) { return static_cast<float>(part); });
    }
    turn_colours(data, rotation);
}

void JoinedScene::add(Scene part) {
    parts_.push_back(part.gaussians);
    bytes_ += part.gaussians.byte_size();
    if (parts_.size() == 1) {
        std::vector<std::string> before = std::move(scene_.info.warnings);
        scene_ = std::move(part);
        for (std::string& warning : before) warn(std::move(warning));
        return;
    }
    scene_.labels = {};
    for (std::string& warning : part.info.warnings) warn(std::move(warning));
}

void JoinedScene::warn(std::string warning) {
    auto& warnings = scene_.info.warnings;
    if (std::find(warnings.begin(), warnings.end(), warning) == warnings.end())
        warnings.push_back(std::move(warning));
}

Scene JoinedScene::take() {
    if (parts_.size() > 1) require_memory(bytes_, "the scene of several parts");
    scene_.gaussians = concatenate(parts_);
    return std::move(scene_);
}

}  // namespace gse::io
