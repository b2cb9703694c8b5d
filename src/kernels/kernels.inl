/* All kernels of one instruction set. The including file has chosen the target, included the wide
 * types and defined NARROW and WIDE (lanes for small and for larger triangles) and KERNELS (the name
 * of the table). */

#define SHB_JOIN_(a, b) a##b
#define SHB_JOIN(a, b) SHB_JOIN_(a, b)

/* Which layers are drawn beside depth. */
enum { LAYER_IDS = 1, LAYER_SECOND = 2 };

#include "k_transform.inl"

#include "k_setup.inl"

#define LANES NARROW
#include "k_rows.inl"
#undef LANES
#if WIDE != NARROW
#define LANES WIDE
#include "k_rows.inl"
#undef LANES
#endif

#include "k_raster.inl"

const shb_kernels KERNELS = {transform, find_tiles, draw};
