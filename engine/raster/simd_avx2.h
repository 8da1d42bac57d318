// 8 lanes of float and 4 of double: AVX2 form of the register types that kernels.inl is written in. Included
// inside a namespace, after immintrin.h.
#pragma once

#define GSE_INLINE static inline __attribute__((always_inline))

struct F {
    static constexpr int W = 8;
    __m256 v;
};
struct D {
    static constexpr int W = 4;
    __m256d v;
};
struct M {
    __m256 v;
};
struct MD {
    __m256d v;
};

GSE_INLINE F set(float a) { return {_mm256_set1_ps(a)}; }
GSE_INLINE F zero() { return {_mm256_setzero_ps()}; }
GSE_INLINE F load(const float* p) { return {_mm256_load_ps(p)}; }
GSE_INLINE void store(float* p, F a) { _mm256_store_ps(p, a.v); }
GSE_INLINE F operator+(F a, F b) { return {_mm256_add_ps(a.v, b.v)}; }
GSE_INLINE F operator-(F a, F b) { return {_mm256_sub_ps(a.v, b.v)}; }
GSE_INLINE F operator*(F a, F b) { return {_mm256_mul_ps(a.v, b.v)}; }
GSE_INLINE F operator/(F a, F b) { return {_mm256_div_ps(a.v, b.v)}; }
GSE_INLINE F fma(F a, F b, F c) { return {_mm256_fmadd_ps(a.v, b.v, c.v)}; }
GSE_INLINE F fnma(F a, F b, F c) { return {_mm256_fnmadd_ps(a.v, b.v, c.v)}; }
GSE_INLINE F min(F a, F b) { return {_mm256_min_ps(a.v, b.v)}; }
GSE_INLINE F max(F a, F b) { return {_mm256_max_ps(a.v, b.v)}; }
GSE_INLINE F sqrt(F a) { return {_mm256_sqrt_ps(a.v)}; }
GSE_INLINE F floor(F a) { return {_mm256_floor_ps(a.v)}; }
GSE_INLINE F ceil(F a) { return {_mm256_ceil_ps(a.v)}; }
GSE_INLINE M operator>(F a, F b) { return {_mm256_cmp_ps(a.v, b.v, _CMP_GT_OQ)}; }
GSE_INLINE M operator>=(F a, F b) { return {_mm256_cmp_ps(a.v, b.v, _CMP_GE_OQ)}; }
GSE_INLINE M operator<=(F a, F b) { return {_mm256_cmp_ps(a.v, b.v, _CMP_LE_OQ)}; }
GSE_INLINE M operator&(M a, M b) { return {_mm256_and_ps(a.v, b.v)}; }
GSE_INLINE M operator|(M a, M b) { return {_mm256_or_ps(a.v, b.v)}; }
GSE_INLINE M none() { return {_mm256_setzero_ps()}; }
GSE_INLINE F select(M m, F a, F b) { return {_mm256_blendv_ps(b.v, a.v, m.v)}; }
GSE_INLINE F only(M m, F a) { return {_mm256_and_ps(m.v, a.v)}; }
GSE_INLINE unsigned bits(M m) { return static_cast<unsigned>(_mm256_movemask_ps(m.v)); }
GSE_INLINE bool any(M m) { return _mm256_movemask_ps(m.v) != 0; }
GSE_INLINE F reciprocal(F a) { return {_mm256_div_ps(_mm256_set1_ps(1.0f), a.v)}; }
/// Counters. count() adds 1 in the lanes of m.
struct I {
    __m256i v;
};
GSE_INLINE I load(const std::int32_t* p) { return {_mm256_load_si256(reinterpret_cast<const __m256i*>(p))}; }
GSE_INLINE void store(std::int32_t* p, I a) { _mm256_store_si256(reinterpret_cast<__m256i*>(p), a.v); }
GSE_INLINE I count(I a, M m) { return {_mm256_sub_epi32(a.v, _mm256_castps_si256(m.v))}; }
GSE_INLINE void store_int(std::int32_t* p, F a) {
    _mm256_store_si256(reinterpret_cast<__m256i*>(p), _mm256_cvttps_epi32(a.v));
}
GSE_INLINE I only(M m, I a) { return {_mm256_and_si256(a.v, _mm256_castps_si256(m.v))}; }
GSE_INLINE I set_int(int a) { return {_mm256_set1_epi32(a)}; }
GSE_INLINE I operator&(I a, I b) { return {_mm256_and_si256(a.v, b.v)}; }
GSE_INLINE I operator|(I a, I b) { return {_mm256_or_si256(a.v, b.v)}; }
template <int N> GSE_INLINE I shift_left(I a) { return {_mm256_slli_epi32(a.v, N)}; }
template <int N> GSE_INLINE I shift_right(I a) { return {_mm256_srli_epi32(a.v, N)}; }
/// Bits first..last in the lanes of m.
GSE_INLINE I bit_range(M m, F first, F last) {
    const __m256i one = _mm256_set1_epi32(1), two = _mm256_set1_epi32(2);
    const __m256i low = _mm256_sllv_epi32(one, _mm256_cvttps_epi32(first.v));
    const __m256i bits = _mm256_sub_epi32(_mm256_sllv_epi32(two, _mm256_cvttps_epi32(last.v)), low);
    return {_mm256_and_si256(bits, _mm256_castps_si256(m.v))};
}
/// 2^a: degree-5 minimax polynomial on [-1/2, 1/2], relative error 7.5e-8. The power goes into the exponent
/// field.
GSE_INLINE F exp2_lanes(F a) {
    // 1.5 * 2^23: adding it rounds to a whole number in the low bits.
    const __m256 magic = _mm256_set1_ps(12582912.0f);
    const __m256 shifted = _mm256_add_ps(a.v, magic);
    const __m256 x = _mm256_sub_ps(a.v, _mm256_sub_ps(shifted, magic));
    __m256 p = _mm256_set1_ps(1.3276471519718357e-3f);
    p = _mm256_fmadd_ps(p, x, _mm256_set1_ps(9.675541330689541e-3f));
    p = _mm256_fmadd_ps(p, x, _mm256_set1_ps(5.550713274960774e-2f));
    p = _mm256_fmadd_ps(p, x, _mm256_set1_ps(0.24022119723933638f));
    p = _mm256_fmadd_ps(p, x, _mm256_set1_ps(0.6931469670638641f));
    p = _mm256_fmadd_ps(p, x, _mm256_set1_ps(1.0000000716546549f));
    const __m256i power = _mm256_slli_epi32(_mm256_castps_si256(shifted), 23);
    return {_mm256_castsi256_ps(_mm256_add_epi32(_mm256_castps_si256(p), power))};
}

