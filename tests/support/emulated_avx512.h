#pragma GCC system_header /* names that macros of the compiler's header have may be taken */

/* Included before cpu.c and kernels_avx512.c: the kernels for AVX-512 then run wherever there is
 * AVX2, as functions of SIMDe take the places of the instructions. */
#include "../../src/kernels/target.h"

#define __builtin_cpu_supports(feature) __builtin_cpu_supports("avx2")

#undef SHB_TARGET_BEGIN
#undef SHB_TARGET_END
#define SHB_TARGET_BEGIN(features)
#define SHB_TARGET_END

#if !defined(__clang__)
#pragma GCC optimize("O1") /* at O3 SIMDe's loops take minutes to compile */
#endif

#define SIMDE_ENABLE_NATIVE_ALIASES
#include <simde/x86/avx512.h>

/* What SIMDe 0.7.4 lacks follows, and what it has wrong: the name of _mm512_madd_epi16, the sign of
 * -0 in _mm512_abs_pd, and the second argument of _mm512_roundscale_pd without brackets. */
typedef float emulated_floats __attribute__((vector_size(64)));
typedef int32_t emulated_ints __attribute__((vector_size(64)));
typedef uint8_t emulated_bytes __attribute__((vector_size(16)));

static inline void emulated_mask_store(void *p, __mmask16 mask, __m512i v) {
    for (int i = 0; i < 16; i++)
        if (mask >> i & 1)
            memcpy((char *)p + 4 * i, (char *)&v + 4 * i, 4);
}
static inline float emulated_least(emulated_floats v) {
    float least = v[0];
    for (int i = 1; i < 16; i++)
        least = least < v[i] ? least : v[i];
    return least;
}
static inline __m256i emulated_trunc(__m512d v) {
    return _mm256_set_m128i(_mm256_cvttpd_epi32(_mm512_extractf64x4_pd(v, 1)),
                            _mm256_cvttpd_epi32(_mm512_castpd512_pd256(v)));
}

#undef _mm512_abs_pd
#define _mm512_abs_pd(v)                                                                           \
    _mm512_castsi512_pd(                                                                           \
        _mm512_and_si512(_mm512_castpd_si512(v), _mm512_set1_epi64(0x7fffffffffffffff)))
#undef _mm512_madd_epi16
#define _mm512_madd_epi16(a, b) simde_mm512_madd_epi16(a, b)
#undef _mm512_roundscale_pd
#define _mm512_roundscale_pd(v, how) simde_mm512_roundscale_pd(v, (how))

#define _kand_mask16(a, b) ((__mmask16)((a) & (b)))
#define _kandn_mask16(a, b) ((__mmask16)(~(a) & (b)))
#define _kor_mask16(a, b) ((__mmask16)((a) | (b)))

#define _mm256_cmp_ps_mask(a, b, how) ((__mmask8)_mm256_movemask_ps(_mm256_cmp_ps(a, b, how)))
#define _mm512_mask_cmp_ps_mask(mask, a, b, how) _kand_mask16(mask, _mm512_cmp_ps_mask(a, b, how))
#define _mm512_mask_cmplt_epi32_mask(mask, a, b) _kand_mask16(mask, _mm512_cmpgt_epi32_mask(b, a))
#define _mm512_mask_testn_epi32_mask(mask, a, b)                                                   \
    _kand_mask16(mask, _mm512_cmpeq_epi32_mask(_mm512_and_si512(a, b), _mm512_setzero_si512()))

#define _mm512_cvtepi32_ps(v)                                                                      \
    ((__m512) __builtin_convertvector((emulated_ints)(v), emulated_floats))
#define _mm512_cvtepu8_epi32(v)                                                                    \
    ((__m512i) __builtin_convertvector((emulated_bytes)(v), emulated_ints))
#define _mm512_cvtpd_ps(v) __builtin_convertvector(v, __m256)
#define _mm512_cvtps_pd(v) __builtin_convertvector(v, __m512d)
#define _mm512_cvttpd_epi32(v) emulated_trunc(v)

#define _mm512_extractf32x8_ps(v, i)                                                               \
    _mm256_castpd_ps(_mm512_extractf64x4_pd(_mm512_castps_pd(v), i))
#define _mm512_extracti32x8_epi32(v, i) _mm512_extracti64x4_epi64(v, i)
#define _mm512_mask_storeu_epi32(p, mask, v) emulated_mask_store(p, mask, v)
#define _mm512_reduce_min_ps(v) emulated_least(v)
