// Evidence from the solid cells and from the surfaces in them.
#include "engine/scene/layout/up_evidence.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <unordered_map>
#include <utility>

namespace gse {
namespace {

using Cell = SolidGrid::Cell;

/// A sample in a solid cell.
struct Surface {
    const SurfaceSample* sample = nullptr;
    Cell cell{};
    Vec3 outward;      // its normal, away from the solid
    double trust = 0;  // weight of what the normal says
};

std::array<std::size_t, 2> others(std::size_t axis) { return {(axis + 1) % 3, (axis + 2) % 3}; }

/// Solid cells with a rim, averaged with their neighbours.
class SoftGrid {
public:
    explicit SoftGrid(const SolidGrid& grid) {
        for (std::size_t axis = 0; axis < 3; ++axis) size_[axis] = grid.size()[axis] + 2 * Rim;
        values_.assign(at(size_[0] - 1, size_[1] - 1, size_[2] - 1) + 1, 0);
        Cell cell{};
        for (cell[0] = 0; cell[0] < grid.size()[0]; ++cell[0])
            for (cell[1] = 0; cell[1] < grid.size()[1]; ++cell[1])
                for (cell[2] = 0; cell[2] < grid.size()[2]; ++cell[2])
                    if (grid.solid(cell)) values_[at(cell[0] + Rim, cell[1] + Rim, cell[2] + Rim)] = 1;
        for (int pass = 0; pass < 2; ++pass)
            for (std::size_t axis = 0; axis < 3; ++axis) average(axis);
    }
    /// Direction in which the solid thins out.
    Vec3 outward(const Cell& cell) const {
        const int x = cell[0] + Rim, y = cell[1] + Rim, z = cell[2] + Rim;
        return Vec3{values_[at(x - 1, y, z)] - values_[at(x + 1, y, z)],
                    values_[at(x, y - 1, z)] - values_[at(x, y + 1, z)],
                    values_[at(x, y, z - 1)] - values_[at(x, y, z + 1)]} *
               0.5;
    }

private:
    static constexpr int Rim = 4;

    std::size_t at(int x, int y, int z) const {
        return (static_cast<std::size_t>(x) * static_cast<std::size_t>(size_[1]) +
                static_cast<std::size_t>(y)) *
                   static_cast<std::size_t>(size_[2]) +
               static_cast<std::size_t>(z);
    }
    void average(std::size_t axis) {
        const std::size_t step = axis == 2   ? 1
                                 : axis == 1 ? static_cast<std::size_t>(size_[2])
                                             : static_cast<std::size_t>(size_[1] * size_[2]);
        std::vector<double> result(values_.size(), 0);
        for (std::size_t i = step; i + step < values_.size(); ++i)
            result[i] = (values_[i - step] + values_[i] + values_[i + step]) / 3;
        values_ = std::move(result);
    }

