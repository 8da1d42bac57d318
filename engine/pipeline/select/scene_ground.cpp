// The lowest large flat, grown from its middle.
#include "engine/pipeline/select/scene_ground.h"

#include "engine/base/error.h"
#include "engine/evaluate/metrics.h"
#include "engine/localize/grow_thing.h"
#include "engine/scene/framing.h"

namespace gse::pipeline {
namespace {

constexpr double LabelOnGround = 0.75;  // of a label's rows, that lie in the scene's ground
constexpr double GroundLabelled = 0.6;  // of the ground's rows, that the label holds
constexpr double GroundExtent = 1.2;    // of the scene's radius: voxels fine enough for low things

}  // namespace

std::vector<std::uint8_t> scene_ground(const GaussianSet& set, const Vec3& up, const JobControl& control) {
    const gse::Bounds bounds = framing_bounds(set);
    const auto seed = localize::ground_seed(set.spans(), bounds.centre(), bounds.radius(), up);
    if (!seed) return std::vector<std::uint8_t>(set.size(), 0);
    if (control.stop_requested()) throw Error(ErrorCode::Cancelled, "labelling the ground was stopped");
    return localize::grow_thing(set.spans(), {*seed, up, GroundExtent * bounds.radius(), true}).rows;
}

std::vector<std::uint8_t> whole_ground(const GaussianSet& set, std::vector<std::uint8_t> label,
                                       const Vec3& up, const JobControl& control) {
    auto ground = scene_ground(set, up, control);
    const auto overlap = evaluate::row_overlap(label, ground);
    return overlap.precision >= LabelOnGround && overlap.recall >= GroundLabelled ? ground : label;
}

}  // namespace gse::pipeline
