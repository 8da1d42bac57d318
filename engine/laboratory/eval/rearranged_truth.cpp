// Maps written out by their formulas: R p s + t, R C R' s s, and the three coefficients of degree 1 as a
// vector.
#include "engine/laboratory/eval/rearranged_truth.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/check.h"
#include "engine/evaluate/metrics.h"

namespace gse::bench {
namespace {

constexpr std::size_t Channels = 3;
constexpr double Trim = 0.01;         // of the rows, on either side of an axis
constexpr double Directional = 0.06;  // largest coefficient of degree 1: seen, and small beside the colour
constexpr double LeastDarker = 1e-3;  // coefficient of degree 0: a third of a grey level
constexpr int CaptureViews = 60, CaptureSide = 160;
constexpr double LowElevation = 0.25, HighElevation = 0.8;
constexpr double LeastSeen = 0.1;  // of what a row shows without the thing, that a scan needs to hold it

Vec3 at(std::span<const float> values, std::size_t row) {
    return {values[row * 3], values[row * 3 + 1], values[row * 3 + 2]};
}

Quat turn_of_row(const GaussianSet& set, std::size_t row) {
    const auto q = set.rotation().subspan(row * 4, 4);
    return {q[0], q[1], q[2], q[3]};
}

Mat3 covariance_of(const GaussianSet& set, std::size_t row) {
    const Mat3 turn = rotation_matrix(turn_of_row(set, row));
    const Vec3 scale = at(set.log_scale(), row);
    Mat3 spread;
    for (int k = 0; k < 3; ++k) spread(k, k) = std::exp(2 * scale[k]);
    return turn * spread * turn.transposed();
}

/// Degree 1 of a channel as a vector: the colour in direction d differs by its product with d.
Vec3 slope_of(std::span<const float> sh, std::size_t channel) {
    return {-sh[3 * Channels + channel], -sh[1 * Channels + channel], sh[2 * Channels + channel]};
}

void set_slope(std::span<float> sh, std::size_t channel, const Vec3& slope) {
    sh[3 * Channels + channel] = static_cast<float>(-slope.x);
    sh[1 * Channels + channel] = static_cast<float>(-slope.y);
    sh[2 * Channels + channel] = static_cast<float>(slope.z);
}

/// Turn about the upright axis, counter-clockwise as seen from above, by Rodrigues' formula.
Mat3 turn_about_up(const Vec3& up, double degrees) {
    const double angle = degrees * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
    const auto turned = [&](const Vec3& v) { return v * c + cross(up, v) * s + up * (dot(up, v) * (1 - c)); };
    return Mat3::from_columns(turned({1, 0, 0}), turned({0, 1, 0}), turned({0, 0, 1}));
}

double largest_difference(const Vec3& a, const Vec3& b) {
    return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)});
}

}  // namespace

void MapError::add(const MapError& other) {
    position = std::max(position, other.position);
    covariance = std::max(covariance, other.covariance);
    colour = std::max(colour, other.colour);
}

MapError map_error(const GaussianSet& before, const GaussianSet& after, const RowPairs& pairs,
                   const synth::Placing& map) {
    GSE_CHECK_EQ(before.sh_degree(), after.sh_degree());
    GSE_CHECK(before.sh_degree() <= 1);
    MapError error;
    double largest = 0;
    const std::size_t stride = before.sh_degree() == 0 ? Channels : 4 * Channels;
    for (const auto& [from, to] : pairs) {
        error.position = std::max(
            error.position, largest_difference(map(at(before.position(), from)), at(after.position(), to)));
        const Mat3 wanted = map.turn * covariance_of(before, from) * map.turn.transposed();
        const Mat3 found = covariance_of(after, to);
        for (int k = 0; k < 3; ++k) {
            const Vec3 row = wanted.row(k) * (map.size * map.size);
            error.covariance = std::max(error.covariance, largest_difference(row, found.row(k)));
            largest = std::max(largest, largest_difference(row, {}));
        }
        const auto sh = before.sh().subspan(from * stride, stride),
                   now = after.sh().subspan(to * stride, stride);
        for (std::size_t c = 0; c < Channels; ++c) {
            error.colour = std::max(error.colour, std::abs(static_cast<double>(sh[c]) - now[c]));
            if (stride == Channels) continue;
            error.colour =
                std::max(error.colour, largest_difference(map.turn * slope_of(sh, c), slope_of(now, c)));
        }
    }
    if (largest > 0) error.covariance /= largest;
    return error;
}

