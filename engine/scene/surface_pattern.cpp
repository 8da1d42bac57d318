// Stripes, spots, squares; stone, rust and lava out of noise.
#include "engine/scene/surface_pattern.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/math/noise.h"

namespace gse {
namespace {

using Kind = SurfacePattern::Kind;

struct Named {
    const char* word;
    Kind kind;
};

constexpr std::array<Named, 16> Patterns{{{"striped", Kind::Striped},
                                          {"spotted", Kind::Spotted},
                                          {"dotted", Kind::Spotted},
                                          {"checkered", Kind::Checkered},
                                          {"checked", Kind::Checkered},
                                          {"chequered", Kind::Checkered},
                                          {"rainbow", Kind::Rainbow},
                                          {"marble", Kind::Marble},
                                          {"brick", Kind::Brick},
                                          {"rusty", Kind::Rusty},
                                          {"lava", Kind::Lava},
                                          {"mossy", Kind::Mossy},
                                          {"zebra", Kind::Zebra},
                                          {"leopard", Kind::Leopard},
                                          {"camouflage", Kind::Camouflage},
                                          {"rainbow-coloured", Kind::Rainbow}}};

/// Light blue-white veins across white: Perlin's marble.
Vec3 marble(const Vec3& q) {
    const double bend = layered_noise(q * 3.2);
    const double vein = std::abs(std::sin(3.14159265 * (3.0 * (q.x + 0.7 * q.y + 0.4 * q.z) + 5.5 * bend)));
    const double cloud = layered_noise(q * 2.0 + Vec3{9, 4, 2});
    const Vec3 ground = mix({0.98, 0.97, 0.95}, {0.86, 0.86, 0.88}, smooth_step(0.4, 0.75, cloud));
    return mix({0.42, 0.44, 0.50}, ground, smooth_step(0.05, 0.42, vein));
}

/// Courses of bricks around the vertical axis, every other one moved by half a brick.
Vec3 brick(const Vec3& p, const Vec3& q) {
    constexpr double Height = 0.105, Around = 11, Joint = 0.16;  // bricks around; of a brick's height
    const double course = p.y / Height, row = std::floor(course);
    const double place = Around * (std::atan2(p.z, p.x) / 6.28318531 + 0.5) + 0.5 * std::fmod(row + 100, 2.0);
    const double up = course - row, along = place - std::floor(place);
    if (up < Joint || along < 0.5 * Joint) return {0.80, 0.77, 0.72};
    const double tone = value_noise(Vec3{std::floor(place) * 7.3, row * 5.1, 0} + q);
    return mix({0.48, 0.15, 0.09}, {0.78, 0.32, 0.20}, tone);
}

/// Round dots on a jittered cubic lattice.
bool in_spot(const Vec3& p, const Vec3& offset) {
    constexpr double Cell = 0.2, Radius = 0.34;
    const Vec3 q = (p + offset) * (1 / Cell);
    const Vec3 cell{std::floor(q.x), std::floor(q.y), std::floor(q.z)};
    for (int k = 0; k < 27; ++k) {
        const Vec3 near = cell + Vec3{k % 3 - 1.0, k / 3 % 3 - 1.0, k / 9 - 1.0};
        const Vec3 middle = near + Vec3{0.5 + 0.3 * (value_noise(near * 3.7) - 0.5),
                                        0.5 + 0.3 * (value_noise(near * 5.1) - 0.5), 0.5};
        if (length(q - middle) < Radius * 1.25) return true;
    }
    return false;
}

Vec3 rainbow(const Vec3& p) {
    constexpr std::array<Vec3, 6> Bands{Vec3{0.50, 0.15, 0.75}, Vec3{0.12, 0.28, 0.90},
                                        Vec3{0.08, 0.62, 0.22}, Vec3{0.98, 0.88, 0.10},
                                        Vec3{0.98, 0.50, 0.05}, Vec3{0.88, 0.08, 0.08}};
    const double at = std::clamp(p.y / 1.02, 0.0, 0.999) * Bands.size();
    const auto i = static_cast<std::size_t>(at);
    const Vec3& next = Bands[std::min(i + 1, Bands.size() - 1)];
    return mix(Bands[i], next, smooth_step(0.8, 1.0, at - std::floor(at)));
}

Vec3 rusty(const Vec3& q) {
    const double patch = layered_noise(q * 5.0), grain = value_noise(q * 40.0);
    const Vec3 rust = mix({0.36, 0.14, 0.05}, {0.76, 0.36, 0.12}, 0.6 * value_noise(q * 13.0) + 0.4 * grain);
    return mix(rust, {0.34, 0.33, 0.34}, smooth_step(0.56, 0.66, patch));
}

/// Dark crust with glowing cracks.
Vec3 lava(const Vec3& q) {
    const double crack = std::abs(layered_noise(q * 4.2) - 0.5) + 0.35 * std::abs(value_noise(q * 9.0) - 0.5);
    const Vec3 glow = mix({1.0, 0.85, 0.20}, {0.95, 0.28, 0.02}, smooth_step(0.02, 0.08, crack));
    return mix(glow, Vec3{0.10, 0.07, 0.07} * (0.7 + 0.6 * value_noise(q * 20.0)),
               smooth_step(0.08, 0.13, crack));
}

Vec3 mossy(const Vec3& p, const Vec3& q) {
    const double grey = 0.36 + 0.38 * layered_noise(q * 6.0);
    const double grown = smooth_step(0.38, 0.58, layered_noise(q * 3.6) + 0.12 * (p.y - 0.5));
    const Vec3 moss = mix({0.18, 0.34, 0.06}, {0.52, 0.70, 0.20}, value_noise(q * 24.0));
    return mix(Vec3{grey, grey, 0.95 * grey}, moss, grown);
}

/// Black stripes that bend and fork as noise does.
Vec3 zebra(const Vec3& p, const Vec3& q) {
    const double bend = layered_noise(q * 2.6);
    const double wave = std::sin(6.28318531 * (p.z / 0.16 + 0.35 * p.y / 0.16 + 2.2 * bend));
    return mix({0.07, 0.07, 0.08}, {0.95, 0.94, 0.92}, smooth_step(-0.12, 0.12, wave));
}

/// Dark rings around brown on tan.
Vec3 leopard(const Vec3& p, const Vec3& offset) {
    constexpr double Cell = 0.17;
    const Vec3 q = (p + offset) * (1 / Cell);
    const Vec3 cell{std::floor(q.x), std::floor(q.y), std::floor(q.z)};
    double nearest = 2;
    for (int k = 0; k < 27; ++k) {
        const Vec3 near = cell + Vec3{k % 3 - 1.0, k / 3 % 3 - 1.0, k / 9 - 1.0};
        const Vec3 middle =
            near + Vec3{value_noise(near * 3.7), value_noise(near * 5.1), value_noise(near * 4.3)};
        nearest = std::min(nearest, length(q - middle));
    }
    const Vec3 ground{0.84, 0.62, 0.32};
    if (nearest > 0.45) return ground;
    return nearest > 0.26 ? Vec3{0.12, 0.08, 0.05} : Vec3{0.56, 0.34, 0.14};
}

Vec3 camouflage(const Vec3& q) {
    const double dark = layered_noise(q * 3.4), pale = layered_noise(q * 3.4 + Vec3{31, 7, 19});
    if (dark > 0.57) return {0.12, 0.13, 0.08};
    if (pale > 0.56) return {0.60, 0.54, 0.36};
    return layered_noise(q * 2.7 + Vec3{5, 23, 11}) > 0.5 ? Vec3{0.25, 0.34, 0.14} : Vec3{0.36, 0.26, 0.14};
}

Vec3 squares(const SurfacePattern& pattern, const Vec3& p) {
    constexpr double Square = 0.21;
    const auto cell = std::lround(std::floor(p.x / Square + 0.5) + std::floor(p.y / Square) +
                                  std::floor(p.z / Square + 0.5));
    return (cell & 1) == 0 ? pattern.first : pattern.second;
}

}  // namespace

const std::vector<std::string>& pattern_words() {
    static const std::vector<std::string> words = [] {
        std::vector<std::string> all;
        for (const auto& named : Patterns) all.emplace_back(named.word);
        return all;
    }();
    return words;
}

std::optional<SurfacePattern> pattern_named(const std::string& word) {
    const auto found = std::find_if(Patterns.begin(), Patterns.end(),
                                    [&](const Named& named) { return word == named.word; });
    if (found == Patterns.end()) return std::nullopt;
    SurfacePattern pattern;
    pattern.kind = found->kind;
    return pattern;
}

bool takes_colours(SurfacePattern::Kind kind) {
    return kind == Kind::Striped || kind == Kind::Spotted || kind == Kind::Checkered;
}

Vec3 colour_at(const SurfacePattern& pattern, const Vec3& p) {
    const Vec3 q = p + pattern.offset;
    switch (pattern.kind) {
        case Kind::Striped:
            return std::sin(6.28318531 * (p.y / 0.17 + 0.12 * p.x)) < 0 ? pattern.first : pattern.second;
        case Kind::Spotted: return in_spot(p, pattern.offset) ? pattern.first : pattern.second;
        case Kind::Checkered: return squares(pattern, p);
        case Kind::Rainbow: return rainbow(p);
        case Kind::Marble: return marble(q);
        case Kind::Brick: return brick(p, pattern.offset);
        case Kind::Rusty: return rusty(q);
        case Kind::Lava: return lava(q);
        case Kind::Mossy: return mossy(p, q);
        case Kind::Zebra: return zebra(p, q);
        case Kind::Leopard: return leopard(p, pattern.offset);
        case Kind::Camouflage: return camouflage(q);
    }
    return pattern.first;
}

}  // namespace gse
