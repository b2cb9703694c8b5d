/* The layers of a rectangle of the target while triangles are drawn into it, and the scalar way of
 * drawing a triangle: the reference for the kernels, and the way of all triangles that are cut.
 *
 * Coverage. An edge from a to b is e(p) = dx * (p.y - a.y) - dy * (p.x - a.x), exact, positive on
 * the inside. The top-left rule is a sample moved right by an infinitely small s and down by s^2,
 * so that it lies on no edge: an e of 0 is inside for left edges (dy < 0) and top ones (dy = 0, dx
 * > 0). With a bias of 0 for these and -1 for all others, inside means e + bias >= 0. A triangle
 * covers what is inside its three edges. A cut polygon would too, but snapping can bend it slightly
 * inwards or even turn parts of it over: what it covers is by definition where its winding number
 * is positive. For convex shapes that is the same, and neighbours of cut triangles share samples as
 * exactly as others. The winding number counts the edges that cross the sample's row on its left:
 * +1 for those that go up, -1 for those that go down. Level edges cross no row.
 *
 * Widths. Neighbouring samples differ by 256 dx or 256 dy, so 256 can be divided out without
 * changing a sign: e(i, j) = floor((e(0, 0) + bias) / 256) + dx * j - dy * i. |dx|, |dy| <= 2^23
 * and |e| <= 2^47 at any sample of the target. In a block of 64 by 64 samples, widened to 80 by
 * whole vectors, an edge that changes sign is bounded by (|dx| + |dy|) * 80 < 2^31 there, so that
 * 32 bits are enough for it; any other edge accepts or rejects the whole block. */
#ifndef SRC_LAYERS_H
#define SRC_LAYERS_H

#include "plane.h"

/* Depths are canonical. Sample (column, row) is element (row - samples.first_row) * pitch + column
 * - samples.first_column of each array. */
typedef struct shb_layers {
    shb_samples samples;
    size_t pitch;
    float *nearest;
    float *second; /* NULL: not wanted */
    uint32_t *ids; /* NULL: not wanted */
} shb_layers;

/* Layers of pitch * rows samples for each of count lanes, in the context's scratch, with what the
 * description wants; their samples are for the caller to choose. NULL: out of memory. */
shb_layers *shb_layers_reserve(shb_context *context, const shb_draw_desc *desc, size_t count,
                               size_t pitch, size_t rows);

/* Far depths and no ids. */
void shb_layers_clear(const shb_layers *layers, bool reversed);

/* Merges a drawn shape. The order of shapes does not matter: at each sample the lowest (depth, id)
 * is the nearest layer, the next depth is the second. */
void shb_layers_draw(const shb_layers *layers, const shb_target *target, const shb_shape *shape,
                     uint32_t id);

/* Stores the samples in the images that the description wants, except where a layer is the image.
 */
void shb_layers_store(const shb_layers *layers, const shb_draw_desc *desc);

#endif
