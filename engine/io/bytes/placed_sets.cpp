// Places as maps, and parts one behind the other.
#include "engine/io/bytes/placed_sets.h"

#include <algorithm>
#include <utility>

#include "engine/scene/transform/joined_sets.h"
#include "engine/scene/transform/transformed.h"

namespace gse::io {

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
    scene_.gaussians = joined(parts_);
    return std::move(scene_);
}

}  // namespace gse::io
