/* The depth of a triangle: one plane equation, anchored at the top-left sample of the triangle's
 * box of samples before that is cut to target or tile, and evaluated directly. So neither tiles nor
 * threads nor lanes can change a bit, and whoever holds the triangle can recompute them.
 *
 * Of a whole triangle, from the unsnapped window corners in mesh order, all in double, d the
 * difference to corner 0:
 *     A  = dX1 * dY2 - dX2 * dY1
 *     gx = (dZ1 * dY2 - dZ2 * dY1) / A,  gy = (dX1 * dZ2 - dX2 * dZ1) / A
 *     z0 = (Z0 + gx * (xs - X0)) + gy * (ys - Y0), (xs, ys) the centre of the anchor's pixel
 * Of a cut triangle, whose corners may lie behind the eye: the plane z = a x + b y + c w through
 * its three corners in clip space, turned into the same gx, gy, z0.
 *
 * At the sample i columns and j rows from the anchor, in this order:
 *     plain    ((float)z0 + (float)gy * (float)j) + (float)gx * (float)i, all in float
 *     careful  (z0 + gy * j) + gx * i in double, clamped to the corners' range, rounded to float
 *
 * The error of plain. Let u = 2^-24, e = 2^-53, z the plane's exact value at a covered sample, w by
 * h the samples of the box, g = |gx| + |gy|, m = |gx| i + |gy| j, Zs the smallest |Z| of the
 * corners. Rounding z0, both gradients, both products and both sums costs, to first order,
 *     u (|z0| + 2 m + |z0 + gy j| + |z|) <= u (3 |z| + 4 m)                                   (1)
 * since |z0| <= |z| + m and |z0 + gy j| <= |z| + |gx| i. A shape is plain only if
 *     |gx| w + |gy| h <= Zs / 2                                                               (2)
 * and i < w, j < h, so m <= Zs / 2 - g. Snapping moves a corner by at most 1/512 pixel on an axis,
 * so a covered sample is that close to a point of the true triangle: |z| >= Zs - g / 512. Hence
 * 4 m <= 2 |z| - 3.9 g, and (1) is at most 5 u |z| - 3.9 u g. That leaves room for the rest. Plain
 * also asks for
 *     w h <= 128 |A|                                                                          (3)
 * The true extents are below 2.01 w and 2.01 h, so each product in A and in the numerators is
 * rounded by 3 e of at most 4.1 w h <= 525 |A| or (R = range of Z <= Zs) of at most 2.01 R h or
 * 2.01 R w. All of it moves the plane inside the box by less than 72 * 128 e Zs < 2^-39.8 Zs. If
 * m >= Zs / 4, then, as w, h <= 2^15, g >= 2^-17 Zs and 3.9 u g > 2^-39.1 Zs covers it, with the
 * terms of second order (2^-44 Zs) to spare; if m < Zs / 4, (1) is below 4.1 u |z| already. So
 * |stored - z| <= 5 u |z|. Zs within 2^-64 .. 2^64 keeps subnormals and infinities out. Last, plain
 * asks for
 *     g <= 16 R                                                                               (4)
 * or the triangle is a sliver, less than about 1/16 pixel high, that snapped coverage may leave by
 * a good part of its height.
 *
 * Careful is within u |z| of the plane clamped to the corners' range, but for the double set-up,
 * which under (3) stays below 2^-39 (|gx| w + |gy| h). Beyond (3) the plane itself means little and
 * the range is what counts. */
#ifndef SRC_PLANE_H
#define SRC_PLANE_H

#include "setup.h"

/* Far beyond any far plane, and far from overflow. */
#define SHB_DEPTH_CEILING 2.0

/* Planes with larger numbers are not usable. */
#define SHB_PLANE_MAX 0x1p100

typedef struct shb_plane {
    double z0, gx, gy; /* at the anchor, per column, per row */
    double lo, hi;     /* range of the corners */
    bool is_plain;
} shb_plane;

/* The plane of a drawn shape. */
shb_plane shb_plane_of(const shb_target *target, const shb_shape *shape);

/* Canonical depths of count samples of a row: the first one lies i columns and j rows from the
 * anchor. */
void shb_plane_depths(const shb_plane *plane, int32_t i, int32_t j, size_t count, float *depths);

#endif