Vec3 fitted_shift(const GaussianSet& before, const GaussianSet& after, const RowPairs& pairs,
                  const synth::Placing& map) {
    const synth::Placing unmoved{map.turn, map.size, {}};
    Vec3 sum;
    for (const auto& [from, to] : pairs)
        sum += at(after.position(), to) - unmoved(at(before.position(), from));
    return pairs.empty() ? Vec3{} : sum / static_cast<double>(pairs.size());
}

GaussianSet placed(const GaussianSet& rows, const synth::Placing& map) {
    GSE_CHECK(rows.sh_degree() <= 1);
    GaussianData data = rows.to_data();
    const Quat turn = quaternion(map.turn);
    for (std::size_t row = 0; row < data.size(); ++row) {
        const Vec3 place = map(at(rows.position(), row));
        const Quat turned = turn * turn_of_row(rows, row);
        const double values[] = {turned.w, turned.x, turned.y, turned.z};
        for (int k = 0; k < 4; ++k) data.rotation[row * 4 + k] = static_cast<float>(values[k]);
        for (int k = 0; k < 3; ++k) {
            data.position[row * 3 + k] = static_cast<float>(place[k]);
            data.log_scale[row * 3 + k] =
                static_cast<float>(static_cast<double>(data.log_scale[row * 3 + k]) + std::log(map.size));
        }
        const auto sh = std::span(data.sh).subspan(row * data.sh_stride(), data.sh_stride());
        for (std::size_t c = 0; c < Channels && rows.sh_degree() == 1; ++c)
            set_slope(sh, c, map.turn * slope_of(sh, c));
    }
    return GaussianSet(std::move(data));
}

GaussianSet joined_sets(std::span<const GaussianSet> sets) {
    GaussianData data;
    for (const auto& set : sets) {
        data.sh_degree = set.sh_degree();
        const GaussianData rows = set.to_data();
        for (std::size_t row = 0; row < rows.size(); ++row) data.append_row(rows, row);
    }
    return GaussianSet(std::move(data));
}

FrontAxes front_axes(const synth::SceneSpec& spec) {
    FrontAxes axes;
    const synth::SynthScene none;
    const Camera camera = synth::scene_camera(none, synth::turn_of(spec), 0, 1, 2, 2);
    axes.right = camera.rotation.row(0);
    axes.forward = -camera.forward();
    return axes;
}

double ThingExtent::longest() const { return std::max({size.x, size.y, size.z}); }

ThingExtent extent_of(const GaussianSet& thing, const FrontAxes& axes) {
    ThingExtent extent;
    const Vec3 directions[] = {axes.right, axes.up, axes.forward};
    for (int k = 0; k < 3; ++k) {
        std::vector<double> values;
        for (std::size_t row = 0; row < thing.size(); ++row)
            values.push_back(dot(directions[k], at(thing.position(), row)));
        if (values.empty()) return extent;
        std::sort(values.begin(), values.end());
        const auto cut = static_cast<std::size_t>(Trim * static_cast<double>(values.size() - 1));
        const double low = values[cut], high = values[values.size() - 1 - cut];
        extent.size[k] = high - low;
        if (k != 1) extent.foot += directions[k] * (0.5 * (low + high));
    }
    return extent;
}

