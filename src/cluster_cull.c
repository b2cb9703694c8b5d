#include "strict.h"

#include "cluster_cull.h"

#include <math.h>

#define CLIP_DOUBT 0x1p-48
#define EYE_DOUBT 0x1p-50
#define NORMAL_DOUBT 0x1p-16

/* Errors of a window coordinate, in pixels: of those computed, and of those snapped. */
#define WINDOW_DOUBT 0x1p-12
#define SNAP_DOUBT (0x1p-9 + 0x1.2p-12)

/* Far below SHB_CLIP_MAX. */
#define CLIP_SURE 0x1p290

enum { ROW_X, ROW_Y, ROW_Z, ROW_W };

/* The box of a cluster by its middle and half its size; reach: the largest size of a coordinate. */
typedef struct middle_box {
    double middle[3], half[3], reach[3];
} middle_box;

/* Numbers of a box, or of the box's image. */
typedef struct range {
    double lo, hi;
} range;

/* Of a cluster in window space. */
typedef struct window_box {
    range x, y;
} window_box;

static double determinant(const double a[4], const double b[4], const double c[4], int i, int j,
                          int k) {
    return (a[i] * (b[j] * c[k] - b[k] * c[j]) - a[j] * (b[i] * c[k] - b[k] * c[i])) +
           a[k] * (b[i] * c[j] - b[j] * c[i]);
}

/* The same with every product's size. */
static double determinant_size(const double a[4], const double b[4], const double c[4], int i,
                               int j, int k) {
    return (fabs(a[i]) * (fabs(b[j] * c[k]) + fabs(b[k] * c[j])) +
            fabs(a[j]) * (fabs(b[i] * c[k]) + fabs(b[k] * c[i]))) +
           fabs(a[k]) * (fabs(b[i] * c[j]) + fabs(b[j] * c[i]));
}

static void find_eye(shb_cluster_view *view) {
    static const int others[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};
    const double *x = view->rows[ROW_X], *y = view->rows[ROW_Y], *w = view->rows[ROW_W];
    for (int i = 0; i < 4; i++) {
        const double d = determinant(x, y, w, others[i][0], others[i][1], others[i][2]);
        view->eye[i] = i % 2 ? -d : d;
        view->eye_doubt[i] =
            EYE_DOUBT * determinant_size(x, y, w, others[i][0], others[i][1], others[i][2]);
    }
}

static double squared3(const double v[3]) {
    return (v[0] * v[0] + v[1] * v[1]) + v[2] * v[2];
}

static double length3(const double v[3]) {
    return sqrt(squared3(v));
}

shb_cluster_view shb_cluster_view_of(const shb_draw_instance *instance, const shb_target *target) {
    shb_cluster_view view = {.target = target, .affine = instance->affine};
    for (int row = 0; row < 4; row++)
        for (int column = 0; column < 4; column++)
            view.rows[row][column] = instance->clip_from_mesh.m[4 * column + row];
    const shb_clip_plane outer[5] = {target->volume.cut[0], target->volume.border[0],
                                     target->volume.border[1], target->volume.border[2],
                                     target->volume.border[3]};
    for (int plane = 0; plane < 5; plane++)
        for (int column = 0; column < 4; column++)
            view.planes[plane][column] = outer[plane].sign * view.rows[outer[plane].axis][column] +
                                         outer[plane].offset * view.rows[ROW_W][column];
    view.steep_x = length3(view.rows[ROW_X]);
    view.steep_y = length3(view.rows[ROW_Y]);
    view.steep_w = length3(view.rows[ROW_W]);
    view.facing = instance->keep_positive == instance->keep_negative ? 0
                  : instance->keep_negative                          ? 1
                                                                     : -1;
    find_eye(&view);
    return view;
}

static middle_box middle_of(const shb_cluster *cluster) {
    middle_box box;
    for (int i = 0; i < 3; i++) {
        const double lo = (double)cluster->lo[i], hi = (double)cluster->hi[i];
        box.middle[i] = 0.5 * (lo + hi);
        box.half[i] = 0.5 * (hi - lo);
        box.reach[i] = fabs(box.middle[i]) + box.half[i];
    }
    return box;
}

/* The size of what a coordinate is summed up from. */
static double size_in(const double row[4], const middle_box *box) {
    return ((fabs(row[0]) * box->reach[0] + fabs(row[1]) * box->reach[1]) +
            fabs(row[2]) * box->reach[2]) +
           fabs(row[3]);
}

static double middle_in(const double row[4], const middle_box *box) {
    return ((row[0] * box->middle[0] + row[1] * box->middle[1]) + row[2] * box->middle[2]) + row[3];
}

static double half_in(const double row[4], const middle_box *box) {
    return (fabs(row[0]) * box->half[0] + fabs(row[1]) * box->half[1]) +
           fabs(row[2]) * box->half[2];
}

