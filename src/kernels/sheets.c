#include "sheets.h"

const shb_sheet_kernels *shb_sheet_kernels_of(shb_isa isa) {
    switch (isa) {
#if defined(__x86_64__)
    case SHB_ISA_SSE2:
        return &shb_sheet_kernels_sse2;
    case SHB_ISA_AVX2:
        return &shb_sheet_kernels_avx2;
    case SHB_ISA_AVX512:
        return &shb_sheet_kernels_avx512;
#elif defined(__aarch64__)
    case SHB_ISA_NEON:
        return &shb_sheet_kernels_neon;
#endif
    default:
        return &shb_sheet_kernels_scalar;
    }
}
