// Small scenes of coloured balls, views around them and stand-ins for networks, for the tests of the edit.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "engine/base/random.h"
#include "engine/edit/interfaces/interfaces.h"
#include "engine/edit/optimise/edit_loop.h"
#include "engine/edit/search/locate.h"
#include "engine/localize/clusters.h"
#include "tests/unit/edit/requests.h"

namespace gse::test {

/// Two opaque balls beside each other, `count` splats each: the first red, the second green.
struct BallScene {
    GaussianSet set;
    std::vector<std::uint8_t> first;  // [N] rows of the red ball
};

inline BallScene ball_scene(std::size_t count = 150, int sh_degree = 0) {
    BallScene scene;
    GaussianData data;
    data.sh_degree = sh_degree;
    data.resize(2 * count);
    Random random(11);
    for (std::size_t row = 0; row < 2 * count; ++row) {
        const bool first = row < count;
        const double y = 1 - 2 * (static_cast<double>(row % count) + 0.5) / static_cast<double>(count);
        const double angle = 2.399963 * static_cast<double>(row), r = std::sqrt(1 - y * y);
        const Vec3 p =
            Vec3{first ? -0.55 : 0.55, 0, 0} + Vec3{r * std::cos(angle), y, r * std::sin(angle)} * 0.4;
        const double shade = 0.75 - 0.2 * y + random.uniform(-0.05, 0.05);
        const Vec3 colour = (first ? Vec3{0.9, 0.15, 0.1} : Vec3{0.1, 0.7, 0.2}) * shade;
        for (int axis = 0; axis < 3; ++axis) {
            const auto i = static_cast<std::size_t>(axis);
            data.position[row * 3 + i] = static_cast<float>(p[axis]);
            data.log_scale[row * 3 + i] = static_cast<float>(std::log(0.06));
            data.sh[row * data.sh_stride() + i] = static_cast<float>(sh_from_colour(colour[axis]));
        }
        data.rotation[row * 4] = 1;
        data.opacity_logit[row] = 2.5f;
        scene.first.push_back(first ? 1 : 0);
    }
    scene.set = GaussianSet(std::move(data));
    return scene;
}

inline std::vector<View> ball_views(int count, int side) {
    OrbitParameters orbit;
    orbit.radius = 3;
    return orbit_views(orbit, count, side, side);
}

/// Pixels of a view in which rows with a bit are seen: share of alpha above one half.
inline Mask true_mask(const GaussianSet& set, const std::vector<std::uint8_t>& bits, const Camera& camera,
                      raster::Rasterizer& rasterizer) {
    const std::vector<float> values(bits.begin(), bits.end());
    Image seen;
    rasterizer.forward_values(set.spans(), camera, {}, values, seen);
    return localize::threshold_map(seen, 0.5);
}

/// A plan whose label and masks are the red ball's true ones.
inline edit::EditPlan ball_plan(const BallScene& scene, raster::Rasterizer& rasterizer, int views = 6,
                                int side = 32) {
    edit::EditPlan plan;
    plan.views = ball_views(views, side);
    plan.label = scene.first;
    for (const auto& view : plan.views)
        plan.masks.push_back(localize::dilate(true_mask(scene.set, scene.first, view.camera, rasterizer), 2));
    return plan;
}

/// Guidance from a function.
class FunctionGuidance : public edit::Guidance {
public:
    using Function = std::function<edit::GuidanceOutput(const edit::GuidanceInput&)>;
    explicit FunctionGuidance(Function function) : function_(std::move(function)) {}
    edit::GuidanceOutput evaluate(const edit::GuidanceInput& input) override { return function_(input); }

private:
    Function function_;
};

/// Leaves every pixel as it is.
inline FunctionGuidance still() {
    return FunctionGuidance([](const edit::GuidanceInput& input) {
        return edit::GuidanceOutput{Image(input.rendered.width, input.rendered.height, 3), {}};
    });
}

/// Pulls every pixel towards one colour.
inline FunctionGuidance towards(const Vec3& colour) {
    return FunctionGuidance([colour](const edit::GuidanceInput& input) {
        edit::GuidanceOutput output;
        output.gradient = Image(input.rendered.width, input.rendered.height, 3);
        for (std::size_t i = 0; i < output.gradient.data.size(); ++i)
            output.gradient.data[i] =
                input.rendered.data[i] - static_cast<float>(colour[static_cast<int>(i % 3)]);
        return output;
    });
}

inline bool same_bytes(std::span<const float> a, std::span<const float> b) {
    return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](float x, float y) {
               return std::bit_cast<std::uint32_t>(x) == std::bit_cast<std::uint32_t>(y);
           });
}

inline bool same_bytes(const GaussianSet& a, const GaussianSet& b) {
    return same_bytes(a.position(), b.position()) && same_bytes(a.log_scale(), b.log_scale()) &&
           same_bytes(a.rotation(), b.rotation()) && same_bytes(a.opacity_logit(), b.opacity_logit()) &&
           same_bytes(a.sh(), b.sh());
}

}  // namespace gse::test
