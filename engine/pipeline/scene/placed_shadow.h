// Shadow of a thing that is moved, resized or copied: it goes along on the ground.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/edit/placement/rearrangement.h"
#include "engine/heal/heal.h"

namespace gse::pipeline {

/// Map of the shadow of a thing under a map of the thing. It moves and grows, and does not turn: the light
/// stays where it is. `thing` marks rows of the scene [N]; `foot` is the middle of where it stands.
Affine map_of_shadow(const GaussianSet& scene, std::span<const std::uint8_t> thing, const Vec3& up,
                     const Vec3& foot, const Affine& place);

/// True for a map under which a thing stands where it stood, as large as before.
bool keeps_foot(const edit::UprightBounds& thing, const Affine& place);

/// Light of each row of the set [rows] in the shadow under all these maps of it; 1 = no shadow.
std::vector<Vec3> light_in_shadows(const GaussianSet& set, const heal::Shadow& shadow,
                                   std::span<const Affine> maps);

/// Factors of the scene's colours [N] once the thing stands at its new places. The ground that it leaves is
/// lit again. What its shadow comes to lie on is darker. Rows of the thing have 1.
std::vector<Vec3> light_after(const GaussianSet& scene, std::span<const std::uint8_t> thing,
                              const heal::Shadow& shadow, std::span<const Affine> maps, bool leaves_place);

}  // namespace gse::pipeline
