#include "strict.h"

#include "list_triangle.h"

#include <math.h>

#include "clip.h"

/* The largest relative error of one operation. */
#define ROUNDING 0x1p-53

/* Roundings of a projected coordinate, in units of the sum of its products' sizes: 4 of the row's
 * product, 2 of the row itself, 12 of the corners and points in the world (ray.c), 8 of a corner
 * sheared there times a distance of up to 2; the rest covers the shift to a texel near by. */
#define PROJECTION_ROUNDING (64 * ROUNDING)

static void matrix_row(const shb_mat4 *matrix, int row, double out[4]) {
    for (int column = 0; column < 4; column++)
        out[column] = matrix->m[4 * column + row];
}

static double row_size(const double row[4], double reach) {
    return (fabs(row[0]) + fabs(row[1]) + fabs(row[2])) * reach + fabs(row[3]);
}

/* How much a row changes, by rounding, along a ray from the scene to the light, where it should
 * stay in proportion to w. For a point only the part of the way counts that w says lies between two
 * points of the scene. */
static double drift(const shb_list_frame *frame, const double row[4]) {
    const shb_vec3 p = frame->light.position;
    const double sizes = fabs(row[0] * p.x) + fabs(row[1] * p.y) + fabs(row[2] * p.z);
    const double *w = frame->rows[3];
    if (frame->light.w == 0) {
        const double change = fabs((row[0] * p.x + row[1] * p.y) + row[2] * p.z);
        return 4 * frame->reach * (change + 4 * ROUNDING * sizes);
    }
    const double depth = row_size(w, frame->reach) - fabs(w[3]);
    const double distance = w[3] - depth;
    const double part = distance > 2 * depth ? 2 * depth / distance : 1;
    return part * (fabs(shb_list_row(row, p.x, p.y, p.z)) + 4 * ROUNDING * (sizes + fabs(row[3])));
}

shb_result shb_list_frame_init(const shb_view *view, uint32_t width, uint32_t height, double reach,
                               shb_list_frame *frame) {
    shb_list_frame made = {
        .near_depth = view->reversed ? -1 : 0, .width = width, .height = height, .reach = reach};
    const shb_result result = shb_view_light_source(view, &made.light);
    if (result)
        return result;
    double x[4], y[4], z[4], w[4];
    matrix_row(&view->clip_from_world, 0, x);
    matrix_row(&view->clip_from_world, 1, y);
    matrix_row(&view->clip_from_world, 2, z);
    matrix_row(&view->clip_from_world, 3, w);
    for (int i = 0; i < 4; i++) {
        made.rows[0][i] = (w[i] + x[i]) * (0.5 * made.width);
        made.rows[1][i] = (w[i] - y[i]) * (0.5 * made.height);
        made.rows[2][i] = view->reversed ? -z[i] : z[i];
        made.rows[3][i] = w[i];
    }
    for (int r = 0; r < 4; r++) {
        made.errors[r] = PROJECTION_ROUNDING * row_size(made.rows[r], reach);
        if (r != 2)
            made.errors[r] += drift(&made, made.rows[r]);
    }
    *frame = made;
    return SHB_OK;
}

static void project(const shb_list_frame *frame, const double corner[3], double out[4]) {
    for (int r = 0; r < 4; r++)
        out[r] = shb_list_row(frame->rows[r], corner[0], corner[1], corner[2]);
}

/* The part of a triangle behind the near plane: at most four corners. */
typedef struct part {
    int count;
    bool is_cut;
    double corners[4][4];
} part;

static double behind_near(const shb_list_frame *frame, const double v[4]) {
    return v[2] - frame->near_depth * v[3];
}

static bool is_finite(const double v[4]) {
    return fabs(v[0]) <= SHB_CLIP_MAX && fabs(v[1]) <= SHB_CLIP_MAX && fabs(v[2]) <= SHB_CLIP_MAX &&
           fabs(v[3]) <= SHB_CLIP_MAX;
}

