#include "oracle.h"

#include <math.h>

int64_t oracle_snap(double pixels) {
    const double v = 256 * pixels, below = floor(v), fraction = v - below;
    const int64_t n = (int64_t)below;
    if (fraction == 0.5)
        return n % 2 ? n + 1 : n;
    return fraction > 0.5 ? n + 1 : n;
}

static bool is_in_guard_band(double window) {
    return window >= -16384 && window <= 16384;
}

static void project_corner(oracle_triangle *triangle, int k) {
    const double *v = triangle->clip[k];
    const double inverse = 1 / v[3];
    const double half_width = triangle->width * 0.5, half_height = triangle->height * 0.5;
    triangle->X[k] = half_width + half_width * (inverse * v[0]);
    triangle->Y[k] = half_height - half_height * (inverse * v[1]);
    triangle->Z[k] = inverse * v[2];
    if (!is_in_guard_band(triangle->X[k]) || !is_in_guard_band(triangle->Y[k]))
        return;
    triangle->snapped_x[k] = oracle_snap(triangle->X[k]);
    triangle->snapped_y[k] = oracle_snap(triangle->Y[k]);
}

static oracle_real product(double a, double b) {
    return oracle_exact(a) * oracle_exact(b);
}

static void cross_corners(oracle_triangle *t, int k) {
    const double *p = t->clip[(k + 1) % 3], *q = t->clip[(k + 2) % 3];
    t->opposite[k][0] = product(p[1], q[3]) - product(p[3], q[1]);
    t->opposite[k][1] = product(p[3], q[0]) - product(p[0], q[3]);
    t->opposite[k][2] = product(p[0], q[1]) - product(p[1], q[0]);
}

oracle_triangle oracle_project(const shb_view *view, uint32_t width, uint32_t height,
                               const float corners[9]) {
    oracle_triangle triangle = {.width = width, .height = height, .is_finite = true};
    for (int k = 0; k < 3; k++) {
        const double *m = view->clip_from_world.m;
        for (int row = 0; row < 4; row++) {
            double sum = m[row] * (double)corners[3 * k];
            sum += m[row + 4] * (double)corners[3 * k + 1];
            sum += m[row + 8] * (double)corners[3 * k + 2];
            sum += m[row + 12];
            triangle.clip[k][row] = row == 2 && view->reversed ? -sum : sum;
            triangle.is_finite &= isfinite(sum) != 0;
        }
        const double z = triangle.clip[k][2], w = triangle.clip[k][3];
        if (!(w > 0) || !(view->reversed ? z >= -w : z >= 0)) {
            triangle.needs_clipping = true;
            continue;
        }
        project_corner(&triangle, k);
        triangle.needs_clipping |=
            !is_in_guard_band(triangle.X[k]) || !is_in_guard_band(triangle.Y[k]);
    }
    for (int k = 0; k < 3; k++)
        cross_corners(&triangle, k);
    return triangle;
}

static int sign_of(int64_t v) {
    return v > 0 ? 1 : v < 0 ? -1 : 0;
}

/* Sign of the area of (a, b, point) after the point moved by (s, s^2). */
static int side(int64_t ax, int64_t ay, int64_t bx, int64_t by, int64_t px, int64_t py) {
    const int64_t area = (bx - ax) * (py - ay) - (by - ay) * (px - ax);
    if (area != 0)
        return sign_of(area);
    return by != ay ? sign_of(ay - by) : sign_of(bx - ax);
}

/* The sign of a triangle of the fan if it contains the sample, else 0. */
static int signed_coverage(const int64_t x[3], const int64_t y[3], int column, int row) {
    const int64_t px = 256 * (int64_t)column + 128, py = 256 * (int64_t)row + 128;
    const int facing = sign_of((x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]));
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3;
        if (side(x[a], y[a], x[b], y[b], px, py) != facing)
            return 0;
    }
    return facing;
}

int oracle_winding(size_t count, const int64_t *x, const int64_t *y, int column, int row) {
    int winding = 0;
    for (size_t i = 2; i < count; i++) {
        const int64_t fan_x[3] = {x[0], x[i - 1], x[i]}, fan_y[3] = {y[0], y[i - 1], y[i]};
        winding += signed_coverage(fan_x, fan_y, column, row);
    }
    return winding;
}

bool oracle_covers(const oracle_triangle *t, int column, int row) {
    return signed_coverage(t->snapped_x, t->snapped_y, column, row) != 0;
}

/* Barycentric weights of the point; they need not lie within 0 .. 1. */
oracle_real oracle_depth(const oracle_triangle *t, int column, int row) {
    oracle_real x[3], y[3], weighted = 0, total = 0;
    for (int k = 0; k < 3; k++) {
        x[k] = oracle_exact(t->X[k]) - oracle_exact(column + 0.5);
        y[k] = oracle_exact(t->Y[k]) - oracle_exact(row + 0.5);
    }
    for (int k = 0; k < 3; k++) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        const oracle_real weight = x[a] * y[b] - x[b] * y[a];
        weighted += weight * oracle_exact(t->Z[k]);
        total += weight;
    }
    return weighted / total;
}

