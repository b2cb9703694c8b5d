/* Points of a host, batch by batch. */
#include "exact.h"
#include "exact_lists.h"
#include "exact_triangles.h"
#include "kernels/shade.h"
#include "kernels/sheets.h"
#include "lists.h"
#include "packed_points.h"
#include "project.h"
#include "triples.h"
#include "visibility.h"

#include <string.h>

/* Copies triples of a strided array from element first on; the last one fills up the lanes. */
static void load(const shb_shade_kernels *kernels, const float *base, size_t stride, size_t first,
                 size_t count, float *x, float *y, float *z) {
    const char *bytes = (const char *)base + first * stride;
    if (stride == 3 * sizeof *base) {
        kernels->load((const float *)bytes, count, x, y, z);
        return;
    }
    const size_t lanes = shb_round_to_lanes(count);
    for (size_t i = 0; i < lanes; i++) {
        const float *triple = (const float *)(bytes + (i < count ? i : count - 1) * stride);
        x[i] = triple[0];
        y[i] = triple[1];
        z[i] = triple[2];
    }
}

/* A batch of positions and, if wanted, normals. */
static void load_points(const shb_map *map, const shb_points *points, size_t first, size_t count,
                        bool with_normals, shb_receivers *to) {
    const shb_shade_kernels *kernels = map->context->shade_kernels;
    load(kernels, points->positions, shb_triple_stride(points->position_stride), first, count,
         to->x, to->y, to->z);
    if (with_normals)
        load(kernels, points->normals, shb_triple_stride(points->normal_stride), first, count,
             to->normal_x, to->normal_y, to->normal_z);
}

static shb_own_triangles own_from(const shb_own_triangles *own, size_t first) {
    return (shb_own_triangles){own->ids ? own->ids + first : NULL,
                               own->weight_1 ? own->weight_1 + first : NULL,
                               own->weight_2 ? own->weight_2 + first : NULL};
}

static shb_next_batch next_batch_of(const shb_points *points, bool with_normals, size_t first,
                                    float *visibility) {
    const size_t position_stride = shb_triple_stride(points->position_stride);
    const size_t normal_stride = shb_triple_stride(points->normal_stride);
    const char *positions = (const char *)points->positions + first * position_stride;
    const char *normals =
        with_normals ? (const char *)points->normals + first * normal_stride : NULL;
    return (shb_next_batch){positions, normals, position_stride, normal_stride, visibility + first};
}

static shb_result check_points(const shb_map *map, const shb_points *points,
                               const float *visibility) {
    if (!points || !visibility)
        return shb_fail(map->context, SHB_ERROR_ARGUMENT, "shb_map_visibility: %s is NULL",
                        points ? "visibility" : "points");
    return shb_points_check(map->context, "shb_map_visibility", points);
}

/* Loads a batch as the exact method asks about it, and asks for the memory of the next one. */
static void load_exact(const shb_map *map, const shb_points *points, size_t first,
                       float *visibility, shb_exact_points *exact) {
    const size_t left = points->count - first, count = left < SHB_BATCH ? left : SHB_BATCH;
    const shb_own_triangles own = own_from(&points->own, first);
    shb_receivers batch;
    load_points(map, points, first, count, false, &batch);
    if (left >= 2 * SHB_BATCH) {
        const shb_next_batch next = next_batch_of(points, false, first + SHB_BATCH, visibility);
        shb_prefetch_whole(&next);
    }
    shb_exact_points_of(map, count, &own, &batch, exact);
}

/* What shb_exact_visibility answers where the map keeps lists and sheets. */
static void ask_unsure_lists(const shb_map *map, const shb_points *points, float *visibility) {
    shb_exact_points exact;
    shb_unsure_points unsure;
    shb_unsure_points_begin(map, visibility, &unsure);
    for (size_t first = 0; first < points->count; first += SHB_BATCH) {
        load_exact(map, points, first, visibility, &exact);
        shb_unsure_points_ask(&unsure, &exact, first);
    }
    shb_unsure_points_end(&unsure);
}

/* What shb_exact_visibility answers where the map keeps triangles. */
static void ask_triangles(const shb_map *map, const shb_points *points, float *visibility) {
    const float *position = points->positions, *normal = points->normals;
    const size_t position_stride = shb_triple_stride(points->position_stride);
    const size_t normal_stride = shb_triple_stride(points->normal_stride);
    const shb_walk_places places = {{position, position + 1, position + 2},
                                    {normal, normal + 1, normal + 2},
                                    position_stride / sizeof *position,
                                    normal_stride / sizeof *normal};
    shb_exact_points exact;
    shb_triangle_points asked;
    shb_triangle_points_begin(map, &places, visibility, &asked);
    for (size_t first = 0; first < points->count; first += SHB_BATCH) {
        load_exact(map, points, first, visibility, &exact);
        shb_triangle_points_ask(&asked, &exact, first);
    }
    shb_triangle_points_end(&asked);
}

