#include "context.h"

/* The kernels of an instruction set may use all that is asked for here and nothing else. */
static bool processor_has(shb_isa isa) {
    switch (isa) {
    case SHB_ISA_SCALAR:
        return true;
#if defined(__x86_64__)
    case SHB_ISA_SSE2:
        return true;
    case SHB_ISA_AVX2:
        return __builtin_cpu_supports("avx2");
    case SHB_ISA_AVX512:
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
               __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
#elif defined(__aarch64__)
    case SHB_ISA_NEON:
        return true;
#endif
    default:
        return false;
    }
}

shb_isa shb_cpu_isa(shb_isa cap) {
    int isa = cap == SHB_ISA_BEST ? SHB_ISA_COUNT - 1 : (int)cap;
    while (!processor_has((shb_isa)isa))
        isa--;
    return (shb_isa)isa;
}

const char *shb_isa_name(shb_isa isa) {
    static const char *const names[SHB_ISA_COUNT] = {"best", "scalar", "sse2",
                                                     "avx2", "avx512", "neon"};
    return (unsigned)isa < SHB_ISA_COUNT ? names[isa] : "unknown";
}
