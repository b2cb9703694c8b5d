/* Points and planes as a light's map sees them, in double, each with a bound of its error.
 *
 * Map coordinates are X, Y in texels from the top left corner and canonical depth Z. With rows T of
 * four numbers, X = Tx(P) / w, Y = Ty(P) / w, Z = Tz(P) / w, w = Tw(P). If P moves by v, X moves by
 * A.v / w' exactly, where A = Tx - X Tw (first three elements) and w' belongs to the moved point;
 * likewise Y by B.v / w' and Z by C.v / w'.
 *
 * Error of a point. Let u = 2^-24, e = 2^-53. The rows count as exact. A fragment's position is the
 * true point P rounded to float, so |v_i| <= u |P_i|. A plane Z = gx X + gy Y + k that holds the
 * true point is therefore missed by the rounded one by no more than
 *     sum_i |C_i - gx A_i - gy B_i| u |P_i| / w'                                              (1)
 * The vectors are calculated at the rounded point instead of the true one, which changes them by
 * (u |P| |Tw| / w) of the same movement: of second order, covered by the factor 1 + 2^-10 + 2 Ew /
 * w with Ew = u sum |Tw_i P_i|, and w' >= w - Ew. Calculating X takes four products, four sums and
 * a division, whose inputs are rounded rows: less than 8 e (sum |Tx_i P_i| + |Tx_3| + |X| (sum
 * |Tw_i P_i| + |Tw_3|)) / w, and so on         (2)
 *
 * Slopes of the plane through a point with normal n: gx = n.(C x B) / n.(A x B), gy = n.(A x C) /
 * n.(A x B). If the elements of n, A, B and C are off by dn, da, db and dc, the numerator N and the
 * denominator D are off by
 *     dD = dn.|A x B| + da.|B x n| + db.|n x A| + 16 e |A| |B| |n|                             (3)
 * and the like, and N / D by no more than (dN + |N / D| dD) / (|D| - dD); the products of two
 * errors are covered by taking 2 dD from |D|. Plain sums of absolute values stand for lengths. */
#ifndef SRC_LIGHT_POINT_H
#define SRC_LIGHT_POINT_H

#include "map.h"

#include <math.h>

#define SHB_FLOAT_ROUNDING 0x1p-24
#define SHB_DOUBLE_ROUNDING 0x1p-53

typedef struct shb_light_point {
    double x, y, z, w;
    double a[3], b[3], c[3];
    double by_position[3];            /* u |P_i| / w' */
    double error_x, error_y, error_z; /* by the calculation, (2) */
} shb_light_point;

typedef struct shb_light_slopes {
    double x, y;             /* depth per texel */
    double error_x, error_y; /* infinite where the plane may be parallel to the light's ray */
} shb_light_slopes;

