/* A vector of four doubles for the loops over fragments. + - * / are the compiler's own; the
 * operations are those of doubles_scalar.h. */
#ifndef SRC_KERNELS_DOUBLES_AVX2_H
#define SRC_KERNELS_DOUBLES_AVX2_H

#define DOUBLES 4

typedef __m256d wd;

static inline wd wd_splat(double value) {
    return _mm256_set1_pd(value);
}
static inline wd wd_load_floats(const float *p) {
    return _mm256_cvtps_pd(_mm_loadu_ps(p));
}
static inline wd wd_load(const double *p) {
    return _mm256_loadu_pd(p);
}
static inline void wd_store(double *p, wd v) {
    _mm256_storeu_pd(p, v);
}
static inline void wd_store_floats(float *p, wd v) {
    _mm_storeu_ps(p, _mm256_cvtpd_ps(v));
}
static inline void wd_store_ints(int32_t *p, wd v) {
    _mm_storeu_si128((__m128i *)(void *)p, _mm256_cvttpd_epi32(v));
}
static inline wd wd_max(wd a, wd b) {
    return _mm256_max_pd(a, b);
}
static inline wd wd_min(wd a, wd b) {
    return _mm256_min_pd(a, b);
}
static inline wd wd_sqrt(wd v) {
    return _mm256_sqrt_pd(v);
}
static inline wd wd_floor(wd v) {
    return _mm256_floor_pd(v);
}
static inline wd wd_where_greater(wd a, wd b, wd yes, wd no) {
    return _mm256_blendv_pd(no, yes, _mm256_cmp_pd(a, b, _CMP_GT_OQ));
}
static inline wd wd_where_equal(wd a, wd b, wd yes, wd no) {
    return _mm256_blendv_pd(no, yes, _mm256_cmp_pd(a, b, _CMP_EQ_OQ));
}
static inline wd wd_abs(wd v) {
    return _mm256_andnot_pd(_mm256_set1_pd(-0.0), v);
}
static inline uint32_t wd_greater_bits(wd a, wd b) {
    return (uint32_t)_mm256_movemask_pd(_mm256_cmp_pd(a, b, _CMP_GT_OQ));
}
static inline bool wd_any_signed(wd v) {
    return _mm256_movemask_pd(v) != 0;
}
static inline void wd_read_quads(const double *const from[DOUBLES], wd out[4]) {
    const wd a = _mm256_loadu_pd(from[0]), b = _mm256_loadu_pd(from[1]);
    const wd c = _mm256_loadu_pd(from[2]), d = _mm256_loadu_pd(from[3]);
    const wd ab_even = _mm256_unpacklo_pd(a, b), ab_odd = _mm256_unpackhi_pd(a, b);
    const wd cd_even = _mm256_unpacklo_pd(c, d), cd_odd = _mm256_unpackhi_pd(c, d);
    out[0] = _mm256_permute2f128_pd(ab_even, cd_even, 0x20);
    out[1] = _mm256_permute2f128_pd(ab_odd, cd_odd, 0x20);
    out[2] = _mm256_permute2f128_pd(ab_even, cd_even, 0x31);
    out[3] = _mm256_permute2f128_pd(ab_odd, cd_odd, 0x31);
}
static inline void wd_store_pairs(float *first, void *second, wd v) {
    const __m256 pairs = _mm256_castpd_ps(v);
    const __m128 low = _mm256_castps256_ps128(pairs), high = _mm256_extractf128_ps(pairs, 1);
    _mm_storeu_ps(first, _mm_shuffle_ps(low, high, _MM_SHUFFLE(2, 0, 2, 0)));
    _mm_storeu_ps(second, _mm_shuffle_ps(low, high, _MM_SHUFFLE(3, 1, 3, 1)));
}
static inline void wd_store_quads(double *to, size_t step, wd a, wd b, wd c, wd d) {
    const wd ab_even = _mm256_unpacklo_pd(a, b), ab_odd = _mm256_unpackhi_pd(a, b);
    const wd cd_even = _mm256_unpacklo_pd(c, d), cd_odd = _mm256_unpackhi_pd(c, d);
    _mm256_storeu_pd(to, _mm256_permute2f128_pd(ab_even, cd_even, 0x20));
    _mm256_storeu_pd(to + step, _mm256_permute2f128_pd(ab_odd, cd_odd, 0x20));
    _mm256_storeu_pd(to + 2 * step, _mm256_permute2f128_pd(ab_even, cd_even, 0x31));
    _mm256_storeu_pd(to + 3 * step, _mm256_permute2f128_pd(ab_odd, cd_odd, 0x31));
}

#endif
