// Parts of a scene put in their places and joined.
#pragma once

#include <string>
#include <vector>

#include "engine/scene/scene.h"

namespace gse::io {

/// Place of a part in the world: turned, scaled along its own axes before that, and moved.
struct Placement {
    Quat rotation{1, 0, 0, 0};
    Vec3 scale{1, 1, 1};  // all above 0; their product has an inverse
    Vec3 position{0, 0, 0};

    /// True for a place that changes nothing but the last digits.
    bool identity() const;
};

/// Puts the splats in their place: positions, shapes and every SH band (scene/transform/transformed.h).
void place(GaussianData& data, const Placement& placement);

/// Joins scenes as they are read. The facts are those of the first; each warning comes once.
class JoinedScene {
public:
    void add(Scene part);
    void warn(std::string warning);
    bool empty() const { return parts_.empty(); }
    /// The whole, at the highest SH degree among the parts. Labels stay where there is one part. Throws
    /// OutOfMemory.
    Scene take();

private:
    std::vector<GaussianSet> parts_;
    Scene scene_;
};

}  // namespace gse::io
