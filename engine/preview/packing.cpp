// Activation and packing, the part of the upload that costs time.
#include "engine/preview/packing.h"

#include <algorithm>
#include <bit>
#include <cmath>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace gse::preview {
namespace {

// The limits of engine/raster/conventions.h.
constexpr double PositionLimit = 1e18, LogScaleLimit = 30.0, QuaternionCut = 1e-24;
constexpr float LargestHalf = 65504.0f;
constexpr std::uint16_t HalfNan = 0x7e00;

std::uint16_t half_of(float value) {
    const float clamped = std::clamp(value, -LargestHalf, LargestHalf);
    const auto bits = std::bit_cast<std::uint32_t>(clamped);
    const std::uint32_t sign = bits >> 16 & 0x8000u;
    const float size = std::abs(clamped);
    if (size < 6.103515625e-05f)  // subnormal: steps of 2^-24
        return static_cast<std::uint16_t>(sign |
                                          static_cast<std::uint32_t>(std::nearbyint(size * 16777216.0f)));
    const std::uint32_t whole = bits & 0x7fffffffu;
    const std::uint32_t rounded = whole + 0xfffu + (whole >> 13 & 1u);  // to nearest, ties to even
    return static_cast<std::uint16_t>(sign | std::min(((rounded - 0x38000000u) >> 13), 0x7bffu));
}

void to_half_plain(const float* in, std::size_t count, std::uint16_t* out) {
    for (std::size_t i = 0; i < count; ++i) out[i] = half_of(in[i]);
}

#if defined(__x86_64__)
__attribute__((target("avx,f16c"))) void to_half_f16c(const float* in, std::size_t count,
                                                      std::uint16_t* out) {
    const __m256 low = _mm256_set1_ps(-LargestHalf), high = _mm256_set1_ps(LargestHalf);
    std::size_t i = 0;
    for (; i + 8 <= count; i += 8) {
        const __m256 clamped = _mm256_min_ps(_mm256_max_ps(_mm256_loadu_ps(in + i), low), high);
        _mm_storeu_si128(reinterpret_cast<__m128i*>(out + i),
                         _mm256_cvtps_ph(clamped, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC));
    }
    to_half_plain(in + i, count - i, out + i);
}
#endif

bool usable(const float* position, const float* log_scale, const float* rotation, float logit) {
    for (int k = 0; k < 3; ++k) {
        if (!(std::abs(static_cast<double>(position[k])) <= PositionLimit)) return false;
        if (std::isnan(log_scale[k]) || log_scale[k] == INFINITY) return false;
    }
    for (int k = 0; k < 4; ++k)
        if (!std::isfinite(rotation[k])) return false;
    return !std::isnan(logit);
}

void pack_row(const float* position, const float* log_scale, const float* rotation, float logit, float* out) {
    const bool good = usable(position, log_scale, rotation, logit);
    for (int k = 0; k < 3; ++k) out[k] = good ? position[k] : 0.0f;
    out[3] = good ? 1.0f / (1.0f + std::exp(-logit)) : 0.0f;
    double squared = 0;
    for (int k = 0; k < 4; ++k)
        squared += static_cast<double>(rotation[k]) * static_cast<double>(rotation[k]);
    const bool proper = good && squared >= QuaternionCut;
    const double inverse = proper ? 1.0 / std::sqrt(squared) : 0.0;
    for (int k = 0; k < 4; ++k)
        out[4 + k] = proper ? static_cast<float>(rotation[k] * inverse) : (k == 0 ? 1.0f : 0.0f);
    for (int k = 0; k < 3; ++k)
        out[8 + k] = good ? std::exp(std::min(log_scale[k], static_cast<float>(LogScaleLimit))) : 0.0f;
    out[11] = 0.0f;
}

bool all_finite(const float* values, std::size_t count) {
    float sum = 0;
    for (std::size_t i = 0; i < count; ++i) sum += values[i] * 0.0f;  // NaN as soon as one is not finite
    return sum == 0.0f;
}

}  // namespace

void to_half(const float* in, std::size_t count, std::uint16_t* out) {
#if defined(__x86_64__)
    // Processors with AVX2 have F16C, too; not every compiler can be asked for the latter.
    static const bool fast = __builtin_cpu_supports("avx2") != 0;
    if (fast) return to_half_f16c(in, count, out);
#endif
    to_half_plain(in, count, out);
}

void pack_geometry(const GaussianSet& set, std::size_t begin, std::size_t end, float* out) {
    const float *position = set.position().data(), *log_scale = set.log_scale().data(),
                *rotation = set.rotation().data(), *logit = set.opacity_logit().data();
    for (std::size_t row = begin; row < end; ++row, out += 12)
        pack_row(position + row * 3, log_scale + row * 3, rotation + row * 4, logit[row], out);
}

void pack_harmonics(const GaussianSet& set, std::size_t begin, std::size_t end, std::uint16_t* out) {
    const std::size_t count = static_cast<std::size_t>(sh_coefficient_count(set.sh_degree())) * 3;
    const std::size_t stride = harmonics_texels(set.sh_degree()) * 4;
    const float* sh = set.sh().data();
    for (std::size_t row = begin; row < end; ++row, out += stride) {
        const float* from = sh + row * count;
        to_half(from, count, out);
        std::fill(out + count, out + stride, std::uint16_t{0});
        if (!all_finite(from, count)) out[0] = out[1] = out[2] = HalfNan;
    }
}

}  // namespace gse::preview
