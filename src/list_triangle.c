/* Triangles that the near plane cuts, or whose corners cannot be projected: their plane as the
 * light sees it, from homogeneous coordinates. */
#include "strict.h"

#include "list_triangle.h"

#include <math.h>
#include <string.h>

#include "clip.h"

/* The largest relative error of one operation. */
#define ROUNDING 0x1p-53

static void project(const shb_list_frame *frame, const double corner[3], double out[4]) {
    for (int r = 0; r < 4; r++)
        out[r] = shb_list_row(frame->rows[r], corner[0], corner[1], corner[2]);
}

/* The part of a triangle behind the near plane: at most four corners. */
typedef struct part {
    int count;
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

/* A corner in the plane of the light may be seen anywhere. */
static shb_list_box box_of(const shb_list_frame *frame, const part *seen, uint16_t *level) {
    const double *e = frame->errors;
    range x = {HUGE_VAL, -HUGE_VAL}, y = x, z = x;
    for (int k = 0; k < seen->count; k++) {
        const double *v = seen->corners[k];
        const double inverse = 1 / v[3];
        if (!(v[3] > 4 * e[3] && inverse <= 0x1p1000)) {
            range_add(&x, 0, HUGE_VAL);
            range_add(&y, 0, HUGE_VAL);
            range_add(&z, frame->near_depth, 0);
            continue;
        }
        range_add(&x, v[0] * inverse, 4 * (e[0] + fabs(v[0] * inverse) * e[3]) * inverse);
        range_add(&y, v[1] * inverse, 4 * (e[1] + fabs(v[1] * inverse) * e[3]) * inverse);
        range_add(&z, v[2] * inverse, 4 * (e[2] + fabs(v[2] * inverse) * e[3]) * inverse);
    }
    range_add(&x, x.lo, frame->rim);
    range_add(&x, x.hi, frame->rim);
    range_add(&y, y.lo, frame->rim);
    range_add(&y, y.hi, frame->rim);
    shb_list_box box;
    if (!texels_of(x, frame->width, &box.first_column, &box.last_column) ||
        !texels_of(y, frame->height, &box.first_row, &box.last_row))
        return SHB_LIST_BOX_NONE;
    const double at = (z.lo - frame->level_origin) * frame->levels;
    *level = (uint16_t)(at > 0 ? (at < SHB_LIST_LEVELS - 1 ? at : SHB_LIST_LEVELS - 1) : 0);
    return box;
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

static void measure(const shb_list_frame *frame, const part *seen, local *l) {
    l->least_w = HUGE_VAL;
    l->deepest = 0;
    for (int k = 0; k < seen->count; k++) {
        const double w = seen->corners[k][3], depth = fabs(seen->corners[k][2] / w);
        l->least_w = w < l->least_w ? w : l->least_w;
        l->deepest = depth > l->deepest ? depth : l->deepest;
    }
    const double *e = frame->errors;
    const double inverse = 1 / (l->least_w - e[3]);
    l->point_errors[0] = (e[0] + frame->width * e[3]) * inverse;
    l->point_errors[1] = (e[1] + frame->height * e[3]) * inverse;
    l->point_errors[2] = (e[2] + l->deepest * e[3]) * inverse;
}

static void localise(const shb_list_frame *frame, const double corners[3][3],
                     const shb_list_box *box, local *l) {
    l->column = (double)((box->first_column + box->last_column) / 2);
    l->row = (double)((box->first_row + box->last_row) / 2);
    l->half_x = (double)box->last_column - l->column + 1;
    l->half_y = (double)box->last_row - l->row + 1;
    for (int k = 0; k < 3; k++) {
        double clip[4];
        project(frame, corners[k], clip);
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

/* The triangle's own plane, from the generalised cross product of three points (x, y, z, w). */
typedef struct homogeneous {
    bounded x, y, z, w;
} homogeneous;

static homogeneous plane_of(const local *l) {
    const bounded *p = l->corners[0], *q = l->edges[0], *r = l->edges[1];
    const bounded xy = minor(q[0], q[1], r[0], r[1]), xz = minor(q[0], q[2], r[0], r[2]);
    const bounded xw = minor(q[0], q[3], r[0], r[3]), yz = minor(q[1], q[2], r[1], r[2]);
    const bounded yw = minor(q[1], q[3], r[1], r[3]), zw = minor(q[2], q[3], r[2], r[3]);
    return (homogeneous){
        .x = sum(difference(product(p[1], zw), product(p[2], yw)), product(p[3], yz)),
        .y = difference(difference(product(p[2], xw), product(p[0], zw)), product(p[3], xz)),
        .z = sum(difference(product(p[0], yw), product(p[1], xw)), product(p[3], xy)),
        .w = difference(difference(product(p[1], xz), product(p[0], yz)), product(p[2], xy)),
    };
}

/* Writes its elements; returns the bound of its rounding. */
static double prepare_plane(const shb_list_frame *frame, const local *l, const homogeneous *p,
                            double out[3]) {
    const double size = fabs(p->z.value);
    const double a = p->x.value / p->z.value, b = p->y.value / p->z.value;
    const double d = p->w.value / p->z.value;
    out[0] = a;
    out[1] = b;
    out[2] = d - a * l->column - b * l->row;
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

uint16_t shb_list_triangle_cut(const shb_list_frame *frame, const double corners[3][3],
                               shb_list_triangle *triangle, shb_list_box *box) {
    const part seen = cut_near(frame, corners);
    uint16_t level = 0;
    *box = seen.count ? box_of(frame, &seen, &level) : SHB_LIST_BOX_NONE;
    if (shb_list_box_is_none(box))
        return level;
    *triangle = (shb_list_triangle){
        .rest = HUGE_VALF, .margin = HUGE_VALF, .bound = HUGE_VALF, .clear = HUGE_VALF};
    local l;
    measure(frame, &seen, &l);
    localise(frame, corners, box, &l);
    const homogeneous p = plane_of(&l);
    if (!(l.least_w > 2 * frame->errors[3] && fabs(p.z.value) > 2 * p.z.error))
        return level;
    double plane[3];
    const double bound =
        (prepare_plane(frame, &l, &p, plane) + SHB_LIST_LEAST_BOUND) * (1 + 0x1p-22);
    if (!(bound < (double)HUGE_VALF))
        return level;
    triangle->bound = (float)bound;
    memcpy(triangle->plane, plane, sizeof plane);
    return level;
}
