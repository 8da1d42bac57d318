// A grid of cubes around the source: voted by the masks of all views, or placed by where such things usually
// sit.
#include "engine/edit/placement/voxel_region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>

#include "engine/base/check.h"
#include "engine/base/random.h"
#include "engine/edit/placement/related_place.h"
#include "engine/edit/placement/upright_bounds.h"
#include "engine/language/grammar.h"
#include "engine/localize/clusters.h"

namespace gse::edit {
namespace {

std::vector<Vec3> slice(const std::vector<Vec3>& points, double low, double high) {
    std::vector<Vec3> result;
    for (const auto& point : points)
        if (point.y >= low && point.y <= high) result.push_back(point);
    return result.empty() ? points : result;
}

/// Votes of the views on one point.
struct Vote {
    int counted = 0, seen = 0, covered = 0;  // in the picture; of those not hidden; of those inside the mask
};

Vote vote_at(const RegionSearch& search, const Vec3& world, double side) {
    Vote vote;
    for (std::size_t v = 0; v < search.views.size(); ++v) {
        const Mask& mask = search.masks[v];
        if (mask.data.empty()) continue;
        const Camera& camera = search.views[v].camera;
        const Vec3 p = camera.to_camera(world);
        if (p.z <= 0) continue;
        const double px = camera.fx * p.x / p.z + camera.cx, py = camera.fy * p.y / p.z + camera.cy;
        if (!(px >= 0 && py >= 0 && px < mask.width && py < mask.height)) continue;
        const int x = static_cast<int>(px), y = static_cast<int>(py);
        ++vote.counted;
        const double surface = search.depths.empty() ? 0 : search.depths[v].at(x, y, 0);
        if (surface > 0 && p.z > surface + side) continue;  // hidden
        ++vote.seen;
        vote.covered += mask.at(x, y) != 0 ? 1 : 0;
    }
    return vote;
}

/// The chosen cells that touch `seed` by faces, over any number of steps; marks them in `done`.
std::vector<std::size_t> component(const Grid& grid, const std::vector<std::uint8_t>& chosen,
                                   std::size_t seed, std::vector<std::uint8_t>& done) {
    const auto nx = static_cast<std::size_t>(grid.count[0]), ny = static_cast<std::size_t>(grid.count[1]);
    std::vector<std::size_t> part{seed};
    const auto visit = [&](std::size_t cell) {
        if (chosen[cell] == 0 || done[cell] != 0) return;
        done[cell] = 1;
        part.push_back(cell);
    };
    done[seed] = 1;
    for (std::size_t next = 0; next < part.size(); ++next) {
        const std::size_t cell = part[next];
        const std::array<std::size_t, 3> at{cell % nx, cell / nx % ny, cell / (nx * ny)};
        const std::array<std::size_t, 3> step{1, nx, nx * ny};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (at[axis] > 0) visit(cell - step[axis]);
            if (at[axis] + 1 < static_cast<std::size_t>(grid.count[axis])) visit(cell + step[axis]);
        }
    }
    return part;
}

/// The largest connected set of chosen cells, and every other of at least `share` of its size: wings are two.
std::vector<std::size_t> large_components(const Grid& grid, const std::vector<std::uint8_t>& chosen,
                                          double share) {
    std::vector<std::uint8_t> done(chosen.size(), 0);
    std::vector<std::vector<std::size_t>> parts;
    std::size_t largest = 0;
    for (std::size_t seed = 0; seed < chosen.size(); ++seed) {
        if (chosen[seed] == 0 || done[seed] != 0) continue;
        parts.push_back(component(grid, chosen, seed, done));
        largest = std::max(largest, parts.back().size());
    }
    std::vector<std::size_t> cells;
    for (const auto& part : parts)
        if (static_cast<double>(part.size()) >= share * static_cast<double>(largest))
            cells.insert(cells.end(), part.begin(), part.end());
    std::sort(cells.begin(), cells.end());
    return cells;
}

/// A cap on the top of the source: as wide as what is up there, about as high as its radius, narrower
/// upwards.
VoxelRegion top_region(const Frame& frame, const std::vector<Vec3>& points, int cells) {
    constexpr double TipShare = 0.08, HeadShare = 0.25, HeadReach = 0.32;            // of the height
    constexpr double WiderThanHead = 1.2, Below = 0.25, Above = 0.95, Taper = 0.45;  // of the radius
    const Box all = trimmed_box(points, BoundsTrim);
    const double height = all.size().y;
    const Vec3 tip = trimmed_box(slice(points, all.high.y - TipShare * height, all.high.y), 0.05).centre();
    const Vec3 base{tip.x, all.high.y, tip.z};
    std::vector<double> distances{0.1 * height};
    for (const auto& p : slice(points, all.high.y - HeadShare * height, all.high.y)) {
        const double distance = std::hypot(p.x - base.x, p.z - base.z);
        if (distance < HeadReach * height) distances.push_back(distance);  // the rest is not below the tip
    }
    const double radius = WiderThanHead * quantile(distances, 0.9);
    Box box{base - Vec3{radius, Below * radius, radius}, base + Vec3{radius, Above * radius, radius}};
    return fill(frame, make_grid(box, cells / 2), [=](const Vec3& p) {
        const Vec3 d = p - base;
        const double rise = std::max(0.0, d.y) / (Above * radius);
        return std::hypot(d.x, d.z) <= radius * (1 - Taper * rise) && rise <= 1;
    });
}

/// A thin plate before the face.
VoxelRegion front_region(const Frame& frame, const std::vector<Vec3>& points, int cells) {
    const Box all = trimmed_box(points, BoundsTrim);
    const double height = all.size().y;
    const auto face = slice(points, all.low.y + 0.72 * height, all.low.y + 0.88 * height);
    const Box box = trimmed_box(face, 0.03);
    Box plate;
    plate.low = {box.centre().x - 0.45 * box.size().x, all.low.y + 0.74 * height, box.high.z - 0.06 * height};
    plate.high = {box.centre().x + 0.45 * box.size().x, all.low.y + 0.86 * height,
                  box.high.z + 0.06 * height};
    return fill(frame, make_grid(plate, cells / 2), [](const Vec3&) { return true; });
}

/// A ring around the place between head and body.
VoxelRegion neck_region(const Frame& frame, const std::vector<Vec3>& points, int cells) {
    const Box all = trimmed_box(points, BoundsTrim);
    const double height = all.size().y, low = all.low.y + 0.52 * height, high = all.low.y + 0.68 * height;
    const Box box = trimmed_box(slice(points, low, high), 0.05);
    const double radius = std::max(0.5 * std::max(box.size().x, box.size().z), 0.05 * height);
    const Vec3 centre = box.centre();
    const Vec3 reach{1.2 * radius, 0.5 * (high - low), 1.2 * radius};
    const Vec3 middle{centre.x, 0.5 * (low + high), centre.z};
    return fill(frame, make_grid({middle - reach, middle + reach}, cells), [=](const Vec3& p) {
        const double distance = std::hypot(p.x - centre.x, p.z - centre.z);
        return distance >= 0.8 * radius && distance <= 1.2 * radius;
    });
}

/// A shell around the whole source, open below.
VoxelRegion around_region(const Frame& frame, const std::vector<Vec3>& points, int cells) {
    const Box all = trimmed_box(points, BoundsTrim);
    const Vec3 centre = all.centre(), half = all.size() * 0.5;
    const double wide = std::max(half.x, half.z);
    const Vec3 reach{1.25 * wide, 1.3 * half.y, 1.25 * wide};
    return fill(frame, make_grid({centre - reach, centre + reach}, cells), [=](const Vec3& p) {
        const Vec3 d = p - centre;
        const double distance = std::hypot(d.x / wide, d.y / half.y, d.z / wide);
        return distance >= 0.85 && distance <= 1.25 && d.y > -half.y;
    });
}

/// Tells whether a neighbour by a face is not among the cells (1 in `inside`).
bool on_surface(const Grid& grid, const std::vector<std::uint8_t>& inside, std::size_t cell) {
    const auto nx = static_cast<std::size_t>(grid.count[0]), ny = static_cast<std::size_t>(grid.count[1]);
    const std::array<std::size_t, 3> at{cell % nx, cell / nx % ny, cell / (nx * ny)}, step{1, nx, nx * ny};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (at[axis] == 0 || inside[cell - step[axis]] == 0) return true;
        if (at[axis] + 1 == static_cast<std::size_t>(grid.count[axis]) || inside[cell + step[axis]] == 0)
            return true;
    }
    return false;
}

