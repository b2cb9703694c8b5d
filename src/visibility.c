#include "visibility.h"

#include "kernels/shade.h"
#include "prepare.h"
#include "project.h"
#include "stages.h"

#include <string.h>

/* What a map that was never drawn says, which keeps no occluders. */
static void light_all(size_t count, float *visibility) {
    for (size_t i = 0; i < shb_round_to_lanes(count); i++)
        visibility[i] = 1;
}

/* Whether it matters where in its texel a point lies. */
static bool needs_centers(const shb_bias *bias, const shb_filter *filter) {
    const bool is_flat = !bias->depth || bias->depth == shb_constant_depth;
    return bias->offset || !is_flat || !shb_pcf_is_centered(filter);
}

void shb_visibility_in_full(const shb_map *map, const shb_bias *bias, const shb_filter *filter,
                            const shb_asked_batch *batch, shb_receivers *receivers,
                            float *visibility) {
    const size_t count = batch->count;
    const shb_shade_kernels *kernels = map->context->shade_kernels;
    const shb_bias_args bias_args = {count, bias, &map->info, receivers, kernels};
    const shb_filter_args filter_args = {
        count,     filter,     map,           &map->info,
        receivers, visibility, batch->lifted, shb_prepared_find(map, filter),
        batch->own};

    if (bias->needs & SHB_NEEDS_OCCLUDERS) {
        shb_prefetch_whole(batch->next);
        if (map->occluders.held)
            filter->exact(&filter_args);
        else
            light_all(count, visibility);
        return;
    }
    const uint32_t centers = needs_centers(bias, filter) ? SHB_NEEDS_CENTERS : 0;
    const uint32_t needs = bias->needs | filter->needs | centers;
    kernels->project(map, needs, count, batch->next, receivers);
    if (needs & SHB_NEEDS_NORMAL)
        kernels->normals(&map->projection, count, receivers);
    if (bias->offset) {
        bias->offset(&bias_args);
        kernels->project(map, SHB_NEEDS_CENTERS, count, NULL, receivers);
    }
    if (bias->depth)
        bias->depth(&bias_args);
    else
        kernels->own_depth(count, receivers);
    filter->filter(&filter_args);
}

bool shb_is_asked_quickly(const shb_map *map, const shb_bias *bias, const shb_filter *filter,
                          shb_quick_bias *quick) {
    return map->context->shade_kernels->quick && (!filter || filter->filter == shb_hard_test) &&
           shb_quick_bias_of(map, bias, quick);
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
                          const shb_asked_batch *batch, const shb_quick_points *points,
                          shb_quick_test *test, shb_receivers *receivers, float *visibility) {
    const size_t count = batch->count;
    SHB_ALIGN float asked[SHB_BATCH];
    uint16_t doubtful[SHB_BATCH];
    shb_quick_bias quick;
    size_t left = SIZE_MAX;
    if (shb_is_asked_quickly(map, bias, filter, &quick))
        left = map->context->shade_kernels->quick(map, &quick, count, points, test, visibility,
                                                  doubtful);
    if (left == SIZE_MAX) {
        copy_points(points, count, shb_visibility_needs_normals(map, bias, filter), receivers);
        shb_visibility_in_full(map, bias, filter, batch, receivers, visibility);
        return;
    }
    shb_prefetch_whole(batch->next);
    if (left > 0) {
        const shb_asked_batch rest = {.count = left, .lifted = batch->lifted};
        shb_receivers_pick(points, doubtful, left, quick.plane, receivers);
        shb_visibility_in_full(map, bias, filter, &rest, receivers, asked);
        for (size_t i = 0; i < left; i++)
            visibility[doubtful[i]] = asked[i];
    }
}
