#include "strict.h"

#include "exact_lists.h"

#include "kernels/sheets.h"
#include "light_point.h"
#include "lists.h"
#include "project.h"

void shb_exact_ask_lists(const shb_map *map, const shb_exact_points *points, float *visibility) {
    const shb_list_points asked = {.count = points->count,
                                   .x = points->x,
                                   .y = points->y,
                                   .z = points->z,
                                   .own_ids = points->has_ids ? points->own_ids : NULL,
                                   .rounding = points->are_exact ? 0 : SHB_FLOAT_ROUNDING};
    shb_lists_query(map->lists, &asked, visibility);
}

size_t shb_exact_settle(const shb_map *map, const shb_exact_points *points, float *visibility,
                        uint16_t unsure[SHB_BATCH]) {
    SHB_ALIGN int32_t answers[SHB_BATCH];
    SHB_ALIGN float x[SHB_BATCH], y[SHB_BATCH], z[SHB_BATCH];
    const shb_sheet_kernels *kernels = shb_sheet_kernels_of(map->context->isa);
    for (size_t i = 0; i < shb_round_to_lanes(points->count); i++) {
        x[i] = (float)points->x[i];
        y[i] = (float)points->y[i];
        z[i] = (float)points->z[i];
    }
    kernels->ask(shb_map_sheets(map), points->count, x, y, z, answers);
    size_t left = 0;
    for (size_t i = 0; i < points->count; i++) {
        visibility[i] = answers[i] == SHB_LIGHT_SHADOWED ? 0.0f : 1.0f;
        unsure[left] = (uint16_t)i;
        left += answers[i] == SHB_LIGHT_UNSURE;
    }
    return left;
}

void shb_unsure_points_begin(const shb_map *map, float *visibility, shb_unsure_points *unsure) {
    unsure->map = map;
    unsure->visibility = visibility;
    unsure->points.count = 0;
    unsure->points.has_ids = false;
    unsure->points.are_exact = false;
}

void shb_unsure_points_end(shb_unsure_points *unsure) {
    SHB_ALIGN float answers[SHB_BATCH];
    shb_exact_ask_lists(unsure->map, &unsure->points, answers);
    for (size_t k = 0; k < unsure->points.count; k++)
        unsure->visibility[unsure->numbers[k]] = answers[k];
    unsure->points.count = 0;
}

void shb_unsure_points_ask(shb_unsure_points *unsure, const shb_exact_points *points,
                           size_t first) {
    uint16_t numbers[SHB_BATCH];
    shb_exact_points *waiting = &unsure->points;
    const size_t left = shb_exact_settle(unsure->map, points, unsure->visibility + first, numbers);
    if (waiting->count + left > SHB_BATCH)
        shb_unsure_points_end(unsure);
    for (size_t k = 0; k < left; k++)
        unsure->numbers[shb_exact_points_add(points, numbers[k], waiting)] = first + numbers[k];
}
