#include "visibility.h"

#include "exact.h"
#include "exact_lists.h"
#include "exact_triangles.h"
#include "kernels/shade.h"
#include "kernels/sheets.h"
#include "lists.h"
#include "packed_points.h"
#include "prepare.h"
#include "project.h"
#include "stages.h"
#include "triples.h"

#include <string.h>

/* Lists answer by positions alone. */
static bool needs_normals(const shb_map *map, const shb_bias *bias, const shb_filter *filter) {
    const bool by_planes =
        bias->needs & SHB_NEEDS_OCCLUDERS && map->info.occluders != SHB_OCCLUDERS_LISTS;
    const uint32_t needs = bias->needs | (filter ? filter->needs : 0);
    return by_planes || needs & (SHB_NEEDS_NORMAL | SHB_NEEDS_SLOPE);
}

static const char *name_or_unnamed(const char *name) {
    return name ? name : "unnamed";
}

static const char *name_of(const shb_bias *bias) {
    return name_or_unnamed(bias->name);
}

/* True if the map's depths are those that the method works on. */
static bool map_serves(const shb_map *map, const shb_bias *bias) {
    if (map->empty)
        return true;
    const bool flipped = (bias->needs & SHB_NEEDS_FLIPPED) != 0;
    if (map->combine != bias->combine || map->flipped != flipped)
        return false;
    return !bias->combine || (map->combine_user == bias->user &&
                              memcmp(map->combine_params, bias->params, sizeof bias->params) == 0);
}

static shb_result check_occluders(const shb_map *map, const char *caller, const shb_bias *bias,
                                  const shb_filter *filter) {
    if (!map->info.occluders && !map->empty)
        return shb_fail(map->context, SHB_ERROR_UNSUPPORTED,
                        "%s: the method \"%s\" needs a map that was created with desc.occluders",
                        caller, name_of(bias));
    if (!map->empty && !map->occluders.held)
        return shb_fail(map->context, SHB_ERROR_UNSUPPORTED,
                        "%s: the method \"%s\" needs occluders and the map was drawn for another",
                        caller, name_of(bias));
    if (filter && !filter->exact)
        return shb_fail(map->context, SHB_ERROR_UNSUPPORTED,
                        "%s: the method \"%s\" asks occluders, which the filter \"%s\" cannot",
                        caller, name_of(bias), name_or_unnamed(filter->name));
    if (filter && filter->needs & SHB_NEEDS_SAMPLES && map->info.occluders == SHB_OCCLUDERS_LISTS)
        return shb_fail(map->context, SHB_ERROR_UNSUPPORTED,
                        "%s: the filter \"%s\" asks the occluder of each texel, and "
                        "desc.occluders of the map are lists",
                        caller, name_or_unnamed(filter->name));
    return SHB_OK;
}

static shb_result check_filter(const shb_map *map, const char *caller, const shb_filter *filter) {
    const uint32_t known = SHB_NEEDS_NORMAL | SHB_NEEDS_SCALE | SHB_NEEDS_SLOPE |
                           SHB_NEEDS_PREPARED | SHB_NEEDS_SAMPLES;
    if (!filter->filter)
        return shb_fail(map->context, SHB_ERROR_ARGUMENT, "%s: filter.filter is NULL", caller);
    if (filter->needs & ~known)
        return shb_fail(map->context, SHB_ERROR_ARGUMENT, "%s: filter.needs 0x%x has unknown bits",
                        caller, (unsigned)filter->needs);
    if (filter->needs & SHB_NEEDS_PREPARED && !shb_prepared_find(map, filter))
        return shb_fail(map->context, SHB_ERROR_UNSUPPORTED,
                        "%s: the filter \"%s\" needs shb_map_prepare after the map was drawn",
                        caller, name_or_unnamed(filter->name));
    return SHB_OK;
}