/// The connected cells on which at least `level` of the views agree; empty when they are too few, or too many
/// to be a place.
VoxelRegion region_at(const Grid& grid, const Frame& frame, const std::vector<double>& agreement,
                      double level, const RegionParameters& parameters) {
    std::vector<std::uint8_t> chosen(grid.size());
    for (std::size_t cell = 0; cell < grid.size(); ++cell) chosen[cell] = agreement[cell] >= level ? 1 : 0;
    const auto cells = large_components(grid, chosen, parameters.least_part);
    const double share = static_cast<double>(cells.size()) / static_cast<double>(grid.size());
    if (static_cast<int>(cells.size()) < parameters.least_cells || share > parameters.most_volume) return {};
    VoxelRegion region;
    region.side = grid.side;
    region.origin = "attention";
    std::fill(chosen.begin(), chosen.end(), std::uint8_t{0});
    for (const std::size_t cell : cells) chosen[cell] = 1;
    for (const std::size_t cell : cells) {
        region.centres.push_back(frame.to_world(grid.centre(cell)));
        if (on_surface(grid, chosen, cell)) region.shell.push_back(region.centres.back());
        region.agreement += agreement[cell] / static_cast<double>(cells.size());
    }
    return region;
}

/// Mean intersection over union of what the region covers with what the masks say, over the views that vote.
double silhouette_match(const RegionSearch& search, const VoxelRegion& region) {
    double sum = 0;
    std::size_t views = 0;
    for (std::size_t v = 0; v < search.views.size(); ++v) {
        const Mask& mask = search.masks[v];
        if (mask.data.empty()) continue;
        sum += localize::mask_iou(mask, region_mask(region, search.views[v].camera,
                                                    search.depths.empty() ? nullptr : &search.depths[v]));
        ++views;
    }
    return views > 0 ? sum / static_cast<double>(views) : 0;
}

