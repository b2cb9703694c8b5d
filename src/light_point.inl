/* The arithmetic of light_point.h for REAL, a double or a vector of them; the including file has
 * defined the operations on it, and REAL_NAME, which makes a name of its own of each name here. */

typedef struct REAL_NAME(light_point) {
    REAL x, y, z, w;
    REAL a[3], b[3], c[3];
    REAL by_position[3];            /* u |P_i| / w' */
    REAL error_x, error_y, error_z; /* by the calculation, (2) */
} REAL_NAME(light_point);

typedef struct REAL_NAME(light_slopes) {
    REAL x, y;             /* depth per texel */
    REAL error_x, error_y; /* infinite where the plane may be parallel to the light's ray */
} REAL_NAME(light_slopes);

#define REAL_INLINE static inline __attribute__((always_inline))
#define DOT_ABS(a, b)                                                                              \
    ((REAL_ABS((a)[0] * (b)[0]) + REAL_ABS((a)[1] * (b)[1])) + REAL_ABS((a)[2] * (b)[2]))

REAL_INLINE REAL REAL_NAME(dot_abs)(const REAL *a, const REAL *b) {
    return DOT_ABS(a, b);
}

REAL_INLINE REAL REAL_NAME(sum_abs)(const REAL *a) {
    return (REAL_ABS(a[0]) + REAL_ABS(a[1])) + REAL_ABS(a[2]);
}

REAL_INLINE void REAL_NAME(cross)(const REAL *a, const REAL *b, REAL *product) {
    product[0] = a[1] * b[2] - a[2] * b[1];
    product[1] = a[2] * b[0] - a[0] * b[2];
    product[2] = a[0] * b[1] - a[1] * b[0];
}

/* Of a point whose w is known. rounding: of the position's elements, relative; 0 for an exact
 * position. The numbers mean nothing where w is not positive. */
REAL_INLINE REAL_NAME(light_point)
    REAL_NAME(light_point_with)(const shb_light_rows *rows, const REAL p[3], double rounding,
                                REAL w, REAL inverse_w) {
    REAL_NAME(light_point) point;
    const REAL zero = REAL_SPLAT(0.0);
    const REAL size_w = DOT_ABS(rows->w, p);
    const REAL noise = 8 * SHB_DOUBLE_ROUNDING * inverse_w;
    const REAL noise_w = size_w + fabs(rows->w[3]);
    const REAL moved_w = rounding * size_w;
    const REAL by_position = rounding * ((1 + 0x1p-10) + 2.0 * moved_w * inverse_w) /
                             REAL_WHERE_GREATER(w, moved_w, w - moved_w, zero);
    point.w = w;
    point.x = (SHB_DOT(rows->x, p) + rows->x[3]) * inverse_w;
    point.y = (SHB_DOT(rows->y, p) + rows->y[3]) * inverse_w;
    point.z = (SHB_DOT(rows->z, p) + rows->z[3]) * inverse_w;
    for (int i = 0; i < 3; i++) {
        point.a[i] = rows->x[i] - point.x * rows->w[i];
        point.b[i] = rows->y[i] - point.y * rows->w[i];
        point.c[i] = rows->z[i] - point.z * rows->w[i];
        point.by_position[i] = by_position * REAL_ABS(p[i]);
    }
    point.error_x = noise * (DOT_ABS(rows->x, p) + fabs(rows->x[3]) + REAL_ABS(point.x) * noise_w);
    point.error_y = noise * (DOT_ABS(rows->y, p) + fabs(rows->y[3]) + REAL_ABS(point.y) * noise_w);
    point.error_z = noise * (DOT_ABS(rows->z, p) + fabs(rows->z[3]) + REAL_ABS(point.z) * noise_w);
    return point;
}