shb_result shb_visibility_check(const shb_map *map, const char *caller, const shb_bias *bias,
                                const shb_filter *filter, bool has_normals) {
    const shb_context *context = map->context;
    const uint32_t known = SHB_NEEDS_NORMAL | SHB_NEEDS_SCALE | SHB_NEEDS_SLOPE |
                           SHB_NEEDS_FLIPPED | SHB_NEEDS_OCCLUDERS;
    if (!bias)
        return shb_fail(context, SHB_ERROR_ARGUMENT, "%s: bias is NULL", caller);
    if (bias->needs & ~known)
        return shb_fail(context, SHB_ERROR_ARGUMENT, "%s: bias.needs 0x%x has unknown bits", caller,
                        (unsigned)bias->needs);
    const shb_result result = filter ? check_filter(map, caller, filter) : SHB_OK;
    if (result != SHB_OK)
        return result;
    if (needs_normals(map, bias, filter) && !has_normals)
        return shb_fail(context, SHB_ERROR_UNSUPPORTED,
                        "%s: the method \"%s\" or the filter needs normals and points.normals is "
                        "NULL",
                        caller, name_of(bias));
    if (map->exact_only && !(bias->needs & SHB_NEEDS_OCCLUDERS))
        return shb_fail(context, SHB_ERROR_UNSUPPORTED,
                        "%s: the method \"%s\" needs depths, and the map was created with "
                        "desc.exact_only",
                        caller, name_of(bias));
    if (!map_serves(map, bias))
        return shb_fail(context, SHB_ERROR_UNSUPPORTED,
                        "%s: the method \"%s\" needs a map that was drawn for it with the same "
                        "parameters",
                        caller, name_of(bias));
    return bias->needs & SHB_NEEDS_OCCLUDERS ? check_occluders(map, caller, bias, filter) : SHB_OK;
}

/* What a map that was never drawn says, which keeps no occluders. */
static void light_all(size_t count, float *visibility) {
    for (size_t i = 0; i < shb_round_to_lanes(count); i++)
        visibility[i] = 1;
}

static void prefetch_whole(const shb_next_batch *next) {
    for (size_t i = 0; i < SHB_BATCH; i += SHB_LINE_FLOATS)
        shb_prefetch_next(next, i);
}

void shb_visibility_in_full(const shb_map *map, const shb_bias *bias, const shb_filter *filter,
                            size_t count, bool lifted, const shb_own_triangles *own,
                            const shb_next_batch *next, shb_receivers *receivers,
                            float *visibility) {
    const shb_shade_kernels *kernels = map->context->shade_kernels;
    const shb_bias_args bias_args = {count, bias, &map->info, receivers, kernels};
    const shb_filter_args filter_args = {
        count,     filter,     map,    &map->info,
        receivers, visibility, lifted, shb_prepared_find(map, filter),
        own};

    if (bias->needs & SHB_NEEDS_OCCLUDERS) {
        prefetch_whole(next);
        if (map->occluders.held)
            filter->exact(&filter_args);
        else
            light_all(count, visibility);
        return;
    }
    const uint32_t needs = bias->needs | filter->needs;
    kernels->project(map, needs, count, next, receivers);
    if (needs & SHB_NEEDS_NORMAL)
        kernels->normals(&map->projection, count, receivers);
    if (bias->offset) {
        bias->offset(&bias_args);
        kernels->project(map, 0, count, NULL, receivers);
    }
    if (bias->depth)
        bias->depth(&bias_args);
    else
        kernels->own_depth(count, receivers);
    filter->filter(&filter_args);
}

/* Positions, and with_normals: normals, where they lie elsewhere. */
static void copy_points(const shb_quick_points *from, size_t count, bool with_normals,
                        shb_receivers *to) {
    float *const positions[] = {to->x, to->y, to->z};
    float *const normals[] = {to->normal_x, to->normal_y, to->normal_z};
    const size_t size = shb_round_to_lanes(count) * sizeof *to->x;
    for (int k = 0; k < 3; k++) {
        if (from->position[k] != positions[k])
            memcpy(positions[k], from->position[k], size);
        if (with_normals && from->normal[k] != normals[k])
            memcpy(normals[k], from->normal[k], size);
    }
}

