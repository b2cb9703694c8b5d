#include "target.h"

/* One element at a time: what the vectors of all instruction sets have to agree with. */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-vectorize")
#endif

#include "doubles_scalar.h"
#include "wide_scalar.h"
#define NARROW 1
#define WIDE 1
#define SHADE_KERNELS shb_shade_kernels_scalar
#include "k_shade.inl"
#define LIST_KERNELS shb_list_kernels_scalar
#include "k_lists.inl"
#define SHEET_KERNELS shb_sheet_kernels_scalar
#include "k_sheets.inl"
#define MOMENT_KERNELS shb_moment_kernels_scalar
#include "k_moments.inl"
