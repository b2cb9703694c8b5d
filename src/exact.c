#include "strict.h"

#include "exact.h"

#include "exact_lists.h"
#include "exact_triangles.h"
#include "kernels/shade.h"
#include "project.h"

static bool has_planes_alone(const shb_map *map) {
    return map->info.occluders == SHB_OCCLUDERS_PLANES;
}

bool shb_exact_is_hard(const shb_bias *bias, const shb_filter *filter) {
    return bias->needs & SHB_NEEDS_OCCLUDERS && (!filter || filter->exact == shb_exact_visibility);
}

static void ask_planes(const shb_map *map, size_t count, const shb_receivers *receivers,
                       float *visibility) {
    const shb_quick_points points = shb_quick_points_of(receivers);
    map->context->shade_kernels->planes(map, count, &points, visibility);
}

static void ask_triangles(const shb_map *map, const shb_exact_points *points,
                          const shb_receivers *r, float *visibility) {
    const shb_walk_places places = {
        {r->x, r->y, r->z}, {r->normal_x, r->normal_y, r->normal_z}, 1, 1};
    shb_triangle_points asked;
    shb_triangle_points_begin(map, &places, visibility, &asked);
    shb_triangle_points_ask(&asked, points, 0);
    shb_triangle_points_end(&asked);
}

/* By all that the map keeps for the exact method. */
static void ask_occluders(const shb_map *map, const shb_exact_points *points,
                          const shb_receivers *receivers, float *visibility) {
    if (map->lists)
        shb_exact_ask_lists(map, points, visibility);
    else if (has_planes_alone(map))
        ask_planes(map, points->count, receivers, visibility);
    else
        ask_triangles(map, points, receivers, visibility);
}

/* Few fragments are left for the occluders where sheets know the others. */
static void ask_sheets_first(const shb_map *map, const shb_exact_points *points,
                             const shb_receivers *receivers, float *visibility) {
    uint16_t unsure[SHB_BATCH];
    SHB_ALIGN float answers[SHB_BATCH];
    const shb_quick_points arrays = shb_quick_points_of(receivers);
    shb_exact_points left_points;
    shb_receivers left;
    const size_t left_count = shb_exact_settle(map, points, visibility, unsure);
    if (left_count == 0)
        return;
    shb_exact_points_pick(points, unsure, left_count, &left_points);
    shb_receivers_pick(&arrays, unsure, left_count, !map->lists, &left);
    ask_occluders(map, &left_points, &left, answers);
    for (size_t k = 0; k < left_count; k++)
        visibility[unsure[k]] = answers[k];
}

void shb_exact_visibility(const shb_filter_args *args) {
    const shb_map *map = args->map;
    const bool settles = map->classifies && !args->lifted;
    if (!settles && has_planes_alone(map)) { /* they do not ask for exact points */
        ask_planes(map, args->count, args->receivers, args->visibility);
        return;
    }
    shb_exact_points points;
    shb_exact_points_of(map, args->count, args->own, args->receivers, &points);
    if (settles)
        ask_sheets_first(map, &points, args->receivers, args->visibility);
    else
        ask_occluders(map, &points, args->receivers, args->visibility);
}
