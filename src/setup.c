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

/* Nearest even: adding 1.5 * 2^52 leaves no bit for a fraction. */
static int32_t snap(double pixels) {
    const double magic = 0x1.8p52;
    return (int32_t)((pixels * SHB_SUBPIXELS + magic) - magic);
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

/* Twice the area of the triangle of three corners, exact. */
static int64_t fan_area(const shb_shape *shape, size_t a, size_t b, size_t c) {
    const int64_t bx = (int64_t)shape->snapped_x[b] - shape->snapped_x[a];
    const int64_t by = (int64_t)shape->snapped_y[b] - shape->snapped_y[a];
    const int64_t cx = (int64_t)shape->snapped_x[c] - shape->snapped_x[a];
    const int64_t cy = (int64_t)shape->snapped_y[c] - shape->snapped_y[a];
    return bx * cy - cx * by;
}

static int64_t shape_area(const shb_shape *shape) {
    int64_t area = 0;
    for (size_t i = 2; i < shape->count; i++)
        area += fan_area(shape, 0, i - 1, i);
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

/* Snapping can bend a cut polygon slightly inwards. A fan from a corner that sees all others has no
 * negative triangle and covers each sample of the polygon once; where no corner does, fan triangles
 * may overlap. */
static size_t choose_apex(const shb_shape *shape) {
    for (size_t apex = 0; apex < shape->count; apex++) {
        bool sees_all = true;
        for (size_t i = 1; i + 1 < shape->count; i++)
            sees_all &= fan_area(shape, apex, (apex + i) % shape->count,
                                 (apex + i + 1) % shape->count) >= 0;
        if (sees_all)
            return apex;
    }
    return 0;
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
    const int64_t area = shape_area(shape);
    if (area == 0 || !(area > 0 ? instance->keep_positive : instance->keep_negative))
        return SHB_OUTCOME_CULLED;
    shape->samples = box_of(shape);
    if (shb_samples_are_empty(shb_samples_intersect(shape->samples, target->samples)))
        return SHB_OUTCOME_CULLED;
    if (area < 0)
        reverse_order(shape);
    shape->is_cut = clipped == SHB_CLIP_CUT;
    shape->apex = shape->is_cut ? choose_apex(shape) : 0;
    for (int i = 0; i < 3; i++)
        shape->corners[i] = corners[i];
    return SHB_OUTCOME_DRAWN;
}