REAL_INLINE REAL_NAME(light_point)
    REAL_NAME(light_point_at)(const shb_light_rows *rows, const REAL p[3], double rounding) {
    const REAL w = SHB_DOT(rows->w, p) + rows->w[3];
    return REAL_NAME(light_point_with)(rows, p, rounding, w, 1.0 / w);
}

/* How far the true point may lie from a plane of these exact slopes that holds the calculated one,
 * in depth: (1) and (2). */
REAL_INLINE REAL REAL_NAME(light_point_error)(const REAL_NAME(light_point) * point, REAL slope_x,
                                              REAL slope_y) {
    REAL sum = REAL_SPLAT(0.0);
    for (int i = 0; i < 3; i++)
        sum += REAL_ABS(point->c[i] - slope_x * point->a[i] - slope_y * point->b[i]) *
               point->by_position[i];
    return sum + (point->error_z + REAL_ABS(slope_x) * point->error_x +
                  REAL_ABS(slope_y) * point->error_y);
}

/* (3); what A, B and C are off by comes from the point's place and from rounding. */
REAL_INLINE REAL_NAME(light_slopes)
    REAL_NAME(light_slopes_of)(const shb_light_rows *rows, const REAL_NAME(light_point) * point,
                               const REAL n[3], const REAL dn[3]) {
    const REAL *a = point->a, *b = point->b, *c = point->c;
    const REAL zero = REAL_SPLAT(0.0);
    REAL ab[3], cb[3], ac[3], bn[3], na[3], nc[3], da[3], db[3], dc[3];
    REAL_NAME(cross)(a, b, ab);
    REAL_NAME(cross)(c, b, cb);
    REAL_NAME(cross)(a, c, ac);
    REAL_NAME(cross)(b, n, bn);
    REAL_NAME(cross)(n, a, na);
    REAL_NAME(cross)(n, c, nc);
    const REAL moved_x = DOT_ABS(a, point->by_position) + point->error_x;
    const REAL moved_y = DOT_ABS(b, point->by_position) + point->error_y;
    const REAL moved_z = DOT_ABS(c, point->by_position) + point->error_z;
    const double e = 4 * SHB_DOUBLE_ROUNDING;
    for (int i = 0; i < 3; i++) {
        const double w = fabs(rows->w[i]);
        da[i] = moved_x * w + e * (fabs(rows->x[i]) + REAL_ABS(point->x) * w);
        db[i] = moved_y * w + e * (fabs(rows->y[i]) + REAL_ABS(point->y) * w);
        dc[i] = moved_z * w + e * (fabs(rows->z[i]) + REAL_ABS(point->z) * w);
    }
    const REAL size_a = REAL_NAME(sum_abs)(a), size_b = REAL_NAME(sum_abs)(b);
    const REAL size_c = REAL_NAME(sum_abs)(c);
    const REAL noise = 4 * e * REAL_NAME(sum_abs)(n);
    const REAL d = SHB_DOT(a, bn);
    const REAL d_off =
        DOT_ABS(dn, ab) + DOT_ABS(da, bn) + DOT_ABS(db, na) + noise * size_a * size_b;
    const REAL x_off =
        DOT_ABS(dn, cb) + DOT_ABS(dc, bn) + DOT_ABS(db, nc) + noise * size_c * size_b;
    const REAL y_off =
        DOT_ABS(dn, ac) + DOT_ABS(da, nc) + DOT_ABS(dc, na) + noise * size_a * size_c;
    const REAL left = REAL_ABS(d) - 2.0 * d_off;
    const REAL scale = 1.0 / REAL_WHERE_GREATER(left, zero, left, zero);
    REAL_NAME(light_slopes) slopes;
    slopes.x = SHB_DOT(c, bn) / d;
    slopes.y = SHB_DOT(c, na) / d;
    slopes.error_x = (x_off + REAL_ABS(slopes.x) * d_off) * scale;
    slopes.error_y = (y_off + REAL_ABS(slopes.y) * d_off) * scale;
    return slopes;
}

#undef DOT_ABS