    Cell size_{};
    std::vector<double> values_;
};

std::vector<Surface> surfaces_of(std::span<const SurfaceSample> samples, const SolidGrid& grid) {
    const SoftGrid soft(grid);
    std::vector<Surface> surfaces;
    double steepness = 0;
    for (const auto& sample : samples) {
        Surface surface{&sample, {}, {}, 0};
        if (!grid.find(sample.at, surface.cell)) continue;
        surface.outward = soft.outward(surface.cell);
        steepness += length(surface.outward);
        surfaces.push_back(surface);
    }
    steepness /= static_cast<double>(std::max<std::size_t>(surfaces.size(), 1));
    for (auto& surface : surfaces) {
        const double steep = length(surface.outward);
        const double along = dot(normalized(surface.outward), surface.sample->normal);
        surface.trust = steepness > 0 ? surface.sample->flatness * along * along *
                                            std::min(steep / steepness, 1.0) * surface.sample->weight
                                      : 0;
        surface.outward = surface.sample->normal * (along < 0 ? -1.0 : along > 0 ? 1.0 : 0.0);
    }
    return surfaces;
}

double log_brightness(const SurfaceSample& sample) {
    constexpr double Darkest = 0.05;  // what is darker tells little
    return std::log(0.3 * sample.colour[0] + 0.59 * sample.colour[1] + 0.11 * sample.colour[2] + Darkest);
}

/// Key of surfaces of like colour that are near each other.
std::uint64_t neighbourhood(const Surface& surface) {
    constexpr int BlockCells = 8;
    constexpr double Hues = 10;
    const auto& colour = surface.sample->colour;
    const double sum = colour[0] + colour[1] + colour[2] + 0.05;
    std::uint64_t key = 0;
    for (const int cell : surface.cell) key = key * 64 + static_cast<std::uint64_t>(cell / BlockCells);
    for (std::size_t c = 0; c < 2; ++c) key = key * 32 + static_cast<std::uint64_t>(colour[c] / sum * Hues);
    return key;
}

/// Solution x of matrix * x = right for a symmetric matrix that can be inverted.
Vec3 solve(const Mat3& matrix, const Vec3& right) { return glm::inverse(matrix.columns) * right; }

/// Direction to the light; its length says how much of the brightness it explains. Zero where nothing is
/// said.
Vec3 light_from(const std::vector<Surface>& surfaces) {
    struct Mean {
        double trust = 0, brightness = 0;
        Vec3 normal;
    };
    constexpr double Damping = 0.02;  // of the matrix's trace
    std::unordered_map<std::uint64_t, Mean> means;
    for (const auto& surface : surfaces) {
        Mean& mean = means[neighbourhood(surface)];
        mean.trust += surface.trust;
        mean.brightness += surface.trust * log_brightness(*surface.sample);
        mean.normal = mean.normal + surface.outward * surface.trust;
    }
    Mat3 matrix;
    Vec3 right;
    double trust = 0, variance = 0;
    for (const auto& surface : surfaces) {
        const Mean& mean = means[neighbourhood(surface)];
        if (!(mean.trust > 0)) continue;
        const Vec3 normal = surface.outward - mean.normal / mean.trust;
        const double brightness = log_brightness(*surface.sample) - mean.brightness / mean.trust;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) matrix(i, j) += surface.trust * normal[i] * normal[j];
        right = right + normal * (surface.trust * brightness);
        trust += surface.trust;
        variance += surface.trust * brightness * brightness;
    }
    const double trace = matrix(0, 0) + matrix(1, 1) + matrix(2, 2);
    if (!(trace > 0 && variance > 0)) return {};
    for (int i = 0; i < 3; ++i) matrix(i, i) += Damping * trace;
    return solve(matrix, right) / std::sqrt(variance / trust);
}

/// Cells seen along an axis: bit per cell of the plane of the other two, and its box.
struct Footprint {
    std::size_t cells = 0;
    std::array<int, 2> first{1 << 20, 1 << 20}, last{-1, -1};
};

/// Footprint of the layers [begin,end) of an axis.
Footprint footprint(const SolidGrid& grid, std::size_t axis, int begin, int end) {
    const auto [u, v] = others(axis);
    Footprint result;
    Cell cell{};
    for (cell[u] = 0; cell[u] < grid.size()[u]; ++cell[u])
        for (cell[v] = 0; cell[v] < grid.size()[v]; ++cell[v]) {
            bool any = false;
            for (cell[axis] = begin; !any && cell[axis] < end; ++cell[axis]) any = grid.solid(cell);
            if (!any) continue;
            ++result.cells;
            const std::array<int, 2> at{cell[u], cell[v]};
            for (std::size_t i = 0; i < 2; ++i) {
                result.first[i] = std::min(result.first[i], at[i]);
                result.last[i] = std::max(result.last[i], at[i]);
            }
        }
    return result;
}

/// Share of the solid cells whose mirror image across the axis is solid, at the best place of the mirror.
double mirrored(const SolidGrid& grid, std::size_t axis) {
    constexpr int Shifts = 3;
    std::size_t best = 0;
    for (int shift = -Shifts; shift <= Shifts; ++shift) {
        std::size_t count = 0;
        Cell cell{};
        for (cell[0] = 0; cell[0] < grid.size()[0]; ++cell[0])
            for (cell[1] = 0; cell[1] < grid.size()[1]; ++cell[1])
                for (cell[2] = 0; cell[2] < grid.size()[2]; ++cell[2]) {
                    Cell image = cell;
                    image[axis] = grid.size()[axis] - 1 - cell[axis] + shift;
                    if (image[axis] >= 0 && image[axis] < grid.size()[axis] && grid.solid(cell) &&
                        grid.solid(image))
                        ++count;
                }
        best = std::max(best, count);
    }
    return static_cast<double>(best) / static_cast<double>(grid.solid_count());
}

/// Distance of the centre of mass (in cells) from the base's edge, as a share of the grid's width.
double standing(const SolidGrid& grid, std::size_t axis, const Footprint& base, const Vec3& centre) {
    const auto other = others(axis);
    double margin = 1;
    for (std::size_t i = 0; i < 2; ++i) {
        const double at = centre[static_cast<int>(other[i])], width = grid.size()[other[i]];
        margin = std::min({margin, (at - base.first[i]) / width, (base.last[i] + 1 - at) / width});
    }
    return margin;
}

/// Place of the origin between the grid's ends along an axis; 0 = low end.
double origin_place(const SolidGrid& grid, std::size_t axis) {
    return -grid.low()[static_cast<int>(axis)] / (grid.side() * grid.size()[axis]);
}

double at_origin(const SolidGrid& grid, std::size_t axis, bool negative) {
    constexpr double Near = 0.03, Middle = 0.25;
    for (const auto other : others(axis))
        if (std::abs(origin_place(grid, other) - 0.5) > Middle) return 0;
    const double place = origin_place(grid, axis);
    return std::exp(-std::abs(negative ? 1 - place : place) / Near);
}

/// Fullest thin layer of the lower third, seen along a direction.
struct Layer {
    double share = 0;          // of the weight
    double cover = 0;          // of the low face of the grid's box
    double low = 0, high = 0;  // heights, 0 = low end of the grid, 1 = high end
    bool floor() const {
        constexpr double LeastShare = 0.08, LeastCover = 0.35;
        return share > LeastShare && cover > LeastCover;
    }
};

double height_of(const SurfaceSample& sample, const SolidGrid& grid, std::size_t index) {
    const int axis = static_cast<int>(index / 2);
    const double height =
        (sample.at[axis] - grid.low()[axis]) / (grid.side() * grid.size()[static_cast<std::size_t>(axis)]);
    return index % 2 == 1 ? 1 - height : height;
}

Layer fullest_layer(const std::vector<Surface>& surfaces, const SolidGrid& grid, std::size_t index) {
    constexpr std::size_t Layers = 60, Thick = 3, Lower = 20;
    std::array<double, Layers> weight{};
    double total = 0;
    for (const auto& surface : surfaces) {
        const double height = std::clamp(height_of(*surface.sample, grid, index), 0.0, 0.999);
        weight[static_cast<std::size_t>(height * Layers)] += surface.sample->weight;
        total += surface.sample->weight;
    }
    Layer layer;
    for (std::size_t first = 0; first < Lower && total > 0; ++first) {
        const double share = (weight[first] + weight[first + 1] + weight[first + Thick - 1]) / total;
        if (share <= layer.share) continue;
        layer.share = share;
        layer.low = static_cast<double>(first) / Layers;
        layer.high = static_cast<double>(first + Thick) / Layers;
    }
    const std::size_t axis = index / 2;
    const int count = grid.size()[axis];
    int begin = static_cast<int>(layer.low * count), end = static_cast<int>(std::ceil(layer.high * count));
    if (index % 2 == 1) begin = count - std::exchange(end, count - begin);
    const double face = static_cast<double>(grid.size()[others(axis)[0]] * grid.size()[others(axis)[1]]);
    layer.cover = static_cast<double>(footprint(grid, axis, begin, end).cells) / face;
    return layer;
}

/// Takes the trust from level surfaces of a floor: things stand on it, so that it seems to face down.
void distrust(std::vector<Surface>& surfaces, const SolidGrid& grid, const Layer& layer, std::size_t index) {
    constexpr double Level = 0.7, Reach = 0.03;
    if (!layer.floor()) return;
    for (auto& surface : surfaces) {
        const double height = height_of(*surface.sample, grid, index);
        if (height > layer.low - Reach && height < layer.high + Reach &&
            std::abs(dot(surface.sample->normal, direction(index))) > Level)
            surface.trust = 0;
    }
}

/// Evidence of both directions of one axis that follows from cells alone.
void add_cells(std::array<UpEvidence, Directions>& evidence, const SolidGrid& grid, std::size_t axis,
               const Vec3& centre) {
    constexpr double EndShare = 0.1;  // of the height: base and top
    const int layers = grid.size()[axis];
    const int end = std::min(layers, std::max(2, static_cast<int>(layers * EndShare)));
    const Footprint low = footprint(grid, axis, 0, end);
    const Footprint high = footprint(grid, axis, layers - end, layers);
    const double ratio = std::log(static_cast<double>(low.cells + 1) / static_cast<double>(high.cells + 1));
    const double symmetry = -mirrored(grid, axis);
    for (const bool negative : {false, true}) {
        UpEvidence& one = evidence[axis * 2 + (negative ? 1 : 0)];
        const Footprint& base = negative ? high : low;
        one.stands = standing(grid, axis, base, centre);
        one.symmetry = symmetry;
        one.base = negative ? -ratio : ratio;
        one.origin = at_origin(grid, axis, negative);
    }
}

}  // namespace

