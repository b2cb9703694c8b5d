/* Which samples a shape covers, row by row.
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
#ifndef SRC_COVER_H
#define SRC_COVER_H

#include "setup.h"

/* An edge at the first sample of a box, with 256 divided out. */
typedef struct shb_edge {
    int64_t value, per_column, per_row;
    int32_t from_y, to_y;
} shb_edge;

typedef struct shb_cover {
    shb_samples box;
    size_t count;
    shb_edge edges[SHB_POLYGON_MAX];
} shb_cover;

/* Covered columns first .. end - 1. */
typedef struct shb_run {
    int32_t first, end;
} shb_run;

#define SHB_RUNS_MAX (SHB_POLYGON_MAX / 2)

/* The cover of a shape in a box of samples that is not empty. */
shb_cover shb_cover_of(const shb_shape *shape, shb_samples box);

/* The runs of a row of the box, from left to right; returns how many. */
size_t shb_cover_row(const shb_cover *cover, int32_t row, shb_run runs[SHB_RUNS_MAX]);

#endif
