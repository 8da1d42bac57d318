// Maps of a shadow, and the light on the rows around.
#include "engine/pipeline/scene/placed_shadow.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/heal/carried_shade.h"
#include "engine/scene/transform/transformed.h"

namespace gse::pipeline {
namespace {

/// Height along `up` that few of the rows are below.
double lowest_of(const GaussianSet& set, std::span<const std::uint8_t> rows, const Vec3& up) {
    std::vector<double> heights;
    for (std::size_t row = 0; row < rows.size(); ++row) {
        const auto p = set.position().subspan(row * 3, 3);
        if (const double height = dot(up, Vec3{p[0], p[1], p[2]}); rows[row] != 0 && std::isfinite(height))
            heights.push_back(height);
    }
    return heights.empty() ? 0 : edit::quantile(std::move(heights), edit::BoundsTrim);
}

}  // namespace

Affine map_of_shadow(const GaussianSet& scene, std::span<const std::uint8_t> thing, const Vec3& up,
                     const Vec3& foot, const Affine& place) {
    const Vec3 upright = normalized(up);
    const double lifted =
        lowest_of(transformed(scene, thing, place), thing, upright) - lowest_of(scene, thing, upright);
    const Vec3 shift = place(foot) - foot;
    return Affine::move_by(shift + upright * (lifted - dot(shift, upright))) *
           Affine::scale_about(std::cbrt(std::abs(place.determinant())), foot);
}

bool keeps_foot(const edit::UprightBounds& thing, const Affine& place) {
    constexpr double Near = 0.02;  // of the height, and of the size
    return length(place(thing.foot) - thing.foot) < Near * thing.height &&
           std::abs(std::cbrt(std::abs(place.determinant())) - 1) < Near;
}

std::vector<Vec3> light_in_shadows(const GaussianSet& set, const heal::Shadow& shadow,
                                   std::span<const Affine> maps) {
    std::vector<Vec3> light(set.size(), Vec3(1));
    for (const auto& place : maps) {
        const auto shade = heal::carried_shade(shadow, place, set);
        for (std::size_t row = 0; row < light.size(); ++row) light[row] = light[row] * shade[row];
    }
    return light;
}

std::vector<Vec3> light_after(const GaussianSet& scene, std::span<const std::uint8_t> thing,
                              const heal::Shadow& shadow, std::span<const Affine> maps, bool leaves_place) {
    auto light = light_in_shadows(scene, shadow, maps);
    if (leaves_place) {
        const std::array<Affine, 1> where_it_stood{};
        const auto before = light_in_shadows(scene, shadow, where_it_stood);
        for (std::size_t row = 0; row < light.size(); ++row) light[row] = light[row] / before[row];
    }
    for (std::size_t row = 0; row < light.size(); ++row)
        if (thing[row] != 0) light[row] = Vec3(1);
    return light;
}

}  // namespace gse::pipeline
