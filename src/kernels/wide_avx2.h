/* Eight lanes of 32 bits. The operations are those of kernels.inl. */
#ifndef SRC_KERNELS_WIDE_AVX2_H
#define SRC_KERNELS_WIDE_AVX2_H

typedef __m256 wf8;
typedef __m256i wi8;
typedef wi8 wi_pair8;

static inline wf8 wf_splat8(float v) {
    return _mm256_set1_ps(v);
}
static inline wf8 wf_load8(const float *p) {
    return _mm256_loadu_ps(p);
}
static inline void wf_store8(float *p, wf8 v) {
    _mm256_storeu_ps(p, v);
}
static inline wf8 wf_add8(wf8 a, wf8 b) {
    return _mm256_add_ps(a, b);
}
static inline wf8 wf_mul8(wf8 a, wf8 b) {
    return _mm256_mul_ps(a, b);
}
static inline wf8 wf_min8(wf8 a, wf8 b) {
    return _mm256_min_ps(a, b);
}
static inline wf8 wf_max8(wf8 a, wf8 b) {
    return _mm256_max_ps(a, b);
}
static inline wi8 wi_splat8(int32_t v) {
    return _mm256_set1_epi32(v);
}
static inline wf8 wf_lanes8(void) {
    return _mm256_setr_ps(0.0f, 1.0f, 2.0f, 3.0f, 4.0f, 5.0f, 6.0f, 7.0f);
}
static inline wi8 wi_load8(const void *p) {
    return _mm256_loadu_si256((const __m256i *)p);
}
static inline void wi_store8(void *p, wi8 v) {
    _mm256_storeu_si256((__m256i *)p, v);
}
static inline wi8 wi_add8(wi8 a, wi8 b) {
    return _mm256_add_epi32(a, b);
}
static inline wi8 wi_ramp8(int32_t step) {
    const __m256i lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
    return _mm256_mullo_epi32(_mm256_set1_epi32(step), lanes);
}
static inline wi8 wi_or_three8(wi8 a, wi8 b, wi8 c) {
    return _mm256_or_si256(_mm256_or_si256(a, b), c);
}
static inline wf8 wf_min_inside8(wi8 edges, wf8 z, wf8 q) {
    const __m256i outside = _mm256_srai_epi32(edges, 31);
    return _mm256_min_ps(_mm256_or_ps(z, _mm256_castsi256_ps(outside)), q);
}
static inline void wi_store_closer8(uint32_t *ids, wi8 edges, wf8 z, wf8 q, wi8 id) {
    const __m256i old = wi_load8(ids);
    const __m256 inside = _mm256_or_ps(z, _mm256_castsi256_ps(_mm256_srai_epi32(edges, 31)));
    const __m256i closer = _mm256_castps_si256(_mm256_cmp_ps(inside, q, _CMP_LT_OQ));
    const __m256i as_close = _mm256_castps_si256(_mm256_cmp_ps(inside, q, _CMP_LE_OQ));
    const __m256i best = _mm256_blendv_epi8(_mm256_min_epi32(old, id), id, closer);
    wi_store8(ids, _mm256_blendv_epi8(old, best, as_close));
}
static inline wi8 wi_count_less8(wi8 count, wf8 a, wf8 b) {
    return _mm256_sub_epi32(count, _mm256_castps_si256(_mm256_cmp_ps(a, b, _CMP_LT_OQ)));
}
static inline int32_t wi_sum8(wi8 v) {
    const __m128i half = _mm_add_epi32(_mm256_castsi256_si128(v), _mm256_extracti128_si256(v, 1));
    const __m128i pair = _mm_add_epi32(half, _mm_shuffle_epi32(half, _MM_SHUFFLE(1, 0, 3, 2)));
    const __m128i one = _mm_add_epi32(pair, _mm_shuffle_epi32(pair, _MM_SHUFFLE(2, 3, 0, 1)));
    return _mm_cvtsi128_si32(one);
}
static inline wi_pair8 wi_pair_of8(wi8 a, wi8 b) {
    return _mm256_madd_epi16(_mm256_packs_epi32(a, b), _mm256_set1_epi16(1));
}
static inline void wi_store_sums8(void *p, wi_pair8 a, wi_pair8 b) {
    const __m256i halves = wi_pair_of8(a, b);
    const __m128i low = _mm256_castsi256_si128(halves), high = _mm256_extracti128_si256(halves, 1);
    _mm_storeu_si128((__m128i *)p, _mm_add_epi32(low, high));
}
static inline wf8 wf_plane8(double base, double step, double column, double lo, double hi) {
    const __m256d s = _mm256_set1_pd(step), b = _mm256_set1_pd(base), c = _mm256_set1_pd(column);
    const __m256d l = _mm256_set1_pd(lo), h = _mm256_set1_pd(hi);
    const __m256d i0 = _mm256_add_pd(c, _mm256_setr_pd(0.0, 1.0, 2.0, 3.0));
    const __m256d i1 = _mm256_add_pd(c, _mm256_setr_pd(4.0, 5.0, 6.0, 7.0));
    const __m256d z0 = _mm256_add_pd(b, _mm256_mul_pd(s, i0));
    const __m256d z1 = _mm256_add_pd(b, _mm256_mul_pd(s, i1));
    return _mm256_set_m128(_mm256_cvtpd_ps(_mm256_min_pd(_mm256_max_pd(z1, l), h)),
                           _mm256_cvtpd_ps(_mm256_min_pd(_mm256_max_pd(z0, l), h)));
}

/* Bit i is set where byte i of 64 equals value. */
static inline uint64_t wide_equal_bytes(const uint8_t *bytes, uint8_t value) {
    const __m256i wanted = _mm256_set1_epi8((char)value);
    const __m256i lo = _mm256_loadu_si256((const __m256i *)(const void *)bytes);
    const __m256i hi = _mm256_loadu_si256((const __m256i *)(const void *)(bytes + 32));
    const uint32_t lo_bits = (uint32_t)_mm256_movemask_epi8(_mm256_cmpeq_epi8(lo, wanted));
    const uint32_t hi_bits = (uint32_t)_mm256_movemask_epi8(_mm256_cmpeq_epi8(hi, wanted));
    return lo_bits | (uint64_t)hi_bits << 32;
}

static inline void wide_transpose(const shb_vertex *a, const shb_vertex *b, const shb_vertex *c,
                                  const shb_vertex *d, double *x, double *y, double *z) {
    const __m256d va = _mm256_loadu_pd(&a->x), vb = _mm256_loadu_pd(&b->x);
    const __m256d vc = _mm256_loadu_pd(&c->x), vd = _mm256_loadu_pd(&d->x);
    const __m256d xz_ab = _mm256_unpacklo_pd(va, vb), xz_cd = _mm256_unpacklo_pd(vc, vd);
    const __m256d y_ab = _mm256_unpackhi_pd(va, vb), y_cd = _mm256_unpackhi_pd(vc, vd);
    _mm256_storeu_pd(x, _mm256_permute2f128_pd(xz_ab, xz_cd, 0x20));
    _mm256_storeu_pd(y, _mm256_permute2f128_pd(y_ab, y_cd, 0x20));
    _mm256_storeu_pd(z, _mm256_permute2f128_pd(xz_ab, xz_cd, 0x31));
}

#endif
