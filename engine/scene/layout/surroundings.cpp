// A scene's dense core, and tests of what lies far around it.
#include "engine/scene/layout/surroundings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <unordered_map>

#include "engine/math/framing.h"
#include "engine/math/quantile.h"
#include "engine/scene/scene.h"

namespace gse {
namespace {

constexpr std::size_t LeastRows = 100;        // fewer have no dense core
constexpr std::size_t MostSearched = 200000;  // rows, evenly chosen
constexpr double CoreShare = 0.4;             // of the rows: what a core holds at least
constexpr double EndShare = 0.02;             // of the rows at either end of an axis, outside robust bounds
constexpr double LeastReach = 1.3;            // robust bounds over those of the core: below, nothing is far
constexpr double FarReach = 1.5;              // of the core's robust bounds: what lies beyond is far
constexpr double ThinnestSide = 0.2;          // of the longest: flat cores are this thick

/// Rows that are looked at, by their index.
using Indices = std::vector<std::uint32_t>;

Vec3 point_of(const VisibleRows& rows, std::uint32_t index) {
    const float* p = &rows.position[index * std::size_t{3}];
    return {p[0], p[1], p[2]};
}

/// Bounds of the rows without `share` of them at either end of each axis.
Bounds bounds_without(const VisibleRows& rows, const Indices& indices, double share) {
    Bounds bounds;
    std::vector<double> values(indices.size());
    for (int axis = 0; axis < 3; ++axis) {
        std::transform(indices.begin(), indices.end(), values.begin(),
                       [&](std::uint32_t i) { return point_of(rows, i)[axis]; });
        bounds.low[axis] = nearest_quantile(values, share);
        bounds.high[axis] = nearest_quantile(values, 1 - share);
    }
    return bounds;
}

double longest_side(const Bounds& bounds) {
    const Vec3 sides = bounds.high - bounds.low;
    return std::max({sides.x, sides.y, sides.z});
}

/// Bounds around the same centre, `factor` as large, no side thinner than ThinnestSide of the longest.
Bounds grown(const Bounds& bounds, double factor) {
    const double thinnest = ThinnestSide * longest_side(bounds);
    Bounds result;
    for (int axis = 0; axis < 3; ++axis) {
        const double side = std::max(bounds.high[axis] - bounds.low[axis], thinnest);
        const double centre = 0.5 * (bounds.low[axis] + bounds.high[axis]);
        result.low[axis] = centre - 0.5 * factor * side;
        result.high[axis] = centre + 0.5 * factor * side;
    }
    return result;
}

bool holds(const Bounds& bounds, const Vec3& point) {
    for (int axis = 0; axis < 3; ++axis)
        if (point[axis] < bounds.low[axis] || point[axis] > bounds.high[axis]) return false;
    return true;
}

double volume(const Bounds& bounds) {
    const Vec3 sides = bounds.high - bounds.low;
    return sides.x * sides.y * sides.z;
}

/// Rows with a weight each; the weights sum to `total`.
struct Weighted {
    Indices rows;
    std::vector<double> weight;
    double total = 0;
};

double opacity_of(const VisibleRows& rows, std::uint32_t index) {
    return 1 / (1 + std::exp(-static_cast<double>(rows.opacity_logit[index])));
}

Weighted by_opacity(const VisibleRows& rows, const Indices& indices) {
    Weighted result{indices, {}, 0};
    for (const auto i : indices) {
        result.weight.push_back(opacity_of(rows, i));
        result.total += result.weight.back();
    }
    return result;
}

double weight_in(const VisibleRows& rows, const Weighted& some, const Bounds& bounds) {
    double sum = 0;
    for (std::size_t i = 0; i < some.rows.size(); ++i)
        if (holds(bounds, point_of(rows, some.rows[i]))) sum += some.weight[i];
    return sum;
}

/// The rows that have company in their cell, compared with the rows of `dense`.
Weighted in_company(const VisibleRows& rows, const Weighted& all, const Bounds& dense) {
    constexpr double CellShare = 1.0 / 3, LeastOfMiddle = 0.01;  // of the dense box; of its middle count
    constexpr double LeastCount = 3, MostCells = 1e6;            // rows of a cell; cells along an axis
    const double side = CellShare * longest_side(dense);
    const auto key_of = [&](const Vec3& at) {
        std::uint64_t key = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const double cell = std::floor((at[axis] - dense.low[axis]) / side);
            key =
                (key << 21) + static_cast<std::uint64_t>(std::clamp(cell, -MostCells, MostCells) + MostCells);
        }
        return key;
    };
    std::unordered_map<std::uint64_t, double> count;
    for (const auto i : all.rows) ++count[key_of(point_of(rows, i))];
    std::vector<double> counts;
    for (const auto i : all.rows)
        if (holds(dense, point_of(rows, i))) counts.push_back(count[key_of(point_of(rows, i))]);
    Weighted result;
    if (counts.empty()) return result;
    const double least = std::max(LeastCount, LeastOfMiddle * nearest_quantile(counts, 0.5));
    for (std::size_t i = 0; i < all.rows.size(); ++i) {
        if (count[key_of(point_of(rows, all.rows[i]))] < least) continue;
        result.rows.push_back(all.rows[i]);
        result.weight.push_back(all.weight[i]);
        result.total += all.weight[i];
    }
    return result;
}

/// Box of the fullest cells of `box` that together hold CoreShare of the weight.
Bounds fullest_cells(const VisibleRows& rows, const Weighted& all, const Bounds& box) {
    constexpr int Cells = 16;
    const double side = longest_side(box) / Cells;
    std::vector<double> count(Cells * Cells * Cells, 0);
    const auto coordinate = [&](double value, double low) {
        return std::clamp(static_cast<int>((value - low) / side), 0, Cells - 1);
    };
    for (std::size_t i = 0; i < all.rows.size(); ++i) {
        const Vec3 at = point_of(rows, all.rows[i]);
        if (!holds(box, at)) continue;
        count[static_cast<std::size_t>((coordinate(at.x, box.low.x) * Cells + coordinate(at.y, box.low.y)) *
                                           Cells +
                                       coordinate(at.z, box.low.z))] += all.weight[i];
    }
    std::vector<std::size_t> order(count.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return count[a] > count[b]; });
    const double wanted = CoreShare * all.total;
    Bounds result{box.high, box.low};
    double sum = 0;
    for (std::size_t i = 0; i < order.size() && sum < wanted && count[order[i]] > 0; ++i) {
        sum += count[order[i]];
        const std::array<int, 3> cell{static_cast<int>(order[i]) / (Cells * Cells),
                                      static_cast<int>(order[i]) / Cells % Cells,
                                      static_cast<int>(order[i]) % Cells};
        for (int axis = 0; axis < 3; ++axis) {
            const double low = box.low[axis] + cell[static_cast<std::size_t>(axis)] * side;
            result.low[axis] = std::min(result.low[axis], low);
            result.high[axis] = std::max(result.high[axis], low + side);
        }
    }
    return result;
}

