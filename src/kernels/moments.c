#include "moments.h"

const shb_moment_kernels *shb_moment_kernels_of(shb_isa isa) {
    switch (isa) {
#if defined(__x86_64__)
    case SHB_ISA_SSE2:
        return &shb_moment_kernels_sse2;
    case SHB_ISA_AVX2:
        return &shb_moment_kernels_avx2;
    case SHB_ISA_AVX512:
        return &shb_moment_kernels_avx512;
#elif defined(__aarch64__)
    case SHB_ISA_NEON:
        return &shb_moment_kernels_neon;
#endif
    default:
        return &shb_moment_kernels_scalar;
    }
}