/// Box in which votes for worn or added parts count: around the source, down to its foot (a label may lack
/// the part that carries an object) and above.
Box worn_box(const std::vector<Vec3>& points, const UprightBounds& standing, const Frame& frame) {
    Box box = trimmed_box(points, BoundsTrim);
    if (standing.found()) box.low.y = std::min(box.low.y, frame.to_frame(standing.foot).y);
    const Vec3 size = box.size();
    const double wide = 0.35 * std::max({size.x, size.y, size.z});
    box.low = box.low - Vec3{wide, 0.05 * size.y, wide};
    box.high = box.high + Vec3{wide, 0.6 * size.y, wide};
    return box;
}

/// The room that the relation leaves around a source with these points, if it leaves one of its own.
std::optional<RelatedPlace> related_place(const RegionSearch& search, const Frame& frame,
                                          const std::vector<Vec3>& points) {
    if (search.relation == language::Relation::None) return std::nullopt;
    RelatedPlace place(search.relation, points, visible_points(search, frame, false));
    if (!place.found()) return std::nullopt;
    return place;
}

/// Share of the views that see a cube whose mask covers it; 0 where too few count, or where the relation does
/// not allow it.
std::vector<double> agreement_of(const RegionSearch& search, const RegionParameters& parameters,
                                 const Frame& frame, const Grid& grid, const RelatedPlace* place,
                                 std::ptrdiff_t voters) {
    constexpr std::size_t cells_at_once = 512;
    std::vector<double> agreement(grid.size(), 0);
    const auto some = [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t cell = begin; cell < end; ++cell) {
            if (place != nullptr && !place->allows(grid.centre(cell))) continue;
            const Vote vote = vote_at(search, frame.to_world(grid.centre(cell)), grid.side);
            if (vote.counted * 2 < voters || vote.seen < parameters.least_seen * vote.counted) continue;
            if (vote.seen == 0 || vote.covered < parameters.least_covered * vote.counted) continue;
            agreement[cell] = static_cast<double>(vote.covered) / vote.seen;
        }
    };
    if (search.threads != nullptr) search.threads->parallel_for(grid.size(), cells_at_once, some);
    else some(0, grid.size(), 0);
    return agreement;
}

}  // namespace

VoxelRegion vote_region(const RegionSearch& search, const RegionParameters& parameters) {
    GSE_CHECK_EQ(search.masks.size(), search.views.size());
    GSE_CHECK_EQ(search.source_bits.size(), search.gaussians.size());
    const Frame frame = make_frame(search.up, search.front);
    const auto points = visible_points(search, frame, true);
    const auto voters = std::count_if(search.masks.begin(), search.masks.end(),
                                      [](const Mask& m) { return !m.data.empty(); });
    if (points.empty() || voters == 0) return {};
    const auto place = related_place(search, frame, points);
    const auto worn = [&] {
        const bool known = search.standing.found();
        return worn_box(points,
                        known ? search.standing
                              : standing_of(search.gaussians, search.source_bits, search.up, search.front),
                        frame);
    };
    const Grid grid = make_grid(place ? place->box() : worn(), parameters.cells);
    const auto agreement = agreement_of(search, parameters, frame, grid, place ? &*place : nullptr, voters);
    const double best = *std::max_element(agreement.begin(), agreement.end());
    if (best < parameters.least_agreement) return {};
    std::vector<double> levels;
    for (double level = best; level >= parameters.lowest_agreement; level -= parameters.level_step)
        levels.push_back(level);
    std::vector<VoxelRegion> candidates(levels.size());
    std::vector<double> matches(levels.size(), 0);
    auto of_parts = parameters;
    if (place) of_parts.least_part = 1;  // one thing on one side
    const auto some = [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t i = begin; i < end; ++i) {
            candidates[i] = region_at(grid, frame, agreement, levels[i], of_parts);
            if (place && !place->suits(candidates[i], frame)) candidates[i] = {};
            matches[i] = candidates[i].empty() ? 0 : silhouette_match(search, candidates[i]);
        }
    };
    if (search.threads != nullptr) search.threads->parallel_for(levels.size(), 1, some);
    else some(0, levels.size(), 0);
    // Choice: of equal ones the smallest region.
    const auto chosen = std::max_element(matches.begin(), matches.end());
    return chosen == matches.end() || *chosen <= 0
               ? VoxelRegion{}
               : candidates[static_cast<std::size_t>(chosen - matches.begin())];
}

