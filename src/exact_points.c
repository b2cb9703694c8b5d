#include "strict.h"

#include "exact_points.h"

#include "kernels/shade.h"
#include "lists.h"
#include "project.h"

#include <string.h>

/* Without triangles where the map has no use for them. */
static shb_drawn_mesh mesh_of(const shb_map *map) {
    const shb_topology *t = &map->occluders.topology;
    if (map->lists)
        return (shb_drawn_mesh){map->lists->id_count, (const uint32_t(*)[3])map->lists->corners,
                                (const double(*)[3])map->lists->vertices};
    if (shb_map_holds(map, SHB_OCCLUDERS_TRIANGLES))
        return (shb_drawn_mesh){t->triangle_count, (const uint32_t(*)[3])t->corners,
                                (const double(*)[3])t->positions};
    return (shb_drawn_mesh){0};
}

static void fill_group(shb_exact_points *points) {
    const size_t last = points->count - 1;
    for (size_t i = points->count; i % SHB_LIST_GROUP; i++) {
        points->x[i] = points->x[last];
        points->y[i] = points->y[last];
        points->z[i] = points->z[last];
        points->own_ids[i] = points->own_ids[last];
    }
}

/* The last one fills up the lanes. */
static void take_ids(const uint32_t *ids, size_t count, uint32_t *to) {
    memcpy(to, ids, count * sizeof *ids);
    for (size_t i = count; i < shb_round_to_lanes(count); i++)
        to[i] = ids[count - 1];
}

/* True if the points of the weights are there. */
static bool place_all(const shb_map *map, const shb_own_triangles *own, const shb_receivers *r,
                      shb_exact_points *points) {
    const shb_drawn_mesh mesh = mesh_of(map);
    return map->context->shade_kernels->place(&mesh, own->weight_1, own->weight_2, r, points);
}

void shb_exact_points_of(const shb_map *map, size_t count, const shb_own_triangles *own,
                         const shb_receivers *r, shb_exact_points *points) {
    const bool has_ids = own && own->ids, has_weights = has_ids && own->weight_1;
    points->count = count;
    if (has_ids)
        take_ids(own->ids, count, points->own_ids);
    points->are_exact = has_weights && place_all(map, own, r, points);
    points->has_ids = has_ids && (points->are_exact || !has_weights);
    for (size_t i = 0; !points->has_ids && i < count; i++)
        points->own_ids[i] = SHB_ID_NONE;
    for (size_t i = 0; !points->are_exact && i < count; i++) {
        points->x[i] = (double)r->x[i];
        points->y[i] = (double)r->y[i];
        points->z[i] = (double)r->z[i];
    }
    fill_group(points);
}

void shb_exact_points_pick(const shb_exact_points *from, const uint16_t *numbers, size_t count,
                           shb_exact_points *to) {
    to->count = 0;
    to->has_ids = from->has_ids;
    to->are_exact = from->are_exact;
    for (size_t k = 0; k < count; k++)
        shb_exact_points_add(from, numbers[k], to);
    fill_group(to);
}

shb_result shb_own_triangles_check(const shb_map *map, const char *caller,
                                   const shb_points *points) {
    const shb_own_triangles *own = &points->own;
    const size_t triangles = mesh_of(map).triangle_count;
    if (!own->ids ||
        (!shb_map_holds(map, SHB_OCCLUDERS_TRIANGLES) && !shb_map_holds(map, SHB_OCCLUDERS_LISTS)))
        return SHB_OK;
    for (size_t i = 0; i < points->count; i++)
        if (own->ids[i] >= triangles && (own->weight_1 || own->ids[i] != SHB_ID_NONE))
            return shb_fail(map->context, SHB_ERROR_ARGUMENT,
                            "%s: points.own.ids[%zu] is %u and the map's scene has %zu triangles",
                            caller, i, (unsigned)own->ids[i], triangles);
    return SHB_OK;
}
