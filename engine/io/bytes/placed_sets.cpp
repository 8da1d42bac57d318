// Places as maps, and sets one behind the other.
#include "engine/io/bytes/placed_sets.h"

#include <algorithm>
#include <utility>

#include "engine/base/memory.h"
#include "engine/scene/transform/transformed.h"

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

}  // namespace

bool Placement::identity() const {
    constexpr double Rounding = 1e-6;  // of single precision, in which places are written
    return length(position) < Rounding && length(scale - Vec3{1, 1, 1}) < Rounding &&
           length(Vec3{rotation.x, rotation.y, rotation.z}) < Rounding;
}

void place(GaussianData& data, const Placement& placement) {
    if (placement.identity()) return;
    Affine affine{rotation_matrix(placement.rotation), placement.position};
    for (int axis = 0; axis < 3; ++axis) affine.linear.columns[axis] *= placement.scale[axis];
    data = transformed(std::move(data), affine);
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
