#include "strict.h"

#include "backprojection.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "format.h"
#include "kernels/shade.h"
#include "moment_map.h"

/* Keeps products of spans, depths and texels within floats. */
#define SPAN_LIMIT 0x1p60

/* The nearest texel of a window makes it smaller, and that its nearest texel farther. */
enum { NARROWINGS = 3 };

static float limited_span(double span) {
    const double at_most = span < SPAN_LIMIT ? span : SPAN_LIMIT;
    return (float)(at_most > 1 / SPAN_LIMIT ? at_most : 1 / SPAN_LIMIT);
}

/* q, the clip distance being counted as row w does. */
static double depth_per_inverse(const shb_projection *p) {
    const double *w = p->row_w;
    const double length = sqrt((w[0] * w[0] + w[1] * w[1]) + w[2] * w[2]);
    return p->depth_scale / (length > 0 ? length : w[3]);
}

static shb_result check_params(const shb_map *map, const shb_filter *filter) {
    const float *params = filter->params;
    const shb_result result =
        shb_filter_check_param(map, filter, "light", params[SHB_PARAM_LIGHT], FLT_MIN, FLT_MAX);
    return result != SHB_OK
               ? result
               : shb_filter_check_param(map, filter, "window", params[SHB_PARAM_WINDOW],
                                        SHB_WINDOW_MIN, SHB_WINDOW_MAX);
}

shb_result shb_backprojection_prepare(const shb_map *map, const shb_filter *filter, void **prepared,
                                      size_t *bytes) {
    const shb_result result = check_params(map, filter);
    if (result != SHB_OK)
        return result;
    const shb_projection *p = &map->projection;
    const double span = (double)filter->params[SHB_PARAM_LIGHT] / depth_per_inverse(p);
    const bool reversed = map->info.view.reversed;
    shb_backprojection *made = shb_alloc(map->context, 1, sizeof *made);
    if (made)
        *made = (shb_backprojection){.near_depth = reversed ? -1.0f : 0.0f,
                                     .far_depth = shb_far_depth(reversed),
                                     .span_x = limited_span(span / p->texel_width),
                                     .span_y = limited_span(span / p->texel_height),
                                     .window = (int)filter->params[SHB_PARAM_WINDOW]};
    if (!made || !shb_depth_minima_create(map, &made->minima)) {
        shb_free(map->context, made);
        return shb_fail(map->context, SHB_ERROR_MEMORY,
                        "shb_map_prepare: no memory for the filter \"%s\" over %u by %u texels",
                        filter->name, (unsigned)map->info.width, (unsigned)map->info.height);
    }
    *prepared = made;
    *bytes = sizeof *made + made->minima.bytes;
    return SHB_OK;
}

void shb_backprojection_release(const shb_map *map, void *prepared) {
    shb_backprojection *made = prepared;
    shb_depth_minima_destroy(map, &made->minima);
    shb_free(map->context, made);
}

/* ---- the window ---- */

/* The texel that holds a place, or the map's first or last one. */
static int32_t texel_at(float place, uint32_t size) {
    const float last = (float)(size - 1);
    const float at_most = place < last ? place : last;
    return (int32_t)(at_most > 0 ? at_most : 0);
}

/* The texels within half of the light's span for a blocker so much nearer than the fragment. */
static shb_texel_box box_around(const shb_quad_window *w, float nearer_by) {
    const uint32_t width = w->map->info.width, height = w->map->info.height;
    const float x = ((float)w->texel_x + 0.5f) - w->to_center_x;
    const float y = ((float)w->texel_y + 0.5f) - w->to_center_y;
    const float reach_x = 0.5f * w->projection->span_x * nearer_by;
    const float reach_y = 0.5f * w->projection->span_y * nearer_by;
    return (shb_texel_box){texel_at(x - reach_x, width), texel_at(y - reach_y, height),
                           texel_at(x + reach_x, width), texel_at(y + reach_y, height)};
}

static int32_t larger(int32_t a, int32_t b) {
    return a > b ? a : b;
}

/* Cuts the box into quads, whose borders are multiples of the stride in the map. */
static void set_quads(shb_quad_window *w, const shb_texel_box *box) {
    const int32_t most = w->projection->window;
    const int32_t side = larger(box->x1 - box->x0, box->y1 - box->y0) + 1;
    w->stride = (side + most - 1) / most;
    w->first_x = box->x0 / w->stride;
    w->first_y = box->y0 / w->stride;
    w->columns = box->x1 / w->stride - w->first_x + 1;
    w->rows = box->y1 / w->stride - w->first_y + 1;
}

/* One over the difference of depth to the fragment, where a quad's middle texel is in front of the
 * fragment's plane; 0 elsewhere. */
static void read_inverses(const shb_quad_window *w, int32_t quad_y, float *inverses) {
    const shb_backprojection *p = w->projection;
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
        const float depth = depths[i] > p->near_depth ? depths[i] : p->near_depth;
        const float difference = w->depth - depth;
        const bool blocks = (depths[i] < limit) & (difference > 0);
        inverses[i] = blocks ? 1 / difference : 0;
    }
}

bool shb_quad_window_open(const shb_backprojection *projection, const shb_map *map,
                          const shb_receivers *receivers, size_t index, shb_quad_window *window) {
    const shb_receivers *r = receivers;
    shb_quad_window *w = window;
    w->projection = projection;
    w->map = map;
    w->texel_x = r->texel_x[index];
    w->texel_y = r->texel_y[index];
    if ((uint32_t)w->texel_x >= map->info.width || (uint32_t)w->texel_y >= map->info.height)
        return false;
    w->to_center_x = r->to_center_x[index];
    w->to_center_y = r->to_center_y[index];
    w->ref = r->ref[index];
    w->step_x = r->step_x[index];
    w->step_y = r->step_y[index];
    const float own = w->ref - (w->step_x * w->to_center_x + w->step_y * w->to_center_y);
    w->depth = own < projection->far_depth ? own : projection->far_depth;
    if (!(own > projection->near_depth))
        return false;
    float nearest = projection->near_depth;
    shb_texel_box box = {0, 0, 0, 0};
    for (int i = 0; i < NARROWINGS; i++) {
        box = box_around(w, w->depth - nearest);
        nearest = shb_depth_minima_over(&projection->minima, &box);
        if (!(nearest < w->depth))
            return false;
    }
    box = box_around(w, w->depth - nearest);
    set_quads(w, &box);
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
    const float to_x = w->to_center_x - 0.5f, to_y = w->to_center_y - 0.5f;
    const float unit_x = 1 / w->projection->span_x, unit_y = 1 / w->projection->span_y;
    const float top = ((float)(quad_y * stride - w->texel_y) + to_y) * unit_y;
    const float bottom = ((float)((quad_y + 1) * stride - w->texel_y) + to_y) * unit_y;
    for (size_t i = 0; i < count; i++) {
        const int32_t quad_x = w->first_x + (int32_t)i;
        const float left = ((float)(quad_x * stride - w->texel_x) + to_x) * unit_x;
        const float right = ((float)((quad_x + 1) * stride - w->texel_x) + to_x) * unit_x;
        const float inverse = w->here[i], before = i > 0 ? w->here[i - 1] : 0;
        quads->x0[i] = part_of_light(begin_of(left, inverse, before), parts);
        quads->x1[i] = part_of_light(right * inverse, parts);
        quads->y0[i] = part_of_light(begin_of(top, inverse, w->above[i]), parts);
        quads->y1[i] = part_of_light(bottom * inverse, parts);
    }
    return true;
}
