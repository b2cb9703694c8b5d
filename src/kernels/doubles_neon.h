/* A vector of two doubles for the loops over fragments. + - * / are the compiler's own; the
 * operations are those of doubles_scalar.h. */
#ifndef SRC_KERNELS_DOUBLES_NEON_H
#define SRC_KERNELS_DOUBLES_NEON_H

#define DOUBLES 2

typedef float64x2_t wd;

static inline wd wd_splat(double value) {
    return vdupq_n_f64(value);
}
static inline wd wd_load_floats(const float *p) {
    return vcvt_f64_f32(vld1_f32(p));
}
static inline wd wd_load(const double *p) {
    return vld1q_f64(p);
}
static inline void wd_store(double *p, wd v) {
    vst1q_f64(p, v);
}
static inline void wd_store_floats(float *p, wd v) {
    vst1_f32(p, vcvt_f32_f64(v));
}
static inline void wd_store_ints(int32_t *p, wd v) {
    const uint64x2_t known = vceqq_f64(v, v);
    const int64x2_t ints = vcvtq_s64_f64(vbslq_f64(known, v, vdupq_n_f64(-0x1p31)));
    vst1_s32(p, vqmovn_s64(ints));
}
static inline wd wd_max(wd a, wd b) {
    return vbslq_f64(vcgtq_f64(a, b), a, b);
}
static inline wd wd_min(wd a, wd b) {
    return vbslq_f64(vcltq_f64(a, b), a, b);
}
static inline wd wd_sqrt(wd v) {
    return vsqrtq_f64(v);
}
static inline wd wd_floor(wd v) {
    return vrndmq_f64(v);
}
static inline wd wd_where_greater(wd a, wd b, wd yes, wd no) {
    return vbslq_f64(vcgtq_f64(a, b), yes, no);
}
static inline wd wd_where_equal(wd a, wd b, wd yes, wd no) {
    return vbslq_f64(vceqq_f64(a, b), yes, no);
}
static inline wd wd_abs(wd v) {
    return vabsq_f64(v);
}
static inline uint32_t wd_greater_bits(wd a, wd b) {
    const uint64x2_t greater = vcgtq_f64(a, b);
    return (uint32_t)((vgetq_lane_u64(greater, 0) & 1) | (vgetq_lane_u64(greater, 1) & 2));
}
static inline bool wd_any_signed(wd v) {
    const int64x2_t bits = vreinterpretq_s64_f64(v);
    return (vgetq_lane_s64(bits, 0) | vgetq_lane_s64(bits, 1)) < 0;
}
static inline void wd_read_quads(const double *const from[DOUBLES], wd out[4]) {
    for (int k = 0; k < 4; k += 2) {
        const wd a = vld1q_f64(from[0] + k), b = vld1q_f64(from[1] + k);
        out[k] = vzip1q_f64(a, b);
        out[k + 1] = vzip2q_f64(a, b);
    }
}
static inline void wd_store_pairs(float *first, void *second, wd v) {
    const float32x4_t pairs = vreinterpretq_f32_f64(v);
    vst1_f32(first, vget_low_f32(vuzp1q_f32(pairs, pairs)));
    vst1_f32(second, vget_low_f32(vuzp2q_f32(pairs, pairs)));
}
static inline void wd_store_quads(double *to, size_t step, wd a, wd b, wd c, wd d) {
    vst1q_f64(to, vzip1q_f64(a, b));
    vst1q_f64(to + 2, vzip1q_f64(c, d));
    vst1q_f64(to + step, vzip2q_f64(a, b));
    vst1q_f64(to + step + 2, vzip2q_f64(c, d));
}

#endif