void shb_visibility_batch(const shb_map *map, const shb_bias *bias, const shb_filter *filter,
                          size_t count, bool lifted, const shb_own_triangles *own,
                          const shb_quick_points *points, const shb_next_batch *next,
                          shb_quick_test *test, shb_receivers *receivers, float *visibility) {
    const shb_shade_kernels *kernels = map->context->shade_kernels;
    SHB_ALIGN float asked[SHB_BATCH];
    uint16_t doubtful[SHB_BATCH];
    shb_quick_bias quick;
    size_t left = SIZE_MAX;
    if (kernels->quick && filter->filter == shb_hard_test && shb_quick_bias_of(map, bias, &quick))
        left = kernels->quick(map, &quick, count, points, test, visibility, doubtful);
    if (left == SIZE_MAX) {
        copy_points(points, count, needs_normals(map, bias, filter), receivers);
        shb_visibility_in_full(map, bias, filter, count, lifted, own, next, receivers, visibility);
        return;
    }
    prefetch_whole(next);
    if (left > 0) {
        shb_receivers_pick(points, doubtful, left, quick.plane, receivers);
        shb_visibility_in_full(map, bias, filter, left, lifted, NULL, NULL, receivers, asked);
        for (size_t i = 0; i < left; i++)
            visibility[doubtful[i]] = asked[i];
    }
}

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

static bool are_aligned(const shb_points *points) {
    const uintptr_t addresses = (uintptr_t)points->positions | (uintptr_t)points->normals |
                                (uintptr_t)points->own.ids | (uintptr_t)points->own.weight_1 |
                                (uintptr_t)points->own.weight_2;
    return addresses % sizeof(float) == 0;
}

