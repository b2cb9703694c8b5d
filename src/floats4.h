/* Vectors of four floats that need no kernels of instruction sets. */
#ifndef SRC_FLOATS4_H
#define SRC_FLOATS4_H

#include <stdint.h>
#include <string.h>

#if defined(__x86_64__)
#include <emmintrin.h>
#endif

typedef float floats4 __attribute__((vector_size(16)));
typedef int32_t masks4 __attribute__((vector_size(16)));

static inline float min_of(float a, float b) {
    return a < b ? a : b;
}

static inline float max_of(float a, float b) {
    return a > b ? a : b;
}

static inline floats4 splat4(float value) {
    return (floats4){value, value, value, value};
}

static inline floats4 load4(const float *p) {
    floats4 v;
    memcpy(&v, p, sizeof v);
    return v;
}

static inline floats4 choose4(masks4 mask, floats4 yes, floats4 no) {
    return (floats4)((mask & (masks4)yes) | (~mask & (masks4)no));
}

/* a < b ? a : b and a > b ? a : b */
#if defined(__x86_64__)
static inline floats4 min4(floats4 a, floats4 b) {
    return _mm_min_ps(a, b);
}
static inline floats4 max4(floats4 a, floats4 b) {
    return _mm_max_ps(a, b);
}
#else
static inline floats4 min4(floats4 a, floats4 b) {
    return choose4(a < b, a, b);
}
static inline floats4 max4(floats4 a, floats4 b) {
    return choose4(a > b, a, b);
}
#endif

static inline float sum4(floats4 v) {
    return (v[0] + v[1]) + (v[2] + v[3]);
}

#endif
