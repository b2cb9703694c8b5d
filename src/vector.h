/* Vectors and boxes, for where calls of the public functions would cost more than the work. */
#ifndef SRC_VECTOR_H
#define SRC_VECTOR_H

#include <math.h>

#include "shadowbias/math.h"

static inline shb_vec3 vec3_from_floats(const float *v) {
    return (shb_vec3){(double)v[0], (double)v[1], (double)v[2]};
}

static inline shb_vec3 vec3_add(shb_vec3 a, shb_vec3 b) {
    return (shb_vec3){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline shb_vec3 vec3_subtract(shb_vec3 a, shb_vec3 b) {
    return (shb_vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline shb_vec3 vec3_scale(shb_vec3 a, double s) {
    return (shb_vec3){a.x * s, a.y * s, a.z * s};
}

static inline double vec3_dot(shb_vec3 a, shb_vec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline shb_vec3 vec3_cross(shb_vec3 a, shb_vec3 b) {
    return (shb_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline bool vec3_is_finite(shb_vec3 a) {
    return isfinite(a.x) && isfinite(a.y) && isfinite(a.z);
}

/* shb_vec3_normalize, without its scaling where squares stay far from the ends of the range. */
static inline shb_vec3 vec3_normalize(shb_vec3 a) {
    const double squared = vec3_dot(a, a);
    if (!(squared > 0x1p-600 && squared < 0x1p600))
        return shb_vec3_normalize(a);
    const double length = sqrt(squared);
    return (shb_vec3){a.x / length, a.y / length, a.z / length};
}

static inline shb_vec3 mat4_transform_point(const shb_mat4 *a, shb_vec3 p) {
    const double *m = a->m;
    return (shb_vec3){m[0] * p.x + m[4] * p.y + m[8] * p.z + m[12],
                      m[1] * p.x + m[5] * p.y + m[9] * p.z + m[13],
                      m[2] * p.x + m[6] * p.y + m[10] * p.z + m[14]};
}

static inline shb_box box_empty(void) {
    return (shb_box){{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
}

static inline void box_grow(shb_box *box, shb_vec3 p) {
    box->lo.x = p.x < box->lo.x ? p.x : box->lo.x;
    box->lo.y = p.y < box->lo.y ? p.y : box->lo.y;
    box->lo.z = p.z < box->lo.z ? p.z : box->lo.z;
    box->hi.x = p.x > box->hi.x ? p.x : box->hi.x;
    box->hi.y = p.y > box->hi.y ? p.y : box->hi.y;
    box->hi.z = p.z > box->hi.z ? p.z : box->hi.z;
}

#endif