shb_result shb_points_check(const shb_context *context, const char *caller,
                            const shb_points *points) {
    if (points->count && !points->positions)
        return shb_fail(context, SHB_ERROR_ARGUMENT,
                        "%s: points.positions is NULL and points.count is %zu", caller,
                        points->count);
    if (points->position_stride % 4 || points->normal_stride % 4)
        return shb_fail(context, SHB_ERROR_ARGUMENT,
                        "%s: points.position_stride %zu or points.normal_stride %zu is not a "
                        "multiple of 4",
                        caller, points->position_stride, points->normal_stride);
    if (!are_aligned(points))
        return shb_fail(context, SHB_ERROR_ARGUMENT,
                        "%s: points.positions, normals or an array of points.own is not aligned "
                        "to 4",
                        caller);
    if (shb_triples_overflow(points->count, points->position_stride) ||
        (points->normals && shb_triples_overflow(points->count, points->normal_stride)))
        return shb_fail(context, SHB_ERROR_SIZE,
                        "%s: points.count %zu times points.position_stride %zu or "
                        "points.normal_stride %zu overflows",
                        caller, points->count, points->position_stride, points->normal_stride);
    if (!points->own.weight_1 != !points->own.weight_2 ||
        (points->own.weight_1 && !points->own.ids))
        return shb_fail(context, SHB_ERROR_ARGUMENT,
                        "%s: of points.own.ids, weight_1 and weight_2 some are NULL that others "
                        "need",
                        caller);
    return SHB_OK;
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

static bool is_exact(const shb_bias *bias, const shb_filter *filter) {
    return bias->needs & SHB_NEEDS_OCCLUDERS && (!filter || filter->exact == shb_exact_visibility);
}

/* Loads a batch as the exact method asks about it, and asks for the memory of the next one. */
static void load_exact(const shb_map *map, const shb_points *points, size_t first,
                       float *visibility, shb_exact_points *exact) {
    const size_t left = points->count - first, count = left < SHB_BATCH ? left : SHB_BATCH;
    const size_t stride = shb_triple_stride(points->position_stride);
    const shb_own_triangles own = own_from(&points->own, first);
    shb_receivers batch;
    load(map->context->shade_kernels, points->positions, stride, first, count, batch.x, batch.y,
         batch.z);
    if (left >= 2 * SHB_BATCH) {
        const shb_next_batch next = next_batch_of(points, false, first + SHB_BATCH, visibility);
        prefetch_whole(&next);
    }
    shb_exact_points_of(map, count, &own, &batch, exact);
}

/* The exact method where the map keeps lists and sheets. */
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

/* The exact method where the map keeps triangles. */
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
    const bool exact = points->count && is_exact(bias, filter);
    if (exact && shb_exact_asks_triangles_alone(map)) {
        ask_triangles(map, points, visibility);
        return SHB_OK;
    }
    if (exact && !points->own.ids && shb_exact_asks_unsure_lists(map)) {
        ask_unsure_lists(map, points, visibility);
        return SHB_OK;
    }

    const shb_filter hard = shb_filter_hard();
    const shb_shade_kernels *kernels = map->context->shade_kernels;
    const size_t position_stride = shb_triple_stride(points->position_stride);
    const size_t normal_stride = shb_triple_stride(points->normal_stride);
    const bool with_normals = needs_normals(map, bias, filter);
    shb_receivers batch;
    const shb_quick_points arrays = shb_quick_points_of(&batch);
    SHB_ALIGN float batch_visibility[SHB_BATCH];
    shb_quick_test test = {.known = false};
    shb_packed_points packed;
    const bool is_packed = shb_packed_points_init(&packed, map, points, bias, filter, visibility);
    for (size_t first = 0; first < points->count; first += SHB_BATCH) {
        const size_t left = points->count - first;
        const size_t count = left < SHB_BATCH ? left : SHB_BATCH;
        const bool is_tried = is_packed && count == SHB_BATCH;
        if (is_tried && shb_packed_points_ask(&packed, first))
            continue;
        load(kernels, points->positions, position_stride, first, count, batch.x, batch.y, batch.z);
        if (with_normals)
            load(kernels, points->normals, normal_stride, first, count, batch.normal_x,
                 batch.normal_y, batch.normal_z);
        shb_next_batch after;
        const shb_next_batch *next = NULL;
        if (left >= 2 * SHB_BATCH) {
            after = next_batch_of(points, with_normals, first + SHB_BATCH, visibility);
            next = &after;
        }
        const shb_own_triangles own = own_from(&points->own, first);
        if (is_tried)
            shb_visibility_in_full(map, bias, &hard, count, false, &own, next, &batch,
                                   batch_visibility);
        else
            shb_visibility_batch(map, bias, filter ? filter : &hard, count, false, &own, &arrays,
                                 next, &test, &batch, batch_visibility);
        memcpy(visibility + first, batch_visibility, count * sizeof *visibility);
    }
    shb_packed_points_end(&packed);
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
    const size_t stride = shb_triple_stride(points->position_stride);
    const shb_sheet_kernels *kernels = shb_sheet_kernels_of(context->isa);
    SHB_ALIGN float x[SHB_BATCH], y[SHB_BATCH], z[SHB_BATCH];
    SHB_ALIGN int32_t batch[SHB_BATCH];
    for (size_t first = 0; first < points->count; first += SHB_BATCH) {
        const size_t left = points->count - first;
        const size_t count = left < SHB_BATCH ? left : SHB_BATCH;
        load(context->shade_kernels, points->positions, stride, first, count, x, y, z);
        if (map->empty)
            memset(batch, 0, sizeof batch);
        else
            kernels->ask(shb_map_sheets(map), count, x, y, z, batch);
        for (size_t i = 0; i < count; i++)
            answers[first + i] = (uint8_t)batch[i];
    }
    return SHB_OK;
}