/* Weights of the three corners whose sum has x / w and y / w of the sample. */
static void clip_weights(const oracle_triangle *t, int column, int row, oracle_real weights[3]) {
    const oracle_real u = (oracle_real)(2 * column + 1) / t->width - 1;
    const oracle_real v = 1 - (oracle_real)(2 * row + 1) / t->height;
    for (int k = 0; k < 3; k++)
        weights[k] = u * t->opposite[k][0] + v * t->opposite[k][1] + t->opposite[k][2];
}

oracle_real oracle_clip_depth(const oracle_triangle *t, int column, int row) {
    oracle_real weights[3], z = 0, w = 0;
    clip_weights(t, column, row, weights);
    for (int k = 0; k < 3; k++) {
        z += weights[k] * oracle_exact(t->clip[k][2]);
        w += weights[k] * oracle_exact(t->clip[k][3]);
    }
    return z / w;
}

double oracle_clip_inside(const oracle_triangle *t, int column, int row) {
    oracle_real weights[3], w = 0;
    clip_weights(t, column, row, weights);
    for (int k = 0; k < 3; k++)
        w += weights[k] * oracle_exact(t->clip[k][3]);
    double inside = 1e30;
    for (int k = 0; k < 3; k++) {
        /* Weights fall to 0 at the edge, by this much a pixel. All turn round behind the eye. */
        const double x = 2 * (double)t->opposite[k][0] / t->width;
        const double y = 2 * (double)t->opposite[k][1] / t->height;
        const double slope = sqrt(x * x + y * y);
        const double weight = w > 0 ? (double)weights[k] : -(double)weights[k];
        const double distance = weight / (slope > 0 ? slope : 1e-300);
        inside = distance < inside ? distance : inside;
    }
    return inside;
}

/* The declared evaluation, transcribed. */
typedef struct declared_plane {
    int64_t column, row; /* of the anchor */
    double area, gx, gy, z0, lo, hi, columns, rows;
    bool is_plain;
} declared_plane;

static int64_t least(const int64_t v[3]) {
    const int64_t m = v[0] < v[1] ? v[0] : v[1];
    return m < v[2] ? m : v[2];
}

static int64_t greatest(const int64_t v[3]) {
    const int64_t m = v[0] > v[1] ? v[0] : v[1];
    return m > v[2] ? m : v[2];
}

/* First sample at or after a coordinate. */
static int64_t sample_from(int64_t coordinate) {
    return (int64_t)ceil(((double)coordinate - 128) / 256);
}

static declared_plane declare_plane(const oracle_triangle *t) {
    declared_plane p = {.column = sample_from(least(t->snapped_x)),
                        .row = sample_from(least(t->snapped_y))};
    p.columns = (double)(sample_from(greatest(t->snapped_x)) - p.column);
    p.rows = (double)(sample_from(greatest(t->snapped_y)) - p.row);
    const double x1 = t->X[1] - t->X[0], y1 = t->Y[1] - t->Y[0], z1 = t->Z[1] - t->Z[0];
    const double x2 = t->X[2] - t->X[0], y2 = t->Y[2] - t->Y[0], z2 = t->Z[2] - t->Z[0];
    p.area = x1 * y2 - x2 * y1;
    p.gx = (z1 * y2 - z2 * y1) / p.area;
    p.gy = (x1 * z2 - x2 * z1) / p.area;
    p.z0 = t->Z[0] + p.gx * ((double)p.column + 0.5 - t->X[0]);
    p.z0 += p.gy * ((double)p.row + 0.5 - t->Y[0]);
    p.lo = fmin(t->Z[0], fmin(t->Z[1], t->Z[2]));
    p.hi = fmax(t->Z[0], fmax(t->Z[1], t->Z[2]));
    const double smallest = fmin(fabs(p.lo), fabs(p.hi));
    p.is_plain = fabs(p.gx) * p.columns + fabs(p.gy) * p.rows <= smallest / 2 &&
                 p.columns * p.rows <= 128 * fabs(p.area) &&
                 fabs(p.gx) + fabs(p.gy) <= 16 * (p.hi - p.lo) && smallest >= ldexp(1, -64) &&
                 smallest <= ldexp(1, 64);
    if (!(fabs(p.gx) <= ldexp(1, 100) && fabs(p.gy) <= ldexp(1, 100) &&
          fabs(p.z0) <= ldexp(1, 100))) {
        p.gx = p.gy = 0;
        p.z0 = (t->Z[0] + t->Z[1] + t->Z[2]) / 3;
        p.is_plain = false;
    }
    p.hi = fmin(p.hi, 2);
    return p;
}

bool oracle_is_plain(const oracle_triangle *t) {
    return declare_plane(t).is_plain;
}

float oracle_stored(const oracle_triangle *t, int column, int row) {
    const declared_plane p = declare_plane(t);
    const int64_t i = column - p.column, j = row - p.row;
    if (p.is_plain) {
        const float down = (float)p.gy * (float)j, along = (float)p.gx * (float)i;
        const float start = (float)p.z0 + down;
        return start + along;
    }
    const double down = p.gy * (double)j, along = p.gx * (double)i;
    const double start = p.z0 + down;
    return (float)fmin(fmax(start + along, p.lo), p.hi);
}
