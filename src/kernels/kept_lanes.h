/* Lists of the lanes of vectors whose bits are set. */
#ifndef SRC_KERNELS_KEPT_LANES_H
#define SRC_KERNELS_KEPT_LANES_H

#include "vectors.h"

/* vi_keep: keeps the lanes whose bit is set in a list that has count numbers: behind them, the rest
 * of a vector follows. Where lanes cannot be permuted by variables (KEEPS_APART) all stay in the
 * list's places from t on.
 * vi_keep_places: the same of the places t, t + 1, ...; returns how many numbers there are then. */
#if WIDE == 4
#define KEEPS_APART 1
#else
#define KEEPS_APART 0
#endif

#if WIDE < 16
/* Of four bits, those that are set. */
static const int32_t set_bits[16][4] = {
    {0}, {0},    {1},    {0, 1},    {2},    {0, 2},    {1, 2},    {0, 1, 2},
    {3}, {0, 3}, {1, 3}, {0, 1, 3}, {2, 3}, {0, 2, 3}, {1, 2, 3}, {0, 1, 2, 3}};
#endif

#if WIDE == 16
static inline void vi_keep(int32_t *list, int t, int count, vi v, uint32_t bits) {
    (void)t;
    _mm512_storeu_si512(list + count, _mm512_maskz_compress_epi32((__mmask16)bits, (__m512i)v));
}
#elif WIDE == 8
static inline void vi_keep(int32_t *list, int t, int count, vi v, uint32_t bits) {
    (void)t;
    const __m128i low = _mm_loadu_si128((const __m128i *)(const void *)set_bits[bits & 15]);
    const __m128i high = _mm_loadu_si128((const __m128i *)(const void *)set_bits[bits >> 4]);
    const __m256i kept = (__m256i)_mm256_permutevar_ps((__m256)v, _mm256_set_m128i(high, low));
    int32_t *const to = list + count;
    _mm_storeu_si128((__m128i *)(void *)to, _mm256_castsi256_si128(kept));
    _mm_storeu_si128((__m128i *)(void *)(to + __builtin_popcount(bits & 15)),
                     _mm256_extracti128_si256(kept, 1));
}
#else
static inline void vi_keep(int32_t *list, int t, int count, vi v, uint32_t bits) {
    (void)count;
    (void)bits;
    vi_store(list + t, v);
}
#endif

static inline int vi_keep_places(int32_t *list, int t, int count, uint32_t bits) {
#if WIDE == 4
    vi_store(list + count, vi_load(set_bits[bits]) + t);
    return count + (int)(0x4332322132212110u >> 4 * bits & 15);
#else
    vi_keep(list, t, count, vi_numbers() + t, bits);
    return count + __builtin_popcount(bits);
#endif
}

/* The lanes whose bits are set behind the count numbers of a list, without gaps; up to WIDE numbers
 * are written. */
static inline void vi_append(int32_t *list, size_t count, vi v, uint32_t bits) {
#if WIDE >= 8
    vi_keep(list + count, 0, 0, v, bits);
#else
    typedef int32_t word __attribute__((may_alias));
    word *const words = list; /* the list may hold floats */
    int32_t lanes[WIDE];
    memcpy(lanes, &v, sizeof lanes);
    for (int i = 0; i < WIDE; i++) {
        words[count] = lanes[i];
        count += bits >> i & 1;
    }
#endif
}

#endif
