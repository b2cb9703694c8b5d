#include "strict.h"

#include "plane.h"

#include <math.h>

/* The centre of the anchor's pixel. */
static double anchor_x(const shb_shape *shape) {
    return shape->samples.first_column + 0.5;
}

static double anchor_y(const shb_shape *shape) {
    return shape->samples.first_row + 0.5;
}

/* Twice the area of the unsnapped triangle, y down. */
static double window_area(const shb_shape *shape) {
    return (shape->X[1] - shape->X[0]) * (shape->Y[2] - shape->Y[0]) -
           (shape->X[2] - shape->X[0]) * (shape->Y[1] - shape->Y[0]);
}

static void plane_of_whole(const shb_shape *shape, double area, shb_plane *plane) {
    const double dx1 = shape->X[1] - shape->X[0], dx2 = shape->X[2] - shape->X[0];
    const double dy1 = shape->Y[1] - shape->Y[0], dy2 = shape->Y[2] - shape->Y[0];
    const double dz1 = shape->Z[1] - shape->Z[0], dz2 = shape->Z[2] - shape->Z[0];
    plane->gx = (dz1 * dy2 - dz2 * dy1) / area;
    plane->gy = (dx1 * dz2 - dx2 * dz1) / area;
    plane->z0 = (shape->Z[0] + plane->gx * (anchor_x(shape) - shape->X[0])) +
                plane->gy * (anchor_y(shape) - shape->Y[0]);
}

/* The cross product of two corners' (x, y, w). */
static void cross_corners(const double p[4], const double q[4], double product[3]) {
    product[0] = p[1] * q[3] - p[3] * q[1];
    product[1] = p[3] * q[0] - p[0] * q[3];
    product[2] = p[0] * q[1] - p[1] * q[0];
}

/* Solves z = a x + b y + c w for the three corners: with n[k] the cross product of the two corners
 * after corner k, (a, b, c) = (z0 n0 + z1 n1 + z2 n2) / (corner 0 . n0). Divided by w it is depth:
 * Z = a (x / w) + b (y / w) + c, and x / w = X / half_width - 1, y / w = 1 - Y / half_height. */
static void plane_of_cut(const shb_target *target, const shb_shape *shape, shb_plane *plane) {
    double n[3][3], solution[3];
    for (int k = 0; k < 3; k++)
        cross_corners(shape->corners[(k + 1) % 3].v, shape->corners[(k + 2) % 3].v, n[k]);
    const double *p = shape->corners[0].v;
    const double determinant = (p[0] * n[0][0] + p[1] * n[0][1]) + p[3] * n[0][2];
    for (int i = 0; i < 3; i++)
        solution[i] = ((shape->corners[0].v[2] * n[0][i] + shape->corners[1].v[2] * n[1][i]) +
                       shape->corners[2].v[2] * n[2][i]) /
                      determinant;
    plane->gx = solution[0] / target->half_width;
    plane->gy = -solution[1] / target->half_height;
    plane->z0 = (solution[0] * (anchor_x(shape) / target->half_width - 1) +
                 solution[1] * (1 - anchor_y(shape) / target->half_height)) +
                solution[2];
}

static void find_range(const shb_shape *shape, shb_plane *plane) {
    plane->lo = plane->hi = shape->Z[0];
    for (size_t i = 1; i < shape->count; i++) {
        plane->lo = shape->Z[i] < plane->lo ? shape->Z[i] : plane->lo;
        plane->hi = shape->Z[i] > plane->hi ? shape->Z[i] : plane->hi;
    }
}

static bool is_usable(const shb_plane *plane) {
    return fabs(plane->gx) <= SHB_PLANE_MAX && fabs(plane->gy) <= SHB_PLANE_MAX &&
           fabs(plane->z0) <= SHB_PLANE_MAX;
}

/* A triangle that has an area only because it was snapped: its mean depth, everywhere. */
static void flatten(const shb_shape *shape, shb_plane *plane) {
    double sum = 0;
    for (size_t i = 0; i < shape->count; i++)
        sum += shape->Z[i];
    plane->gx = plane->gy = 0;
    plane->z0 = sum / (double)shape->count;
}

/* The conditions (2), (3) and (4). */
static bool can_be_plain(const shb_shape *shape, double area, const shb_plane *plane) {
    const double columns = shape->samples.last_column - shape->samples.first_column + 1;
    const double rows = shape->samples.last_row - shape->samples.first_row + 1;
    const double lo = fabs(plane->lo), hi = fabs(plane->hi);
    const double smallest = lo < hi ? lo : hi;
    const double gx = fabs(plane->gx), gy = fabs(plane->gy);
    return gx * columns + gy * rows <= 0.5 * smallest && columns * rows <= 128 * fabs(area) &&
           gx + gy <= 16 * (plane->hi - plane->lo) && smallest >= 0x1p-64 && smallest <= 0x1p64;
}

shb_plane shb_plane_of(const shb_target *target, const shb_shape *shape) {
    shb_plane plane;
    const double area = window_area(shape);
    if (shape->is_cut)
        plane_of_cut(target, shape, &plane);
    else
        plane_of_whole(shape, area, &plane);
    find_range(shape, &plane);
    const bool usable = is_usable(&plane);
    if (!usable)
        flatten(shape, &plane);
    plane.is_plain = usable && !shape->is_cut && can_be_plain(shape, area, &plane);
    plane.hi = plane.hi < SHB_DEPTH_CEILING ? plane.hi : SHB_DEPTH_CEILING;
    return plane;
}

static void depths_plain(const shb_plane *plane, int32_t i, int32_t j, size_t count,
                         float *restrict depths) {
    const float base = (float)plane->z0 + (float)plane->gy * (float)j, gx = (float)plane->gx;
    for (int32_t k = 0; k < (int32_t)count; k++)
        depths[k] = base + gx * (float)(i + k);
}

static void depths_careful(const shb_plane *plane, int32_t i, int32_t j, size_t count,
                           float *restrict depths) {
    const double base = plane->z0 + plane->gy * j, gx = plane->gx;
    const double lo = plane->lo, hi = plane->hi;
    for (int32_t k = 0; k < (int32_t)count; k++) {
        const double z = base + gx * (double)(i + k);
        const double above = z > lo ? z : lo;
        depths[k] = (float)(above < hi ? above : hi);
    }
}

void shb_plane_depths(const shb_plane *plane, int32_t i, int32_t j, size_t count, float *depths) {
    if (plane->is_plain)
        depths_plain(plane, i, j, count, depths);
    else
        depths_careful(plane, i, j, count, depths);
}
