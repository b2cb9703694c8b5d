/* A vector of two doubles for the loops over fragments. + - * / are the compiler's own; the
 * operations are those of doubles_scalar.h. */
#ifndef SRC_KERNELS_DOUBLES_SSE2_H
#define SRC_KERNELS_DOUBLES_SSE2_H

#define DOUBLES 2

typedef __m128d wd;

static inline wd wd_splat(double value) {
    return _mm_set1_pd(value);
}
static inline wd wd_load_floats(const float *p) {
    return _mm_cvtps_pd(_mm_castsi128_ps(_mm_loadl_epi64((const __m128i *)(const void *)p)));
}
static inline wd wd_load(const double *p) {
    return _mm_loadu_pd(p);
}
static inline void wd_store(double *p, wd v) {
    _mm_storeu_pd(p, v);
}
static inline void wd_store_floats(float *p, wd v) {
    _mm_storel_epi64((__m128i *)(void *)p, _mm_castps_si128(_mm_cvtpd_ps(v)));
}
static inline void wd_store_ints(int32_t *p, wd v) {
    _mm_storel_epi64((__m128i *)(void *)p, _mm_cvttpd_epi32(v));
}
static inline wd wd_max(wd a, wd b) {
    return _mm_max_pd(a, b);
}
static inline wd wd_min(wd a, wd b) {
    return _mm_min_pd(a, b);
}
static inline wd wd_sqrt(wd v) {
    return _mm_sqrt_pd(v);
}
static inline wd wd_floor(wd v) {
    const wd truncated = _mm_cvtepi32_pd(_mm_cvttpd_epi32(v));
    return truncated - _mm_and_pd(_mm_cmpgt_pd(truncated, v), _mm_set1_pd(1.0));
}
static inline wd wd_where_greater(wd a, wd b, wd yes, wd no) {
    const wd mask = _mm_cmpgt_pd(a, b);
    return _mm_or_pd(_mm_and_pd(mask, yes), _mm_andnot_pd(mask, no));
}
static inline wd wd_where_equal(wd a, wd b, wd yes, wd no) {
    const wd mask = _mm_cmpeq_pd(a, b);
    return _mm_or_pd(_mm_and_pd(mask, yes), _mm_andnot_pd(mask, no));
}
static inline wd wd_abs(wd v) {
    return _mm_andnot_pd(_mm_set1_pd(-0.0), v);
}
static inline uint32_t wd_greater_bits(wd a, wd b) {
    return (uint32_t)_mm_movemask_pd(_mm_cmpgt_pd(a, b));
}
static inline bool wd_any_signed(wd v) {
    return _mm_movemask_pd(v) != 0;
}
static inline void wd_read_quads(const double *const from[DOUBLES], wd out[4]) {
    for (int k = 0; k < 4; k += 2) {
        const wd a = _mm_loadu_pd(from[0] + k), b = _mm_loadu_pd(from[1] + k);
        out[k] = _mm_unpacklo_pd(a, b);
        out[k + 1] = _mm_unpackhi_pd(a, b);
    }
}
static inline void wd_store_pairs(float *first, void *second, wd v) {
    const __m128i pairs = _mm_castpd_si128(v);
    _mm_storel_epi64((__m128i *)(void *)first, _mm_shuffle_epi32(pairs, _MM_SHUFFLE(2, 0, 2, 0)));
    _mm_storel_epi64(second, _mm_shuffle_epi32(pairs, _MM_SHUFFLE(3, 1, 3, 1)));
}
static inline void wd_store_quads(double *to, size_t step, wd a, wd b, wd c, wd d) {
    _mm_storeu_pd(to, _mm_unpacklo_pd(a, b));
    _mm_storeu_pd(to + 2, _mm_unpacklo_pd(c, d));
    _mm_storeu_pd(to + step, _mm_unpackhi_pd(a, b));
    _mm_storeu_pd(to + step + 2, _mm_unpackhi_pd(c, d));
}

#endif
