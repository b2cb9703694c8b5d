#include "target.h"

#if defined(__aarch64__)
SHB_TARGET_BEGIN("+simd")
#include "wide_neon.h"
#define NARROW 4
#define WIDE 4
#define KERNELS shb_kernels_neon
#include "doubles_neon.h"
#include "kernels.inl"
#define SHADE_KERNELS shb_shade_kernels_neon
#include "k_shade.inl"
#define LIST_KERNELS shb_list_kernels_neon
#include "k_lists.inl"
#define SHEET_KERNELS shb_sheet_kernels_neon
#include "k_sheets.inl"
#define MOMENT_KERNELS shb_moment_kernels_neon
#include "k_moments.inl"
SHB_TARGET_END
#endif