GSE_INLINE D setd(double a) { return {_mm256_set1_pd(a)}; }
GSE_INLINE D widen(const float* p) { return {_mm256_cvtps_pd(_mm_load_ps(p))}; }
GSE_INLINE void narrow(float* p, D a) { _mm_store_ps(p, _mm256_cvtpd_ps(a.v)); }
GSE_INLINE D operator+(D a, D b) { return {_mm256_add_pd(a.v, b.v)}; }
GSE_INLINE D operator-(D a, D b) { return {_mm256_sub_pd(a.v, b.v)}; }
GSE_INLINE D operator*(D a, D b) { return {_mm256_mul_pd(a.v, b.v)}; }
GSE_INLINE D operator/(D a, D b) { return {_mm256_div_pd(a.v, b.v)}; }
GSE_INLINE D fma(D a, D b, D c) { return {_mm256_fmadd_pd(a.v, b.v, c.v)}; }
GSE_INLINE D fnma(D a, D b, D c) { return {_mm256_fnmadd_pd(a.v, b.v, c.v)}; }
GSE_INLINE D min(D a, D b) { return {_mm256_min_pd(a.v, b.v)}; }
GSE_INLINE D max(D a, D b) { return {_mm256_max_pd(a.v, b.v)}; }
GSE_INLINE D sqrt(D a) { return {_mm256_sqrt_pd(a.v)}; }
GSE_INLINE MD operator>(D a, D b) { return {_mm256_cmp_pd(a.v, b.v, _CMP_GT_OQ)}; }
GSE_INLINE MD operator>=(D a, D b) { return {_mm256_cmp_pd(a.v, b.v, _CMP_GE_OQ)}; }
GSE_INLINE MD operator<(D a, D b) { return {_mm256_cmp_pd(a.v, b.v, _CMP_LT_OQ)}; }
GSE_INLINE MD operator<=(D a, D b) { return {_mm256_cmp_pd(a.v, b.v, _CMP_LE_OQ)}; }
GSE_INLINE MD operator==(D a, D b) { return {_mm256_cmp_pd(a.v, b.v, _CMP_EQ_OQ)}; }
GSE_INLINE MD operator&(MD a, MD b) { return {_mm256_and_pd(a.v, b.v)}; }
GSE_INLINE D select(MD m, D a, D b) { return {_mm256_blendv_pd(b.v, a.v, m.v)}; }
GSE_INLINE unsigned bits(MD m) { return static_cast<unsigned>(_mm256_movemask_pd(m.v)); }
/// a 2^power, for whole powers and results that are normal numbers.
GSE_INLINE F scale_by_power(F a, F power) {
    const __m256i field = _mm256_slli_epi32(_mm256_cvtps_epi32(power.v), 23);
    return {_mm256_castsi256_ps(_mm256_add_epi32(_mm256_castps_si256(a.v), field))};
}
GSE_INLINE F exponent_of(F a) {
    const __m256i field = _mm256_srli_epi32(_mm256_castps_si256(a.v), 23);
    return {_mm256_cvtepi32_ps(_mm256_sub_epi32(field, _mm256_set1_epi32(127)))};
}
GSE_INLINE F mantissa_of(F a) {
    const __m256i low = _mm256_and_si256(_mm256_castps_si256(a.v), _mm256_set1_epi32(0x007fffff));
    return {_mm256_castsi256_ps(_mm256_or_si256(low, _mm256_set1_epi32(0x3f800000)))};
}

