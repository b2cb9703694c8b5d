/* Four lanes of 32 bits: the aarch64 baseline. The operations are those of kernels.inl. */
#ifndef SRC_KERNELS_WIDE_NEON_H
#define SRC_KERNELS_WIDE_NEON_H

typedef float32x4_t wf4;
typedef int32x4_t wi4;
typedef wi4 wi_pair4;

static inline wf4 wf_splat4(float v) {
    return vdupq_n_f32(v);
}
static inline wf4 wf_load4(const float *p) {
    return vld1q_f32(p);
}
static inline void wf_store4(float *p, wf4 v) {
    vst1q_f32(p, v);
}
static inline wf4 wf_add4(wf4 a, wf4 b) {
    return vaddq_f32(a, b);
}
static inline wf4 wf_mul4(wf4 a, wf4 b) {
    return vmulq_f32(a, b);
}
static inline wf4 wf_min4(wf4 a, wf4 b) {
    return vbslq_f32(vcltq_f32(a, b), a, b);
}
static inline wf4 wf_max4(wf4 a, wf4 b) {
    return vbslq_f32(vcgtq_f32(a, b), a, b);
}
static inline wi4 wi_splat4(int32_t v) {
    return vdupq_n_s32(v);
}
static inline wi4 wi_lanes4(void) {
    static const int32_t lanes[4] = {0, 1, 2, 3};
    return vld1q_s32(lanes);
}
static inline wf4 wf_lanes4(void) {
    return vcvtq_f32_s32(wi_lanes4());
}
static inline wi4 wi_load4(const void *p) {
    return vld1q_s32((const int32_t *)p);
}
static inline void wi_store4(void *p, wi4 v) {
    vst1q_s32((int32_t *)p, v);
}
static inline wi4 wi_add4(wi4 a, wi4 b) {
    return vaddq_s32(a, b);
}
static inline wi4 wi_ramp4(int32_t step) {
    return vmulq_n_s32(wi_lanes4(), step);
}
static inline wi4 wi_or_three4(wi4 a, wi4 b, wi4 c) {
    return vorrq_s32(vorrq_s32(a, b), c);
}
static inline wf4 wf_min_inside4(wi4 edges, wf4 z, wf4 q) {
    return vbslq_f32(vandq_u32(vcgezq_s32(edges), vcltq_f32(z, q)), z, q);
}
static inline void wi_store_closer4(uint32_t *ids, wi4 edges, wf4 z, wf4 q, wi4 id) {
    const int32x4_t old = wi_load4(ids);
    const uint32x4_t lower = vandq_u32(vceqq_f32(z, q), vcltq_s32(id, old));
    const uint32x4_t wins = vandq_u32(vcgezq_s32(edges), vorrq_u32(vcltq_f32(z, q), lower));
    wi_store4(ids, vbslq_s32(wins, id, old));
}

static inline wi4 wi_count_less4(wi4 count, wf4 a, wf4 b) {
    return vsubq_s32(count, vreinterpretq_s32_u32(vcltq_f32(a, b)));
}
static inline int32_t wi_sum4(wi4 v) {
    return vaddvq_s32(v);
}

static inline wi_pair4 wi_pair_of4(wi4 a, wi4 b) {
    return vpaddq_s32(a, b);
}
static inline void wi_store_sums4(void *p, wi_pair4 a, wi_pair4 b) {
    wi_store4(p, vpaddq_s32(a, b));
}

/* a > b ? a : b, and a < b ? a : b: the instructions for these treat signed zeros differently. */
static inline float64x2_t wide_max_double(float64x2_t a, float64x2_t b) {
    return vbslq_f64(vcgtq_f64(a, b), a, b);
}
static inline float64x2_t wide_min_double(float64x2_t a, float64x2_t b) {
    return vbslq_f64(vcltq_f64(a, b), a, b);
}

static inline wf4 wf_plane4(double base, double step, double column, double lo, double hi) {
    static const double lanes[4] = {0, 1, 2, 3};
    const float64x2_t s = vdupq_n_f64(step), b = vdupq_n_f64(base), c = vdupq_n_f64(column);
    const float64x2_t l = vdupq_n_f64(lo), h = vdupq_n_f64(hi);
    const float64x2_t z0 = vaddq_f64(b, vmulq_f64(s, vaddq_f64(c, vld1q_f64(lanes))));
    const float64x2_t z1 = vaddq_f64(b, vmulq_f64(s, vaddq_f64(c, vld1q_f64(lanes + 2))));
    return vcombine_f32(vcvt_f32_f64(wide_min_double(wide_max_double(z0, l), h)),
                        vcvt_f32_f64(wide_min_double(wide_max_double(z1, l), h)));
}

/* Bit i is set where byte i of 64 equals value. */
static inline uint64_t wide_equal_bytes(const uint8_t *bytes, uint8_t value) {
    static const uint8_t weights[16] = {1, 2, 4, 8, 16, 32, 64, 128, 1, 2, 4, 8, 16, 32, 64, 128};
    const uint8x16_t weight = vld1q_u8(weights);
    uint64_t bits = 0;
    for (int i = 0; i < 4; i++) {
        const uint8x16_t equal = vceqq_u8(vld1q_u8(bytes + 16 * i), vdupq_n_u8(value));
        const uint8x16_t marked = vandq_u8(equal, weight);
        const uint64_t lo = vaddv_u8(vget_low_u8(marked)), hi = vaddv_u8(vget_high_u8(marked));
        bits |= (lo | hi << 8) << (16 * i);
    }
    return bits;
}

static inline void wide_transpose(const shb_vertex *a, const shb_vertex *b, const shb_vertex *c,
                                  const shb_vertex *d, double *x, double *y, double *z) {
    const float64x2_t xy_a = vld1q_f64(&a->x), xy_b = vld1q_f64(&b->x);
    const float64x2_t xy_c = vld1q_f64(&c->x), xy_d = vld1q_f64(&d->x);
    vst1q_f64(x, vzip1q_f64(xy_a, xy_b));
    vst1q_f64(x + 2, vzip1q_f64(xy_c, xy_d));
    vst1q_f64(y, vzip2q_f64(xy_a, xy_b));
    vst1q_f64(y + 2, vzip2q_f64(xy_c, xy_d));
    vst1q_f64(z, vcombine_f64(vld1_f64(&a->z), vld1_f64(&b->z)));
    vst1q_f64(z + 2, vcombine_f64(vld1_f64(&c->z), vld1_f64(&d->z)));
}

#endif
