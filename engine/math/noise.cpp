// Value noise on a hashed lattice.
#include "engine/math/noise.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace gse {
namespace {

double lattice(std::int64_t x, std::int64_t y, std::int64_t z) {
    auto h = static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15ULL +
             static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4fULL +
             static_cast<std::uint64_t>(z) * 0x165667b19e3779f9ULL;
    h ^= h >> 29;
    h *= 0xbf58476d1ce4e5b9ULL;
    h ^= h >> 32;
    return static_cast<double>(h >> 11) * 0x1.0p-53;
}

}  // namespace

Vec3 mix(const Vec3& a, const Vec3& b, double t) { return a * (1 - t) + b * t; }

double smooth_step(double low, double high, double x) {
    const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

double value_noise(const Vec3& p) {
    const double fx = std::floor(p.x), fy = std::floor(p.y), fz = std::floor(p.z);
    const auto x = static_cast<std::int64_t>(fx), y = static_cast<std::int64_t>(fy),
               z = static_cast<std::int64_t>(fz);
    const double a = smooth_step(0, 1, p.x - fx), b = smooth_step(0, 1, p.y - fy),
                 c = smooth_step(0, 1, p.z - fz);
    const auto edge = [&](std::int64_t j, std::int64_t k) {
        return lattice(x, y + j, z + k) * (1 - a) + lattice(x + 1, y + j, z + k) * a;
    };
    const double low = edge(0, 0) * (1 - b) + edge(1, 0) * b;
    const double high = edge(0, 1) * (1 - b) + edge(1, 1) * b;
    return low * (1 - c) + high * c;
}

double layered_noise(const Vec3& p) {
    return (4 * value_noise(p) + 2 * value_noise(p * 2.03 + Vec3{17, 5, 3}) +
            value_noise(p * 4.01 + Vec3{3, 41, 7})) /
           7;
}

}  // namespace gse