static inline double shb_dot(const double *a, const double *b) {
    return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

static inline double shb_dot_abs(const double *a, const double *b) {
    return (fabs(a[0] * b[0]) + fabs(a[1] * b[1])) + fabs(a[2] * b[2]);
}

static inline double shb_sum_abs(const double *a) {
    return (fabs(a[0]) + fabs(a[1])) + fabs(a[2]);
}

static inline void shb_cross(const double *a, const double *b, double *product) {
    product[0] = a[1] * b[2] - a[2] * b[1];
    product[1] = a[2] * b[0] - a[0] * b[2];
    product[2] = a[0] * b[1] - a[1] * b[0];
}

/* rounding: of the position's elements, relative; 0 for an exact position. The numbers mean nothing
 * where w is not positive. */
static inline shb_light_point shb_light_point_at(const shb_light_rows *rows, const double p[3],
                                                 double rounding) {
    shb_light_point point;
    const double w = shb_dot(rows->w, p) + rows->w[3];
    const double inverse_w = 1 / w;
    const double size_w = shb_dot_abs(rows->w, p);
    const double noise = 8 * SHB_DOUBLE_ROUNDING * inverse_w;
    const double noise_w = size_w + fabs(rows->w[3]);
    const double moved_w = rounding * size_w;
    const double by_position =
        rounding * (1 + 0x1p-10 + 2 * moved_w * inverse_w) / (w > moved_w ? w - moved_w : 0);
    point.w = w;
    point.x = (shb_dot(rows->x, p) + rows->x[3]) * inverse_w;
    point.y = (shb_dot(rows->y, p) + rows->y[3]) * inverse_w;
    point.z = (shb_dot(rows->z, p) + rows->z[3]) * inverse_w;
    for (int i = 0; i < 3; i++) {
        point.a[i] = rows->x[i] - point.x * rows->w[i];
        point.b[i] = rows->y[i] - point.y * rows->w[i];
        point.c[i] = rows->z[i] - point.z * rows->w[i];
        point.by_position[i] = by_position * fabs(p[i]);
    }
    point.error_x = noise * (shb_dot_abs(rows->x, p) + fabs(rows->x[3]) + fabs(point.x) * noise_w);
    point.error_y = noise * (shb_dot_abs(rows->y, p) + fabs(rows->y[3]) + fabs(point.y) * noise_w);
    point.error_z = noise * (shb_dot_abs(rows->z, p) + fabs(rows->z[3]) + fabs(point.z) * noise_w);
    return point;
}

/* How far the true point may lie from a plane of these exact slopes that holds the calculated one,
 * in depth: (1) and (2). */
static inline double shb_light_point_error(const shb_light_point *point, double slope_x,
                                           double slope_y) {
    double sum = 0;
    for (int i = 0; i < 3; i++)
        sum += fabs(point->c[i] - slope_x * point->a[i] - slope_y * point->b[i]) *
               point->by_position[i];
    return sum + (point->error_z + fabs(slope_x) * point->error_x + fabs(slope_y) * point->error_y);
}

/* (3); what A, B and C are off by comes from the point's place and from rounding. */
static inline shb_light_slopes shb_light_slopes_of(const shb_light_rows *rows,
                                                   const shb_light_point *point, const double n[3],
                                                   const double dn[3]) {
    const double *a = point->a, *b = point->b, *c = point->c;
    double ab[3], cb[3], ac[3], bn[3], na[3], nc[3], da[3], db[3], dc[3];
    shb_cross(a, b, ab);
    shb_cross(c, b, cb);
    shb_cross(a, c, ac);
    shb_cross(b, n, bn);
    shb_cross(n, a, na);
    shb_cross(n, c, nc);
    const double moved_x = shb_dot_abs(a, point->by_position) + point->error_x;
    const double moved_y = shb_dot_abs(b, point->by_position) + point->error_y;
    const double moved_z = shb_dot_abs(c, point->by_position) + point->error_z;
    const double e = 4 * SHB_DOUBLE_ROUNDING;
    for (int i = 0; i < 3; i++) {
        const double w = fabs(rows->w[i]);
        da[i] = moved_x * w + e * (fabs(rows->x[i]) + fabs(point->x) * w);
        db[i] = moved_y * w + e * (fabs(rows->y[i]) + fabs(point->y) * w);
        dc[i] = moved_z * w + e * (fabs(rows->z[i]) + fabs(point->z) * w);
    }
    const double size_a = shb_sum_abs(a), size_b = shb_sum_abs(b), size_c = shb_sum_abs(c);
    const double noise = 4 * e * shb_sum_abs(n);
    const double d = shb_dot(a, bn);
    const double d_off =
        shb_dot_abs(dn, ab) + shb_dot_abs(da, bn) + shb_dot_abs(db, na) + noise * size_a * size_b;
    const double x_off =
        shb_dot_abs(dn, cb) + shb_dot_abs(dc, bn) + shb_dot_abs(db, nc) + noise * size_c * size_b;
    const double y_off =
        shb_dot_abs(dn, ac) + shb_dot_abs(da, nc) + shb_dot_abs(dc, na) + noise * size_a * size_c;
    const double left = fabs(d) - 2 * d_off;
    const double scale = 1 / (left > 0 ? left : 0);
    shb_light_slopes slopes = {shb_dot(c, bn) / d, shb_dot(c, na) / d, 0, 0};
    slopes.error_x = (x_off + fabs(slopes.x) * d_off) * scale;
    slopes.error_y = (y_off + fabs(slopes.y) * d_off) * scale;
    return slopes;
}

#endif
