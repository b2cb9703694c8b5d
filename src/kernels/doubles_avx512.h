/* A vector of eight doubles for the loops over fragments. + - * / are the compiler's own; the
 * operations are those of doubles_scalar.h. */
#ifndef SRC_KERNELS_DOUBLES_AVX512_H
#define SRC_KERNELS_DOUBLES_AVX512_H

#define DOUBLES 8

typedef __m512d wd;

static inline wd wd_splat(double value) {
    return _mm512_set1_pd(value);
}
static inline wd wd_load_floats(const float *p) {
    return _mm512_cvtps_pd(_mm256_loadu_ps(p));
}
static inline wd wd_load(const double *p) {
    return _mm512_loadu_pd(p);
}
static inline void wd_store(double *p, wd v) {
    _mm512_storeu_pd(p, v);
}
static inline void wd_store_floats(float *p, wd v) {
    _mm256_storeu_ps(p, _mm512_cvtpd_ps(v));
}
static inline void wd_store_ints(int32_t *p, wd v) {
    _mm256_storeu_si256((__m256i *)(void *)p, _mm512_cvttpd_epi32(v));
}
static inline wd wd_max(wd a, wd b) {
    return _mm512_max_pd(a, b);
}
static inline wd wd_min(wd a, wd b) {
    return _mm512_min_pd(a, b);
}
static inline wd wd_sqrt(wd v) {
    return _mm512_sqrt_pd(v);
}
static inline wd wd_floor(wd v) {
    return _mm512_roundscale_pd(v, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC);
}
static inline wd wd_where_greater(wd a, wd b, wd yes, wd no) {
    return _mm512_mask_blend_pd(_mm512_cmp_pd_mask(a, b, _CMP_GT_OQ), no, yes);
}
static inline wd wd_where_equal(wd a, wd b, wd yes, wd no) {
    return _mm512_mask_blend_pd(_mm512_cmp_pd_mask(a, b, _CMP_EQ_OQ), no, yes);
}
static inline wd wd_abs(wd v) {
    return _mm512_abs_pd(v);
}
static inline uint32_t wd_greater_bits(wd a, wd b) {
    return _mm512_cmp_pd_mask(a, b, _CMP_GT_OQ);
}
static inline bool wd_any_signed(wd v) {
    return _mm512_movepi64_mask(_mm512_castpd_si512(v)) != 0;
}
static inline wd two_quads(const double *low, const double *high) {
    return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(low)), _mm256_loadu_pd(high),
                              1);
}
static inline void wd_read_quads(const double *const from[DOUBLES], wd out[4]) {
    const wd a = two_quads(from[0], from[4]), b = two_quads(from[1], from[5]);
    const wd c = two_quads(from[2], from[6]), d = two_quads(from[3], from[7]);
    const __m512i low = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
    const __m512i high = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
    const wd ab_even = _mm512_unpacklo_pd(a, b), ab_odd = _mm512_unpackhi_pd(a, b);
    const wd cd_even = _mm512_unpacklo_pd(c, d), cd_odd = _mm512_unpackhi_pd(c, d);
    out[0] = _mm512_permutex2var_pd(ab_even, low, cd_even);
    out[1] = _mm512_permutex2var_pd(ab_odd, low, cd_odd);
    out[2] = _mm512_permutex2var_pd(ab_even, high, cd_even);
    out[3] = _mm512_permutex2var_pd(ab_odd, high, cd_odd);
}
static inline void wd_store_pairs(float *first, void *second, wd v) {
    const __m512i pairs = _mm512_castpd_si512(v);
    _mm256_storeu_si256((__m256i *)(void *)first, _mm512_cvtepi64_epi32(pairs));
    _mm256_storeu_si256(second, _mm512_cvtepi64_epi32(_mm512_srli_epi64(pairs, 32)));
}
static inline void wd_store_quads(double *to, size_t step, wd a, wd b, wd c, wd d) {
    const wd ab[2] = {_mm512_unpacklo_pd(a, b), _mm512_unpackhi_pd(a, b)};
    const wd cd[2] = {_mm512_unpacklo_pd(c, d), _mm512_unpackhi_pd(c, d)};
    const __m512i low = _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11);
    const __m512i high = _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15);
    for (size_t odd = 0; odd < 2; odd++) {
        const wd first = _mm512_permutex2var_pd(ab[odd], low, cd[odd]);
        const wd last = _mm512_permutex2var_pd(ab[odd], high, cd[odd]);
        _mm256_storeu_pd(to + odd * step, _mm512_castpd512_pd256(first));
        _mm256_storeu_pd(to + (odd + 2) * step, _mm512_extractf64x4_pd(first, 1));
        _mm256_storeu_pd(to + (odd + 4) * step, _mm512_castpd512_pd256(last));
        _mm256_storeu_pd(to + (odd + 6) * step, _mm512_extractf64x4_pd(last, 1));
    }
}

#endif
