#include "strict.h"

#include "backprojection.h"

#include <float.h>
#include <string.h>

#include "filter_check.h"
#include "kernels/moments.h"
#include "kernels/shade.h"

static shb_result check_params(const shb_map *map, const shb_filter *filter) {
    const float *params = filter->params;
    const shb_result result =
        shb_filter_check_param(map, filter, "light", params[SHB_PARAM_LIGHT], FLT_MIN, FLT_MAX);
    return result != SHB_OK
               ? result
               : shb_filter_check_param(map, filter, "window", params[SHB_PARAM_WINDOW],
                                        SHB_WINDOW_MIN, SHB_WINDOW_MAX);
}

/* NULL: no memory. */
static shb_backprojection *create(const shb_map *map, const shb_filter *filter) {
    shb_backprojection *made = shb_alloc(map->context, 1, sizeof *made);
    if (!made)
        return NULL;
    made->window = (int)filter->params[SHB_PARAM_WINDOW];
    if (shb_light_span_create(map, filter->params[SHB_PARAM_LIGHT], &made->span))
        return made;
    shb_free(map->context, made);
    return NULL;
}

shb_result shb_backprojection_prepare(const shb_map *map, const shb_filter *filter, void **prepared,
                                      size_t *bytes) {
    const shb_result result = check_params(map, filter);
    if (result != SHB_OK)
        return result;
    shb_backprojection *made = *prepared ? *prepared : create(map, filter);
    if (!made)
        return shb_filter_no_memory(map, filter);
    shb_light_span_fill(map, &made->span);
    *prepared = made;
    *bytes = sizeof *made + made->span.minima.bytes;
    return SHB_OK;
}

void shb_backprojection_release(const shb_map *map, void *prepared) {
    shb_backprojection *made = prepared;
    shb_light_span_destroy(map, &made->span);
    shb_free(map->context, made);
}

/* ---- the window ---- */

static int32_t larger(int32_t a, int32_t b) {
    return a > b ? a : b;
}

/* Cuts the window into quads, whose borders are multiples of the stride in the map. */
static void set_quads(shb_quad_window *w, const shb_light_windows *windows, size_t index) {
    const int32_t x0 = windows->x0[index], x1 = windows->x1[index];
    const int32_t y0 = windows->y0[index], y1 = windows->y1[index];
    const int32_t most = w->projection->window;
    const int32_t side = larger(x1 - x0, y1 - y0) + 1;
    w->stride = (side + most - 1) / most;
    w->first_x = x0 / w->stride;
    w->first_y = y0 / w->stride;
    w->columns = x1 / w->stride - w->first_x + 1;
    w->rows = y1 / w->stride - w->first_y + 1;
}

/* One over the difference of depth to the fragment, where a quad's middle texel is in front of the
 * fragment's plane; 0 elsewhere. */
static void read_inverses(const shb_quad_window *w, int32_t quad_y, float *inverses) {
    const float near_depth = w->projection->span.near_depth;
    const size_t count = (size_t)w->columns;
    const int32_t row = quad_y * w->stride + w->stride / 2;
    const float plane = w->ref + (float)(row - w->texel_y) * w->step_y;
    int32_t columns[SHB_WINDOW_BUFFER] = {0}, rows[SHB_WINDOW_BUFFER] = {0};
    float depths[SHB_WINDOW_BUFFER];
    for (size_t i = 0; i < count; i++) {
        columns[i] = (w->first_x + (int32_t)i) * w->stride + w->stride / 2;
        rows[i] = row;
    }
    w->map->context->shade_kernels->fetch(w->map, count, columns, rows, depths);
    for (size_t i = 0; i < count; i++) {
        const float limit = plane + (float)(columns[i] - w->texel_x) * w->step_x;
        const float depth = depths[i] > near_depth ? depths[i] : near_depth;
        const float difference = w->depth - depth;
        const bool blocks = (depths[i] < limit) & (difference > 0);
        inverses[i] = blocks ? 1 / difference : 0;
    }
}

void shb_quad_windows_find(const shb_filter_args *args, shb_light_windows *windows) {
    const shb_backprojection *projection = args->prepared;
    shb_moment_kernels_in(args)->windows(args->map, &projection->span, args->count, args->receivers,
                                         windows);
}

bool shb_quad_window_open(const shb_filter_args *args, const shb_light_windows *windows,
                          size_t index, shb_quad_window *window) {
    const shb_receivers *receivers = args->receivers;
    shb_quad_window *w = window;
    if (windows->nearest[index] >= windows->depth[index])
        return false;
    w->projection = args->prepared;
    w->map = args->map;
    w->texel_x = receivers->texel_x[index];
    w->texel_y = receivers->texel_y[index];
    w->ref = receivers->ref[index];
    w->step_x = receivers->step_x[index];
    w->step_y = receivers->step_y[index];
    w->x = windows->x[index];
    w->y = windows->y[index];
    w->depth = windows->depth[index];
    set_quads(w, windows, index);
    memset(w->here, 0, (size_t)w->columns * sizeof *w->here);
    return true;
}

/* ---- quads ---- */

/* A place on the light, counted from its middle in its widths, in parts from its side. */
static inline int32_t part_of_light(float from_middle, float parts) {
    const float part = (from_middle + 0.5f) * parts + 0.5f;
    const float at_most = part < parts ? part : parts;
    return (int32_t)(at_most > 0 ? at_most : 0);
}

/* Where a quad begins on the light: at the side of its neighbour if there is a gap between two that
 * block. */
static inline float begin_of(float side, float inverse, float neighbour) {
    const bool both = (inverse > 0) & (neighbour > 0);
    const float own = side * inverse, other = side * (both ? neighbour : inverse);
    return other < own ? other : own;
}

static bool all_are_zero(const float *values, size_t count) {
    float sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += values[i];
    return sum == 0;
}

bool shb_quad_window_read(shb_quad_window *window, int32_t row, float parts, shb_quad_row *quads) {
    shb_quad_window *w = window;
    const size_t count = (size_t)w->columns;
    memcpy(w->above, w->here, count * sizeof *w->here);
    const int32_t quad_y = w->first_y + row;
    read_inverses(w, quad_y, w->here);
    if (all_are_zero(w->here, count))
        return false;
    const int32_t stride = w->stride;
    const float unit_x = 1 / w->projection->span.x, unit_y = 1 / w->projection->span.y;
    const float top = ((float)(quad_y * stride) - w->y) * unit_y;
    const float bottom = ((float)((quad_y + 1) * stride) - w->y) * unit_y;
    for (size_t i = 0; i < count; i++) {
        const int32_t quad_x = w->first_x + (int32_t)i;
        const float left = ((float)(quad_x * stride) - w->x) * unit_x;
        const float right = ((float)((quad_x + 1) * stride) - w->x) * unit_x;
        const float inverse = w->here[i], before = i > 0 ? w->here[i - 1] : 0;
        quads->x0[i] = part_of_light(begin_of(left, inverse, before), parts);
        quads->x1[i] = part_of_light(right * inverse, parts);
        quads->y0[i] = part_of_light(begin_of(top, inverse, w->above[i]), parts);
        quads->y1[i] = part_of_light(bottom * inverse, parts);
    }
    return true;
}