/// The dense part of the scene.
struct Core {
    Bounds bounds;  // robust
    Bounds reach;   // what lies beyond is certainly no part of it
};

std::optional<Core> core_of(const VisibleRows& rows, const Indices& indices) {
    constexpr double OutermostShare = 0.002, Zoom = 0.5, Step = 1.5, LeastGrowth = 0.02;
    constexpr double Thin = 0.02;  // of the density so far: what lies there is no more of the core
    constexpr double Margin = 1.25;
    constexpr int MostZooms = 12, MostSteps = 20;
    const Weighted all = by_opacity(rows, indices);
    Bounds box = bounds_without(rows, indices, OutermostShare);
    for (int zoom = 0; zoom < MostZooms && longest_side(box) > 0; ++zoom) {
        const Bounds nearer = fullest_cells(rows, all, box);
        if (!(longest_side(nearer) <= Zoom * longest_side(box))) break;
        box = nearer;
    }
    if (!(longest_side(box) > 0)) return std::nullopt;
    box = grown(box, 1);
    const Weighted dense = in_company(rows, all, box);
    double inside = weight_in(rows, dense, box);
    for (int step = 0; step < MostSteps && inside > 0; ++step) {
        const Bounds larger = grown(box, Step);
        const double more = weight_in(rows, dense, larger), added = more - inside;
        const double density = added / (volume(larger) - volume(box));
        if (added < LeastGrowth * dense.total || density < Thin * inside / volume(box)) break;
        box = larger;
        inside = more;
    }
    Indices held;
    const Bounds reach = grown(box, Margin);
    box = grown(box, Step);
    std::copy_if(dense.rows.begin(), dense.rows.end(), std::back_inserter(held),
                 [&](std::uint32_t i) { return holds(box, point_of(rows, i)); });
    if (held.empty() || inside < 0.5 * CoreShare * all.total) return std::nullopt;
    return Core{bounds_without(rows, held, EndShare), reach};
}

double middle_opacity(const VisibleRows& rows, const Indices& indices) {
    std::vector<double> logits(indices.size());
    std::transform(indices.begin(), indices.end(), logits.begin(),
                   [&](std::uint32_t i) { return static_cast<double>(rows.opacity_logit[i]); });
    return 1 / (1 + std::exp(-nearest_quantile(logits, 0.5)));
}

bool faint(const VisibleRows& rows, const Indices& far, const Indices& near) {
    constexpr double MostOpacity = 0.15, MostOfCore = 1.0 / 3;
    const double opacity = middle_opacity(rows, far);
    return opacity <= MostOpacity && opacity <= MostOfCore * middle_opacity(rows, near);
}

