#include "target.h"

#if defined(__x86_64__)
SHB_TARGET_BEGIN("sse2")
#include "wide_sse2.h"
#define NARROW 4
#define WIDE 4
#define KERNELS shb_kernels_sse2
#include "doubles_sse2.h"
#include "kernels.inl"
#define SHADE_KERNELS shb_shade_kernels_sse2
#include "k_shade.inl"
#define LIST_KERNELS shb_list_kernels_sse2
#include "k_lists.inl"
#define SHEET_KERNELS shb_sheet_kernels_sse2
#include "k_sheets.inl"
#define MOMENT_KERNELS shb_moment_kernels_sse2
#include "k_moments.inl"
SHB_TARGET_END
#endif