static range range_in(const double row[4], const middle_box *box) {
    const double middle = middle_in(row, box);
    const double half = half_in(row, box) + CLIP_DOUBT * size_in(row, box);
    return (range){middle - half, middle + half};
}

static bool is_sure(range r) {
    return r.lo >= -CLIP_SURE && r.hi <= CLIP_SURE;
}

/* Where w is 1 the clip coordinates' ranges tell it: a sum with 1 has its exact sign. */
static bool is_outside_affine(const shb_cluster_view *view, range x, range y, range z) {
    return x.hi < -1 || x.lo > 1 || y.hi < -1 || y.lo > 1 ||
           z.hi < -view->target->volume.cut[0].offset;
}

static bool is_outside(const shb_cluster_view *view, const middle_box *box) {
    /* Rows are rounded sums: their sizes are those of the rows added. */
    const double size_w = size_in(view->rows[ROW_W], box);
    for (int plane = 0; plane < 5; plane++) {
        const double *row = view->planes[plane];
        const double size = size_in(row, box) + size_w;
        if (middle_in(row, box) + half_in(row, box) < -2 * CLIP_DOUBT * size)
            return true;
    }
    return false;
}

/* True if no vertex lies behind the near plane. */
static bool is_before_eye(const shb_cluster_view *view, const middle_box *box, range z) {
    if (view->affine)
        return z.lo >= -view->target->volume.cut[0].offset;
    const double size = size_in(view->rows[ROW_Z], box) + size_in(view->rows[ROW_W], box);
    return range_in(view->planes[0], box).lo > 2 * CLIP_DOUBT * size;
}

static range widen(range r, double by) {
    return (range){r.lo - by, r.hi + by};
}

static double largest(range r) {
    return fmax(fabs(r.lo), fabs(r.hi));
}

/* x / w over the box's corners, for x in rows[row]. */
static range quotient_in(const shb_cluster_view *view, const middle_box *box, int row) {
    const double *m = view->rows[row], *n = view->rows[ROW_W];
    const double x = middle_in(m, box), w = middle_in(n, box);
    range found = {HUGE_VAL, -HUGE_VAL};
    for (int corner = 0; corner < 8; corner++) {
        const double a = corner & 1 ? box->half[0] : -box->half[0];
        const double b = corner & 2 ? box->half[1] : -box->half[1];
        const double c = corner & 4 ? box->half[2] : -box->half[2];
        const double quotient =
            (((m[0] * a + m[1] * b) + m[2] * c) + x) / (((n[0] * a + n[1] * b) + n[2] * c) + w);
        found.lo = quotient < found.lo ? quotient : found.lo;
        found.hi = quotient > found.hi ? quotient : found.hi;
    }
    return found;
}

/* The quotient of a coordinate by w and its error; clip: the coordinate's range. */
static range project(const shb_cluster_view *view, const middle_box *box, int row, range clip,
                     double least_w, double *doubt) {
    if (view->affine) {
        *doubt = CLIP_DOUBT * size_in(view->rows[row], box);
        return clip;
    }
    const range quotient = quotient_in(view, box, row);
    *doubt = CLIP_DOUBT *
             (size_in(view->rows[row], box) + largest(quotient) * size_in(view->rows[ROW_W], box)) /
             least_w;
    return widen(quotient, *doubt);
}

static int32_t floor_to_int(double pixels) {
    const double inside = fmin(fmax(pixels, -SHB_GUARD_PIXELS), 2 * SHB_GUARD_PIXELS);
    return (int32_t)(inside + 2 * SHB_GUARD_PIXELS) - (int32_t)(2 * SHB_GUARD_PIXELS);
}

/* The samples whose centres lie within the box, or next to it. */
static shb_samples samples_in(const window_box *window) {
    return (shb_samples){floor_to_int(window->x.lo + 0.5 - 2 * SNAP_DOUBT),
                         floor_to_int(window->y.lo + 0.5 - 2 * SNAP_DOUBT),
                         floor_to_int(window->x.hi - 0.5 + 2 * SNAP_DOUBT),
                         floor_to_int(window->y.hi - 0.5 + 2 * SNAP_DOUBT)};
}

/* From the first sample to the origin of a small cluster, and from there to the last one: a
 * vertex lies at most 1.5 samples beyond. */
#define ORIGIN_DISTANCE (SHB_PAIR_REACH / SHB_SUBPIXELS - 1)

static void find_origin(const shb_samples *samples, shb_seen_cluster *seen) {
    seen->is_small = samples->last_column - samples->first_column <= 2 * ORIGIN_DISTANCE &&
                     samples->last_row - samples->first_row <= 2 * ORIGIN_DISTANCE;
    seen->origin_x = samples->first_column + ORIGIN_DISTANCE;
    seen->origin_y = samples->first_row + ORIGIN_DISTANCE;
}

