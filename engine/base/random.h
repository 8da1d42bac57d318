// Seeded random numbers, equal on every machine and independent of the standard library.
#pragma once

#include <cmath>
#include <cstdint>

namespace gse {

/// SplitMix64: one 64-bit state, good enough to seed and to sample. A copy forks the stream.
class Random {
    __extension__ using Wide = unsigned __int128;

public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    /// Independent stream number `index` of `seed`.
    static Random stream(std::uint64_t seed, std::uint64_t index) {
        Random mixer(seed ^ (index * 0x9e3779b97f4a7c15ULL + 0x632be59bd9b4e019ULL));
        mixer.next();
        return Random(mixer.next());
    }
    std::uint64_t next() {
        state_ += 0x9e3779b97f4a7c15ULL;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
        return z ^ (z >> 31);
    }
    /// Uniform in [0, 1).
    double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
    double uniform(double low, double high) { return low + (high - low) * uniform(); }
    /// Uniform integer in [0, count); count > 0.
    std::uint64_t below(std::uint64_t count) {
        return static_cast<std::uint64_t>((static_cast<Wide>(next()) * count) >> 64);
    }
    /// Standard normal (Box-Muller, one value per call).
    double normal() {
        const double u = 1.0 - uniform();
        const double v = uniform();
        return std::sqrt(-2.0 * std::log(u)) * std::cos(6.283185307179586476925 * v);
    }

private:
    std::uint64_t state_;
};

}  // namespace gse
