/* Vectors of WIDE floats or ints for the loops that read maps at scattered places. Arithmetic and
 * comparisons (0 or -1 in each lane) are the compiler's own; what it lacks follows. */
#ifndef SRC_KERNELS_VECTORS_H
#define SRC_KERNELS_VECTORS_H

typedef float vf __attribute__((vector_size(4 * WIDE)));
typedef int32_t vi __attribute__((vector_size(4 * WIDE)));
typedef uint32_t vu __attribute__((vector_size(4 * WIDE)));

static inline vf vf_splat(float value) {
    return value - (vf){0};
}
static inline vi vi_splat(int32_t value) {
    return value - (vi){0};
}
static inline vf vf_load(const float *p) {
    vf v;
    memcpy(&v, p, sizeof v);
    return v;
}
static inline vi vi_load(const int32_t *p) {
    vi v;
    memcpy(&v, p, sizeof v);
    return v;
}
static inline void vf_store(float *p, vf v) {
    memcpy(p, &v, sizeof v);
}
static inline vf vf_where(vi mask, vf yes, vf no) {
    return (vf)((mask & (vi)yes) | (~mask & (vi)no));
}
/* a where the mask is set, else 0. */
static inline vf vf_keep(vi mask, vf a) {
    return (vf)(mask & (vi)a);
}

/* vf_min, vf_max: a < b ? a : b, a > b ? a : b. vi_any: true if the mask is set in some lane. */
#if WIDE == 16
static inline vf vf_min(vf a, vf b) {
    return _mm512_min_ps(a, b);
}
static inline vf vf_max(vf a, vf b) {
    return _mm512_max_ps(a, b);
}
static inline bool vi_any(vi mask) {
    return _mm512_movepi32_mask((__m512i)mask) != 0;
}
static inline vf vf_gather(const float *base, vi index) {
    return _mm512_i32gather_ps((__m512i)index, base, 4);
}
static inline vi vi_gather(const int32_t *base, vi index) {
    return (vi)_mm512_i32gather_epi32((__m512i)index, base, 4);
}
#elif WIDE == 8
static inline vf vf_min(vf a, vf b) {
    return _mm256_min_ps(a, b);
}
static inline vf vf_max(vf a, vf b) {
    return _mm256_max_ps(a, b);
}
static inline bool vi_any(vi mask) {
    return _mm256_movemask_ps((__m256)mask) != 0;
}
static inline vf vf_gather(const float *base, vi index) {
    return _mm256_i32gather_ps(base, (__m256i)index, 4);
}
static inline vi vi_gather(const int32_t *base, vi index) {
    return (vi)_mm256_i32gather_epi32(base, (__m256i)index, 4);
}
#else
#if defined(__x86_64__) && WIDE == 4
static inline vf vf_min(vf a, vf b) {
    return _mm_min_ps(a, b);
}
static inline vf vf_max(vf a, vf b) {
    return _mm_max_ps(a, b);
}
#else
static inline vf vf_min(vf a, vf b) {
    return vf_where(a < b, a, b);
}
static inline vf vf_max(vf a, vf b) {
    return vf_where(a > b, a, b);
}
#endif
static inline bool vi_any(vi mask) {
    int32_t any = 0;
    for (int i = 0; i < WIDE; i++)
        any |= mask[i];
    return any != 0;
}
static inline vf vf_gather(const float *base, vi index) {
    vf v;
    for (int i = 0; i < WIDE; i++)
        v[i] = base[index[i]];
    return v;
}
static inline vi vi_gather(const int32_t *base, vi index) {
    vi v;
    for (int i = 0; i < WIDE; i++)
        v[i] = base[index[i]];
    return v;
}
#endif

#endif
