#include "packed_points.h"

#include "exact.h"
#include "kernels/shade.h"
#include "project.h"
#include "triples.h"
#include "visibility.h"

bool shb_packed_points_init(shb_packed_points *packed, const shb_map *map, const shb_points *points,
                            const shb_bias *bias, const shb_filter *filter, float *visibility) {
    const size_t gapless = 3 * sizeof(float);
    packed->map = map;
    packed->points = points;
    packed->bias = bias;
    packed->visibility = visibility;
    packed->test.known = false;
    packed->waiting = 0;
    packed->by_planes = shb_exact_is_hard(bias, filter) && !map->classifies &&
                        shb_map_holds(map, SHB_OCCLUDERS_PLANES);
    packed->quick.plane = true;
    return (packed->by_planes || shb_is_asked_quickly(map, bias, filter, &packed->quick)) &&
           shb_triple_stride(points->position_stride) == gapless &&
           (!packed->quick.plane || shb_triple_stride(points->normal_stride) == gapless);
}

/* The last one fills up the lanes. */
static void fill_lanes(shb_packed_points *packed) {
    const shb_quick_points waiting = shb_quick_points_of(&packed->receivers);
    uint16_t numbers[SHB_BATCH];
    for (size_t i = 0; i < packed->waiting; i++)
        numbers[i] = (uint16_t)i;
    shb_receivers_pick(&waiting, numbers, packed->waiting, packed->quick.plane, &packed->receivers);
}

void shb_packed_points_end(shb_packed_points *packed) {
    SHB_ALIGN float visibility[SHB_BATCH];
    const shb_filter hard = shb_filter_hard();
    if (packed->waiting == 0)
        return;
    const shb_asked_batch batch = {.count = packed->waiting};
    fill_lanes(packed);
    shb_visibility_in_full(packed->map, packed->bias, &hard, &batch, &packed->receivers,
                           visibility);
    for (size_t i = 0; i < packed->waiting; i++)
        packed->visibility[packed->numbers[i]] = visibility[i];
    packed->waiting = 0;
}

static void let_wait(shb_packed_points *packed, size_t number) {
    const size_t place = packed->waiting++;
    const float *position = packed->points->positions + 3 * number;
    shb_receivers *r = &packed->receivers;
    packed->numbers[place] = number;
    r->x[place] = position[0];
    r->y[place] = position[1];
    r->z[place] = position[2];
    if (!packed->quick.plane)
        return;
    const float *normal = packed->points->normals + 3 * number;
    r->normal_x[place] = normal[0];
    r->normal_y[place] = normal[1];
    r->normal_z[place] = normal[2];
}

bool shb_packed_points_ask(shb_packed_points *packed, size_t first) {
    const shb_shade_kernels *kernels = packed->map->context->shade_kernels;
    const shb_points *points = packed->points;
    const bool plane = packed->quick.plane;
    const size_t left = points->count - first;
    const size_t next = left < 2 * SHB_BATCH ? first : first + SHB_BATCH;
    uint16_t doubtful[SHB_BATCH];
    const shb_quick_points batch = {
        .position = {points->positions + 3 * first},
        .normal = {plane ? points->normals + 3 * first : NULL},
        .packed = true,
        .next_position = points->positions + 3 * next,
        .next_normal = plane ? points->normals + 3 * next : NULL,
        .next_visibility = packed->visibility + next,
    };
    float *visibility = packed->visibility + first;
    if (packed->by_planes) {
        kernels->planes(packed->map, SHB_BATCH, &batch, visibility);
        return true;
    }
    const size_t found = kernels->quick(packed->map, &packed->quick, SHB_BATCH, &batch,
                                        &packed->test, visibility, doubtful);
    if (found == SIZE_MAX)
        return false;
    if (packed->waiting + found > SHB_BATCH)
        shb_packed_points_end(packed);
    for (size_t i = 0; i < found; i++)
        let_wait(packed, first + doubtful[i]);
    return true;
}
