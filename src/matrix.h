/* What matrices, views and lights have in common. */
#ifndef SRC_MATRIX_H
#define SRC_MATRIX_H

#include "shadowbias/math.h"

/* By basic operations only: the C library's differ in the last place from system to system, and a
 * matrix or a light's point must not. */
void shb_sine_cosine(double angle, double *sine, double *cosine);

/* The cofactors of row 0 .. 3, a vector at right angles to the other three rows. Returns its dot
 * product with the row itself, the determinant; both times one and the same power of two, which
 * keeps them in range. Each is exactly 0 where rounding cannot tell it from 0, whatever the units
 * of rows and columns. */
double shb_mat4_cofactors(const shb_mat4 *a, int row, double cofactors[4]);

void shb_mat4_row(const shb_mat4 *a, int row, double elements[4]);

bool shb_mat4_is_finite(const shb_mat4 *a);

/* World to eye space for a direction of view of any length but 0. */
shb_mat4 shb_mat4_look_along(shb_vec3 eye, shb_vec3 direction, shb_vec3 up);

/* shb_mat4_perspective by the half sizes of the frustum at distance 1. */
shb_mat4 shb_mat4_frustum(double half_width, double half_height, double near_distance,
                          double far_distance, bool reversed);

#endif
