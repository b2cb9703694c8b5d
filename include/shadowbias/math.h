/* Double-precision matrices and vectors: what describes cameras, lights and instances. */
#ifndef SHADOWBIAS_MATH_H
#define SHADOWBIAS_MATH_H

#include "shadowbias/base.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct shb_vec3 {
    double x, y, z;
} shb_vec3;

/* Column-major: m[4 * column + row]. In descriptions, all zeros stands for the identity. */
typedef struct shb_mat4 {
    double m[16];
} shb_mat4;

/* An axis-aligned box in world units; empty when any lo is greater than its hi. */
typedef struct shb_box {
    shb_vec3 lo, hi;
} shb_box;

shb_mat4 shb_mat4_identity(void);

/* a * b: b acts first. */
shb_mat4 shb_mat4_multiply(shb_mat4 a, shb_mat4 b);

shb_mat4 shb_mat4_translation(double x, double y, double z);
shb_mat4 shb_mat4_scaling(double x, double y, double z);

/* Right-handed rotation by an angle in radians about an axis of any length but 0. */
shb_mat4 shb_mat4_rotation(shb_vec3 axis, double angle);

/* World to eye space: the eye looks along -z, y up, at a target that is elsewhere. If up is zero or
 * parallel to the way there, the coordinate axis least parallel to it takes its place. */
shb_mat4 shb_mat4_look_at(shb_vec3 eye, shb_vec3 target, shb_vec3 up);

/* Eye to clip space. vertical_angle in radians, in (0, pi); aspect is width / height; distances in
 * world units with 0 < near < far; far may be INFINITY. reversed maps near to depth 1, far to 0. */
shb_mat4 shb_mat4_perspective(double vertical_angle, double aspect, double near_distance,
                              double far_distance, bool reversed);

/* Eye to clip space for a box of half sizes above 0, in world units; near < far, both finite. */
shb_mat4 shb_mat4_orthographic(double half_width, double half_height, double near_distance,
                               double far_distance, bool reversed);

/* The inverse; SHB_ERROR_NUMBER if a is singular or not finite, SHB_ERROR_ARGUMENT for NULL. */
shb_result shb_mat4_inverse(shb_mat4 a, shb_mat4 *inverse);

shb_vec3 shb_vec3_add(shb_vec3 a, shb_vec3 b);
shb_vec3 shb_vec3_subtract(shb_vec3 a, shb_vec3 b);
shb_vec3 shb_vec3_scale(shb_vec3 a, double s);
double shb_vec3_dot(shb_vec3 a, shb_vec3 b);
shb_vec3 shb_vec3_cross(shb_vec3 a, shb_vec3 b);
double shb_vec3_length(shb_vec3 a);

/* a / |a|; the zero vector stays zero. */
shb_vec3 shb_vec3_normalize(shb_vec3 a);

/* The point a * (p, 1), not divided by its w: for transforms whose last row is 0 0 0 1. */
shb_vec3 shb_mat4_transform_point(shb_mat4 a, shb_vec3 p);

#ifdef __cplusplus
}
#endif

#endif