/// 8x8 transpose of registers.
GSE_INLINE void transpose(__m256* r) {
    __m256 t[8];
    for (int i = 0; i < 8; i += 2) {
        t[i] = _mm256_unpacklo_ps(r[i], r[i + 1]);
        t[i + 1] = _mm256_unpackhi_ps(r[i], r[i + 1]);
    }
    for (int i = 0; i < 8; i += 4) {
        r[i] = _mm256_shuffle_ps(t[i], t[i + 2], 0x44);
        r[i + 1] = _mm256_shuffle_ps(t[i], t[i + 2], 0xee);
        r[i + 2] = _mm256_shuffle_ps(t[i + 1], t[i + 3], 0x44);
        r[i + 3] = _mm256_shuffle_ps(t[i + 1], t[i + 3], 0xee);
    }
    for (int i = 0; i < 4; ++i) {
        const __m256 low = r[i], high = r[i + 4];
        r[i] = _mm256_permute2f128_ps(low, high, 0x20);
        r[i + 4] = _mm256_permute2f128_ps(low, high, 0x31);
    }
}
GSE_INLINE void load_columns(const float* const* rows, int columns, float* to) {
    int base = 0;
    for (; base + 8 <= columns; base += 8) {
        __m256 r[8];
        for (int i = 0; i < 8; ++i) r[i] = _mm256_loadu_ps(rows[i] + base);
        transpose(r);
        for (int i = 0; i < 8; ++i) _mm256_store_ps(to + (base + i) * 8, r[i]);
    }
    for (; base < columns; ++base)
        for (int row = 0; row < 8; ++row) to[base * 8 + row] = rows[row][base];
}
GSE_INLINE void store_columns(const float* from, int columns, float* const* rows, int row_count) {
    int base = 0;
    for (; base + 8 <= columns; base += 8) {
        __m256 r[8];
        for (int i = 0; i < 8; ++i) r[i] = _mm256_load_ps(from + (base + i) * 8);
        transpose(r);
        for (int i = 0; i < row_count; ++i) _mm256_storeu_ps(rows[i] + base, r[i]);
    }
    for (; base < columns; ++base)
        for (int row = 0; row < row_count; ++row) rows[row][base] = from[base * 8 + row];
}
/// store_columns of whole cache lines, and zeros, that go past the caches.
#define GSE_HAS_STREAMS 1
constexpr bool HasStreams = true;
GSE_INLINE void stream_columns(const float* from, int columns, float* const* rows, int row_count) {
    for (int base = 0; base < columns; base += 16) {
        __m256 low[8], high[8];
        for (int i = 0; i < 8; ++i) low[i] = _mm256_load_ps(from + (base + i) * 8);
        for (int i = 0; i < 8; ++i) high[i] = _mm256_load_ps(from + (base + 8 + i) * 8);
        transpose(low);
        transpose(high);
        for (int i = 0; i < row_count; ++i) {  // the two halves of a line together
            _mm256_stream_ps(rows[i] + base, low[i]);
            _mm256_stream_ps(rows[i] + base + 8, high[i]);
        }
    }
}
GSE_INLINE void stream_zeros(float* to, std::size_t count) {
    for (std::size_t i = 0; i < count; i += 8) _mm256_stream_ps(to + i, _mm256_setzero_ps());
}
/// Orders streamed stores before all later ones.
GSE_INLINE void end_streams() { _mm_sfence(); }

