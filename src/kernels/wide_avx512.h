/* Sixteen lanes of 32 bits (AVX-512 F, VL, DQ, BW). The operations are those of kernels.inl. */
#ifndef SRC_KERNELS_WIDE_AVX512_H
#define SRC_KERNELS_WIDE_AVX512_H

typedef __m512 wf16;
typedef __m512i wi16;
typedef wi16 wi_pair16;

static inline wf16 wf_splat16(float v) {
    return _mm512_set1_ps(v);
}
static inline wf16 wf_load16(const float *p) {
    return _mm512_loadu_ps(p);
}
static inline void wf_store16(float *p, wf16 v) {
    _mm512_storeu_ps(p, v);
}
static inline wf16 wf_add16(wf16 a, wf16 b) {
    return _mm512_add_ps(a, b);
}
static inline wf16 wf_mul16(wf16 a, wf16 b) {
    return _mm512_mul_ps(a, b);
}
static inline wf16 wf_min16(wf16 a, wf16 b) {
    return _mm512_min_ps(a, b);
}
static inline wf16 wf_max16(wf16 a, wf16 b) {
    return _mm512_max_ps(a, b);
}
static inline wi16 wi_splat16(int32_t v) {
    return _mm512_set1_epi32(v);
}
static inline wi16 wi_lanes16(void) {
    return _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}
static inline wf16 wf_lanes16(void) {
    return _mm512_cvtepi32_ps(wi_lanes16());
}
static inline wi16 wi_load16(const void *p) {
    return _mm512_loadu_si512(p);
}
static inline void wi_store16(void *p, wi16 v) {
    _mm512_storeu_si512(p, v);
}
static inline wi16 wi_add16(wi16 a, wi16 b) {
    return _mm512_add_epi32(a, b);
}
static inline wi16 wi_ramp16(int32_t step) {
    return _mm512_mullo_epi32(_mm512_set1_epi32(step), wi_lanes16());
}
static inline wi16 wi_or_three16(wi16 a, wi16 b, wi16 c) {
    return _mm512_ternarylogic_epi32(a, b, c, 0xfe);
}
static inline wf16 wf_min_inside16(wi16 edges, wf16 z, wf16 q) {
    const __mmask16 inside = _mm512_cmpge_epi32_mask(edges, _mm512_setzero_si512());
    return _mm512_mask_min_ps(q, inside, z, q);
}
/* Equal depths are rare: only they need the old ids. */
static inline void wi_store_closer16(uint32_t *ids, wi16 edges, wf16 z, wf16 q, wi16 id) {
    const __mmask16 inside = _mm512_cmpge_epi32_mask(edges, _mm512_setzero_si512());
    const __mmask16 equal = _mm512_mask_cmp_ps_mask(inside, z, q, _CMP_EQ_OQ);
    __mmask16 wins = _mm512_mask_cmp_ps_mask(inside, z, q, _CMP_LT_OQ);
    if (__builtin_expect(equal != 0, 0))
        wins = _kor_mask16(wins, _mm512_mask_cmplt_epi32_mask(equal, id, wi_load16(ids)));
    _mm512_mask_storeu_epi32(ids, wins, id);
}
static inline wi16 wi_count_less16(wi16 count, wf16 a, wf16 b) {
    const __mmask16 less = _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ);
    return _mm512_mask_add_epi32(count, less, count, _mm512_set1_epi32(1));
}
static inline int32_t wi_sum16(wi16 v) {
    return wi_sum8(_mm256_add_epi32(_mm512_castsi512_si256(v), _mm512_extracti32x8_epi32(v, 1)));
}
static inline wi_pair16 wi_pair_of16(wi16 a, wi16 b) {
    return _mm512_madd_epi16(_mm512_packs_epi32(a, b), _mm512_set1_epi16(1));
}
static inline void wi_store_sums16(void *p, wi_pair16 a, wi_pair16 b) {
    const __m512i quarters = wi_pair_of16(a, b);
    const __m256i halves =
        _mm256_add_epi32(_mm512_castsi512_si256(quarters), _mm512_extracti64x4_epi64(quarters, 1));
    const __m128i low = _mm256_castsi256_si128(halves), high = _mm256_extracti128_si256(halves, 1);
    _mm_storeu_si128((__m128i *)p, _mm_add_epi32(low, high));
}
static inline wf16 wf_plane16(double base, double step, double column, double lo, double hi) {
    const __m512d s = _mm512_set1_pd(step), b = _mm512_set1_pd(base), c = _mm512_set1_pd(column);
    const __m512d l = _mm512_set1_pd(lo), h = _mm512_set1_pd(hi);
    const __m512d i0 = _mm512_add_pd(c, _mm512_setr_pd(0, 1, 2, 3, 4, 5, 6, 7));
    const __m512d i1 = _mm512_add_pd(c, _mm512_setr_pd(8, 9, 10, 11, 12, 13, 14, 15));
    const __m512d z0 = _mm512_add_pd(b, _mm512_mul_pd(s, i0));
    const __m512d z1 = _mm512_add_pd(b, _mm512_mul_pd(s, i1));
    const __m256 f0 = _mm512_cvtpd_ps(_mm512_min_pd(_mm512_max_pd(z0, l), h));
    const __m256 f1 = _mm512_cvtpd_ps(_mm512_min_pd(_mm512_max_pd(z1, l), h));
    return _mm512_insertf32x8(_mm512_castps256_ps512(f0), f1, 1);
}

#endif
