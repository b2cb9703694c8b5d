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

/* A box in clip space: all x, y, z and w that drawing may compute for its points, the sizes of what
 * they are summed up from and their errors. */
typedef struct clip_box {
    double lo[4], hi[4], size[4], doubt[4];
} clip_box;

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

static inline double larger(double a, double b) {
    return a > b ? a : b;
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
        for (int column = 0; column < 4; column++) {
            const double number = instance->clip_from_mesh.m[4 * column + row];
            view.rows[row][column] = view.columns[column][row] = number;
            view.column_sizes[column][row] = fabs(number);
        }
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

static clip_box image_of(const shb_cluster_view *view, const middle_box *box) {
    const double(*m)[4] = view->columns, (*sizes)[4] = view->column_sizes;
    clip_box image;
    for (int i = 0; i < 4; i++) {
        const double middle =
            ((m[0][i] * box->middle[0] + m[1][i] * box->middle[1]) + m[2][i] * box->middle[2]) +
            m[3][i];
        image.size[i] = ((sizes[0][i] * box->reach[0] + sizes[1][i] * box->reach[1]) +
                         sizes[2][i] * box->reach[2]) +
                        sizes[3][i];
        image.doubt[i] = CLIP_DOUBT * image.size[i];
        const double half = ((sizes[0][i] * box->half[0] + sizes[1][i] * box->half[1]) +
                             sizes[2][i] * box->half[2]) +
                            image.doubt[i];
        image.lo[i] = middle - half;
        image.hi[i] = middle + half;
    }
    return image;
}

static bool is_sure(const clip_box *image) {
    bool sure = true;
    for (int i = 0; i < 4; i++)
        sure &= image->lo[i] >= -CLIP_SURE && image->hi[i] <= CLIP_SURE;
    return sure;
}

/* Where w is 1 the clip coordinates' ranges tell it: a sum with 1 has its exact sign. */
static bool is_outside_affine(const shb_cluster_view *view, const clip_box *image) {
    return image->hi[ROW_X] < -1 || image->lo[ROW_X] > 1 || image->hi[ROW_Y] < -1 ||
           image->lo[ROW_Y] > 1 || image->hi[ROW_Z] < -view->target->volume.cut[0].offset;
}

static bool is_outside(const shb_cluster_view *view, const middle_box *box, const clip_box *image) {
    /* Rows are rounded sums: their sizes are those of the rows added. */
    for (int plane = 0; plane < 5; plane++) {
        const double *row = view->planes[plane];
        const double size = size_in(row, box) + image->size[ROW_W];
        if (middle_in(row, box) + half_in(row, box) < -2 * CLIP_DOUBT * size)
            return true;
    }
    return false;
}

/* True if no vertex lies behind the near plane. */
static bool is_before_eye(const shb_cluster_view *view, const middle_box *box,
                          const clip_box *image) {
    if (view->affine)
        return image->lo[ROW_Z] >= -view->target->volume.cut[0].offset;
    const double *row = view->planes[0];
    const double doubt = 2 * (image->doubt[ROW_Z] + image->doubt[ROW_W]);
    return middle_in(row, box) - (half_in(row, box) + CLIP_DOUBT * size_in(row, box)) > doubt;
}

static range widen(range r, double by) {
    return (range){r.lo - by, r.hi + by};
}

static double largest(range r) {
    return larger(fabs(r.lo), fabs(r.hi));
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

/* The quotient of a coordinate by w and its error. */
static range project(const shb_cluster_view *view, const middle_box *box, const clip_box *image,
                     int row, double *doubt) {
    *doubt = image->doubt[row];
    if (view->affine)
        return (range){image->lo[row], image->hi[row]};
    const range quotient = quotient_in(view, box, row);
    *doubt = (image->doubt[row] + largest(quotient) * image->doubt[ROW_W]) / image->lo[ROW_W];
    return widen(quotient, *doubt);
}

/* Of a place in the guard band. */
static int32_t floor_to_int(double pixels) {
    return (int32_t)(pixels + 2 * SHB_GUARD_PIXELS) - (int32_t)(2 * SHB_GUARD_PIXELS);
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

/* No normal has a larger product with v. */
static double largest_product(const shb_cluster *cluster, const double v[3]) {
    const double size[3] = {fabs(v[0]), fabs(v[1]), fabs(v[2])};
    const int first = size[0] >= size[1]   ? (size[0] >= size[2] ? 0 : 2)
                      : size[1] >= size[2] ? 1
                                           : 2;
    const int a = (first + 1) % 3, b = (first + 2) % 3;
    const int second = size[a] >= size[b] ? a : b, third = 3 - first - second;
    const int order[3] = {first, second, third};
    int direction[3] = {0, 0, 0};
    double sum = 0;
    for (int i = 0; i < 3; i++) {
        const double next = i < 2 ? size[order[i + 1]] : 0;
        direction[order[i]] = v[order[i]] < 0 ? -1 : 1;
        sum += (size[order[i]] - next) *
               cluster->largest[shb_direction(direction[0], direction[1], direction[2])];
    }
    return sum / SHB_NORMAL_UNIT;
}

/* A bound of them, from x / w and y / w. */
static double pixels_a_unit(const shb_cluster_view *view, range x, range y, double least_w) {
    const double steep_x = view->target->half_width * (view->steep_x + largest(x) * view->steep_w);
    const double steep_y = view->target->half_height * (view->steep_y + largest(y) * view->steep_w);
    return sqrt(steep_x * steep_x + steep_y * steep_y) / least_w;
}

/* True if every triangle of the cluster faces the way that is dropped, (1). */
static bool faces_away(const shb_cluster_view *view, const shb_cluster *cluster,
                       const middle_box *box, double pixels, double largest_w) {
    const double *e = view->eye;
    double v[3], doubt = 0;
    for (int i = 0; i < 3; i++) {
        v[i] = view->facing * (e[i] - e[3] * box->middle[i]);
        doubt += view->eye_doubt[i] + view->eye_doubt[3] * box->reach[i];
    }
    const double c = -(largest_product(cluster, v) + fabs(e[3]) * length3(box->half)) -
                     (doubt + NORMAL_DOUBT * sqrt(squared3(v)));
    const double h = (double)cluster->height, d = SNAP_DOUBT;
    const double area = view->target->half_width * view->target->half_height;
    const double cube = largest_w * largest_w * largest_w;
    return h * area * c > (4.25 * d * pixels + 8 * d * d / h) * cube;
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
    const clip_box image = image_of(view, &box);
    if (!is_sure(&image))
        return SHB_CLUSTER_DOUBTFUL;
    if (view->affine ? is_outside_affine(view, &image) : is_outside(view, &box, &image))
        return SHB_CLUSTER_DROPPED;
    if (!(image.lo[ROW_W] >= 0x1p-500))
        return SHB_CLUSTER_DOUBTFUL;
    double doubt_x, doubt_y, doubt_z;
    const double half_width = view->target->half_width, half_height = view->target->half_height;
    const range x = project(view, &box, &image, ROW_X, &doubt_x);
    const range y = project(view, &box, &image, ROW_Y, &doubt_y);
    const range z = project(view, &box, &image, ROW_Z, &doubt_z);
    const window_box window = {
        .x = {x.lo * half_width + half_width, x.hi * half_width + half_width},
        .y = {half_height - y.hi * half_height, half_height - y.lo * half_height}};
    if (!(doubt_x * half_width <= WINDOW_DOUBT && doubt_y * half_height <= WINDOW_DOUBT))
        return SHB_CLUSTER_DOUBTFUL;
    const double guard = SHB_GUARD_PIXELS - 1;
    if (!is_before_eye(view, &box, &image) || !(largest(window.x) <= guard) ||
        !(largest(window.y) <= guard))
        return SHB_CLUSTER_DOUBTFUL;
    const shb_samples samples = samples_in(&window);
    find_origin(&samples, seen);
    seen->samples = shb_samples_intersect(samples, view->target->samples);
    seen->nearest = nearest_sample(z);
    if (shb_samples_are_empty(seen->samples))
        return SHB_CLUSTER_DROPPED;
    if (view->facing != 0 && cluster->height > 0 &&
        faces_away(view, cluster, &box, pixels_a_unit(view, x, y, image.lo[ROW_W]),
                   image.hi[ROW_W]))
        return SHB_CLUSTER_DROPPED;
    return SHB_CLUSTER_PLAIN;
}
