/* Compiles the functions between begin and end for an instruction set, in any host's build. */
#ifndef SRC_KERNELS_TARGET_H
#define SRC_KERNELS_TARGET_H

#include "../strict.h"

/* Loops are vectorised whatever the host's level of optimisation. gcc heeds this line only outside
 * of a macro. */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("O3")
#endif

#include <math.h>
#include <string.h>

#if defined(__x86_64__)
#include <immintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#endif

#include "raster.h"

/* Names of the wide types end in their number of lanes. */
#define SHB_JOIN_(a, b) a##b
#define SHB_JOIN(a, b) SHB_JOIN_(a, b)

#define SHB_PRAGMA(text) _Pragma(#text)
#if defined(__clang__)
#define SHB_TARGET_BEGIN(features)                                                                 \
    SHB_PRAGMA(clang attribute push(__attribute__((target(features))), apply_to = function))
#define SHB_TARGET_END SHB_PRAGMA(clang attribute pop)
#else
#define SHB_TARGET_BEGIN(features) SHB_PRAGMA(GCC push_options) SHB_PRAGMA(GCC target(features))
#define SHB_TARGET_END SHB_PRAGMA(GCC pop_options)
#endif

#endif
