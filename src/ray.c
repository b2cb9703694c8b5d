/* Watertight ray against triangle (Woop, Benthin and Wald 2013), with exact signs.
 *
 * The corners, seen from the origin, are sheared along the ray so that the ray becomes a coordinate
 * axis. What remains is a question in the plane: does the triangle of the sheared corners hold the
 * point 0? A corner shears to the same doubles in every triangle that shares it, and the sign of an
 * edge function is exact for these doubles. So neighbours see one and the same plane mesh, and no
 * ray slips through between them.
 *
 * The distance then follows from the triangle's plane, as an interval that holds the exact value.
 */
#include "strict.h"

#include "ray.h"

#include "larger.h"

#include <float.h>
#include <math.h>

/* The largest relative error of one operation. */
#define ROUNDING 0x1p-53

/* Roundings behind an input coordinate, in units of ROUNDING times the largest coordinate of the
 * triangles involved: a world corner is three products and three sums (4), a point on its triangle
 * is a corner plus two weighted edges, each up to twice as long as a coordinate is large (7), and
 * second-order terms (1). */
#define INPUT_ROUNDING (12 * ROUNDING)

bool shb_ray_to_light(const shb_light_source *light, shb_vec3 point, shb_ray *ray) {
    const double target[3] = {light->position.x, light->position.y, light->position.z};
    const double origin[3] = {point.x, point.y, point.z};
    const bool directional = light->w == 0;
    int major = 0;
    for (int i = 0; i < 3; i++) {
        ray->origin[i] = origin[i];
        ray->direction[i] = directional ? target[i] : target[i] - origin[i];
        if (!isfinite(ray->origin[i]) || !isfinite(ray->direction[i]))
            return false;
        if (fabs(ray->direction[i]) > fabs(ray->direction[major]))
            major = i;
    }
    ray->limit = directional ? HUGE_VAL : 1;
    ray->rounding = 0;
    for (int i = 0; i < 3; i++)
        ray->axis[i] = (major + 1 + i) % 3;
    for (int i = 0; i < 2; i++)
        ray->shear[i] = ray->direction[ray->axis[i]] / ray->direction[major];
    return ray->direction[major] != 0;
}

/* The exact sign of a * d - b * c when the rounded products are too close to tell. They are then
 * within a factor of two, so their difference is exact; what the products lost is added to it. */
static double exact_determinant_sign(double a, double b, double c, double d) {
    const double left = a * d, right = b * c;
    const double left_tail = fma(a, d, -left), right_tail = fma(b, c, -right);
    /* tails + lost = left_tail - right_tail, exactly (Knuth's two-sum) */
    const double tails = left_tail - right_tail;
    const double turned = left_tail - tails;
    const double lost = (left_tail - (tails + turned)) + (turned - right_tail);
    const double sum = (left - right) + tails;
    /* Where the sum cancels it is exact and a multiple of the last place of tails, so lost, half of
     * that at most, decides only when nothing else is left. */
    return sum != 0 ? sum : lost;
}

/* Sign of the determinant of two points of the plane: which side of the line through them 0 is on.
 */
static double edge_sign(const double p[2], const double q[2]) {
    const double left = p[0] * q[1], right = p[1] * q[0];
    const double determinant = left - right;
    const double error = 2 * ROUNDING * (fabs(left) + fabs(right)) + DBL_MIN;
    if (fabs(determinant) > error)
        return determinant;
    return exact_determinant_sign(p[0], p[1], q[0], q[1]);
}

static void shear_corner(const shb_ray *ray, const double corner[3], double sheared[2]) {
    const int x = ray->axis[0], y = ray->axis[1], z = ray->axis[2];
    const double along = corner[z] - ray->origin[z];
    sheared[0] = (corner[x] - ray->origin[x]) - ray->shear[0] * along;
    sheared[1] = (corner[y] - ray->origin[y]) - ray->shear[1] * along;
}

bool shb_ray_line_meets(const shb_ray *ray, const shb_triangle *triangle) {
    double a[2], b[2], c[2];
    shear_corner(ray, triangle->corners[0], a);
    shear_corner(ray, triangle->corners[1], b);
    shear_corner(ray, triangle->corners[2], c);
    const double u = edge_sign(b, c), v = edge_sign(c, a), w = edge_sign(a, b);
    if (u > 0 || v > 0 || w > 0)
        return u >= 0 && v >= 0 && w >= 0;
    return u <= 0 && v <= 0 && w <= 0 && (u < 0 || v < 0 || w < 0);
}

