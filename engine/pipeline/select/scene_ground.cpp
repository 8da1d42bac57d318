// The lowest large flat, grown from its middle.
#include "engine/pipeline/select/scene_ground.h"

#include "engine/base/error.h"
#include "engine/localize/grow_thing.h"
#include "engine/scene/framing.h"

namespace gse::pipeline {
namespace {

constexpr double GroundExtent = 1.2;  // of the scene's radius: voxels fine enough for low things

}  // namespace

std::vector<std::uint8_t> scene_ground(const GaussianSet& set, const Vec3& up, const JobControl& control) {
    const gse::Bounds bounds = framing_bounds(set);
    const auto seed = localize::ground_seed(set.spans(), bounds.centre(), bounds.radius(), up);
    if (!seed) return std::vector<std::uint8_t>(set.size(), 0);
    if (control.stop_requested()) throw Error(ErrorCode::Cancelled, "labelling the ground was stopped");
    return localize::grow_thing(set.spans(), {*seed, up, GroundExtent * bounds.radius(), true}).rows;
}

}  // namespace gse::pipeline
