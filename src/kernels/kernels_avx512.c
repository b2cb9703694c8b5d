#include "target.h"

#if defined(__x86_64__)
SHB_TARGET_BEGIN("avx2,avx512f,avx512vl,avx512dq,avx512bw")
#include "wide_avx2.h"
#include "wide_avx512.h"
#define NARROW 8
#define WIDE 16
#define KERNELS shb_kernels_avx512
#include "doubles_avx512.h"
#include "kernels.inl"
#define SHADE_KERNELS shb_shade_kernels_avx512
#include "k_shade.inl"
#define LIST_KERNELS shb_list_kernels_avx512
#include "k_lists.inl"
#define SHEET_KERNELS shb_sheet_kernels_avx512
#include "k_sheets.inl"
#define MOMENT_KERNELS shb_moment_kernels_avx512
#include "k_moments.inl"
SHB_TARGET_END
#endif