/* Nothing of a triangle that drawing would leave out as not finite. */
static part cut_near(const shb_list_frame *frame, const double corners[3][3]) {
    double clip[3][4], behind[3];
    for (int k = 0; k < 3; k++) {
        project(frame, corners[k], clip[k]);
        behind[k] = behind_near(frame, clip[k]);
    }
    part result = {0};
    if (!is_finite(clip[0]) || !is_finite(clip[1]) || !is_finite(clip[2]))
        return result;
    for (int k = 0; k < 3; k++) {
        const int next = (k + 1) % 3;
        if (behind[k] >= 0) {
            for (int i = 0; i < 4; i++)
                result.corners[result.count][i] = clip[k][i];
            result.count++;
        } else {
            result.is_cut = true;
        }
        if ((behind[k] >= 0) == (behind[next] >= 0))
            continue;
        const double t = behind[k] / (behind[k] - behind[next]);
        for (int i = 0; i < 4; i++)
            result.corners[result.count][i] = clip[k][i] + (clip[next][i] - clip[k][i]) * t;
        result.count++;
    }
    return result;
}

/* The largest float that is not above the value, and the smallest not below. */
static float round_down(double value) {
    const float nearest = (float)value;
    return (double)nearest > value ? nextafterf(nearest, -HUGE_VALF) : nearest;
}

static float round_up(double value) {
    return -round_down(-value);
}

typedef struct range {
    double lo, hi;
} range;

static void range_add(range *r, double value, double error) {
    r->lo = value - error < r->lo ? value - error : r->lo;
    r->hi = value + error > r->hi ? value + error : r->hi;
}

/* Texels of a range that are in the view; false: none. */
static bool texels_of(range r, double size, uint16_t *first, uint16_t *last) {
    if (!(r.hi >= 0 && r.lo <= size))
        return false;
    *first = (uint16_t)(r.lo > 0 ? (r.lo < size - 1 ? r.lo : size - 1) : 0);
    *last = (uint16_t)(r.hi < size - 1 ? r.hi : size - 1);
    return true;
}