/* Bounds of the rounding of each input coordinate. */
static void input_errors(const shb_ray *ray, const shb_triangle *triangle, const shb_triangle *own,
                         double errors[3]) {
    for (int i = 0; i < 3; i++) {
        double largest = fabs(ray->origin[i]);
        for (int k = 0; k < 3; k++) {
            largest = larger(largest, fabs(triangle->corners[k][i]));
            if (own)
                largest = larger(largest, fabs(own->corners[k][i]));
        }
        errors[i] = INPUT_ROUNDING * largest;
    }
}

/* An interval of the ray's parameter. */
typedef struct range {
    double lo, hi;
} range;

/* Where the corners lie along the ray: a line that meets the triangle meets it between them. */
static range range_of_corners(const shb_ray *ray, const shb_triangle *triangle,
                              const double errors[3]) {
    const int z = ray->axis[2];
    double at[3];
    for (int k = 0; k < 3; k++)
        at[k] = (triangle->corners[k][z] - ray->origin[z]) / ray->direction[z];
    const double lo = -larger(larger(-at[0], -at[1]), -at[2]);
    const double hi = larger(larger(at[0], at[1]), at[2]);
    /* subtraction, division and the three sums of this line and the next */
    const double error =
        errors[z] / fabs(ray->direction[z]) + 6 * ROUNDING * larger(fabs(lo), fabs(hi));
    return (range){lo - error, hi + error};
}

/* Where the ray meets the triangle's plane: t = T / D with T = n . (a - o), D = n . d.
 *
 * With u = ROUNDING and first order in u: edges carry u, so a component of n = e x f carries 4 u of
 * A, the sum of the sizes of its two products; a - o carries u, a product u, a sum of three 2 u.
 * Hence |error of T| <= 8 u sum A |a - o| and |error of D| <= 7 u sum A |d|, taken as 10 for the
 * higher orders. Where the line meets the triangle, moving corners and origin by up to e moves the
 * plane under it by no more: sum |n| e in T. Finally t = T / D: (error of T + |t| error of D) /
 * |D|, where |D| is taken for as small as it may be. Nothing is known if D may be 0: the line runs
 * along the plane. */
static range range_of_plane(const shb_ray *ray, const shb_triangle *triangle,
                            const double errors[3]) {
    double e[3], f[3], from_origin[3];
    for (int i = 0; i < 3; i++) {
        e[i] = triangle->corners[1][i] - triangle->corners[0][i];
        f[i] = triangle->corners[2][i] - triangle->corners[0][i];
        from_origin[i] = triangle->corners[0][i] - ray->origin[i];
    }
    double distance = 0, distance_error = 0, slope = 0, slope_error = 0;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double left = e[j] * f[k], right = e[k] * f[j];
        const double n = left - right, size = fabs(left) + fabs(right);
        distance += n * from_origin[i];
        distance_error += 10 * ROUNDING * size * fabs(from_origin[i]);
        distance_error += (fabs(n) + 10 * ROUNDING * size) * errors[i];
        slope += n * ray->direction[i];
        slope_error += 10 * ROUNDING * size * fabs(ray->direction[i]);
    }
    const double least_slope = fabs(slope) - slope_error;
    if (!(least_slope > 0))
        return (range){-HUGE_VAL, HUGE_VAL};
    const double at = distance / slope;
    const double error =
        (distance_error + fabs(at) * slope_error) / least_slope + 4 * ROUNDING * fabs(at);
    return (range){at - error, at + error};
}

/* True if the place where the line meets the triangle lies between origin and light for sure. */
static bool lies_between(const shb_ray *ray, const shb_triangle *triangle,
                         const shb_triangle *own) {
    double errors[3];
    input_errors(ray, triangle, own, errors);
    range along = range_of_corners(ray, triangle, errors);
    range plane = range_of_plane(ray, triangle, errors);
    if (!(along.hi < ray->limit || plane.hi < ray->limit))
        return false;
    if (ray->rounding > 0) { /* which moves the origin, but not the light */
        for (int i = 0; i < 3; i++)
            errors[i] += ray->rounding * larger(fabs(ray->origin[i]), (double)FLT_MIN);
        along = range_of_corners(ray, triangle, errors);
        plane = range_of_plane(ray, triangle, errors);
    }
    return along.lo > 0 || plane.lo > 0;
}

bool shb_ray_is_blocked(const shb_ray *ray, const shb_triangle *triangle, const shb_triangle *own) {
    return shb_ray_line_meets(ray, triangle) && lies_between(ray, triangle, own);
}
