/* How much of an area light reaches points, by many shadow maps.
 *
 * A view is moved to a sample so that its rows x, y and w vanish there: by a translation for a
 * point, by a shear along row z for a direction. Then its window is fitted to the points. */
#include "strict.h"

#include <math.h>

#include "area_light.h"
#include "triples.h"
#include "vector.h"
#include "visibility.h"

/* Points that one task asks about. */
enum { POINTS = 4096 };

typedef struct query {
    const shb_context *context;
    const shb_area_desc *desc;
    const shb_points *points;
    shb_light_source light; /* of the given view */
    const shb_map *map;     /* of the present sample */
    uint8_t *in_sight;      /* of the given view; one a point, as the following */
    float *seen;            /* in the present map */
    float *sum;
} query;

/* A part of the clip plane, x and y over w. */
typedef struct window {
    double lo[2], hi[2];
} window;

/* ---- views ---- */

static double dot_row(const shb_mat4 *a, int row, shb_vec3 v, double w) {
    return a->m[row] * v.x + a->m[4 + row] * v.y + a->m[8 + row] * v.z + a->m[12 + row] * w;
}

/* Adds a multiple of one row to another. */
static void add_row(shb_mat4 *a, int row, int other, double factor) {
    for (int column = 0; column < 4; column++)
        a->m[4 * column + row] += factor * a->m[4 * column + other];
}

static shb_mat4 move_view(const shb_mat4 *view, const shb_light_source *from,
                          const shb_light_source *to) {
    if (from->w == 1) {
        const shb_vec3 way = vec3_subtract(from->position, to->position);
        return shb_mat4_multiply(*view, shb_mat4_translation(way.x, way.y, way.z));
    }
    const int rows[3] = {0, 1, 3};
    const double depth = dot_row(view, 2, to->position, 0);
    shb_mat4 moved = *view;
    for (int i = 0; i < 3; i++)
        add_row(&moved, rows[i], 2, -dot_row(view, rows[i], to->position, 0) / depth);
    return moved;
}

static shb_vec3 point_at(const shb_points *points, size_t index) {
    return vec3_from_floats(shb_triple_at(points->positions, points->position_stride, index));
}

static void find_in_sight(query *q) {
    const shb_mat4 *view = &q->desc->map.view.clip_from_world;
    for (size_t i = 0; i < q->points->count; i++) {
        const shb_vec3 p = point_at(q->points, i);
        const double w = dot_row(view, 3, p, 1);
        q->in_sight[i] =
            w > 0 && fabs(dot_row(view, 0, p, 1)) <= w && fabs(dot_row(view, 1, p, 1)) <= w;
    }
}

/* The smallest window around the points in sight, as a moved view sees those in front of it; the
 * whole plane if there are none. */
static window window_of_points(const query *q, const shb_mat4 *view) {
    window result = {{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}};
    for (size_t i = 0; i < q->points->count; i++) {
        const shb_vec3 p = point_at(q->points, i);
        const double w = dot_row(view, 3, p, 1);
        if (!q->in_sight[i] || !(w > 0))
            continue;
        for (int k = 0; k < 2; k++) {
            const double at = dot_row(view, k, p, 1) / w;
            result.lo[k] = at < result.lo[k] ? at : result.lo[k];
            result.hi[k] = at > result.hi[k] ? at : result.hi[k];
        }
    }
    return result.lo[0] <= result.hi[0] ? result : (window){{-1, -1}, {1, 1}};
}

/* Makes the window the whole of the view, with a margin of two texels on each side and at least one
 * of the given view, so that a single point has a map as well. */
static void fit_window(const window *part, const uint32_t size[2], shb_mat4 *view) {
    for (int k = 0; k < 2; k++) {
        const double extent = part->hi[k] - part->lo[k] > 1 ? part->hi[k] - part->lo[k] : 1;
        const double margin = 2 * extent / size[k];
        const double half = 0.5 * (part->hi[k] - part->lo[k]) + margin;
        const double middle = 0.5 * (part->hi[k] + part->lo[k]);
        add_row(view, k, 3, -middle);
        for (int column = 0; column < 4; column++)
            view->m[4 * column + k] /= half;
    }
}

/* ---- maps ---- */

static void ask_points(void *arg, size_t index) {
    const query *q = arg;
    const size_t begin = index * POINTS, left = q->points->count - begin;
    shb_points part = *q->points;
    part.count = left < POINTS ? left : POINTS;
    part.positions = shb_triple_at(part.positions, part.position_stride, begin);
    if (part.normals)
        part.normals = shb_triple_at(part.normals, part.normal_stride, begin);
    part.own = (shb_own_triangles){0};
    shb_map_visibility(q->map, &part, q->desc->bias, q->desc->filter, q->seen + begin);
    for (size_t i = begin; i < begin + part.count; i++)
        q->sum[i] += q->seen[i];
}