static bool same(const double a[3], const double b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

bool shb_list_triangle_bounds(const shb_list_frame *frame, const double corners[3][3],
                              shb_list_box *box, float *nearest) {
    if (same(corners[0], corners[1]) || same(corners[1], corners[2]) ||
        same(corners[2], corners[0]))
        return false;
    const part seen = cut_near(frame, corners);
    if (seen.count == 0)
        return false;
    const double *e = frame->errors;
    range x = {HUGE_VAL, -HUGE_VAL}, y = x, z = x;
    for (int k = 0; k < seen.count; k++) {
        const double *v = seen.corners[k];
        const double inverse = 1 / v[3];
        if (!(v[3] > 4 * e[3] && inverse <= 0x1p1000)) {
            /* In the plane of the light: it may be seen anywhere. */
            range_add(&x, 0, HUGE_VAL);
            range_add(&y, 0, HUGE_VAL);
            range_add(&z, frame->near_depth, 0);
            continue;
        }
        range_add(&x, v[0] * inverse, 4 * (e[0] + fabs(v[0] * inverse) * e[3]) * inverse);
        range_add(&y, v[1] * inverse, 4 * (e[1] + fabs(v[1] * inverse) * e[3]) * inverse);
        range_add(&z, v[2] * inverse, 4 * (e[2] + fabs(v[2] * inverse) * e[3]) * inverse);
    }
    *nearest = round_down(z.lo);
    return texels_of(x, frame->width, &box->first_column, &box->last_column) &&
           texels_of(y, frame->height, &box->first_row, &box->last_row);
}

/* A number and a bound of how far it is from what exact arithmetic would give. */
typedef struct bounded {
    double value, error;
} bounded;

static inline bounded difference(bounded a, bounded b) {
    const double value = a.value - b.value;
    return (bounded){value, a.error + b.error + ROUNDING * fabs(value)};
}

static inline bounded product(bounded a, bounded b) {
    const double value = a.value * b.value;
    return (bounded){value, fabs(a.value) * b.error + a.error * fabs(b.value) + a.error * b.error +
                                ROUNDING * fabs(value)};
}

static inline bounded minor(bounded a, bounded b, bounded c, bounded d) {
    return difference(product(a, d), product(b, c));
}

static inline bounded sum(bounded a, bounded b) {
    return difference(a, (bounded){-b.value, b.error});
}

/* A triangle by its corners about a texel near by. */
typedef struct local {
    bounded corners[3][4];
    bounded edges[2][4];    /* from the first corner to the others */
    double column, row;     /* of the texel */
    double half_x, half_y;  /* of the box around it where the functions are asked */
    double least_w;         /* of what lies behind the near plane */
    double deepest;         /* size of depth there */
    double point_errors[3]; /* of X, Y, Z of a point */
} local;

static void measure(const shb_list_frame *frame, const shb_triangle *world, local *l,
                    bool *is_cut) {
    const part seen = cut_near(frame, world->corners);
    l->least_w = HUGE_VAL;
    l->deepest = 0;
    for (int k = 0; k < seen.count; k++) {
        const double w = seen.corners[k][3], depth = fabs(seen.corners[k][2] / w);
        l->least_w = w < l->least_w ? w : l->least_w;
        l->deepest = depth > l->deepest ? depth : l->deepest;
    }
    *is_cut = seen.is_cut;
    const double *e = frame->errors;
    const double inverse = 1 / (l->least_w - e[3]);
    l->point_errors[0] = (e[0] + frame->width * e[3]) * inverse;
    l->point_errors[1] = (e[1] + frame->height * e[3]) * inverse;
    l->point_errors[2] = (e[2] + l->deepest * e[3]) * inverse;
}

static void localise(const shb_list_frame *frame, const shb_triangle *world,
                     const shb_list_box *box, local *l) {
    l->column = (double)((box->first_column + box->last_column) / 2);
    l->row = (double)((box->first_row + box->last_row) / 2);
    l->half_x = (double)box->last_column - l->column + 1;
    l->half_y = (double)box->last_row - l->row + 1;
    for (int k = 0; k < 3; k++) {
        double clip[4];
        project(frame, world->corners[k], clip);
        for (int r = 0; r < 4; r++)
            l->corners[k][r] = (bounded){clip[r], frame->errors[r]};
        l->corners[k][0].value -= l->column * clip[3];
        l->corners[k][1].value -= l->row * clip[3];
        l->corners[k][0].error += l->column * frame->errors[3];
        l->corners[k][1].error += l->row * frame->errors[3];
    }
    for (int k = 0; k < 2; k++)
        for (int r = 0; r < 4; r++)
            l->edges[k][r] = difference(l->corners[k + 1][r], l->corners[0][r]);
}

/* The plane through the light and an edge, from the cross product of two corners' (x, y, w). */
static double prepare_edge(const shb_list_frame *frame, const local *l, int edge, double sign,
                           shb_list_triangle *triangle) {
    const bounded *from = l->corners[(edge + 1) % 3], *to = l->corners[(edge + 2) % 3];
    const bounded x = difference(to[0], from[0]), y = difference(to[1], from[1]);
    const bounded w = difference(to[3], from[3]);
    const bounded a = minor(from[1], from[3], y, w);
    const bounded b = minor(from[3], from[0], w, x);
    const bounded c = minor(from[0], from[1], x, y);
    const double size = fabs(a.value) + fabs(b.value);
    const double scale = sign / size;
    triangle->x[edge] = a.value * scale;
    triangle->y[edge] = b.value * scale;
    triangle->one[edge] = (c.value - a.value * l->column - b.value * l->row) * scale;
    const double of_edge = (a.error * l->half_x + b.error * l->half_y + c.error) / size;
    const double evaluation = frame->width + frame->height + fabs(c.value / size);
    return of_edge + l->point_errors[0] + l->point_errors[1] + 16 * ROUNDING * evaluation;
}

/* The triangle's own plane, from the generalised cross product of three points (x, y, z, w). */
typedef struct plane {
    bounded x, y, z, w;
} plane;

static plane plane_of(const local *l) {
    const bounded *p = l->corners[0], *q = l->edges[0], *r = l->edges[1];
    const bounded xy = minor(q[0], q[1], r[0], r[1]), xz = minor(q[0], q[2], r[0], r[2]);
    const bounded xw = minor(q[0], q[3], r[0], r[3]), yz = minor(q[1], q[2], r[1], r[2]);
    const bounded yw = minor(q[1], q[3], r[1], r[3]), zw = minor(q[2], q[3], r[2], r[3]);
    return (plane){
        .x = sum(difference(product(p[1], zw), product(p[2], yw)), product(p[3], yz)),
        .y = difference(difference(product(p[2], xw), product(p[0], zw)), product(p[3], xz)),
        .z = sum(difference(product(p[0], yw), product(p[1], xw)), product(p[3], xy)),
        .w = difference(difference(product(p[1], xz), product(p[0], yz)), product(p[2], xy)),
    };
}

static double prepare_depth(const shb_list_frame *frame, const local *l, const plane *p,
                            shb_list_triangle *triangle) {
    const double size = fabs(p->z.value);
    const double a = p->x.value / p->z.value, b = p->y.value / p->z.value;
    const double d = p->w.value / p->z.value;
    const double one = d - a * l->column - b * l->row;
    triangle->x[SHB_LIST_DEPTH] = a;
    triangle->y[SHB_LIST_DEPTH] = b;
    triangle->one[SHB_LIST_DEPTH] = one;
    for (int i = 0; i < 3; i++) {
        const double change = (frame->rows[2][i] + a * frame->rows[0][i]) +
                              (b * frame->rows[1][i] + one * frame->rows[3][i]);
        triangle->normal[i] = round_up(fabs(change) * (1 + 0x1p-20));
    }
    const double of_plane =
        2 *
        (p->x.error * l->half_x + p->y.error * l->half_y + p->z.error * l->deepest + p->w.error) /
        size;
    const double of_point =
        l->point_errors[2] + fabs(a) * l->point_errors[0] + fabs(b) * l->point_errors[1];
    const double evaluation =
        l->deepest + fabs(a) * frame->width + fabs(b) * frame->height + fabs(d);
    return of_plane + of_point + 16 * ROUNDING * evaluation;
}

void shb_list_triangle_prepare(const shb_list_frame *frame, const shb_triangle *world,
                               const shb_list_box *box, float nearest,
                               shb_list_triangle *triangle) {
    local l;
    bool is_cut;
    measure(frame, world, &l, &is_cut);
    localise(frame, world, box, &l);
    const shb_list_triangle unknown = {.edge_bound = HUGE_VALF,
                                       .depth_bound = HUGE_VALF,
                                       .nearest = nearest,
                                       .id = world->id,
                                       .crosses_near = is_cut};
    *triangle = unknown;
    const plane p = plane_of(&l);
    if (!(l.least_w > 2 * frame->errors[3] && fabs(p.z.value) > 2 * p.z.error))
        return;
    const double sign = p.z.value < 0 ? -1 : 1;
    double edge_bound = 0;
    for (int edge = 0; edge < 3; edge++) {
        const double bound = prepare_edge(frame, &l, edge, sign, triangle);
        edge_bound = bound > edge_bound ? bound : edge_bound;
    }
    const double depth_bound = prepare_depth(frame, &l, &p, triangle);
    triangle->edge_bound = round_up(edge_bound);
    triangle->depth_bound = round_up(depth_bound);
    if (!(edge_bound < (double)HUGE_VALF && depth_bound < (double)HUGE_VALF))
        *triangle = unknown;
}
