// Procedural patterns of surfaces, in the space of an object that is one unit high.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/math/vec.h"

namespace gse {

/// Pattern of two colours, or of colours of its own. Object space: y up, the middle of its foot at the
/// origin, about one unit high.
struct SurfacePattern {
    enum class Kind {
        Striped,
        Spotted,
        Checkered,
        Rainbow,
        Marble,
        Brick,
        Rusty,
        Lava,
        Mossy,
        Zebra,
        Leopard,
        Camouflage
    };
    Kind kind = Kind::Striped;
    Vec3 first{0.08, 0.08, 0.09};   // stripes, spots and squares (display values in [0,1]),
    Vec3 second{0.95, 0.95, 0.94};  // and what is between them
    Vec3 offset{};                  // where natural surfaces are cut out of their noise
};

/// Words for patterns: "striped", "marble", ...
const std::vector<std::string>& pattern_words();

/// Pattern that a word of pattern_words() names; none for others.
std::optional<SurfacePattern> pattern_named(const std::string& word);

/// True when the pattern is made of `first` and `second`. Others have colours of their own.
bool takes_colours(SurfacePattern::Kind kind);

/// Display colour in [0,1] at a point of object space.
Vec3 colour_at(const SurfacePattern& pattern, const Vec3& point);

}  // namespace gse
