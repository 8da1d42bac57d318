// 16 lanes of float and 8 of double: AVX-512 form of the register types that kernels.inl is written in.
// Included inside a namespace, after immintrin.h.
#pragma once

#define GSE_INLINE static inline __attribute__((always_inline))

struct F {
    static constexpr int W = 16;
    __m512 v;
};
struct D {
    static constexpr int W = 8;
    __m512d v;
};
struct M {
    __mmask16 v;
};
struct MD {
    __mmask8 v;
};

GSE_INLINE F set(float a) { return {_mm512_set1_ps(a)}; }
GSE_INLINE F zero() { return {_mm512_setzero_ps()}; }
GSE_INLINE F load(const float* p) { return {_mm512_load_ps(p)}; }
GSE_INLINE void store(float* p, F a) { _mm512_store_ps(p, a.v); }
GSE_INLINE F operator+(F a, F b) { return {_mm512_add_ps(a.v, b.v)}; }
GSE_INLINE F operator-(F a, F b) { return {_mm512_sub_ps(a.v, b.v)}; }
GSE_INLINE F operator*(F a, F b) { return {_mm512_mul_ps(a.v, b.v)}; }
GSE_INLINE F operator/(F a, F b) { return {_mm512_div_ps(a.v, b.v)}; }
GSE_INLINE F fma(F a, F b, F c) { return {_mm512_fmadd_ps(a.v, b.v, c.v)}; }
GSE_INLINE F fnma(F a, F b, F c) { return {_mm512_fnmadd_ps(a.v, b.v, c.v)}; }
GSE_INLINE F min(F a, F b) { return {_mm512_min_ps(a.v, b.v)}; }
GSE_INLINE F max(F a, F b) { return {_mm512_max_ps(a.v, b.v)}; }
GSE_INLINE F sqrt(F a) { return {_mm512_sqrt_ps(a.v)}; }
GSE_INLINE F floor(F a) { return {_mm512_roundscale_ps(a.v, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC)}; }
GSE_INLINE F ceil(F a) { return {_mm512_roundscale_ps(a.v, _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC)}; }
GSE_INLINE M operator>(F a, F b) { return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_GT_OQ)}; }
GSE_INLINE M operator>=(F a, F b) { return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_GE_OQ)}; }
GSE_INLINE M operator<=(F a, F b) { return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_LE_OQ)}; }
GSE_INLINE M operator&(M a, M b) { return {_kand_mask16(a.v, b.v)}; }
GSE_INLINE M operator|(M a, M b) { return {_kor_mask16(a.v, b.v)}; }
GSE_INLINE M none() { return {0}; }
GSE_INLINE F select(M m, F a, F b) { return {_mm512_mask_mov_ps(b.v, m.v, a.v)}; }
GSE_INLINE F only(M m, F a) { return {_mm512_maskz_mov_ps(m.v, a.v)}; }
GSE_INLINE unsigned bits(M m) { return m.v; }
GSE_INLINE bool any(M m) { return !_kortestz_mask16_u8(m.v, m.v); }
/// 1/a to the last bit or two: estimate and one Newton step.
GSE_INLINE F reciprocal(F a) {
    const __m512 estimate = _mm512_rcp14_ps(a.v);
    return {_mm512_fmadd_ps(estimate, _mm512_fnmadd_ps(a.v, estimate, _mm512_set1_ps(1.0f)), estimate)};
}
/// Counters. count() adds 1 in the lanes of m.
struct I {
    __m512i v;
};
GSE_INLINE I load(const std::int32_t* p) { return {_mm512_load_si512(p)}; }
GSE_INLINE void store(std::int32_t* p, I a) { _mm512_store_si512(p, a.v); }
GSE_INLINE I count(I a, M m) { return {_mm512_mask_sub_epi32(a.v, m.v, a.v, _mm512_set1_epi32(-1))}; }
GSE_INLINE void store_int(std::int32_t* p, F a) { _mm512_store_si512(p, _mm512_cvttps_epi32(a.v)); }
GSE_INLINE I only(M m, I a) { return {_mm512_maskz_mov_epi32(m.v, a.v)}; }
GSE_INLINE I set_int(int a) { return {_mm512_set1_epi32(a)}; }
GSE_INLINE I operator&(I a, I b) { return {_mm512_and_si512(a.v, b.v)}; }
GSE_INLINE I operator|(I a, I b) { return {_mm512_or_si512(a.v, b.v)}; }
template <int N> GSE_INLINE I shift_left(I a) { return {_mm512_slli_epi32(a.v, N)}; }
template <int N> GSE_INLINE I shift_right(I a) { return {_mm512_srli_epi32(a.v, N)}; }
/// Bits first..last in the lanes of m.
GSE_INLINE I bit_range(M m, F first, F last) {
    const __m512i one = _mm512_set1_epi32(1), two = _mm512_set1_epi32(2);
    const __m512i low = _mm512_sllv_epi32(one, _mm512_cvttps_epi32(first.v));
    return {_mm512_maskz_sub_epi32(m.v, _mm512_sllv_epi32(two, _mm512_cvttps_epi32(last.v)), low)};
}
/// 2^a: degree-5 minimax polynomial on [-1/2, 1/2], relative error 7.5e-8.
GSE_INLINE F exp2_lanes(F a) {
    const __m512 whole = _mm512_roundscale_ps(a.v, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
    const __m512 x = _mm512_sub_ps(a.v, whole);
    __m512 p = _mm512_set1_ps(1.3276471519718357e-3f);
    p = _mm512_fmadd_ps(p, x, _mm512_set1_ps(9.675541330689541e-3f));
    p = _mm512_fmadd_ps(p, x, _mm512_set1_ps(5.550713274960774e-2f));
    p = _mm512_fmadd_ps(p, x, _mm512_set1_ps(0.24022119723933638f));
    p = _mm512_fmadd_ps(p, x, _mm512_set1_ps(0.6931469670638641f));
    p = _mm512_fmadd_ps(p, x, _mm512_set1_ps(1.0000000716546549f));
    return {_mm512_scalef_ps(p, whole)};
}

GSE_INLINE D setd(double a) { return {_mm512_set1_pd(a)}; }
GSE_INLINE D widen(const float* p) { return {_mm512_cvtps_pd(_mm256_load_ps(p))}; }
GSE_INLINE void narrow(float* p, D a) { _mm256_store_ps(p, _mm512_cvtpd_ps(a.v)); }
GSE_INLINE D operator+(D a, D b) { return {_mm512_add_pd(a.v, b.v)}; }
GSE_INLINE D operator-(D a, D b) { return {_mm512_sub_pd(a.v, b.v)}; }
GSE_INLINE D operator*(D a, D b) { return {_mm512_mul_pd(a.v, b.v)}; }
GSE_INLINE D operator/(D a, D b) { return {_mm512_div_pd(a.v, b.v)}; }
GSE_INLINE D fma(D a, D b, D c) { return {_mm512_fmadd_pd(a.v, b.v, c.v)}; }
GSE_INLINE D fnma(D a, D b, D c) { return {_mm512_fnmadd_pd(a.v, b.v, c.v)}; }
GSE_INLINE D min(D a, D b) { return {_mm512_min_pd(a.v, b.v)}; }
GSE_INLINE D max(D a, D b) { return {_mm512_max_pd(a.v, b.v)}; }
GSE_INLINE D sqrt(D a) { return {_mm512_sqrt_pd(a.v)}; }
GSE_INLINE MD operator>(D a, D b) { return {_mm512_cmp_pd_mask(a.v, b.v, _CMP_GT_OQ)}; }
GSE_INLINE MD operator>=(D a, D b) { return {_mm512_cmp_pd_mask(a.v, b.v, _CMP_GE_OQ)}; }
GSE_INLINE MD operator<(D a, D b) { return {_mm512_cmp_pd_mask(a.v, b.v, _CMP_LT_OQ)}; }
GSE_INLINE MD operator<=(D a, D b) { return {_mm512_cmp_pd_mask(a.v, b.v, _CMP_LE_OQ)}; }
GSE_INLINE MD operator==(D a, D b) { return {_mm512_cmp_pd_mask(a.v, b.v, _CMP_EQ_OQ)}; }
GSE_INLINE MD operator&(MD a, MD b) { return {_kand_mask8(a.v, b.v)}; }
GSE_INLINE D select(MD m, D a, D b) { return {_mm512_mask_mov_pd(b.v, m.v, a.v)}; }
GSE_INLINE unsigned bits(MD m) { return m.v; }
/// a 2^power, for whole powers.
GSE_INLINE F scale_by_power(F a, F power) { return {_mm512_scalef_ps(a.v, power.v)}; }
GSE_INLINE F exponent_of(F a) { return {_mm512_getexp_ps(a.v)}; }
GSE_INLINE F mantissa_of(F a) { return {_mm512_getmant_ps(a.v, _MM_MANT_NORM_1_2, _MM_MANT_SIGN_src)}; }

/// 16x16 transpose of registers.
GSE_INLINE void transpose(__m512* r) {
    __m512 t[16];
    for (int i = 0; i < 16; i += 2) {
        t[i] = _mm512_unpacklo_ps(r[i], r[i + 1]);
        t[i + 1] = _mm512_unpackhi_ps(r[i], r[i + 1]);
    }
    for (int i = 0; i < 16; i += 4) {
        r[i] = _mm512_castpd_ps(_mm512_unpacklo_pd(_mm512_castps_pd(t[i]), _mm512_castps_pd(t[i + 2])));
        r[i + 1] = _mm512_castpd_ps(_mm512_unpackhi_pd(_mm512_castps_pd(t[i]), _mm512_castps_pd(t[i + 2])));
        r[i + 2] =
            _mm512_castpd_ps(_mm512_unpacklo_pd(_mm512_castps_pd(t[i + 1]), _mm512_castps_pd(t[i + 3])));
        r[i + 3] =
            _mm512_castpd_ps(_mm512_unpackhi_pd(_mm512_castps_pd(t[i + 1]), _mm512_castps_pd(t[i + 3])));
    }
    for (int i = 0; i < 4; ++i) {
        t[i] = _mm512_shuffle_f32x4(r[i], r[i + 4], 0x88);
        t[i + 4] = _mm512_shuffle_f32x4(r[i], r[i + 4], 0xdd);
        t[i + 8] = _mm512_shuffle_f32x4(r[i + 8], r[i + 12], 0x88);
        t[i + 12] = _mm512_shuffle_f32x4(r[i + 8], r[i + 12], 0xdd);
    }
    for (int i = 0; i < 4; ++i) {
        r[i] = _mm512_shuffle_f32x4(t[i], t[i + 8], 0x88);
        r[i + 8] = _mm512_shuffle_f32x4(t[i], t[i + 8], 0xdd);
        r[i + 4] = _mm512_shuffle_f32x4(t[i + 4], t[i + 12], 0x88);
        r[i + 12] = _mm512_shuffle_f32x4(t[i + 4], t[i + 12], 0xdd);
    }
}
GSE_INLINE void load_columns(const float* const* rows, int columns, float* to) {
    for (int base = 0; base < columns; base += 16) {
        const int left = columns - base;
        const __mmask16 lanes = left >= 16 ? 0xffff : static_cast<__mmask16>((1u << left) - 1u);
        __m512 r[16];
        for (int i = 0; i < 16; ++i) r[i] = _mm512_maskz_loadu_ps(lanes, rows[i] + base);
        transpose(r);
        for (int i = 0; i < 16; ++i) _mm512_store_ps(to + (base + i) * 16, r[i]);
    }
}
GSE_INLINE void store_columns(const float* from, int columns, float* const* rows, int row_count) {
    for (int base = 0; base < columns; base += 16) {
        const int left = columns - base;
        const __mmask16 lanes = left >= 16 ? 0xffff : static_cast<__mmask16>((1u << left) - 1u);
        __m512 r[16];
        for (int i = 0; i < 16; ++i) r[i] = _mm512_load_ps(from + (base + i) * 16);
        transpose(r);
        for (int i = 0; i < row_count; ++i) _mm512_mask_storeu_ps(rows[i] + base, lanes, r[i]);
    }
}
/// store_columns of whole cache lines, and zeros, that go past the caches.
#define GSE_HAS_STREAMS 1
constexpr bool HasStreams = true;
GSE_INLINE void stream_columns(const float* from, int columns, float* const* rows, int row_count) {
    for (int base = 0; base < columns; base += 16) {
        __m512 r[16];
        for (int i = 0; i < 16; ++i) r[i] = _mm512_load_ps(from + (base + i) * 16);
        transpose(r);
        for (int i = 0; i < row_count; ++i) _mm512_stream_ps(rows[i] + base, r[i]);
    }
}
GSE_INLINE void stream_zeros(float* to, std::size_t count) {
    for (std::size_t i = 0; i < count; i += 16) _mm512_stream_ps(to + i, _mm512_setzero_ps());
}
/// Orders streamed stores before all later ones.
GSE_INLINE void end_streams() { _mm_sfence(); }

/// Four registers -> one whose every 128-bit quarter holds the four sums of that quarter.
GSE_INLINE __m512 quarter_sums(__m512 a, __m512 b, __m512 c, __m512 d) {
    const __m512 ab = _mm512_add_ps(_mm512_unpacklo_ps(a, b), _mm512_unpackhi_ps(a, b));
    const __m512 cd = _mm512_add_ps(_mm512_unpacklo_ps(c, d), _mm512_unpackhi_ps(c, d));
    return _mm512_castpd_ps(_mm512_unpacklo_pd(_mm512_castps_pd(ab), _mm512_castps_pd(cd))) +
           _mm512_castpd_ps(_mm512_unpackhi_pd(_mm512_castps_pd(ab), _mm512_castps_pd(cd)));
}
/// Horizontal sums of ten registers. The other six floats are 0.
GSE_INLINE __m512 ten_sums(const F* a) {
    const __m512 x = quarter_sums(a[0].v, a[1].v, a[2].v, a[3].v);
    const __m512 y = quarter_sums(a[4].v, a[5].v, a[6].v, a[7].v);
    const __m512 nought = _mm512_setzero_ps();
    const __m512 z = quarter_sums(a[8].v, a[9].v, nought, nought);
    const __m512 xy = _mm512_add_ps(_mm512_shuffle_f32x4(x, y, 0x44), _mm512_shuffle_f32x4(x, y, 0xee));
    const __m512 zz =
        _mm512_add_ps(_mm512_shuffle_f32x4(z, nought, 0x44), _mm512_shuffle_f32x4(z, nought, 0xee));
    return _mm512_add_ps(_mm512_shuffle_f32x4(xy, zz, 0x88), _mm512_shuffle_f32x4(xy, zz, 0xdd));
}
GSE_INLINE void store_sums(const F* a, float* to) { _mm512_store_ps(to, ten_sums(a)); }
GSE_INLINE void stream_sums(const F* a, float* to) { _mm512_stream_ps(to, ten_sums(a)); }
/// Masks of 16 entries -> for each block the list of the entries that touch it.
#define GSE_HAS_LISTS 1
GSE_INLINE void append_lists(const std::uint32_t* blocks, std::uint32_t first, std::uint16_t (*lists)[272],
                             std::uint32_t* lengths) {
    const __m512i masks = _mm512_load_si512(blocks);
    const __m512i names =
        _mm512_add_epi32(_mm512_set1_epi32(static_cast<int>(first)),
                         _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15));
    for (int block = 0; block < 16; ++block) {
        const __mmask16 touched = _mm512_test_epi32_mask(masks, _mm512_set1_epi32(1 << block));
        const __m256i packed = _mm512_cvtepi32_epi16(_mm512_maskz_compress_epi32(touched, names));
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(lists[block] + lengths[block]), packed);
        lengths[block] += static_cast<std::uint32_t>(_mm_popcnt_u32(touched));
    }
}