/// True when typical neighbours are too far apart for a surface.
bool scattered(const VisibleRows& rows, const Indices& far) {
    constexpr std::size_t Probes = 200, MostRows = 100000;
    constexpr std::size_t FewestRows = 50;  // fewer may be a tall part of few splats
    constexpr double LeastGap = 6;          // sizes of a splat
    if (far.size() < FewestRows || far.size() > MostRows) return false;
    std::vector<double> gaps;
    const std::size_t count = std::min(Probes, far.size());
    for (std::size_t probe = 0; probe < count; ++probe) {
        const std::uint32_t row = far[probe * far.size() / count];
        const Vec3 at = point_of(rows, row);
        double nearest = std::numeric_limits<double>::infinity();
        for (const auto other : far) {
            if (other == row) continue;
            const Vec3 away = point_of(rows, other) - at;
            nearest = std::min(nearest, dot(away, away));
        }
        gaps.push_back(std::sqrt(nearest) / std::exp(static_cast<double>(rows.log_size[row])));
    }
    return nearest_quantile(gaps, 0.5) > LeastGap;
}

/// True when the rows fill the space around the core evenly, as no surfaces do.
bool fills_space(const VisibleRows& rows, const Indices& far, const Bounds& core) {
    constexpr int Cells = 5;
    constexpr std::size_t LeastCount = 150;
    constexpr double LeastFilled = 0.7, LeastEven = 0.3;
    if (far.size() < LeastCount) return false;
    const Bounds box = bounds_without(rows, far, EndShare);
    std::array<std::size_t, Cells * Cells * Cells> count{};
    for (const auto i : far) {
        const Vec3 at = point_of(rows, i);
        if (!holds(box, at)) continue;
        std::size_t index = 0;
        for (int axis = 0; axis < 3; ++axis)
            index =
                index * Cells + static_cast<std::size_t>(std::min(
                                    static_cast<int>((at[axis] - box.low[axis]) /
                                                     std::max(box.high[axis] - box.low[axis], 1e-12) * Cells),
                                    Cells - 1));
        ++count[index];
    }
    std::size_t inner = 0, filled = 0, in_inner = 0, in_outer = 0, outer = 0;
    for (int cell = 0; cell < Cells * Cells * Cells; ++cell) {
        const std::array<int, 3> at{cell / (Cells * Cells), cell / Cells % Cells, cell % Cells};
        const bool edge = std::any_of(at.begin(), at.end(), [](int i) { return i == 0 || i == Cells - 1; });
        Vec3 middle;
        for (int axis = 0; axis < 3; ++axis)
            middle[axis] = box.low[axis] + (at[static_cast<std::size_t>(axis)] + 0.5) *
                                               (box.high[axis] - box.low[axis]) / Cells;
        if (holds(grown(core, FarReach), middle)) continue;
        const auto rows_here = count[static_cast<std::size_t>(cell)];
        ++(edge ? outer : inner);
        (edge ? in_outer : in_inner) += rows_here;
        if (!edge && rows_here > 0) ++filled;
    }
    if (inner == 0 || outer == 0) return false;
    const double inside = static_cast<double>(in_inner) / static_cast<double>(inner);
    return static_cast<double>(filled) >= LeastFilled * static_cast<double>(inner) &&
           inside >= LeastEven * static_cast<double>(in_outer) / static_cast<double>(outer);
}

/// Distances between which a shell around `centre` lies; nothing if there is none.
std::optional<std::array<double, 2>> shell(const VisibleRows& rows, const Indices& far, const Bounds& core,
                                           double least_share) {
    constexpr double Thickness = 1.35, LeastDistance = 1.7;  // distance in core radii
    constexpr double MostLean = 0.8;                         // length of the mean direction: a dome has 0.5
    const Vec3 centre = core.centre();
    std::vector<double> distance(far.size());
    std::transform(far.begin(), far.end(), distance.begin(),
                   [&](std::uint32_t i) { return length(point_of(rows, i) - centre); });
    std::sort(distance.begin(), distance.end());
    std::size_t best = 0, from = 0;
    for (std::size_t first = 0, last = 0; first < distance.size(); ++first) {
        while (last < distance.size() && distance[last] <= Thickness * distance[first]) ++last;
        if (last - first > best) best = last - first, from = first;
    }
    const double inner = distance[from], outer = inner * Thickness;
    if (static_cast<double>(best) < least_share * static_cast<double>(far.size()) ||
        inner < LeastDistance * core.radius())
        return std::nullopt;
    Vec3 mean;
    for (const auto i : far) {
        const Vec3 away = point_of(rows, i) - centre;
        if (length(away) >= inner && length(away) <= outer) mean = mean + normalized(away);
    }
    if (length(mean) / static_cast<double>(best) > MostLean) return std::nullopt;
    return std::array{inner, outer};
}