Vec3 direction(std::size_t index) {
    Vec3 result;
    result[static_cast<int>(index / 2)] = index % 2 == 1 ? -1 : 1;
    return result;
}

const char* direction_name(std::size_t index) {
    constexpr std::array<const char*, Directions> Names{"x", "-x", "y", "-y", "z", "-z"};
    return Names[index];
}

std::array<UpEvidence, Directions> up_evidence(std::span<const SurfaceSample> samples,
                                               const SolidGrid& grid) {
    std::array<UpEvidence, Directions> evidence{};
    if (grid.empty()) return evidence;
    auto surfaces = surfaces_of(samples, grid);
    for (std::size_t index = 0; index < Directions; ++index) {
        const Layer layer = fullest_layer(surfaces, grid, index);
        evidence[index].ground = layer.share;
        evidence[index].cover = layer.cover;
        distrust(surfaces, grid, layer, index);
    }
    const Vec3 light = light_from(surfaces);
    Vec3 centre;
    double weight = 0, flat = 0, trust = 0;
    for (const auto& surface : surfaces) {
        centre = centre + surface.sample->at * surface.sample->weight;
        weight += surface.sample->weight;
        flat += surface.sample->weight * surface.sample->flatness;
        trust += surface.trust;
    }
    if (!(weight > 0)) return evidence;
    centre = (centre / weight - grid.low()) / grid.side();
    for (std::size_t axis = 0; axis < 3; ++axis) add_cells(evidence, grid, axis, centre);
    for (std::size_t index = 0; index < Directions; ++index) {
        UpEvidence& one = evidence[index];
        const Vec3 up = direction(index);
        one.light = dot(light, up);
        for (const auto& surface : surfaces) {
            const double along = dot(surface.outward, up), level = along * along;
            if (flat > 0)
                one.level += surface.sample->weight * surface.sample->flatness * level * level / flat;
            if (trust > 0) one.facing += surface.trust * (along > 0 ? level : -level) / trust;
        }
    }
    return evidence;
}

}  // namespace gse