/* Draws the scene into the map of a sample and adds what the points see of it. */
static shb_result ask_map(query *q, shb_map *map) {
    const shb_area_desc *desc = q->desc;
    shb_result result = shb_map_draw(map, desc->scene, desc->bias, NULL);
    if (!result && desc->filter)
        result = shb_map_prepare(map, desc->filter);
    /* What can fail fails for the first point. */
    shb_points first = *q->points;
    first.own = (shb_own_triangles){0};
    first.count = first.count ? 1 : 0;
    if (!result)
        result = shb_map_visibility(map, &first, desc->bias, desc->filter, q->seen);
    if (result)
        return result;
    q->map = map;
    shb_parallel_for(q->context, ask_points, q, (q->points->count + POINTS - 1) / POINTS);
    return SHB_OK;
}

static shb_result ask_sample(shb_context *context, query *q, uint32_t index) {
    const shb_area_desc *desc = q->desc;
    const shb_light_source sample =
        shb_area_sample(&desc->area, shb_area_pattern(index, desc->samples));
    shb_map_desc map_desc = desc->map;
    shb_mat4 *view = &map_desc.view.clip_from_world;
    *view = move_view(view, &q->light, &sample);
    const window part = window_of_points(q, view);
    fit_window(
        &part,
        (uint32_t[2]){desc->map.width, desc->map.height ? desc->map.height : desc->map.width},
        view);
    shb_map *map;
    shb_result result = shb_map_create(context, &map_desc, &map);
    if (result)
        return result;
    result = ask_map(q, map);
    shb_map_destroy(map);
    return result;
}

static shb_result ask_samples(shb_context *context, query *q, float *visibility) {
    const uint32_t samples = q->desc->samples;
    find_in_sight(q);
    for (size_t i = 0; i < q->points->count; i++)
        q->sum[i] = 0;
    for (uint32_t i = 0; i < samples; i++) {
        const shb_result result = ask_sample(context, q, i);
        if (result)
            return result;
    }
    for (size_t i = 0; i < q->points->count; i++)
        visibility[i] = q->in_sight[i] ? q->sum[i] / (float)samples : 1;
    return SHB_OK;
}

/* ---- the call ---- */

static shb_result check_points(const shb_context *context, const shb_points *points,
                               const float *visibility) {
    if (points->count && !visibility)
        return shb_fail(context, SHB_ERROR_ARGUMENT, "shb_area_visibility: visibility is NULL");
    return shb_points_check(context, "shb_area_visibility", points);
}

static shb_result check_view(const shb_context *context, const shb_area_desc *desc,
                             shb_light_source *light) {
    if (shb_view_light_source(&desc->map.view, light) != SHB_OK)
        return shb_fail(context, SHB_ERROR_NUMBER,
                        "shb_area_visibility: desc.map.view has no inverse or is not finite");
    if (light->w != desc->area.light.w)
        return shb_fail(context, SHB_ERROR_ARGUMENT,
                        "shb_area_visibility: desc.area.light.w is %g and desc.map.view has %s",
                        desc->area.light.w, light->w == 1 ? "a point" : "a direction");
    return SHB_OK;
}

shb_result shb_area_visibility(shb_context *context, const shb_area_desc *desc,
                               const shb_points *points, float *visibility) {
    if (!context)
        return SHB_ERROR_ARGUMENT;
    if (!desc || !desc->scene || !points)
        return shb_fail(context, SHB_ERROR_ARGUMENT, "shb_area_visibility: %s is NULL",
                        !desc    ? "desc"
                        : points ? "desc.scene"
                                 : "points");
    query q = {.context = context, .desc = desc, .points = points};
    shb_result result = check_points(context, points, visibility);
    if (!result)
        result = shb_area_check(context, "shb_area_visibility", &desc->area, desc->samples);
    if (!result)
        result = check_view(context, desc, &q.light);
    if (result)
        return result;
    q.in_sight = shb_alloc(context, points->count, sizeof *q.in_sight);
    q.seen = shb_alloc(context, points->count, sizeof *q.seen);
    q.sum = shb_alloc(context, points->count, sizeof *q.sum);
    if (q.in_sight && q.seen && q.sum)
        result = ask_samples(context, &q, visibility);
    else
        result = shb_fail(context, SHB_ERROR_MEMORY,
                          "shb_area_visibility: no memory for %zu points", points->count);
    shb_free(context, q.in_sight);
    shb_free(context, q.seen);
    shb_free(context, q.sum);
    return result;
}
