/* Triangles of a map that keeps planes: the slopes of its plane are drawn where a triangle's id
 * would be, and depths that are never in front of the true plane. Let u = 2^-24 and e = 2^-53.
 *
 * Which plane. The rasterizer's own one, through the window corners, where corners that are off by
 * (dX, dY, dZ) leave it good: it misses true corner k by at most d = dZ + |gx| dX + |gy| dY, and a
 * point of true weights b_k by no more than (sum |b_k|) d. Points up to a texel beyond the corners'
 * box, and the corners, lie within W by H of each other, three more than the box of samples has. So
 * with twice the area A no weight but the first is larger than 2 k, k = W H / |A|, and sum |b_k| is
 * at most 1 + 8 k. The true area is |A| - 8 (H dX + W dY + e W H) at least, which has to be half of
 * |A|. With R the range of the corners' depths, rounding of the slopes costs 16 e k R + 8 e k m
 * within W by H, m = |gx| W + |gy| H, and as (1 + 8 k) (dX / W + dY / H) < 2, less than three times
 * as much where they multiply dX and dY:
 *     (1 + 8 k) d + 64 e k (R + m)                                                              (1)
 * Where that is more than 2^-30 of the depths, the rasterizer is told the plane of the triangle by
 * its corners in the world, (z + gx X) + gy Y with X and Y in pixels of the target, how far it may
 * lie in front of the true one, and 8 e ((|z| + |gx X|) + |gy Y|) more for rounding at the anchor.
 *
 * Anchored at the first sample of the box a plane is z0 + gx i + gy j, and with m = |gx| i + |gy| j
 * <= M in the box the double arithmetic costs less than
 *     8 e (|z0| + M)                                                                           (2)
 *
 * A plane whose numbers are small beside its depths is plain: in float, the anchor A = (float)z0
 * and the rest r = (float)(z0 - A) apart, A + ((r + (float)gy * j) + (float)gx * i). Slopes and
 * products are rounded by 2 u m, the inner sums by u |gy| j and u m, r and what it adds to them by
 * u^2 |z0| each. The outer sum, as what careful rounds to a float, is off by half a unit in the
 * last place. A covered sample is within 1/512 pixel of the triangle: its depth is at most D, the
 * largest size of a corner's depth + |gx| + |gy|. With P the power of two at or below D, all is
 *     u P, for plain ones 4 u M more                                                           (3)
 * (from beyond 2 P more may be rounded off, but not below 2 P, where no true depth is). Below
 * 2^-126 floats have steps of 2^-149 throughout, and with slopes times less than 2^14 samples all
 * is less than 2^-134 there.
 *
 * The plane is raised by the bound of its choice, (2) and (3), and 2^-10 of that for terms of
 * second order. So what is drawn lies behind the plane that was chosen by no more than twice that:
 * a unit in the last place, and half of one more where a plane is plain, since then 16 M is below
 * all depths. Careful depths are not brought down to the corners' range, only up to it: no triangle
 * is drawn in front of its corners. */
#ifndef SRC_DRAWN_PLANE_H
#define SRC_DRAWN_PLANE_H

#include "plane.h"
#include "scene.h"

#include <math.h>
#include <string.h>

/* The plane depth = z + slope_x * X + slope_y * Y of a triangle, X and Y in texels, and how far it
 * may lie in front of the true one near the triangle, up to a texel beyond its box: infinite for
 * one that is not to be used. */
typedef struct shb_occluder_plane {
    double z, slope_x, slope_y, error;
} shb_occluder_plane;

/* The same plane in the world: normal . P + offset is how far P lies behind it as the light sees
 * it, in units of what the plane's own numbers may be off by near the triangle. offset is NaN where
 * the plane is not to be used. */
typedef struct shb_world_plane {
    double normal[3], offset;
} shb_world_plane;

/* Planes are found for up to so many triangles at a time, in vectors that are no wider than
 * SHB_PLANE_VECTOR. */
#define SHB_PLANE_LANES 128
#define SHB_PLANE_VECTOR 16

/* Corners of triangles in their mesh: corner, axis. */
typedef struct shb_plane_corners {
    SHB_ALIGN float at[3][3][SHB_PLANE_LANES];
} shb_plane_corners;

/* The numbers of their planes. */
typedef struct shb_found_planes {
    SHB_ALIGN double z[SHB_PLANE_LANES];
    double slope_x[SHB_PLANE_LANES], slope_y[SHB_PLANE_LANES], error[SHB_PLANE_LANES];
} shb_found_planes;

typedef struct shb_found_world_planes {
    SHB_ALIGN double normal[3][SHB_PLANE_LANES];
    double offset[SHB_PLANE_LANES];
} shb_found_world_planes;

