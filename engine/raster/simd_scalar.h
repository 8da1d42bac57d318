// One lane: the portable form of the register types that kernels.inl is written in. Included inside a
// namespace.
#pragma once

#define GSE_INLINE static inline __attribute__((always_inline))

#ifndef GSE_ONE_LANE_MATH
// Who includes this may bring these, and an exponential and a logarithm, along.
#define GSE_SCALAR_MATH 1
GSE_INLINE float fused(float a, float b, float c) { return a * b + c; }
GSE_INLINE double fused(double a, double b, double c) { return a * b + c; }
GSE_INLINE float power_of_two(float a) { return a > -100.0f ? __builtin_exp2f(a) : 0.0f; }
#endif

/// W lanes of float.
struct F {
    static constexpr int W = 1;
    float v;
};
/// W lanes of double.
struct D {
    static constexpr int W = 1;
    double v;
};
/// Lane masks.
struct M {
    bool v;
};
struct MD {
    bool v;
};

GSE_INLINE F set(float a) { return {a}; }
GSE_INLINE F zero() { return {0}; }
GSE_INLINE F load(const float* p) { return {*p}; }
GSE_INLINE void store(float* p, F a) { *p = a.v; }
GSE_INLINE F operator+(F a, F b) { return {a.v + b.v}; }
GSE_INLINE F operator-(F a, F b) { return {a.v - b.v}; }
GSE_INLINE F operator*(F a, F b) { return {a.v * b.v}; }
GSE_INLINE F operator/(F a, F b) { return {a.v / b.v}; }
GSE_INLINE F fma(F a, F b, F c) { return {fused(a.v, b.v, c.v)}; }
GSE_INLINE F fnma(F a, F b, F c) { return {fused(-a.v, b.v, c.v)}; }
GSE_INLINE F min(F a, F b) { return {a.v < b.v ? a.v : b.v}; }
GSE_INLINE F max(F a, F b) { return {a.v > b.v ? a.v : b.v}; }
GSE_INLINE F sqrt(F a) { return {__builtin_sqrtf(a.v)}; }
GSE_INLINE F floor(F a) { return {__builtin_floorf(a.v)}; }
GSE_INLINE F ceil(F a) { return {__builtin_ceilf(a.v)}; }
GSE_INLINE M operator>(F a, F b) { return {a.v > b.v}; }
GSE_INLINE M operator>=(F a, F b) { return {a.v >= b.v}; }
GSE_INLINE M operator<=(F a, F b) { return {a.v <= b.v}; }
GSE_INLINE M operator&(M a, M b) { return {a.v && b.v}; }
GSE_INLINE M operator|(M a, M b) { return {a.v || b.v}; }
GSE_INLINE M none() { return {false}; }
GSE_INLINE F select(M m, F a, F b) { return m.v ? a : b; }
GSE_INLINE F only(M m, F a) { return {m.v ? a.v : 0.0f}; }
GSE_INLINE unsigned bits(M m) { return m.v ? 1u : 0u; }
GSE_INLINE bool any(M m) { return m.v; }
GSE_INLINE F reciprocal(F a) { return {1.0f / a.v}; }
/// Counters. count() adds 1 in the lanes of m.
struct I {
    std::int32_t v;
};
GSE_INLINE I load(const std::int32_t* p) { return {*p}; }
GSE_INLINE void store(std::int32_t* p, I a) { *p = a.v; }
GSE_INLINE I count(I a, M m) { return {a.v + (m.v ? 1 : 0)}; }
GSE_INLINE void store_int(std::int32_t* p, F a) { *p = static_cast<std::int32_t>(a.v); }
GSE_INLINE I only(M m, I a) { return {m.v ? a.v : 0}; }
GSE_INLINE I set_int(int a) { return {a}; }
GSE_INLINE I operator&(I a, I b) { return {a.v & b.v}; }
GSE_INLINE I operator|(I a, I b) { return {a.v | b.v}; }
template <int N> GSE_INLINE I shift_left(I a) {
    return {static_cast<std::int32_t>(static_cast<std::uint32_t>(a.v) << N)};
}
template <int N> GSE_INLINE I shift_right(I a) {
    return {static_cast<std::int32_t>(static_cast<std::uint32_t>(a.v) >> N)};
}
/// Bits first..last in the lanes of m.
GSE_INLINE I bit_range(M m, F first, F last) {
    return {m.v ? (2 << static_cast<std::int32_t>(last.v)) - (1 << static_cast<std::int32_t>(first.v)) : 0};
}
/// 2^a for a in about [-100, 0]. Anything else gives an arbitrary value.
GSE_INLINE F exp2_lanes(F a) { return {power_of_two(a.v)}; }

GSE_INLINE D setd(double a) { return {a}; }
GSE_INLINE D widen(const float* p) { return {static_cast<double>(*p)}; }
GSE_INLINE void narrow(float* p, D a) { *p = static_cast<float>(a.v); }
GSE_INLINE D operator+(D a, D b) { return {a.v + b.v}; }
GSE_INLINE D operator-(D a, D b) { return {a.v - b.v}; }
GSE_INLINE D operator*(D a, D b) { return {a.v * b.v}; }
GSE_INLINE D operator/(D a, D b) { return {a.v / b.v}; }
GSE_INLINE D fma(D a, D b, D c) { return {fused(a.v, b.v, c.v)}; }
GSE_INLINE D fnma(D a, D b, D c) { return {fused(-a.v, b.v, c.v)}; }
GSE_INLINE D min(D a, D b) { return {a.v < b.v ? a.v : b.v}; }
GSE_INLINE D max(D a, D b) { return {a.v > b.v ? a.v : b.v}; }
GSE_INLINE D sqrt(D a) { return {__builtin_sqrt(a.v)}; }
GSE_INLINE MD operator>(D a, D b) { return {a.v > b.v}; }
GSE_INLINE MD operator>=(D a, D b) { return {a.v >= b.v}; }
GSE_INLINE MD operator<(D a, D b) { return {a.v < b.v}; }
GSE_INLINE MD operator<=(D a, D b) { return {a.v <= b.v}; }
GSE_INLINE MD operator==(D a, D b) { return {a.v == b.v}; }
GSE_INLINE MD operator&(MD a, MD b) { return {a.v && b.v}; }
GSE_INLINE D select(MD m, D a, D b) { return m.v ? a : b; }
GSE_INLINE unsigned bits(MD m) { return m.v ? 1u : 0u; }
#ifdef GSE_SCALAR_MATH
GSE_INLINE F exp_lanes(F a) { return {__builtin_expf(a.v)}; }
GSE_INLINE F log2_lanes(F a) { return {__builtin_log2f(a.v)}; }
#endif

/// Columns of W rows -> to[column][row]. Rows may lie anywhere.
GSE_INLINE void load_columns(const float* const* rows, int columns, float* to) {
    for (int k = 0; k < columns; ++k) to[k] = rows[0][k];
}
/// The reverse, for the first `count` rows.
GSE_INLINE void store_columns(const float* from, int columns, float* const* rows, int row_count) {
    if (row_count < 1) return;
    for (int k = 0; k < columns; ++k) rows[0][k] = from[k];
}
/// Horizontal sums of ten registers, into the first ten floats of `to`. The other six become 0.
GSE_INLINE void store_sums(const F* a, float* to) {
    for (int k = 0; k < 16; ++k) to[k] = k < 10 ? a[k].v : 0.0f;
}
