// Copies cell by cell, then what is still thin.
#include "engine/heal/lay.h"

#include <algorithm>
#include <cmath>

#include "engine/heal/smooth_fill.h"
#include "engine/math/sh.h"

namespace gse::heal {
namespace {

constexpr double LargestCopy = 3.5;  // cells, standard deviation of a row that is copied
constexpr float LeastShown = 0.1F;   // of a row that is copied: what others hide would come to light
constexpr double MostRimGain = 0.5;  // of a channel at the rim, in logarithms
constexpr double DarkestRim = 0.03;  // channel value that logarithms start from
constexpr double RimBlur = 2.5;      // standard deviation
constexpr int RimSmoothings = 3;
constexpr double ThinShare = 0.96;   // of the usual cover, below which a cell gets a row of its own
constexpr double FreshDepth = 0.25;  // cells, that such a row lies below the surface
constexpr double FreshAlong = 0.62, FreshThrough = 0.08;  // standard deviations of such a row, cells
constexpr double FreshOpacity = 0.95;

/// Shortest turn from one unit vector to another.
Quat turn_between(const Vec3& from, const Vec3& to) {
    const double along = dot(from, to);
    if (along < -0.99) return {1, 0, 0, 0};
    const Vec3 axis = cross(from, to);
    return glm::normalize(Quat(1 + along, axis.x, axis.y, axis.z));
}

SurfaceRow fresh_row(const Chart& chart, double x, double y, const Vec3& colour) {
    SurfaceRow row;
    row.normal = chart.normal_at(x, y);
    row.at = chart.world(x, y, chart.height_at(x, y) - FreshDepth * chart.cell);
    row.colour = colour;
    const Vec3 along = normalized(chart.u - row.normal * dot(chart.u, row.normal));
    row.axis = {along, cross(row.normal, along), row.normal};
    row.scale = {FreshAlong * chart.cell, FreshAlong * chart.cell, FreshThrough * chart.cell};
    row.opacity = FreshOpacity;
    return row;
}

void append_fresh(const SurfaceRow& row, GaussianData& added) {
    const std::size_t at = added.size();
    added.resize(at + 1);
    const Quat q = quaternion(Mat3::from_columns(row.axis[0], row.axis[1], row.axis[2]));
    const double turn[4] = {q.w, q.x, q.y, q.z};
    for (std::size_t k = 0; k < 4; ++k) added.rotation[at * 4 + k] = static_cast<float>(turn[k]);
    for (std::size_t k = 0; k < 3; ++k) {
        const int axis = static_cast<int>(k);
        added.position[at * 3 + k] = static_cast<float>(row.at[axis]);
        added.log_scale[at * 3 + k] = static_cast<float>(std::log(row.scale[k]));
        added.sh[at * added.sh_stride() + k] = static_cast<float>(sh_from_colour(row.colour[axis]));
    }
    added.opacity_logit[at] = static_cast<float>(std::log(row.opacity / (1 - row.opacity)));
}

Vec3 limited(const Vec3& v, double most) {
    return {std::clamp(v.x, -most, most), std::clamp(v.y, -most, most), std::clamp(v.z, -most, most)};
}

/// Means over the cells of `bits` around each of them.
void smooth_over(Grid<Vec3>& values, const BitGrid& bits) {
    const auto before = values;
    each_cell(bits, [&](int x, int y) {
        if (bits.at(x, y) == 0) return;
        Vec3 sum = before.at(x, y);
        double count = 1;
        each_neighbour(bits, x, y, 2, [&](int nx, int ny) {
            if (bits.at(nx, ny) != 0) sum += before.at(nx, ny), count += 1;
        });
        values.at(x, y) = sum / count;
    });
}

/// Logarithm of the colours around a place over those around where the shift copies from, over cells that are
/// known at both, so that a texture is compared with itself.
Vec3 colour_step(const Grid<Vec3>& colour, const BitGrid& known, int x, int y, Shift shift) {
    const int reach = static_cast<int>(std::ceil(2.5 * RimBlur));
    Vec3 here, there;
    for (int dy = -reach; dy <= reach; ++dy)
        for (int dx = -reach; dx <= reach; ++dx) {
            const int ax = x + dx, ay = y + dy, bx = ax + shift.x, by = ay + shift.y;
            if (!known.inside(ax, ay) || !known.inside(bx, by)) continue;
            if (known.at(ax, ay) == 0 || known.at(bx, by) == 0) continue;
            const double w = std::exp(-0.5 * (dx * dx + dy * dy) / (RimBlur * RimBlur));
            here += colour.at(ax, ay) * w, there += colour.at(bx, by) * w;
        }
    Vec3 step;
    for (int c = 0; c < 3; ++c)
        step[c] = std::log(std::max(here[c], DarkestRim) / std::max(there[c], DarkestRim));
    return step;
}

}  // namespace

void append_copy(const GaussianSet& scene, std::size_t row, const Vec3& at, const Quat& turn,
                 const Vec3& gain, GaussianData& added) {
    const std::size_t to = added.size(), stride = added.sh_stride();
    added.resize(to + 1);
    const float* q = &scene.rotation()[row * 4];
    const Quat turned = turn * Quat(q[0], q[1], q[2], q[3]);
    const double rotation[4] = {turned.w, turned.x, turned.y, turned.z};
    for (std::size_t k = 0; k < 4; ++k) added.rotation[to * 4 + k] = static_cast<float>(rotation[k]);
    for (std::size_t k = 0; k < 3; ++k) {
        added.position[to * 3 + k] = static_cast<float>(at[static_cast<int>(k)]);
        added.log_scale[to * 3 + k] = scene.log_scale()[row * 3 + k];
    }
    added.opacity_logit[to] = scene.opacity_logit()[row];
    for (std::size_t k = 0; k < stride; ++k) {
        const int channel = static_cast<int>(k % 3);
        const double value = scene.sh()[row * stride + k];
        added.sh[to * stride + k] = static_cast<float>(
            k < 3 ? sh_from_colour(colour_from_sh(value) * gain[channel]) : value * gain[channel]);
    }
}

Grid<Vec3> rim_gain(const Chart& chart, const BitGrid& hole, const PatchFill& fill) {
    Grid<Vec3> gain(hole.width, hole.height, Vec3(0));
    BitGrid rim(hole.width, hole.height, 0), known = chart.known;
    for (std::size_t i = 0; i < known.cells.size(); ++i)
        if (hole.cells[i] != 0) known.cells[i] = 0;
    if (fill.found) {
        each_cell(hole, [&](int x, int y) {
            if (known.at(x, y) == 0) return;
            Vec3 sum;
            double count = 0;
            each_neighbour(hole, x, y, 1, [&](int nx, int ny) {
                if (hole.at(nx, ny) == 0) return;
                sum += colour_step(chart.colour, known, x, y, fill.shift.at(nx, ny));
                count += 1;
            });
            if (count > 0) rim.at(x, y) = 1, gain.at(x, y) = limited(sum / count, MostRimGain);
        });
        for (int pass = 0; pass < RimSmoothings; ++pass) smooth_over(gain, rim);
        fill_membrane(gain, hole, rim);
    }
    for (auto& value : gain.cells) value = {std::exp(value.x), std::exp(value.y), std::exp(value.z)};
    return gain;
}

void lay_rows(const GaussianSet& scene, std::span<const SurfaceRow> rows, const Chart& chart,
              const BitGrid& hole, const PatchFill& fill, const Grid<Vec3>& rim_gains,
              std::span<const Vec3> gain, GaussianData& added) {
    auto through = chart.through;
    const auto cover = [&](const SurfaceRow& row) {
        each_covered(chart, row,
                     [&](std::size_t cell, double opacity) { through.cells[cell] *= 1 - opacity; });
    };
    const auto copy_cell = [&](int x, int y, Shift shift) {
        for (const auto i : chart.rows_in(x + shift.x, y + shift.y)) {
            SurfaceRow row = rows[i];
            if (row.longest() > LargestCopy * chart.cell || chart.shown[i] < LeastShown) continue;
            const Vec3 from = chart.local(row.at);
            const double px = from.x - shift.x, py = from.y - shift.y;
            const double rise = from.z - chart.height_at(from.x, from.y);
            const Quat turn = turn_between(chart.normal_at(from.x, from.y), chart.normal_at(px, py));
            row.at = chart.world(px, py, chart.height_at(px, py) + rise);
            append_copy(scene, row.row, row.at, turn, gain[i] * between_cells(rim_gains, px, py), added);
            cover(row);
        }
    };
    if (fill.found)
        each_cell(hole, [&](int x, int y) {
            if (hole.at(x, y) != 0) copy_cell(x, y, fill.shift.at(x, y));
        });
    // Rows below the surface close what is thin, and gaps between copies and the rim.
    each_cell(hole, [&](int x, int y) {
        const bool inside = hole.at(x, y) != 0;
        bool rim = false;
        each_neighbour(hole, x, y, 1, [&](int nx, int ny) { rim = rim || (hole.at(nx, ny) != 0) != inside; });
        if (!inside && !(rim && chart.known.at(x, y) != 0)) return;
        if (!rim && 1 - through.at(x, y) >= ThinShare * chart.usual_cover) return;
        const Vec3 colour = inside ? fill.colour.at(x, y) * rim_gains.at(x, y) : chart.colour.at(x, y);
        const SurfaceRow row = fresh_row(chart, x + 0.5, y + 0.5, colour);
        append_fresh(row, added);
        cover(row);
    });
}

}  // namespace gse::heal