/// For each set of eight bits, the places of those that are set, in order.
struct PlacesOfBits {
    std::uint8_t of[256][8];
};
constexpr PlacesOfBits places_of_bits() {
    PlacesOfBits places = {};
    for (int set = 0; set < 256; ++set)
        for (int bit = 0, found = 0; bit < 8; ++bit)
            if ((set >> bit & 1) != 0) places.of[set][found++] = static_cast<std::uint8_t>(bit);
    return places;
}
/// Masks of 16 entries -> for each block the list of the entries that touch it. Has no branch, since nothing
/// of it can be predicted.
#define GSE_HAS_LISTS 1
GSE_INLINE void append_lists(const std::uint32_t* blocks, std::uint32_t first, std::uint16_t (*lists)[272],
                             std::uint32_t* lengths) {
    static constexpr PlacesOfBits places = places_of_bits();
    for (std::uint32_t half = 0; half < 16; half += 8) {
        const __m256i masks = _mm256_load_si256(reinterpret_cast<const __m256i*>(blocks + half));
        const __m128i base = _mm_set1_epi16(static_cast<short>(first + half));
        for (int block = 15; block >= 0; --block) {  // its bit is moved to where the sign is
            const __m256i at_sign = _mm256_slli_epi32(masks, 31 - block);
            const auto touched = static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(at_sign)));
            const __m128i found =
                _mm_cvtepu8_epi16(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(places.of[touched])));
            _mm_storeu_si128(reinterpret_cast<__m128i*>(lists[block] + lengths[block]),
                             _mm_add_epi16(found, base));
            lengths[block] += static_cast<std::uint32_t>(__builtin_popcount(touched));
        }
    }
}
/// Sums of four registers, one per lane.
GSE_INLINE __m128 four_sums(__m256 a, __m256 b, __m256 c, __m256 d) {
    const __m256 abcd = _mm256_hadd_ps(_mm256_hadd_ps(a, b), _mm256_hadd_ps(c, d));
    return _mm_add_ps(_mm256_castps256_ps128(abcd), _mm256_extractf128_ps(abcd, 1));
}
/// Horizontal sums of ten registers, into the first ten floats of `to`. The other six become 0.
GSE_INLINE void store_sums(const F* a, float* to) {
    const __m256 nought = _mm256_setzero_ps();
    _mm_store_ps(to, four_sums(a[0].v, a[1].v, a[2].v, a[3].v));
    _mm_store_ps(to + 4, four_sums(a[4].v, a[5].v, a[6].v, a[7].v));
    _mm_store_ps(to + 8, four_sums(a[8].v, a[9].v, nought, nought));
    _mm_store_ps(to + 12, _mm_setzero_ps());
}
GSE_INLINE void stream_sums(const F* a, float* to) {
    const __m256 nought = _mm256_setzero_ps();
    const __m128 first = four_sums(a[0].v, a[1].v, a[2].v, a[3].v),
                 second = four_sums(a[4].v, a[5].v, a[6].v, a[7].v);
    const __m128 third = four_sums(a[8].v, a[9].v, nought, nought);
    _mm256_stream_ps(to, _mm256_set_m128(second, first));
    _mm256_stream_ps(to + 8, _mm256_set_m128(_mm_setzero_ps(), third));
}