synth::Placing asked_map(const EvalCase& edit, const ThingExtent& thing, const FrontAxes& axes) {
    const auto& asked = edit.asked;
    synth::Placing map{turn_about_up(axes.up, asked.degrees), asked.size, {}};
    map.shift = thing.foot - map(thing.foot);
    const auto far = [&](double own) { return asked.distance > 0 ? asked.distance : own; };
    map.shift += axes.right * (asked.right * far(thing.size.x));
    map.shift += axes.forward * (asked.forward * far(thing.size.z));
    return map;
}

synth::SynthScene directional_scene(const synth::SceneSpec& spec) {
    auto scene = synth::generate(spec);
    const GaussianSet flat = scene.scene.gaussians;
    GaussianData data = flat.to_data();
    data.sh_degree = 1;
    data.sh.assign(flat.size() * data.sh_stride(), 0.0f);
    Random random(spec.seed);
    for (std::size_t row = 0; row < flat.size(); ++row) {
        const auto sh = std::span(data.sh).subspan(row * data.sh_stride(), data.sh_stride());
        std::copy_n(flat.sh().begin() + static_cast<std::ptrdiff_t>(row * Channels), Channels, sh.begin());
        if (scene.parts[row] == synth::Part::Ground) continue;
        for (auto& value : sh.subspan(Channels))
            value = static_cast<float>(random.uniform(-Directional, Directional));
    }
    scene.scene.gaussians = GaussianSet(std::move(data));
    return scene;
}

std::vector<std::uint8_t> shadowed_rows(const synth::SynthScene& scene,
                                        const std::vector<synth::Placing>& places) {
    const GaussianSet ground = synth::ground_under(scene.spec, {}),
                      later = synth::ground_under(scene.spec, places);
    const GaussianSet& set = scene.scene.gaussians;
    const std::size_t stride = set.empty() ? Channels : set.sh().size() / set.size();
    std::vector<std::uint8_t> dark(set.size(), 0);
    std::size_t lit = 0;  // row of the ground; a scan lacks some
    for (std::size_t row = 0; row < set.size() && scene.parts[row] == synth::Part::Ground; ++row, ++lit) {
        while (lit < ground.size() && at(ground.position(), lit) != at(set.position(), row)) ++lit;
        GSE_CHECK(lit < ground.size());
        for (std::size_t c = 0; c < Channels; ++c) {
            const float light = ground.sh()[lit * Channels + c];
            if (light - std::min(set.sh()[row * stride + c], later.sh()[lit * Channels + c]) > LeastDarker)
                dark[row] = 1;
        }
    }
    return dark;
}

synth::SynthScene scanned(synth::SynthScene scene, raster::Rasterizer& rasterizer) {
    const GaussianSet& all = scene.scene.gaussians;
    const GaussianSet ground = synth::ground_under(scene.spec, {});
    std::vector<double> unused(all.size(), 0), shown(all.size(), 0), shown_free(all.size(), 0);
    const Image everything(CaptureSide, CaptureSide, 1, 1.0f);
    for (int i = 0; i < CaptureViews; ++i) {
        const Camera camera =
            synth::scene_camera(scene, 2 * std::numbers::pi * (i + 0.5) / CaptureViews,
                                i % 2 == 0 ? LowElevation : HighElevation, 1, CaptureSide, CaptureSide);
        rasterizer.contributions(all.spans(), camera, {}, everything, unused, shown);
        rasterizer.contributions(ground.spans(), camera, {}, everything,
                                 std::span(unused).first(ground.size()),
                                 std::span(shown_free).first(ground.size()));
    }
    std::vector<std::uint8_t> keep(all.size(), 1);
    std::vector<synth::Part> parts;
    for (std::size_t row = 0; row < all.size(); ++row) {
        if (row < ground.size() && shown[row] <= LeastSeen * shown_free[row]) keep[row] = 0;
        if (keep[row] != 0) parts.push_back(scene.parts[row]);
    }
    scene.scene.gaussians = all.filtered(keep);
    scene.scene.labels = {};
    scene.parts = std::move(parts);
    return scene;
}

}  // namespace gse::bench
