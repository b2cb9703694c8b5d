/* The tables of kernels by instruction set. */
#include "lists.h"
#include "moments.h"
#include "raster.h"
#include "shade.h"
#include "sheets.h"

#if defined(__x86_64__)
#define TABLE_OF(isa, tables, scalar)                                                              \
    ((isa) == SHB_ISA_SSE2     ? &tables##_sse2                                                    \
     : (isa) == SHB_ISA_AVX2   ? &tables##_avx2                                                    \
     : (isa) == SHB_ISA_AVX512 ? &tables##_avx512                                                  \
                               : (scalar))
#elif defined(__aarch64__)
#define TABLE_OF(isa, tables, scalar) ((isa) == SHB_ISA_NEON ? &tables##_neon : (scalar))
#else
#define TABLE_OF(isa, tables, scalar) ((void)(isa), (scalar))
#endif

const shb_kernels *shb_kernels_of(shb_isa isa) {
    return TABLE_OF(isa, shb_kernels, NULL);
}

const shb_shade_kernels *shb_shade_kernels_of(shb_isa isa) {
    return TABLE_OF(isa, shb_shade_kernels, &shb_shade_kernels_scalar);
}

const shb_list_kernels *shb_list_kernels_of(shb_isa isa) {
    return TABLE_OF(isa, shb_list_kernels, &shb_list_kernels_scalar);
}

const shb_sheet_kernels *shb_sheet_kernels_of(shb_isa isa) {
    return TABLE_OF(isa, shb_sheet_kernels, &shb_sheet_kernels_scalar);
}

const shb_moment_kernels *shb_moment_kernels_of(shb_isa isa) {
    return TABLE_OF(isa, shb_moment_kernels, &shb_moment_kernels_scalar);
}
