// Ground textures (grass, sand, snow, water, tiles) and the cast shadow as a small height-free map.
#include "engine/laboratory/synth/objects/ground.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gse::synth {
namespace {

/// Darkness of the ground around the object, [0,1], on a square grid; sampled bilinearly.
class ShadowMap {
public:
    ShadowMap(std::span<const SurfacePoint> object, const Light& light) {
        for (const auto& point : object) {
            const Vec3& p = point.position;
            const double area = point.spacing * point.spacing;
            const double reach = p.y / std::max(light.key.y, 0.2);
            deposit(p.x - light.key.x * reach, p.z - light.key.z * reach, area * 1.1);
            if (p.y < ContactHeight) deposit(p.x, p.z, area * 1.6 * (1 - p.y / ContactHeight));
        }
        blur();
        blur();
    }

    double darkness(double x, double z) const {
        const double gx = std::clamp((x / HalfWidth + 1) * 0.5 * (Cells - 1), 0.0, Cells - 1.001);
        const double gz = std::clamp((z / HalfWidth + 1) * 0.5 * (Cells - 1), 0.0, Cells - 1.001);
        const auto ix = static_cast<std::size_t>(gx), iz = static_cast<std::size_t>(gz);
        const double tx = gx - static_cast<double>(ix), tz = gz - static_cast<double>(iz);
        const auto low = at(ix, iz) * (1 - tx) + at(ix + 1, iz) * tx;
        const auto high = at(ix, iz + 1) * (1 - tx) + at(ix + 1, iz + 1) * tx;
        return std::min(1.0, low * (1 - tz) + high * tz);
    }

private:
    static constexpr int Cells = 44;
    static constexpr double HalfWidth = 1.5;  // model units
    static constexpr double ContactHeight = 0.12;

    double at(std::size_t x, std::size_t z) const { return cells_[z * Cells + x]; }
    void deposit(double x, double z, double area) {
        constexpr double Cell = 2 * HalfWidth / (Cells - 1);
        const auto ix = static_cast<int>(std::lround((x + HalfWidth) / Cell));
        const auto iz = static_cast<int>(std::lround((z + HalfWidth) / Cell));
        if (ix < 1 || iz < 1 || ix >= Cells - 1 || iz >= Cells - 1) return;
        cells_[static_cast<std::size_t>(iz * Cells + ix)] += area / (Cell * Cell);
    }
    void blur() {
        for (auto& cell : cells_) cell = std::min(cell, 1.3);
        const auto old = cells_;
        for (std::size_t z = 1; z + 1 < Cells; ++z)
            for (std::size_t x = 1; x + 1 < Cells; ++x) {
                const std::size_t i = z * Cells + x;
                cells_[i] =
                    0.25 * old[i] + 0.125 * (old[i - 1] + old[i + 1] + old[i - Cells] + old[i + Cells]) +
                    0.0625 *
                        (old[i - Cells - 1] + old[i - Cells + 1] + old[i + Cells - 1] + old[i + Cells + 1]);
            }
    }

