/* Four lanes of 32 bits: the x86-64 baseline. The operations are those of kernels.inl. */
#ifndef SRC_KERNELS_WIDE_SSE2_H
#define SRC_KERNELS_WIDE_SSE2_H

typedef __m128 wf4;
typedef __m128i wi4;
typedef wi4 wi_pair4;

static inline wf4 wf_splat4(float v) {
    return _mm_set1_ps(v);
}
static inline wf4 wf_load4(const float *p) {
    return _mm_loadu_ps(p);
}
static inline void wf_store4(float *p, wf4 v) {
    _mm_storeu_ps(p, v);
}
static inline wf4 wf_add4(wf4 a, wf4 b) {
    return _mm_add_ps(a, b);
}
static inline wf4 wf_mul4(wf4 a, wf4 b) {
    return _mm_mul_ps(a, b);
}
static inline wf4 wf_min4(wf4 a, wf4 b) {
    return _mm_min_ps(a, b);
}
static inline wf4 wf_max4(wf4 a, wf4 b) {
    return _mm_max_ps(a, b);
}
static inline wi4 wi_splat4(int32_t v) {
    return _mm_set1_epi32(v);
}
static inline wf4 wf_lanes4(void) {
    return _mm_setr_ps(0.0f, 1.0f, 2.0f, 3.0f);
}
static inline wi4 wi_load4(const void *p) {
    return _mm_loadu_si128((const __m128i *)p);
}
static inline void wi_store4(void *p, wi4 v) {
    _mm_storeu_si128((__m128i *)p, v);
}
static inline wi4 wi_add4(wi4 a, wi4 b) {
    return _mm_add_epi32(a, b);
}
static inline wi4 wi_ramp4(int32_t step) {
    const __m128i one = _mm_set1_epi32(step), two = _mm_add_epi32(one, one);
    return _mm_add_epi32(_mm_and_si128(one, _mm_setr_epi32(0, -1, 0, -1)),
                         _mm_and_si128(two, _mm_setr_epi32(0, 0, -1, -1)));
}
static inline wi4 wi_or_three4(wi4 a, wi4 b, wi4 c) {
    return _mm_or_si128(_mm_or_si128(a, b), c);
}
static inline wf4 wf_min_inside4(wi4 edges, wf4 z, wf4 q) {
    const __m128i outside = _mm_srai_epi32(edges, 31);
    return _mm_min_ps(_mm_or_ps(z, _mm_castsi128_ps(outside)), q);
}
static inline void wi_store_closer4(uint32_t *ids, wi4 edges, wf4 z, wf4 q, wi4 id) {
    const __m128i old = wi_load4(ids);
    const __m128i closer = _mm_castps_si128(_mm_cmplt_ps(z, q));
    const __m128i equal = _mm_castps_si128(_mm_cmpeq_ps(z, q));
    const __m128i lower = _mm_and_si128(equal, _mm_cmplt_epi32(id, old));
    const __m128i outside = _mm_srai_epi32(edges, 31);
    const __m128i wins = _mm_andnot_si128(outside, _mm_or_si128(closer, lower));
    wi_store4(ids, _mm_or_si128(_mm_and_si128(wins, id), _mm_andnot_si128(wins, old)));
}
static inline wi4 wi_count_less4(wi4 count, wf4 a, wf4 b) {
    return _mm_sub_epi32(count, _mm_castps_si128(_mm_cmplt_ps(a, b)));
}
static inline int32_t wi_sum4(wi4 v) {
    const __m128i pair = _mm_add_epi32(v, _mm_shuffle_epi32(v, _MM_SHUFFLE(1, 0, 3, 2)));
    const __m128i one = _mm_add_epi32(pair, _mm_shuffle_epi32(pair, _MM_SHUFFLE(2, 3, 0, 1)));
    return _mm_cvtsi128_si32(one);
}
static inline wi_pair4 wi_pair_of4(wi4 a, wi4 b) {
    return _mm_madd_epi16(_mm_packs_epi32(a, b), _mm_set1_epi16(1));
}
static inline void wi_store_sums4(void *p, wi_pair4 a, wi_pair4 b) {
    _mm_storeu_si128((__m128i *)p, wi_pair_of4(a, b));
}
static inline wf4 wf_plane4(double base, double step, double column, double lo, double hi) {
    const __m128d s = _mm_set1_pd(step), b = _mm_set1_pd(base), c = _mm_set1_pd(column);
    const __m128d l = _mm_set1_pd(lo), h = _mm_set1_pd(hi);
    const __m128d z0 = _mm_add_pd(b, _mm_mul_pd(s, _mm_add_pd(c, _mm_setr_pd(0.0, 1.0))));
    const __m128d z1 = _mm_add_pd(b, _mm_mul_pd(s, _mm_add_pd(c, _mm_setr_pd(2.0, 3.0))));
    return _mm_movelh_ps(_mm_cvtpd_ps(_mm_min_pd(_mm_max_pd(z0, l), h)),
                         _mm_cvtpd_ps(_mm_min_pd(_mm_max_pd(z1, l), h)));
}

/* Bit i is set where byte i of 64 equals value. */
static inline uint64_t wide_equal_bytes(const uint8_t *bytes, uint8_t value) {
    const __m128i wanted = _mm_set1_epi8((char)value);
    uint64_t bits = 0;
    for (int i = 0; i < 4; i++) {
        const __m128i part = _mm_loadu_si128((const __m128i *)(const void *)(bytes + 16 * i));
        bits |= (uint64_t)(uint32_t)_mm_movemask_epi8(_mm_cmpeq_epi8(part, wanted)) << (16 * i);
    }
    return bits;
}

static inline void wide_transpose(const shb_vertex *a, const shb_vertex *b, const shb_vertex *c,
                                  const shb_vertex *d, double *x, double *y, double *z) {
    const __m128d xy_a = _mm_loadu_pd(&a->x), xy_b = _mm_loadu_pd(&b->x);
    const __m128d xy_c = _mm_loadu_pd(&c->x), xy_d = _mm_loadu_pd(&d->x);
    _mm_storeu_pd(x, _mm_unpacklo_pd(xy_a, xy_b));
    _mm_storeu_pd(x + 2, _mm_unpacklo_pd(xy_c, xy_d));
    _mm_storeu_pd(y, _mm_unpackhi_pd(xy_a, xy_b));
    _mm_storeu_pd(y + 2, _mm_unpackhi_pd(xy_c, xy_d));
    _mm_storeu_pd(z, _mm_loadh_pd(_mm_load_sd(&a->z), &b->z));
    _mm_storeu_pd(z + 2, _mm_loadh_pd(_mm_load_sd(&c->z), &d->z));
}

#endif
