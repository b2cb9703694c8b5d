/* What the taps of a filter compare a map with, in every planar map.
 *
 * A tap is the texel m columns to the right of and n rows below the fragment's own one. The plane
 * of a fragment stays a plane in the map, so the depth where the light's ray through a tap's centre
 * meets it grows by step_x and step_y from texel to texel: the delta bias of Ehm et al. 2015, eq. 2
 * and alg. 1. The naive way, which they started from, cuts every ray with the plane in the world;
 * both are the same but for rounding. */
#ifndef SRC_TAPS_H
#define SRC_TAPS_H

#include "light_point.h"

/* Texels in a row of the largest box. */
#define SHB_BOX_MAX 63

/* Texels in a row of a box of this size, texels. */
static inline int32_t shb_box_size(float size, float least) {
    const float some = size > least ? size : least;
    return (int32_t)((some < SHB_BOX_MAX ? some : SHB_BOX_MAX) + 0.5f);
}

/* SHB_TAPS_PLANE, and SHB_TAPS_OWN with steps of 0. Evaluated in this order everywhere. */
static inline float shb_tap_depth(float ref, float step_x, float step_y, float m, float n) {
    return (ref + m * step_x) + n * step_y;
}

/* The depth of the plane through a point of the world at the place (x, y) of the map, texels. The
 * light's ray there is where the planes a.P + a3 = 0 and b.P + b3 = 0 meet, whose elements are
 * those of (row x - x row w) and (row y - y row w). From the point P, off these by a.P + a3 and
 * b.P + b3, the vector to the ray that stays in the plane is
 *     -((a.P + a3) (b x n) + (b.P + b3) (n x a)) / n.(a x b) */
static inline double shb_tap_occluder(const shb_light_rows *rows, const double point[3],
                                      const double normal[3], double x, double y) {
    double a[4], b[4], bn[3], na[3], met[3];
    for (int i = 0; i < 4; i++) {
        a[i] = rows->x[i] - x * rows->w[i];
        b[i] = rows->y[i] - y * rows->w[i];
    }
    shb_cross(b, normal, bn);
    shb_cross(normal, a, na);
    const double inverse = 1 / shb_dot(a, bn);
    const double off_a = (shb_dot(a, point) + a[3]) * inverse;
    const double off_b = (shb_dot(b, point) + b[3]) * inverse;
    for (int i = 0; i < 3; i++)
        met[i] = point[i] - (off_a * bn[i] + off_b * na[i]);
    return (shb_dot(rows->z, met) + rows->z[3]) / (shb_dot(rows->w, met) + rows->w[3]);
}

/* SHB_TAPS_NAIVE: a fragment of a batch that holds normals. */
typedef struct shb_tap_surface {
    double point[3], normal[3];
    double own_x, own_y; /* centre of the own texel */
    double epsilon;      /* of the method: from the plane to ref there */
} shb_tap_surface;

static inline shb_tap_surface shb_tap_surface_of(const shb_light_rows *rows,
                                                 const shb_receivers *receivers, size_t i) {
    shb_tap_surface surface = {
        .point = {(double)receivers->x[i], (double)receivers->y[i], (double)receivers->z[i]},
        .normal = {(double)receivers->normal_x[i], (double)receivers->normal_y[i],
                   (double)receivers->normal_z[i]},
        .own_x = receivers->texel_x[i] + 0.5,
        .own_y = receivers->texel_y[i] + 0.5,
    };
    const double own =
        shb_tap_occluder(rows, surface.point, surface.normal, surface.own_x, surface.own_y);
    surface.epsilon = own - (double)receivers->ref[i];
    return surface;
}

static inline float shb_tap_naive(const shb_light_rows *rows, const shb_tap_surface *surface, int m,
                                  int n) {
    const double x = surface->own_x + m, y = surface->own_y + n;
    return (float)(shb_tap_occluder(rows, surface->point, surface->normal, x, y) -
                   surface->epsilon);
}

#endif
