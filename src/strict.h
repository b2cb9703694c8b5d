/* Include first in every file that calculates: floating point without contraction, whatever flags
 * the host's build uses. */
#ifndef SRC_STRICT_H
#define SRC_STRICT_H

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) ||           \
    defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__)
#error "libshadowbias needs IEEE arithmetic: compile it without -ffast-math and its parts"
#endif

#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__)
/* Nothing here reads exception flags or errno, which would keep loops from being vectorised. */
#pragma GCC optimize("fp-contract=off", "no-trapping-math", "no-math-errno")
#endif

#endif
