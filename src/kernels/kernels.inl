/* All kernels of one instruction set. The including file has chosen the target, included the wide
 * types and defined NARROW and WIDE (lanes for small and for larger triangles) and KERNELS (the
 * name of the table).
 *
 * The wide types are what a kernel may ask of an instruction set. Each wide_*.h defines the
 * following for its number of lanes, which ends every name (wf_add8); k_*.inl write W(wf_add).
 *
 *   wf, wi                floats, 32-bit integers
 *   wf_splat, wi_splat    the same number in every lane
 *   wf_lanes              0, 1, 2, ...
 *   wf_load, wf_store, wi_load, wi_store    from and to any address
 *   wf_add, wf_mul, wi_add
 *   wi_ramp(step)         0, step, 2 * step, ...
 *   wi_or_three(a, b, c)  a | b | c
 *   wf_min_inside(edges, z, q)
 *                         edges >= 0 && z < q ? z : q
 *   wi_store_closer(ids, edges, z, q, id)
 *                         id where edges >= 0 and (z, id) is below (q, the old one)
 *   wf_plane(base, step, column, lo, hi)
 *                         base + step * (column + lane) in double, lo where it is below, hi where
 *                         it is above, rounded to float
 *   wf_min, wf_max(a, b)  a < b ? a : b, a > b ? a : b: b if one is NaN
 *   wi_count_less(count, a, b)
 *                         count + 1 where a < b
 *   wi_sum(v)             of all lanes
 *   wi_pair               parts of the sums of two vectors
 *   wi_pair_of(a, b)      of vectors whose lanes are 0 to 2^13
 *   wi_store_sums(to, a, b)
 *                         wi_sum of the first and the second of a, then of b
 *
 * and these, whose names do not end in a number:
 *
 *   wide_equal_bytes(bytes, value)
 *                         bit i: byte i of 64 equals value
 *   wide_transpose(a, b, c, d, x, y, z)
 *                         the positions of four vertices, each coordinate in an array */

/* Which layers are drawn beside depth. */
enum { LAYER_IDS = 1, LAYER_SECOND = 2, LAYER_PLANES = 4 /* in place of ids */ };

#include "pairs.h"

#include "k_transform.inl"

#include "k_setup.inl"

#include "k_pairs.inl"

#include "k_clear.inl"

#include "k_hidden.inl"

#include "k_cells.inl"

#define LANES NARROW
#include "k_rows.inl"
#undef LANES
#if WIDE != NARROW
#define LANES WIDE
#include "k_rows.inl"
#undef LANES
#endif

#include "k_raster.inl"

const shb_kernels KERNELS = {transform, find_tiles, draw, clear};
