/* Vectors of WIDE pairs of 16-bit numbers, each in the place of a lane of 32 bits: x in the lower
 * half, y in the upper one. */
#ifndef SRC_KERNELS_PAIRS_H
#define SRC_KERNELS_PAIRS_H

#include "kept_lanes.h"

typedef int16_t vs __attribute__((vector_size(4 * WIDE)));
typedef uint16_t vs_bits __attribute__((vector_size(4 * WIDE)));

#define WIDE_BITS ((1u << WIDE) - 1)

static inline vs vs_splat(int32_t x, int32_t y) {
    return (vs)vi_splat((int32_t)((uint32_t)(x & 0xffff) | (uint32_t)y << 16));
}
/* a - b and a * 2^8, modulo 2^16: of triangles that are too large all is computed, but not used. */
static inline vs vs_minus(vs a, vs b) {
    return (vs)((vs_bits)a - (vs_bits)b);
}
static inline vs vs_times_256(vs a) {
    return (vs)((vs_bits)a << 8);
}

/* vs_swap: (y, x). vs_min, vs_max: of each number. vi_dot: a.x * b.x + a.y * b.y. */
#if WIDE == 16
static inline vs vs_swap(vs v) {
    return (vs)_mm512_rol_epi32((__m512i)v, 16);
}
static inline vs vs_min(vs a, vs b) {
    return (vs)_mm512_min_epi16((__m512i)a, (__m512i)b);
}
static inline vs vs_max(vs a, vs b) {
    return (vs)_mm512_max_epi16((__m512i)a, (__m512i)b);
}
static inline vi vi_dot(vs a, vs b) {
    return (vi)_mm512_madd_epi16((__m512i)a, (__m512i)b);
}
#elif WIDE == 8
static inline vs vs_swap(vs v) {
    const __m256i low = _mm256_shufflelo_epi16((__m256i)v, _MM_SHUFFLE(2, 3, 0, 1));
    return (vs)_mm256_shufflehi_epi16(low, _MM_SHUFFLE(2, 3, 0, 1));
}
static inline vs vs_min(vs a, vs b) {
    return (vs)_mm256_min_epi16((__m256i)a, (__m256i)b);
}
static inline vs vs_max(vs a, vs b) {
    return (vs)_mm256_max_epi16((__m256i)a, (__m256i)b);
}
static inline vi vi_dot(vs a, vs b) {
    return (vi)_mm256_madd_epi16((__m256i)a, (__m256i)b);
}
#elif defined(__x86_64__)
static inline vs vs_swap(vs v) {
    const __m128i low = _mm_shufflelo_epi16((__m128i)v, _MM_SHUFFLE(2, 3, 0, 1));
    return (vs)_mm_shufflehi_epi16(low, _MM_SHUFFLE(2, 3, 0, 1));
}
static inline vs vs_min(vs a, vs b) {
    return (vs)_mm_min_epi16((__m128i)a, (__m128i)b);
}
static inline vs vs_max(vs a, vs b) {
    return (vs)_mm_max_epi16((__m128i)a, (__m128i)b);
}
static inline vi vi_dot(vs a, vs b) {
    return (vi)_mm_madd_epi16((__m128i)a, (__m128i)b);
}
#else
static inline vs vs_swap(vs v) {
    return (vs)vrev32q_s16((int16x8_t)v);
}
static inline vs vs_min(vs a, vs b) {
    return (vs)vminq_s16((int16x8_t)a, (int16x8_t)b);
}
static inline vs vs_max(vs a, vs b) {
    return (vs)vmaxq_s16((int16x8_t)a, (int16x8_t)b);
}
static inline vi vi_dot(vs a, vs b) {
    const int32x4_t low = vmull_s16(vget_low_s16((int16x8_t)a), vget_low_s16((int16x8_t)b));
    return (vi)vpaddq_s32(low, vmull_high_s16((int16x8_t)a, (int16x8_t)b));
}
#endif

/* The words of a table whose numbers are those of WIDE triangles' corners. AVX-512 looks them up in
 * registers. */
#if WIDE == 16
static inline __attribute__((always_inline)) void
vs_look_up(const int32_t *table, size_t count, const uint8_t *numbers, vs corners[3]) {
    __m512i number[3], found[3];
    for (int k = 0; k < 3; k++) {
        number[k] = _mm512_cvtepu8_epi32(
            _mm_loadu_si128((const __m128i *)(const void *)(numbers + 16 * k)));
        found[k] = _mm512_permutex2var_epi32(_mm512_loadu_si512(table), number[k],
                                             _mm512_loadu_si512(table + 16));
    }
    for (size_t block = 32; block < count; block += 32) {
        const __m512i low = _mm512_loadu_si512(table + block);
        const __m512i high = _mm512_loadu_si512(table + block + 16);
        const __m512i first = _mm512_set1_epi32((int32_t)block);
        for (int k = 0; k < 3; k++)
            found[k] = _mm512_mask_mov_epi32(found[k], _mm512_cmpge_epi32_mask(number[k], first),
                                             _mm512_permutex2var_epi32(low, number[k], high));
    }
    for (int k = 0; k < 3; k++)
        corners[k] = (vs)found[k];
}
#else
static inline __attribute__((always_inline)) void
vs_look_up(const int32_t *table, size_t count, const uint8_t *numbers, vs corners[3]) {
    (void)count;
    for (int k = 0; k < 3; k++) {
        const uint8_t *n = numbers + SHB_CORNERS_TOGETHER * k;
#if WIDE == 8
        corners[k] = (vs)(vi){table[n[0]], table[n[1]], table[n[2]], table[n[3]],
                              table[n[4]], table[n[5]], table[n[6]], table[n[7]]};
#else
        corners[k] = (vs)(vi){table[n[0]], table[n[1]], table[n[2]], table[n[3]]};
#endif
    }
}
#endif

#endif
