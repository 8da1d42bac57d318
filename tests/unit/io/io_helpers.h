// Shared by the tests of files: random scenes, comparison, errors caught, and the data folder.
#pragma once

#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/random.h"
#include "engine/io/formats/scene_formats.h"
#include "engine/io/project/load_scene.h"
#include "engine/io/scene/scene_file.h"
#include "tests/test_paths.h"

namespace gse::test {

inline std::span<const std::byte> as_bytes(const std::string& text) {
    return {reinterpret_cast<const std::byte*>(text.data()), text.size()};
}

inline std::filesystem::path data_folder() { return shared_folder() / "data"; }

/// The error that `body` throws, or nothing.
template <class F> std::optional<Error> error_of(F&& body) {
    try {
        body();
    } catch (const Error& error) { return error; }
    return std::nullopt;
}

/// The file's bytes in the format of that name.
inline std::string written_as(const std::string& format, const Scene& scene,
                              const SaveOptions& options = {}) {
    std::string bytes;
    find_format(format)->write(scene, options, [&](std::string_view piece) { bytes += piece; });
    return bytes;
}

/// Plausible splats: positions within +-`extent`, scales of some hundredths, any colour and rotation.
inline GaussianData random_gaussians(std::size_t count, int sh_degree, std::uint64_t seed,
                                     double extent = 3) {
    Random random(seed);
    GaussianData data;
    data.sh_degree = sh_degree;
    data.resize(count);
    for (float& value : data.position) value = static_cast<float>(random.uniform(-extent, extent));
    for (float& value : data.log_scale) value = static_cast<float>(random.uniform(-6, -1));
    for (float& value : data.rotation) value = static_cast<float>(random.normal());
    for (float& value : data.opacity_logit) value = static_cast<float>(random.uniform(-5, 5));
    for (float& value : data.sh) value = static_cast<float>(random.uniform(-0.9, 0.9));
    return data;
}

inline Scene random_scene(std::size_t count, int sh_degree, std::uint64_t seed, double extent = 3) {
    Scene scene;
    scene.gaussians = GaussianSet(random_gaussians(count, sh_degree, seed, extent));
    return scene;
}

inline bool same_bits(std::span<const float> a, std::span<const float> b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

inline bool same_bits(const GaussianSet& a, const GaussianSet& b) {
    return a.sh_degree() == b.sh_degree() && same_bits(a.position(), b.position()) &&
           same_bits(a.log_scale(), b.log_scale()) && same_bits(a.rotation(), b.rotation()) &&
           same_bits(a.opacity_logit(), b.opacity_logit()) && same_bits(a.sh(), b.sh());
}

inline double largest_difference(std::span<const float> a, std::span<const float> b) {
    if (a.size() != b.size()) return HUGE_VAL;
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double difference = std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i]));
        if (!(difference <= largest)) largest = difference;
    }
    return largest;
}

/// |cosine| of the half angle between two rotations: 1 = the same.
inline double rotation_agreement(const float* a, const float* b) {
    double ab = 0, aa = 0, bb = 0;
    for (int i = 0; i < 4; ++i) {
        ab += static_cast<double>(a[i]) * b[i];
        aa += static_cast<double>(a[i]) * a[i];
        bb += static_cast<double>(b[i]) * b[i];
    }
    return std::abs(ab) / std::sqrt(aa * bb);
}

inline double sigmoid(double logit) { return 1 / (1 + std::exp(-logit)); }

/// Largest difference of linear opacities.
inline double opacity_difference(const GaussianSet& a, const GaussianSet& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        largest = std::max(largest, std::abs(sigmoid(a.opacity_logit()[i]) - sigmoid(b.opacity_logit()[i])));
    return largest;
}

}  // namespace gse::test
