#include "target.h"

#if defined(__x86_64__)
SHB_TARGET_BEGIN("avx2")
#include "wide_avx2.h"
#define NARROW 8
#define WIDE 8
#define KERNELS shb_kernels_avx2
#include "doubles_avx2.h"
#include "kernels.inl"
#define SHADE_KERNELS shb_shade_kernels_avx2
#include "k_shade.inl"
#define LIST_KERNELS shb_list_kernels_avx2
#include "k_lists.inl"
#define SHEET_KERNELS shb_sheet_kernels_avx2
#include "k_sheets.inl"
#define MOMENT_KERNELS shb_moment_kernels_avx2
#include "k_moments.inl"
SHB_TARGET_END
#endif
