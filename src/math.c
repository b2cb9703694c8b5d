#include "strict.h"

#include "matrix.h"

#include <math.h>

/* Products of elements that carry a few roundings of their own, and their sum: 32 units. */
#define ROUNDING 0x1p-48

shb_vec3 shb_vec3_add(shb_vec3 a, shb_vec3 b) {
    return (shb_vec3){a.x + b.x, a.y + b.y, a.z + b.z};
}

shb_vec3 shb_vec3_subtract(shb_vec3 a, shb_vec3 b) {
    return (shb_vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}

shb_vec3 shb_vec3_scale(shb_vec3 a, double s) {
    return (shb_vec3){a.x * s, a.y * s, a.z * s};
}

double shb_vec3_dot(shb_vec3 a, shb_vec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

shb_vec3 shb_vec3_cross(shb_vec3 a, shb_vec3 b) {
    return (shb_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* A power of two near the largest component: dividing by it is exact and keeps squares in range.
 * 1 for the zero vector and for one that is not finite. */
static double vec3_magnitude(shb_vec3 a) {
    double largest = fabs(a.x);
    largest = largest < fabs(a.y) ? fabs(a.y) : largest;
    largest = largest < fabs(a.z) ? fabs(a.z) : largest;
    if (!(largest > 0) || !isfinite(largest))
        return 1;
    int exponent;
    frexp(largest, &exponent);
    return ldexp(1, exponent - 1);
}

static shb_vec3 vec3_divide(shb_vec3 a, double s) {
    return (shb_vec3){a.x / s, a.y / s, a.z / s};
}

double shb_vec3_length(shb_vec3 a) {
    const double magnitude = vec3_magnitude(a);
    const shb_vec3 scaled = vec3_divide(a, magnitude);
    return magnitude * sqrt(shb_vec3_dot(scaled, scaled));
}

shb_vec3 shb_vec3_normalize(shb_vec3 a) {
    const shb_vec3 scaled = vec3_divide(a, vec3_magnitude(a));
    const double length = sqrt(shb_vec3_dot(scaled, scaled));
    return length > 0 ? vec3_divide(scaled, length) : a;
}

shb_mat4 shb_mat4_identity(void) {
    return shb_mat4_scaling(1, 1, 1);
}

shb_mat4 shb_mat4_multiply(shb_mat4 a, shb_mat4 b) {
    shb_mat4 product;
    for (int column = 0; column < 4; column++) {
        const double *v = b.m + 4 * column;
        for (int row = 0; row < 4; row++)
            product.m[4 * column + row] =
                a.m[row] * v[0] + a.m[4 + row] * v[1] + a.m[8 + row] * v[2] + a.m[12 + row] * v[3];
    }
    return product;
}

void shb_mat4_row(const shb_mat4 *a, int row, double elements[4]) {
    for (int column = 0; column < 4; column++)
        elements[column] = a->m[4 * column + row];
}

shb_vec3 shb_mat4_transform_point(shb_mat4 a, shb_vec3 p) {
    return (shb_vec3){a.m[0] * p.x + a.m[4] * p.y + a.m[8] * p.z + a.m[12],
                      a.m[1] * p.x + a.m[5] * p.y + a.m[9] * p.z + a.m[13],
                      a.m[2] * p.x + a.m[6] * p.y + a.m[10] * p.z + a.m[14]};
}

shb_mat4 shb_mat4_translation(double x, double y, double z) {
    return (shb_mat4){{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1}};
}

shb_mat4 shb_mat4_scaling(double x, double y, double z) {
    return (shb_mat4){{x, 0, 0, 0, 0, y, 0, 0, 0, 0, z, 0, 0, 0, 0, 1}};
}

/* Taylor series in Horner form, for |x| <= pi / 4. */
static double series_sine(double x) {
    const double s = x * x;
    double sum = 1;
    for (int n = 18; n >= 2; n -= 2)
        sum = 1 - sum * s / (n * (n + 1));
    return x * sum;
}

static double series_cosine(double x) {
    const double s = x * x;
    double sum = 1;
    for (int n = 17; n >= 1; n -= 2)
        sum = 1 - sum * s / (n * (n + 1));
    return sum;
}

void shb_sine_cosine(double angle, double *sine, double *cosine) {
    /* pi / 2 in two parts; the first is short, so that quarters * pi_half is exact. */
    const double pi_half = 0x1.921fb544p0, pi_half_rest = 0x1.0b4611a626331p-34;
    const double quarters = floor(angle / (pi_half + pi_half_rest) + 0.5);
    const double rest = (angle - quarters * pi_half) - quarters * pi_half_rest;
    const double s = series_sine(rest), c = series_cosine(rest);
    const double quadrant = quarters - 4 * floor(quarters / 4);
    *sine = quadrant == 0 ? s : quadrant == 1 ? c : quadrant == 2 ? -s : -c;
    *cosine = quadrant == 0 ? c : quadrant == 1 ? -s : quadrant == 2 ? -c : s;
}

/* Rodrigues: cos I + (1 - cos) n n^T + sin [n]x. */
shb_mat4 shb_mat4_rotation(shb_vec3 axis, double angle) {
    const shb_vec3 n = shb_vec3_normalize(axis);
    double s, c;
    shb_sine_cosine(angle, &s, &c);
    const double t = 1 - c;
    return (shb_mat4){{t * n.x * n.x + c, t * n.x * n.y + s * n.z, t * n.x * n.z - s * n.y, 0,
                       t * n.x * n.y - s * n.z, t * n.y * n.y + c, t * n.y * n.z + s * n.x, 0,
                       t * n.x * n.z + s * n.y, t * n.y * n.z - s * n.x, t * n.z * n.z + c, 0, 0, 0,
                       0, 1}};
}

static shb_vec3 least_parallel_axis(shb_vec3 direction) {
    const double x = fabs(direction.x), y = fabs(direction.y), z = fabs(direction.z);
    if (y <= x && y <= z)
        return (shb_vec3){0, 1, 0};
    return x <= z ? (shb_vec3){1, 0, 0} : (shb_vec3){0, 0, 1};
}

shb_mat4 shb_mat4_look_along(shb_vec3 eye, shb_vec3 direction, shb_vec3 up) {
    const shb_vec3 forward = shb_vec3_normalize(direction);
    shb_vec3 right = shb_vec3_cross(forward, shb_vec3_normalize(up));
    if (!(shb_vec3_dot(right, right) > 1e-20))
        right = shb_vec3_cross(forward, least_parallel_axis(forward));
    right = shb_vec3_normalize(right);
    const shb_vec3 true_up = shb_vec3_cross(right, forward);
    return (shb_mat4){{right.x, true_up.x, -forward.x, 0, right.y, true_up.y, -forward.y, 0,
                       right.z, true_up.z, -forward.z, 0, -shb_vec3_dot(right, eye),
                       -shb_vec3_dot(true_up, eye), shb_vec3_dot(forward, eye), 1}};
}

shb_mat4 shb_mat4_look_at(shb_vec3 eye, shb_vec3 target, shb_vec3 up) {
    return shb_mat4_look_along(eye, shb_vec3_subtract(target, eye), up);
}

/* With w = -z: depth * w = scale * z + offset, 0 at z = -near and w at z = -far, or the reverse. */
shb_mat4 shb_mat4_frustum(double half_width, double half_height, double near_distance,
                          double far_distance, bool reversed) {
    const double n = near_distance, f = far_distance;
    const double ratio = isinf(f) ? 1 : f / (f - n);
    const double scale = reversed ? n / (f - n) : -ratio;
    const double offset = reversed ? n * ratio : -n * ratio;
    return (shb_mat4){
        {1 / half_width, 0, 0, 0, 0, 1 / half_height, 0, 0, 0, 0, scale, -1, 0, 0, offset, 0}};
}

shb_mat4 shb_mat4_perspective(double vertical_angle, double aspect, double near_distance,
                              double far_distance, bool reversed) {
    double s, c;
    shb_sine_cosine(0.5 * vertical_angle, &s, &c);
    const double half_height = s / c;
    return shb_mat4_frustum(aspect * half_height, half_height, near_distance, far_distance,
                            reversed);
}

shb_mat4 shb_mat4_orthographic(double half_width, double half_height, double near_distance,
                               double far_distance, bool reversed) {
    const double range = far_distance - near_distance;
    const double scale = reversed ? 1 / range : -1 / range;
    const double offset = reversed ? far_distance / range : -near_distance / range;
    return (shb_mat4){
        {1 / half_width, 0, 0, 0, 0, 1 / half_height, 0, 0, 0, 0, scale, 0, 0, 0, offset, 1}};
}

bool shb_mat4_is_finite(const shb_mat4 *a) {
    for (int i = 0; i < 16; i++)
        if (!isfinite(a->m[i]))
            return false;
    return true;
}

/* A row divided by a power of two near its largest element, so that products of elements of three
 * rows neither overflow nor vanish. */
static void scaled_row(const shb_mat4 *a, int row, double scaled[4]) {
    double largest = 0;
    for (int column = 0; column < 4; column++) {
        const double size = fabs(a->m[4 * column + row]);
        largest = largest < size ? size : largest;
    }
    int exponent;
    frexp(largest, &exponent);
    for (int column = 0; column < 4; column++)
        scaled[column] = ldexp(a->m[4 * column + row], -exponent);
}

/* The determinant of three rows without one column; *bound is the sum of the sizes of its six
 * products, to which its rounding error is proportional. */
static double minor_determinant(double rows[3][4], int without, double *bound) {
    const int i = without == 0 ? 1 : 0, j = without <= 1 ? 2 : 1, k = without == 3 ? 2 : 3;
    const double *a = rows[0], *b = rows[1], *c = rows[2];
    const double jk = b[j] * c[k], kj = b[k] * c[j];
    const double ki = b[k] * c[i], ik = b[i] * c[k];
    const double ij = b[i] * c[j], ji = b[j] * c[i];
    *bound = fabs(a[i]) * (fabs(jk) + fabs(kj)) + fabs(a[j]) * (fabs(ki) + fabs(ik)) +
             fabs(a[k]) * (fabs(ij) + fabs(ji));
    return a[i] * (jk - kj) + a[j] * (ki - ik) + a[k] * (ij - ji);
}

static double zero_within_rounding(double value, double bound) {
    return fabs(value) <= ROUNDING * bound ? 0 : value;
}

double shb_mat4_cofactors(const shb_mat4 *a, int row, double cofactors[4]) {
    double others[3][4];
    for (int i = 0; i < 3; i++)
        scaled_row(a, i < row ? i : i + 1, others[i]);
    double determinant = 0, determinant_bound = 0;
    for (int column = 0; column < 4; column++) {
        const double element = a->m[4 * column + row];
        double bound;
        const double minor = minor_determinant(others, column, &bound);
        const double cofactor = (row + column) % 2 ? -minor : minor;
        determinant += element * cofactor;
        determinant_bound += fabs(element) * bound;
        cofactors[column] = zero_within_rounding(cofactor, bound);
    }
    return zero_within_rounding(determinant, determinant_bound);
}

shb_result shb_mat4_inverse(shb_mat4 a, shb_mat4 *inverse) {
    if (!inverse)
        return SHB_ERROR_ARGUMENT;
    if (!shb_mat4_is_finite(&a))
        return SHB_ERROR_NUMBER;
    shb_mat4 made;
    for (int row = 0; row < 4; row++) {
        double cofactors[4];
        const double determinant = shb_mat4_cofactors(&a, row, cofactors);
        if (determinant == 0)
            return SHB_ERROR_NUMBER;
        for (int column = 0; column < 4; column++)
            made.m[4 * row + column] = cofactors[column] / determinant;
    }
    if (!shb_mat4_is_finite(&made))
        return SHB_ERROR_NUMBER;
    *inverse = made;
    return SHB_OK;
}
