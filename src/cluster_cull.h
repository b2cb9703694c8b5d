/* What a view can see of a cluster, from its box and the bounds of its normals alone.
 *
 * Nothing is left out that drawing triangle by triangle would draw, or count as not finite: bounds
 * hold for the rounded numbers that drawing computes. u = 2^-53.
 *
 * Clip space. A coordinate ((m0 x + m1 y) + m2 z) + m3 of a point of the box is rounded by at most
 * 4 u S, S = |m0| max|x| + |m1| max|y| + |m2| max|z| + |m3|; the box's image, found with as many
 * roundings again, is made larger by 2^-48 S. A sum of two such coordinates has the right sign, so
 * that a cluster whose box lies behind the near plane, or outside of a border of the target, holds
 * triangles alone that clipping finds there.
 *
 * Window space, for boxes before the eye: the image of a box is that of its corners. The window
 * coordinate X = half_width (x / w + 1) is computed with an error below half_width (E_x + r E_w) /
 * w + 2^-30, r the largest |x / w|, E the clip coordinates' errors. If that exceeds 2^-12 pixels
 * the cluster is only given to the kernels as it is. Snapping adds 2^-9: all in all a corner lies
 * within D = 2^-9 + 1.125 * 2^-12 pixels of where it should.
 *
 * Facing. The window area (doubled) of a triangle is A = -half_width half_height F / (w0 w1 w2), F
 * = N . e - e_w (N . P0), N the normal (its length is twice the area), P0 a corner, (e, e_w) the
 * null vector of the matrix's rows x, y and w: the eye. Let L be the longest edge, h the height
 * over it, |N| = h L, and g pixels a unit of the mesh. A corner that moves by D on both axes
 * changes A by D (|dx| + |dy|) <= sqrt2 D g L, dx and dy those of the edge opposite; three corners
 * by less than 4.25 D g L, and terms of second order by at most 8 D^2. So the snapped area has the
 * sign of A if, with |F| >= |N| c, h the least one of the cluster (h <= L) and w the largest,
 *
 *     h half_width half_height c / w^3 > 4.25 D g + 8 D^2 / h                               (1)
 *
 * c: with v = e - e_w P and |v_i| >= |v_j| >= |v_k|, v is a sum of three directions with its signs,
 *     (|v_i| - |v_j|) (one in i) + (|v_j| - |v_k|) (one in i and j) + |v_k| (one in all),
 * and n . v is no more than the sum of the largest products of normals with these. From the centre
 * of the cluster's box to P, v changes by at most |e_w| R, R half the diagonal, and n . v by no
 * more. Sums are right to 2^-17 |v|, and e and e_w to 2^-50 of the sum of sizes of their products.
 *
 * Depth. Let the corners' depths, as computed, lie in lo .. hi. Careful samples do, too (plane.h).
 * A plain one is within 5 * 2^-24 |z| of the depth z of the triangle's plane at a place at most
 * 1/512 pixel outside of the triangle on either axis, and the plane's slope is at most 16 (hi - lo)
 * a pixel there: no sample is nearer than lo - (hi - lo) / 32 - 2^-21 (|lo| + |hi|), which leaves
 * room for rounding this number to float. */
#ifndef SRC_CLUSTER_CULL_H
#define SRC_CLUSTER_CULL_H

#include "clusters.h"

/* An instance as its clusters are looked at. */
typedef struct shb_cluster_view {
    const shb_target *target;
    double rows[4][4];                        /* of the matrix: x, y, canonical z, w */
    double columns[4][4], column_sizes[4][4]; /* the same, and the sizes of all numbers */
    double planes[5][4]; /* a point with a negative product lies outside: near plane, borders */
    bool affine;         /* w is 1 */
    double steep_x, steep_y, steep_w; /* lengths of the rows' first three */
    double facing; /* 1: positive areas are dropped, -1: negative ones, 0: none */
    double eye[4], eye_doubt[4];
} shb_cluster_view;

typedef enum shb_cluster_fate {
    SHB_CLUSTER_DROPPED, /* every triangle is finite and culled */
    SHB_CLUSTER_PLAIN,   /* every vertex is usable */
    SHB_CLUSTER_DOUBTFUL
} shb_cluster_fate;

shb_cluster_view shb_cluster_view_of(const shb_draw_instance *instance, const shb_target *target);

/* Fills in the samples, the nearest depth and the origin of a cluster that is not dropped. */
shb_cluster_fate shb_cluster_look(const shb_cluster_view *view, const shb_cluster *cluster,
                                  shb_seen_cluster *seen);

#endif
