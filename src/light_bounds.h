/* What the bounds of light_point.h need of a map, in floats, for whole vectors of fragments.
 *
 * Let |v| be the sum of the absolute values of v, and x, y, z, w the first three elements of the
 * rows of X, Y, Z and w, X and Y counted from the map's middle. Divided by
 *     s_x = |x| + |w| width / 2,  s_y = |y| + |w| height / 2,  s_z = |z| + |w|
 * and w by |w|, they are unit rows, whatever the units of the scene are, and
 *     A / s_x = unit_x - xi unit_w,  B / s_y = unit_y - eta unit_w,  C / s_z = unit_z - zeta unit_w
 * with xi = X |w| / s_x, eta = Y |w| / s_y, zeta = Z |w| / s_z. Where |w| is 0, unit_w and these
 * three are 0, and 1 takes its place as a divisor. */
#ifndef SRC_LIGHT_BOUNDS_H
#define SRC_LIGHT_BOUNDS_H

struct shb_light_rows;

typedef struct shb_light_bounds {
    float x[3], y[3], z[3], w[3]; /* absolute values of the unit rows' elements */
    float size_x, size_y, size_z; /* their sums */
    float way[4];                 /* unit_w and the last element of w, divided alike */
    float to_xi, to_eta, to_zeta; /* factors of X, Y, Z */
    float middle_x, middle_y;     /* of the map, texels */
    float unit_x, unit_y, unit_z; /* s_x, s_y, s_z by the divisor of w */
    float slope_x, slope_y;       /* s_z / s_x, s_z / s_y */
    float turns;                  /* 1, or 0 where |w| is 0 */
    float x_cross_y[3], x_cross_w[3], y_cross_w[3]; /* of the unit rows */
    float z_cross_y[3], z_cross_w[3], x_cross_z[3];
} shb_light_bounds;

shb_light_bounds shb_light_bounds_of(const struct shb_light_rows *rows, double width,
                                     double height);

#endif
