#include "target.h"

#if defined(__aarch64__)
SHB_TARGET_BEGIN("+simd")
#include "wide_neon.h"
#define NARROW 4
#define WIDE 4
#define KERNELS shb_kernels_neon
#include "kernels.inl"
SHB_TARGET_END
#endif
