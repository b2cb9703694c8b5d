/* One lane of 32 bits: what the operations of all vectors mean for boxes of texels. */
#ifndef SRC_KERNELS_WIDE_SCALAR_H
#define SRC_KERNELS_WIDE_SCALAR_H

typedef float wf1;
typedef int32_t wi1;
typedef struct wi_pair1 {
    wi1 first, second;
} wi_pair1;

static inline wf1 wf_splat1(float v) {
    return v;
}
static inline wf1 wf_load1(const float *p) {
    return *p;
}
static inline wf1 wf_add1(wf1 a, wf1 b) {
    return a + b;
}
static inline wf1 wf_mul1(wf1 a, wf1 b) {
    return a * b;
}
static inline wf1 wf_min1(wf1 a, wf1 b) {
    return a < b ? a : b;
}
static inline wf1 wf_max1(wf1 a, wf1 b) {
    return a > b ? a : b;
}
static inline wi1 wi_add1(wi1 a, wi1 b) {
    return a + b;
}
static inline wi1 wi_splat1(int32_t v) {
    return v;
}
static inline void wi_store1(void *p, wi1 v) {
    *(int32_t *)p = v;
}
static inline wi1 wi_count_less1(wi1 count, wf1 a, wf1 b) {
    return count + (a < b);
}
static inline int32_t wi_sum1(wi1 v) {
    return v;
}
static inline wi_pair1 wi_pair_of1(wi1 a, wi1 b) {
    return (wi_pair1){a, b};
}
static inline void wi_store_sums1(void *p, wi_pair1 a, wi_pair1 b) {
    const wi1 sums[4] = {a.first, a.second, b.first, b.second};
    memcpy(p, sums, sizeof sums);
}

#endif
