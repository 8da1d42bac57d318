// Guess of a scene's up direction from its splats, for files that do not state it.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "engine/scene/layout/up_evidence.h"

namespace gse {

/// Likelihood of each world axis as up, with its sign.
struct UpGuess {
    std::array<double, Directions> likelihood{};  // in the order of direction(); they sum to 1
    std::size_t best = 3;                         // index of the likeliest

    Vec3 up() const { return direction(best); }
    double confidence() const { return likelihood[best]; }
    /// False when the guess must not be taken without asking.
    bool sure() const;
};

/// Guess for the rows with skip[row] == 0; `skip` may be empty. Equal sets give equal guesses. Without any
/// surface only habit decides: -y, the up of COLMAP, is the likeliest, and the guess is not sure.
UpGuess guess_up_axis(const GaussianSet& set, std::span<const std::uint8_t> skip = {});

}  // namespace gse
