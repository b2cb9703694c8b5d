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
static inline wd wd_load_ints(const int32_t *p) {
    return _mm256_cvtepi32_pd(_mm_loadu_si128((const __m128i *)(const void *)p));
}
static inline double wd_at(const void *record, size_t offset) {
    return *(const double *)(const void *)((const char *)record + offset);
}
static inline wd wd_gather(const void *const *records, size_t offset) {
    return _mm256_setr_pd(wd_at(records[0], offset), wd_at(records[1], offset),
                          wd_at(records[2], offset), wd_at(records[3], offset));
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

#endif