VoxelRegion anchor_region(const RegionSearch& search, const std::string& place, int cells) {
    const Frame frame = make_frame(search.up, search.front);
    const auto points = visible_points(search, frame, true);
    if (points.empty()) return {};
    VoxelRegion region = place == "front"    ? front_region(frame, points, cells)
                         : place == "neck"   ? neck_region(frame, points, cells)
                         : place == "around" ? around_region(frame, points, cells)
                                             : top_region(frame, points, cells);
    region.origin = place == "front" || place == "neck" || place == "around" ? place : "top";
    return region;
}

VoxelRegion usual_region(const RegionSearch& search, const std::string& thing, int cells) {
    const Frame frame = make_frame(search.up, search.front);
    const auto points = visible_points(search, frame, true);
    if (points.empty()) return {};
    if (const auto place = related_place(search, frame, points)) return place->usual(frame, cells);
    return anchor_region(search, language::usual_place(thing), cells);
}

GaussianData seed_splats(const VoxelRegion& region, int count, int sh_degree, std::uint64_t seed,
                         double opacity) {
    GaussianData data;
    data.sh_degree = sh_degree;
    if (region.empty() || count <= 0) return data;
    data.resize(static_cast<std::size_t>(count));  // colour coefficients stay 0: neutral grey
    constexpr double OverlapFactor = 0.55;         // standard deviation over the room of one splat
    const double volume =
        static_cast<double>(region.centres.size()) * region.side * region.side * region.side;
    const auto scale = static_cast<float>(std::log(OverlapFactor * std::cbrt(volume / count)));
    const auto logit = static_cast<float>(std::log(opacity / (1 - opacity)));
    Random random = Random::stream(seed, 101);
    for (std::size_t row = 0; row < data.size(); ++row) {
        const Vec3& cell = region.centres[random.below(region.centres.size())];
        for (int axis = 0; axis < 3; ++axis) {
            const std::size_t i = row * 3 + static_cast<std::size_t>(axis);
            data.position[i] = static_cast<float>(cell[axis] + region.side * (random.uniform() - 0.5));
            data.log_scale[i] = scale;
        }
        data.rotation[row * 4] = 1;
        data.opacity_logit[row] = logit;
    }
    return data;
}

Mask region_mask(const VoxelRegion& region, const Camera& camera, const Image* depth) {
    Mask mask(camera.width, camera.height);
    // Half the diagonal of a face of side 1: neighbours leave no gap, and reach little beyond.
    constexpr double Corner = 0.71;
    // A ray that meets an inner cube meets one of the shell before, and what is drawn of a cube reaches as
    // far as the corners of a face.
    for (const auto& centre : region.shell.empty() ? region.centres : region.shell) {
        const Vec3 p = camera.to_camera(centre);
        if (p.z <= region.side) continue;
        const double x = camera.fx * p.x / p.z + camera.cx, y = camera.fy * p.y / p.z + camera.cy;
        const double radius = Corner * region.side * camera.fx / p.z;
        const auto limit = [](double value, int size) {
            return static_cast<int>(std::clamp(value, 0.0, size + 0.0));
        };
        const double reach = std::max(radius, 0.71) * std::max(radius, 0.71);
        for (int v = limit(y - radius, mask.height); v < limit(y + radius + 1, mask.height);
             ++v) {  // pixel centres in the circle
            const double rest = reach - (v + 0.5 - y) * (v + 0.5 - y);
            if (rest < 0) continue;
            const double half = std::sqrt(rest);
            const int first = limit(std::ceil(x - half - 0.5), mask.width),
                      end = limit(std::floor(x + half - 0.5) + 1, mask.width);
            for (int u = first; u < end; ++u) {
                const float surface = depth != nullptr ? depth->at(u, v, 0) : 0;
                if (surface <= 0 || p.z <= surface + region.side) mask.at(u, v) = 1;
            }
        }
    }
    return mask;
}

}  // namespace gse::edit
