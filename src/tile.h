/* Drawing tile by tile: the triangles of a tile's list, in rising order of ids, into layers of the
 * tile, which are then stored in the caller's images.
 *
 * An edge from a to b is e(p) = dx * (p.y - a.y) - dy * (p.x - a.x), exact in 64 bits, positive
 * inside. A sample on an edge is covered if the edge is a left one (dy < 0) or a top one (dy = 0,
 * dx > 0), which is where the inside begins for a sample moved by (s, s^2), s infinitely small: so
 * each sample belongs to exactly one side of an edge. With a bias of -1 for all other edges covered
 * means e + bias >= 0.
 *
 * Neighbouring samples differ by 256 dx or 256 dy, so 256 can be divided out without changing a
 * sign: e(i, j) = floor((e(0, 0) + bias) / 256) + dx * j - dy * i |dx|, |dy| <= 2^23 and |e(0, 0)|
 * <= 2^47 from any sample of the target. In a block of 64 by 64 samples an edge that changes sign
 * is bounded by (|dx| + |dy|) * 64 <= 2^30 there, so that 32 bits are enough for it; any other edge
 * accepts or rejects the whole block. */
#ifndef SRC_TILE_H
#define SRC_TILE_H

#include "bin.h"

/* Draws all tiles on the context's threads; false: out of memory, the images are untouched. */
bool shb_tiles_draw(shb_context *context, const shb_draw_desc *desc, const shb_geometry *geometry,
                    const shb_target *target, const shb_bins *bins);

#endif