/* Any method and filter. */
static void ask_batches(const shb_map *map, const shb_points *points, const shb_bias *bias,
                        const shb_filter *filter, float *visibility) {
    const shb_filter hard = shb_filter_hard();
    const bool with_normals = shb_visibility_needs_normals(map, bias, filter);
    shb_receivers receivers;
    const shb_quick_points arrays = shb_quick_points_of(&receivers);
    SHB_ALIGN float answers[SHB_BATCH];
    shb_quick_test test = {.known = false};
    shb_packed_points packed;
    const bool is_packed = shb_packed_points_init(&packed, map, points, bias, filter, visibility);
    for (size_t first = 0; first < points->count; first += SHB_BATCH) {
        const size_t left = points->count - first;
        const size_t count = left < SHB_BATCH ? left : SHB_BATCH;
        const bool is_tried = is_packed && count == SHB_BATCH;
        if (is_tried && shb_packed_points_ask(&packed, first))
            continue;
        load_points(map, points, first, count, with_normals, &receivers);
        const bool is_followed = left >= 2 * SHB_BATCH;
        const shb_next_batch next = next_batch_of(
            points, with_normals, is_followed ? first + SHB_BATCH : first, visibility);
        const shb_own_triangles own = own_from(&points->own, first);
        const shb_asked_batch batch = {count, false, &own, is_followed ? &next : NULL};
        if (is_tried)
            shb_visibility_in_full(map, bias, &hard, &batch, &receivers, answers);
        else
            shb_visibility_batch(map, bias, filter ? filter : &hard, &batch, &arrays, &test,
                                 &receivers, answers);
        memcpy(visibility + first, answers, count * sizeof *visibility);
    }
    shb_packed_points_end(&packed);
}

shb_result shb_map_visibility(const shb_map *map, const shb_points *points, const shb_bias *bias,
                              const shb_filter *filter, float *visibility) {
    if (!map)
        return SHB_ERROR_ARGUMENT;
    shb_result result = check_points(map, points, visibility);
    if (result == SHB_OK)
        result = shb_visibility_check(map, "shb_map_visibility", bias, filter,
                                      points->normals || points->count == 0);
    if (result == SHB_OK && bias->needs & SHB_NEEDS_OCCLUDERS)
        result = shb_own_triangles_check(map, "shb_map_visibility", points);
    if (result != SHB_OK)
        return result;
    const bool exact = points->count && shb_exact_is_hard(bias, filter);
    if (exact && !map->classifies && shb_map_holds(map, SHB_OCCLUDERS_TRIANGLES))
        ask_triangles(map, points, visibility);
    else if (exact && map->classifies && shb_map_holds(map, SHB_OCCLUDERS_LISTS) &&
             !points->own.ids)
        ask_unsure_lists(map, points, visibility);
    else
        ask_batches(map, points, bias, filter, visibility);
    return SHB_OK;
}

shb_result shb_map_classify(const shb_map *map, const shb_points *points, uint8_t *answers) {
    if (!map)
        return SHB_ERROR_ARGUMENT;
    const shb_context *context = map->context;
    if (!points || !answers)
        return shb_fail(context, SHB_ERROR_ARGUMENT, "shb_map_classify: %s is NULL",
                        points ? "answers" : "points");
    const shb_result result = shb_points_check(context, "shb_map_classify", points);
    if (result != SHB_OK)
        return result;
    if (!map->classifies)
        return shb_fail(context, SHB_ERROR_UNSUPPORTED,
                        "shb_map_classify: the map was created without desc.classifies");
    const shb_sheet_kernels *kernels = shb_sheet_kernels_of(context->isa);
    shb_receivers receivers;
    SHB_ALIGN int32_t batch[SHB_BATCH];
    for (size_t first = 0; first < points->count; first += SHB_BATCH) {
        const size_t left = points->count - first;
        const size_t count = left < SHB_BATCH ? left : SHB_BATCH;
        load_points(map, points, first, count, false, &receivers);
        if (map->empty)
            memset(batch, 0, sizeof batch);
        else
            kernels->ask(shb_map_sheets(map), count, receivers.x, receivers.y, receivers.z, batch);
        for (size_t i = 0; i < count; i++)
            answers[first + i] = (uint8_t)batch[i];
    }
    return SHB_OK;
}
