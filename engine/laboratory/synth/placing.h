// Turn, size and place of a thing.
#pragma once

#include "engine/math/vec.h"

namespace gse::synth {

/// Map of space p' = turn p size + shift.
struct Placing {
    Mat3 turn = Mat3::identity();
    double size = 1;
    Vec3 shift{};

    Vec3 operator()(const Vec3& p) const { return turn * p * size + shift; }
};

}  // namespace gse::synth