    std::array<double, static_cast<std::size_t>(Cells) * Cells> cells_{};
};

Vec3 ground_colour(const std::string& word, const Vec3& p, const Vec3& offset) {
    const Vec3 q = p + offset;
    if (word == "grass") {
        const double patch = layered_noise(q * 2.2);
        const double blade = value_noise(q * 13.0);
        const Vec3 base = mix({0.20, 0.50, 0.10}, {0.52, 0.74, 0.20}, smooth_step(0.25, 0.75, patch));
        return base * (0.75 + 0.5 * blade);
    }
    if (word == "sand") {
        const double ripple = 0.5 + 0.5 * std::sin(9.0 * (p.z + 0.35 * p.x) + 5.0 * layered_noise(q * 1.1));
        return mix({0.80, 0.64, 0.40}, {0.94, 0.83, 0.60}, 0.65 * ripple + 0.35 * value_noise(q * 11.0));
    }
    if (word == "snow") {
        const double drift = layered_noise(q * 1.6);
        return mix({0.80, 0.87, 0.98}, {0.97, 0.98, 1.0}, smooth_step(0.3, 0.62, drift));
    }
    if (word == "water") {
        const double bend = layered_noise(q * 1.7);
        const double wave = 0.5 + 0.5 * std::sin(8.5 * p.z + 1.2 * p.x + 9.0 * bend);
        const Vec3 base = mix({0.05, 0.42, 0.58}, {0.20, 0.68, 0.80}, wave);
        return mix(base, {0.85, 0.97, 1.0},
                   0.8 * smooth_step(0.82, 1.0, wave) * smooth_step(0.35, 0.6, value_noise(q * 2.7)));
    }
    if (word == "leaves") {  // fallen, in autumn
        const double kind = value_noise(q * 8.0), shade = value_noise(q * 15.0 + Vec3{5, 0, 9});
        const Vec3 leaf = mix(mix({0.55, 0.16, 0.04}, {0.90, 0.48, 0.06}, smooth_step(0.25, 0.55, kind)),
                              {0.93, 0.78, 0.18}, smooth_step(0.58, 0.75, kind));
        return leaf * (0.6 + 0.55 * shade);
    }
    if (word == "mud") {
        const double wet = layered_noise(q * 2.6);
        return mix({0.22, 0.13, 0.07}, {0.45, 0.30, 0.18}, smooth_step(0.3, 0.7, wet)) *
               (0.85 + 0.3 * value_noise(q * 12.0));
    }
    if (word == "gravel") {
        const double pebble = value_noise(q * 11.0), tone = value_noise(q * 3.0);
        const double grey = 0.22 + 0.58 * smooth_step(0.25, 0.75, pebble) * (0.75 + 0.4 * tone);
        return Vec3{grey, 0.98 * grey, 0.95 * grey};
    }
    if (word == "ice") {
        const double crack = std::abs(layered_noise(q * 1.8) - 0.5);
        const Vec3 sheet =
            mix({0.52, 0.78, 0.92}, {0.74, 0.92, 0.99}, smooth_step(0.3, 0.7, value_noise(q * 1.3)));
        return mix({0.97, 0.99, 1.0}, sheet, smooth_step(0.0, 0.05, crack));
    }
    constexpr double Tile = 0.5;
    const auto column = static_cast<long>(std::floor(p.x / Tile + 0.5));
    const auto row = static_cast<long>(std::floor(p.z / Tile + 0.5));
    return ((column + row) & 1) == 0 ? Vec3{0.90, 0.90, 0.88} : Vec3{0.25, 0.28, 0.33};
}

}  // namespace

GroundSample make_ground(const std::string& word, int target, std::span<const SurfacePoint> object,
                         const Light& light, Random random) {
    constexpr double Golden = 2.399963229728653;  // golden angle
    constexpr double Crowding = 0.72;             // radius = u^Crowding; 0.5 would be even
    const ShadowMap shadow(object, light);
    const Vec3 offset{random.uniform(0, 60), 0, random.uniform(0, 60)};
    const double turn = random.uniform(0, 6.2831853);
    const double brightness = light.sky_strength + light.key_strength * light.key.y;
    GroundSample sample;
    sample.points.reserve(static_cast<std::size_t>(target));
    sample.colours.reserve(static_cast<std::size_t>(target));
    for (int i = 0; i < target; ++i) {
        const double u = (i + 0.5) / target;
        const double radius = GroundRadius * std::pow(u, Crowding);
        const double spread = GroundRadius * Crowding * std::pow(u, Crowding - 1);  // d radius / d u
        SurfacePoint point;
        const double angle = turn + Golden * i;
        point.spacing = std::sqrt(6.2831853 * radius * spread / target);
        const double jitter = 0.2 * point.spacing;
        point.position = {radius * std::cos(angle) + random.uniform(-jitter, jitter), 0,
                          radius * std::sin(angle) + random.uniform(-jitter, jitter)};
        point.normal = {0, 1, 0};
        const double dark = shadow.darkness(point.position.x, point.position.z);
        const Vec3 tone = mix({1, 1, 1}, {0.40, 0.42, 0.50}, dark);
        const Vec3 colour = ground_colour(word, point.position, offset) * std::min(brightness, 1.05);
        sample.points.push_back(point);
        sample.colours.push_back({std::min(colour.x * tone.x, 1.0), std::min(colour.y * tone.y, 1.0),
                                  std::min(colour.z * tone.z, 1.0)});
    }
    return sample;
}

}  // namespace gse::synth
