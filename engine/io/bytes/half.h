// 16-bit floats as stored in files.
#pragma once

#include <cmath>
#include <cstdint>

namespace gse::io {

inline float half_to_float(std::uint16_t half) {
    const int exponent = (half >> 10) & 31;
    const int mantissa = half & 1023;
    const double magnitude = exponent == 0    ? std::ldexp(mantissa, -24)
                             : exponent == 31 ? (mantissa == 0 ? HUGE_VAL : NAN)
                                              : std::ldexp(1024 + mantissa, exponent - 25);
    return static_cast<float>((half & 0x8000) != 0 ? -magnitude : magnitude);
}

}  // namespace gse::io
