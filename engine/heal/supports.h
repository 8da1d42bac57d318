// Planes through the surfaces around a thing, by seeded RANSAC.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "engine/base/random.h"
#include "engine/heal/chart.h"
#include "engine/heal/distance.h"

namespace gse::heal {

/// Row as evidence for a plane.
struct PlaneSample {
    std::size_t index = 0;  // of the row
    Vec3 at, normal;
    double weight = 0;    // less for rows far from the thing
    double distance = 0;  // to the thing, world units
};

/// At most some thousands of evenly chosen rows within `band` of the body.
std::vector<PlaneSample> plane_samples(std::span<const SurfaceRow> rows, const Body& body, double band);

/// Plane with the most weight within `tolerance`; its normal is on the body's side. None where no plane has
/// enough, or where what lies on it is far from the body.
std::optional<Plane> find_plane(std::span<const PlaneSample> samples, double total_weight, double tolerance,
                                const Body& body, Random& random);

}  // namespace gse::heal
