/* Vectors of doubles made of vectors of floats in registers. */
#ifndef SRC_KERNELS_LANE_PARTS_H
#define SRC_KERNELS_LANE_PARTS_H

#include "vectors.h"

/* DOUBLES lanes from lane first on, a multiple of DOUBLES. */
static inline wd wd_part(vf v, size_t first) {
#if WIDE == 16
    return _mm512_cvtps_pd(first ? _mm512_extractf32x8_ps(v, 1) : _mm512_castps512_ps256(v));
#elif WIDE == 8
    return _mm256_cvtps_pd(first ? _mm256_extractf128_ps(v, 1) : _mm256_castps256_ps128(v));
#elif WIDE == 4 && defined(__x86_64__)
    return _mm_cvtps_pd(first ? _mm_movehl_ps(v, v) : (__m128)v);
#elif WIDE == 4
    return first ? vcvt_high_f64_f32(v) : vcvt_f64_f32(vget_low_f32(v));
#else
    return (double)v[first];
#endif
}

#endif
