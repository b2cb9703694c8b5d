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

#endif