/* What tells the rasterizer the planes of an instance's triangles. */
typedef struct shb_plane_finder {
    void (*find)(const struct shb_plane_finder *finder, const struct shb_draw_instance *instance,
                 size_t count, shb_plane_corners *corners, shb_found_planes *planes);
    double slope_unit; /* of the slopes that are drawn, a power of two */
} shb_plane_finder;

/* The corners of the mesh's triangle. */
static inline void shb_plane_corners_set(shb_plane_corners *corners, size_t lane,
                                         const shb_mesh *mesh, uint32_t triangle) {
    uint32_t vertices[3];
    shb_mesh_triangle(mesh, triangle, vertices);
    for (int k = 0; k < 3; k++)
        for (int axis = 0; axis < 3; axis++)
            corners->at[k][axis][lane] = shb_mesh_position(mesh, vertices[k])[axis];
}

/* The one at or below a number that is neither negative nor subnormal. */
static inline double shb_power_of_two(double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    bits &= 0x7ff0000000000000u;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* The bound (1) of a triangle whose corners have twice this area in the window and these depths at
 * least and at most; infinite where the plane is not good enough. */
static inline double shb_plane_bound(const shb_corner_errors *off, double area, double lo,
                                     double hi, int32_t width, int32_t height, double gx,
                                     double gy) {
    const double e = 0x1p-53, largest = fabs(lo) > fabs(hi) ? fabs(lo) : fabs(hi);
    const double w = width + 3, h = height + 3, steep_x = fabs(gx), steep_y = fabs(gy);
    const double left = fabs(area) - 8 * ((h * off->x + w * off->y) + e * (w * h));
    const double k = w * h / left;
    const double moved = (off->z + off->z_part * largest) + (steep_x * off->x + steep_y * off->y);
    const double across = (hi - lo) + (steep_x * w + steep_y * h);
    const double bound = ((1 + 8 * k) * moved + 64 * e * k * across) * (1 + 0x1p-10);
    double good = bound <= 0x1p-30 * largest ? bound : HUGE_VAL;
    good = largest <= 0x1p64 ? good : HUGE_VAL;
    good = 2 * left >= fabs(area) ? good : HUGE_VAL;
    return k <= 0x1p24 ? good : HUGE_VAL;
}

/* Takes lane i of the planes found for a triangle whose first sample this is. Returns its bound. */
static inline double shb_plane_take(const shb_found_planes *found, size_t i, int32_t x, int32_t y,
                                    shb_plane *plane) {
    const double along = found->slope_x[i] * (x + 0.5), above = found->slope_y[i] * (y + 0.5);
    plane->z0 = (found->z[i] + along) + above;
    plane->gx = found->slope_x[i];
    plane->gy = found->slope_y[i];
    return found->error[i] + 8 * 0x1p-53 * ((fabs(found->z[i]) + fabs(along)) + fabs(above));
}

/* Makes a plane with this bound, of a triangle with a box of so many samples, what is to be drawn
 * of it. */
static inline void shb_plane_raise(double bound, int32_t width, int32_t height, shb_plane *plane) {
    const double u = 0x1p-24, e = 0x1p-53;
    const double lo = fabs(plane->lo), hi = fabs(plane->hi);
    const double largest = lo > hi ? lo : hi, smallest = lo < hi ? lo : hi;
    const double steep_x = fabs(plane->gx), steep_y = fabs(plane->gy);
    const double across = steep_x * (width - 1) + steep_y * (height - 1);
    plane->is_plain = plane->is_plain && 16 * across < smallest;
    const double power = shb_power_of_two(largest + (steep_x + steep_y));
    const double floats = u * (power + (plane->is_plain ? 4 * across : 0));
    const double doubles = 8 * e * (fabs(plane->z0) + across);
    plane->z0 += (bound + (floats + doubles)) * (1 + 0x1p-10) + 0x1p-134;
    plane->hi = SHB_DEPTH_CEILING;
}

/* Depths of count samples of a row of such a plane, from i columns and j rows from its anchor on.
 */
static inline void shb_plane_raised_depths(const shb_plane *plane, int32_t i, int32_t j,
                                           size_t count, float *restrict depths) {
    const float anchor = (float)plane->z0, rest = (float)(plane->z0 - (double)anchor);
    const float base = rest + (float)plane->gy * (float)j, gx = (float)plane->gx;
    if (!plane->is_plain)
        shb_plane_depths(plane, i, j, count, depths);
    else
        for (int32_t k = 0; k < (int32_t)count; k++)
            depths[k] = anchor + (base + gx * (float)(i + k));
}

#endif
