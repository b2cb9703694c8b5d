#include "strict.h"

#include "lists_frame.h"

#include "project.h"

#include <float.h>
#include <math.h>

/* The largest relative error of one operation. */
#define ROUNDING 0x1p-53

/* Roundings of a projected coordinate, in units of the sum of its products' sizes: 4 of the row's
 * product, 2 of the row itself, 12 of the corners and points in the world (ray.c), 8 of a corner
 * sheared there times a distance of up to 2, 4 of the division and of differences of coordinates;
 * the rest is to spare. */
#define PROJECTION_ROUNDING (64 * ROUNDING)

/* The largest size of what a row's product is summed up from, for points within reach. */
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

shb_result shb_list_frame_init(const shb_view *view, uint32_t width, uint32_t height,
                               shb_list_frame *frame) {
    shb_list_frame made = {.near_depth = view->reversed ? -1 : 0,
                           .width = width,
                           .height = height,
                           .levels = 1,
                           .level_size = 1};
    const shb_result result = shb_view_light_source(view, &made.light);
    if (result)
        return result;
    const shb_light_rows rows = shb_light_rows_of(view, width, height);
    for (int i = 0; i < 4; i++) {
        made.rows[0][i] = rows.x[i];
        made.rows[1][i] = rows.y[i];
        made.rows[2][i] = rows.z[i];
        made.rows[3][i] = rows.w[i];
    }
    *frame = made;
    return SHB_OK;
}

shb_list_extent shb_list_extent_none(void) {
    return (shb_list_extent){0, DBL_MAX, -DBL_MAX};
}

void shb_list_extent_add(shb_list_extent *extent, const double p[3], double z, bool is_seen) {
    for (int k = 0; k < 3; k++)
        extent->reach = fabs(p[k]) > extent->reach ? fabs(p[k]) : extent->reach;
    if (!is_seen)
        return;
    extent->nearest = z < extent->nearest ? z : extent->nearest;
    extent->farthest = z > extent->farthest ? z : extent->farthest;
}

static shb_list_extent join(size_t count, const shb_list_extent extents[]) {
    shb_list_extent all = shb_list_extent_none();
    for (size_t i = 0; i < count; i++) {
        const shb_list_extent *one = &extents[i];
        all.reach = one->reach > all.reach ? one->reach : all.reach;
        all.nearest = one->nearest < all.nearest ? one->nearest : all.nearest;
        all.farthest = one->farthest > all.farthest ? one->farthest : all.farthest;
    }
    return all;
}

/* How much a row's product with a point may change where that is rounded to floats, if no
 * coordinate is larger than size. */
static double rounding_within(const shb_list_frame *frame, int row, double size) {
    const double *r = frame->rows[row];
    return 0x1.01p-24 * (fabs(r[0]) + fabs(r[1]) + fabs(r[2])) * size;
}

double shb_list_row_rounding(const shb_list_frame *frame, int row) {
    return rounding_within(frame, row, frame->reach);
}

void shb_list_frame_fit(shb_list_frame *frame, size_t count, const shb_list_extent extents[]) {
    const shb_list_extent all = join(count, extents);
    /* Below FLT_MIN floats have no finer steps, and points are rounded as there. */
    frame->reach = all.reach > (double)FLT_MIN ? all.reach : (double)FLT_MIN;
    for (int r = 0; r < 4; r++) {
        frame->errors[r] = PROJECTION_ROUNDING * row_size(frame->rows[r], frame->reach) +
                           rounding_within(frame, r, (double)FLT_MIN);
        if (r != 2)
            frame->errors[r] += drift(frame, frame->rows[r]);
    }
    frame->rounding_z = shb_list_row_rounding(frame, 2) * (1 + 0x1p-9);
    frame->rounding_w = shb_list_row_rounding(frame, 3) * (1 + 0x1p-9);
    const double range = all.farthest - all.nearest;
    frame->level_origin = range > 0 ? all.nearest : frame->near_depth;
    frame->levels = SHB_LIST_LEVELS / (range > 0x1p-500 && range < 0x1p500 ? range : 1);
    frame->level_size = 1 / frame->levels;
}