/* No normal of the cone has a larger product with v; HUGE_VAL: it says nothing. */
static double largest_in_cone(const shb_cluster *cluster, const double v[3]) {
    const double cosine = (double)cluster->cosine;
    const double along = ((double)cluster->axis[0] * v[0] + (double)cluster->axis[1] * v[1]) +
                         (double)cluster->axis[2] * v[2];
    if (!(cosine > 0 && along < 0))
        return HUGE_VAL;
    const double across = sqrt(fmax(squared3(v) - along * along, 0));
    return along * cosine + across * sqrt(1 - fmin(cosine * cosine, 1));
}

static double largest_in_box(const shb_cluster *cluster, const double v[3]) {
    double sum = 0;
    for (int i = 0; i < 3; i++)
        sum += fmax((double)cluster->normal_lo[i] * v[i], (double)cluster->normal_hi[i] * v[i]);
    return sum;
}

/* True if every triangle of the cluster faces the way that is dropped, (1). */
static bool faces_away(const shb_cluster_view *view, const shb_cluster *cluster,
                       const middle_box *box, double pixels_a_unit, double largest_w) {
    if (view->facing == 0 || !(cluster->height > 0))
        return false;
    const double *e = view->eye;
    double v[3], doubt = 0;
    for (int i = 0; i < 3; i++) {
        v[i] = view->facing * (e[i] - e[3] * box->middle[i]);
        doubt += view->eye_doubt[i] + view->eye_doubt[3] * box->reach[i];
    }
    const double largest = fmin(largest_in_cone(cluster, v), largest_in_box(cluster, v));
    const double c =
        -(largest + fabs(e[3]) * length3(box->half)) - (doubt + NORMAL_DOUBT * sqrt(squared3(v)));
    const double h = (double)cluster->height, d = SNAP_DOUBT;
    const double area = view->target->half_width * view->target->half_height;
    const double cube = largest_w * largest_w * largest_w;
    return h * area * c > (4.25 * d * pixels_a_unit + 8 * d * d / h) * cube;
}

static float nearest_sample(range depth) {
    return (float)(depth.lo - (depth.hi - depth.lo) / 32 -
                   0x1p-21 * (fabs(depth.lo) + fabs(depth.hi)));
}

shb_cluster_fate shb_cluster_look(const shb_cluster_view *view, const shb_cluster *cluster,
                                  shb_seen_cluster *seen) {
    seen->samples = view->target->samples;
    seen->nearest = -HUGE_VALF;
    seen->is_small = false;
    if (!(cluster->lo[0] == cluster->lo[0]))
        return SHB_CLUSTER_DOUBTFUL;
    const middle_box box = middle_of(cluster);
    const range x = range_in(view->rows[ROW_X], &box), y = range_in(view->rows[ROW_Y], &box);
    const range z = range_in(view->rows[ROW_Z], &box);
    const range w = view->affine ? (range){1, 1} : range_in(view->rows[ROW_W], &box);
    if (!is_sure(x) || !is_sure(y) || !is_sure(z) || !is_sure(w))
        return SHB_CLUSTER_DOUBTFUL;
    if (view->affine ? is_outside_affine(view, x, y, z) : is_outside(view, &box))
        return SHB_CLUSTER_DROPPED;
    if (!(w.lo >= 0x1p-500))
        return SHB_CLUSTER_DOUBTFUL;
    double doubt_x, doubt_y;
    const double half_width = view->target->half_width, half_height = view->target->half_height;
    const range u = project(view, &box, ROW_X, x, w.lo, &doubt_x);
    const range v = project(view, &box, ROW_Y, y, w.lo, &doubt_y);
    const window_box window = {
        .x = {u.lo * half_width + half_width, u.hi * half_width + half_width},
        .y = {half_height - v.hi * half_height, half_height - v.lo * half_height}};
    if (!(fmax(doubt_x * half_width, doubt_y * half_height) <= WINDOW_DOUBT))
        return SHB_CLUSTER_DOUBTFUL;
    double doubt_z;
    const range depth = project(view, &box, ROW_Z, z, w.lo, &doubt_z);
    const double guard = SHB_GUARD_PIXELS - 1;
    if (!is_before_eye(view, &box, z) || !(largest(window.x) <= guard) ||
        !(largest(window.y) <= guard))
        return SHB_CLUSTER_DOUBTFUL;
    const shb_samples samples = samples_in(&window);
    find_origin(&samples, seen);
    seen->samples = shb_samples_intersect(samples, view->target->samples);
    seen->nearest = nearest_sample(depth);
    if (shb_samples_are_empty(seen->samples))
        return SHB_CLUSTER_DROPPED;
    const double steep_x = half_width * (view->steep_x + largest(u) * view->steep_w);
    const double steep_y = half_height * (view->steep_y + largest(v) * view->steep_w);
    const double pixels_a_unit = sqrt(steep_x * steep_x + steep_y * steep_y) / w.lo;
    if (faces_away(view, cluster, &box, pixels_a_unit, w.hi))
        return SHB_CLUSTER_DROPPED;
    return SHB_CLUSTER_PLAIN;
}
