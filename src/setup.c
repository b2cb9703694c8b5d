#include "strict.h"

#include "setup.h"

shb_target shb_target_of(uint32_t width, uint32_t height, bool reversed) {
    return (shb_target){
        .volume = shb_clip_volume_of(width, height, reversed),
        .half_width = (double)width / 2,
        .half_height = (double)height / 2,
        .samples = {0, 0, (int32_t)width - 1, (int32_t)height - 1},
    };
}

shb_samples shb_samples_intersect(shb_samples a, shb_samples b) {
    return (shb_samples){
        a.first_column > b.first_column ? a.first_column : b.first_column,
        a.first_row > b.first_row ? a.first_row : b.first_row,
        a.last_column < b.last_column ? a.last_column : b.last_column,
        a.last_row < b.last_row ? a.last_row : b.last_row,
    };
}

bool shb_samples_are_empty(shb_samples samples) {
    return samples.last_column < samples.first_column || samples.last_row < samples.first_row;
}

/* Corners of whole triangles lie within the guard band, and so do cut points but for rounding: next
 * to coordinates of 1e18 that is any distance. */
static double clamp_to_guard(double pixels) {
    const double above = pixels > -SHB_GUARD_PIXELS ? pixels : -SHB_GUARD_PIXELS;
    return above < SHB_GUARD_PIXELS ? above : SHB_GUARD_PIXELS;
}

/* Nearest even: adding 1.5 * 2^52 leaves no bit for a fraction. */
static int32_t snap(double pixels) {
    const double magic = 0x1.8p52;
    return (int32_t)((clamp_to_guard(pixels) * SHB_SUBPIXELS + magic) - magic);
}

static void project(const shb_target *target, const shb_polygon *polygon, shb_shape *shape) {
    shape->count = polygon->count;
    for (size_t i = 0; i < polygon->count; i++) {
        const double *v = polygon->corners[i].v;
        const double inverse_w = 1 / v[3];
        shape->X[i] = (v[0] * inverse_w) * target->half_width + target->half_width;
        shape->Y[i] = (v[1] * inverse_w) * -target->half_height + target->half_height;
        shape->Z[i] = v[2] * inverse_w;
        shape->snapped_x[i] = snap(shape->X[i]);
        shape->snapped_y[i] = snap(shape->Y[i]);
    }
}

/* Twice the area inside the snapped corners, exact: the fan of triangles around corner 0. */
static int64_t snapped_area(const shb_shape *shape) {
    int64_t area = 0;
    for (size_t i = 2; i < shape->count; i++) {
        const int64_t ax = (int64_t)shape->snapped_x[i - 1] - shape->snapped_x[0];
        const int64_t ay = (int64_t)shape->snapped_y[i - 1] - shape->snapped_y[0];
        const int64_t bx = (int64_t)shape->snapped_x[i] - shape->snapped_x[0];
        const int64_t by = (int64_t)shape->snapped_y[i] - shape->snapped_y[0];
        area += ax * by - bx * ay;
    }
    return area;
}

static void reverse_order(shb_shape *shape) {
    for (size_t i = 0, k = shape->count - 1; i < k; i++, k--) {
        const int32_t x = shape->snapped_x[i], y = shape->snapped_y[i];
        shape->snapped_x[i] = shape->snapped_x[k];
        shape->snapped_y[i] = shape->snapped_y[k];
        shape->snapped_x[k] = x;
        shape->snapped_y[k] = y;
    }
}

/* Rounds up to the first sample at or after the lowest coordinate, and down to the last one
 * strictly before the highest: the top-left rule covers nothing on a right or bottom end. */
static shb_samples box_of(const shb_shape *shape) {
    int32_t lo_x = shape->snapped_x[0], hi_x = lo_x, lo_y = shape->snapped_y[0], hi_y = lo_y;
    for (size_t i = 1; i < shape->count; i++) {
        const int32_t x = shape->snapped_x[i], y = shape->snapped_y[i];
        lo_x = x < lo_x ? x : lo_x;
        hi_x = x > hi_x ? x : hi_x;
        lo_y = y < lo_y ? y : lo_y;
        hi_y = y > hi_y ? y : hi_y;
    }
    return (shb_samples){(lo_x + 127) >> 8, (lo_y + 127) >> 8, (hi_x - 129) >> 8,
                         (hi_y - 129) >> 8};
}

shb_outcome shb_shape_prepare(const shb_target *target, const shb_draw_instance *instance,
                              const shb_clip_position corners[3], shb_shape *shape) {
    for (int i = 0; i < 3; i++)
        if (!shb_clip_is_finite(&corners[i]))
            return SHB_OUTCOME_NOT_FINITE;
    shb_polygon polygon;
    const shb_clip_outcome clipped = shb_clip_triangle(&target->volume, corners, &polygon);
    if (clipped == SHB_CLIP_OUTSIDE)
        return SHB_OUTCOME_CULLED;
    project(target, &polygon, shape);
    const int64_t area = snapped_area(shape);
    if (area == 0 || !(area > 0 ? instance->keep_positive : instance->keep_negative))
        return SHB_OUTCOME_CULLED;
    shape->samples = box_of(shape);
    if (shb_samples_are_empty(shb_samples_intersect(shape->samples, target->samples)))
        return SHB_OUTCOME_CULLED;
    if (area < 0)
        reverse_order(shape);
    shape->is_cut = clipped == SHB_CLIP_CUT;
    for (int i = 0; i < 3; i++)
        shape->corners[i] = corners[i];
    return SHB_OUTCOME_DRAWN;
}