/// Kinds of the rows beyond the core: sky between two distances, haze, both or neither.
struct FarKind {
    std::optional<std::array<double, 2>> sky;
    bool haze = false;
};

FarKind kind_of(const VisibleRows& rows, const Indices& beyond, const Indices& near, const Bounds& core) {
    constexpr double MostlyShell = 0.7, PartlyShell = 0.5;
    const auto hazy = [&](const Indices& some) {
        return !some.empty() &&
               (faint(rows, some, near) || scattered(rows, some) || fills_space(rows, some, core));
    };
    FarKind kind;
    kind.sky = shell(rows, beyond, core, MostlyShell);
    if (!kind.sky && hazy(beyond)) return {std::nullopt, true};
    if (!kind.sky) kind.sky = shell(rows, beyond, core, PartlyShell);
    if (!kind.sky) return kind;
    Indices rest;
    for (const auto row : beyond) {
        const double distance = length(point_of(rows, row) - core.centre());
        if (distance < (*kind.sky)[0] || distance > (*kind.sky)[1]) rest.push_back(row);
    }
    kind.haze = hazy(rest);
    return kind;
}

}  // namespace

void VisibleRows::add(const GaussianSpans& set, std::size_t row) {
    const auto at = set.position.subspan(row * 3, 3);
    const auto scale = set.log_scale.subspan(row * 3, 3);
    position.insert(position.end(), at.begin(), at.end());
    opacity_logit.push_back(set.opacity_logit[row]);
    log_size.push_back(std::max({scale[0], scale[1], scale[2]}));
}

void VisibleRows::reserve(std::size_t rows) {
    position.reserve(rows * 3);
    opacity_logit.reserve(rows);
    log_size.reserve(rows);
}

void VisibleRows::drop(std::span<const std::uint8_t> bits) {
    if (bits.empty()) return;
    std::size_t kept = 0;
    for (std::size_t row = 0; row < size(); ++row) {
        if (bits[row] != 0) continue;
        std::copy_n(&position[row * 3], 3, &position[kept * 3]);
        opacity_logit[kept] = opacity_logit[row];
        log_size[kept] = log_size[row];
        ++kept;
    }
    position.resize(kept * 3);
    opacity_logit.resize(kept);
    log_size.resize(kept);
}

Surroundings find_surroundings(const VisibleRows& rows) {
    Surroundings found;
    if (rows.size() < LeastRows) return found;
    Indices searched;
    for (std::size_t row = 0; row < rows.size(); row += rows.size() / MostSearched + 1)
        searched.push_back(static_cast<std::uint32_t>(row));
    const auto core = core_of(rows, searched);
    if (!core || bounds_without(rows, searched, EndShare).radius() < LeastReach * core->bounds.radius())
        return found;
    const Bounds near_box = grown(core->bounds, FarReach);
    Indices near, far, beyond;
    for (std::uint32_t row = 0; row < rows.size(); ++row) {
        const Vec3 at = point_of(rows, row);
        (holds(near_box, at) ? near : far).push_back(row);
        if (!holds(near_box, at) && !holds(core->reach, at)) beyond.push_back(row);
    }
    if (beyond.empty() || near.empty()) return found;
    const auto kind = kind_of(rows, beyond, near, core->bounds);
    if (!kind.sky && !kind.haze) return found;
    found.rows.assign(rows.size(), 0);
    for (const auto row : far) {
        const double distance = length(point_of(rows, row) - core->bounds.centre());
        const bool sky = kind.sky && distance >= (*kind.sky)[0] && distance <= (*kind.sky)[1];
        if (!sky && !kind.haze) continue;
        found.rows[row] = 1;
        ++(sky ? found.sky : found.haze);
    }
    return found;
}

std::vector<std::uint8_t> surrounding_rows(const GaussianSet& gaussians) {
    const auto usable = usable_rows(gaussians);
    const GaussianSpans set = gaussians.spans();
    const auto least = static_cast<float>(std::log(1.0 / 254));  // logit of the least opacity that is drawn
    VisibleRows visible;
    Indices index;
    for (std::size_t row = 0; row < set.size; ++row) {
        if (usable[row] == 0 || set.opacity_logit[row] < least) continue;
        visible.add(set, row);
        index.push_back(static_cast<std::uint32_t>(row));
    }
    const auto found = find_surroundings(visible);
    std::vector<std::uint8_t> rows(found.rows.empty() ? 0 : set.size, 0);
    for (std::size_t i = 0; i < found.rows.size(); ++i) rows[index[i]] = found.rows[i];
    return rows;
}

}  // namespace gse
