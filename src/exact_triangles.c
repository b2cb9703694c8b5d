/* From each of the four samples around a fragment a walk follows the mesh to the fragment's place.
 *
 * A triangle met there in front of the fragment blocks its ray, whatever led to it. If all four
 * walks meet the fragment's own surface without a turn of the mesh, there is no silhouette near,
 * and the fragment is lit. Otherwise the walks go on, over folds and beyond the fragment, because
 * what the samples have missed may hang on the mesh on its other side; and a fragment that none of
 * them finds a blocker for is lit, too: what is in front of it at the samples is known to end
 * before it. Only if all four were cut before they met anything, the planes are asked instead: what
 * is not one mesh may go on all the same. */
#include "strict.h"

#include "exact_triangles.h"

#include "exact.h"
#include "exact_walk.h"
#include "occluders.h"

/* Where a triangle that covers the fragment's place lies, as far as rounding can tell; HIT_NONE:
 * it has no plane that could tell. */
typedef enum hit { HIT_NONE, HIT_BEHIND, HIT_OWN, HIT_IN_FRONT } hit;

typedef struct asking {
    const shb_map *map;
    const shb_receivers *receivers;
    size_t number;
    uint32_t own_id;
    shb_light_point point;
    int32_t column, row;
    shb_walk walks[4];
    int count;
} asking;

static hit compare_depth(const asking *a, uint32_t triangle) {
    const shb_occluder_plane *plane = &a->map->occluders.planes[triangle];
    const shb_light_point *point = &a->point;
    const double behind = point->z - shb_occluder_depth(plane, point->x, point->y);
    const double error =
        shb_light_point_error(point, plane->slope_x, plane->slope_y) + plane->error;
    return !(error < HUGE_VAL) ? HIT_NONE
           : behind > error    ? HIT_IN_FRONT
           : behind >= -error  ? HIT_OWN
                               : HIT_BEHIND;
}

/* Of the next triangle whose plane is known; HIT_NONE: the walk has ended. */
static hit next_hit(const asking *a, shb_walk *walk) {
    hit found = HIT_NONE;
    for (uint32_t met; !found && (met = shb_walk_next(walk)) != SHB_ID_NONE;)
        found = met == a->own_id ? HIT_OWN : compare_depth(a, met);
    return found;
}

static bool has_walk_from(const asking *a, uint32_t triangle) {
    for (int i = 0; i < a->count; i++)
        if (a->walks[i].triangle == triangle)
            return true;
    return false;
}

/* Walks from the four nearest samples, one for each triangle, the nearest sample first; returns
 * whether all four have one. */
static bool begin_walks(asking *a) {
    const shb_map *map = a->map;
    const double to[2] = {a->point.x, a->point.y};
    const int32_t left = a->column - (to[0] - a->column < 0.5);
    const int32_t top = a->row - (to[1] - a->row < 0.5);
    const int own = (a->column - left) + 2 * (a->row - top);
    bool complete = true;
    a->count = 0;
    for (int k = 0; k < 4; k++) {
        const int32_t column = left + ((own ^ k) & 1), row = top + ((own ^ k) >> 1);
        const bool inside = (uint32_t)column < map->info.width && (uint32_t)row < map->info.height;
        const uint32_t id = inside ? shb_occluder_row(map, row)[column] : SHB_ID_NONE;
        const double from[2] = {column + 0.5, row + 0.5};
        complete &= id != SHB_ID_NONE;
        if (id != SHB_ID_NONE && !has_walk_from(a, id))
            a->walks[a->count++] = shb_walk_begin(&map->occluders.mesh, id, from, to);
    }
    return complete;
}

/* The test of mutual planes with the nearest sample's triangle. */
static bool is_shadowed_by_planes(const asking *a) {
    const shb_map *map = a->map;
    const shb_receivers *r = a->receivers;
    const size_t i = a->number;
    const uint32_t id = shb_occluder_row(map, a->row)[a->column];
    const shb_occluder_plane *plane = &map->occluders.planes[id];
    const double position[3] = {(double)r->x[i], (double)r->y[i], (double)r->z[i]};
    const double normal[3] = {(double)r->normal_x[i], (double)r->normal_y[i],
                              (double)r->normal_z[i]};
    const double x = a->column + 0.5, y = a->row + 0.5;
    const shb_exact_fragment fragment = shb_exact_fragment_of(&map->rows, position, normal);
    const shb_exact_sample sample = {.center_x = x,
                                     .center_y = y,
                                     .depth = shb_occluder_depth(plane, x, y) + plane->error,
                                     .slope_x = plane->slope_x,
                                     .slope_y = plane->slope_y};
    return shb_exact_is_shadowed(&fragment, &sample);
}

static bool is_shadowed(asking *a) {
    bool is_plain = begin_walks(a), are_cut = is_plain, meets_own = false;
    for (int i = 0; i < a->count; i++) {
        const hit first = next_hit(a, &a->walks[i]);
        if (first == HIT_IN_FRONT)
            return true;
        meets_own |= first == HIT_OWN;
        are_cut &= first == HIT_NONE && a->walks[i].cut;
        is_plain &= first == HIT_OWN && !a->walks[i].turned;
    }
    for (int i = 0; i < a->count && !is_plain; i++)
        for (hit next; (next = next_hit(a, &a->walks[i])) != HIT_NONE; meets_own |= next == HIT_OWN)
            if (next == HIT_IN_FRONT)
                return true;
    return !meets_own && are_cut && is_shadowed_by_planes(a);
}

static bool is_inside(const shb_map *map, const shb_light_point *point) {
    return point->w > 0 && point->x >= 0 && point->y >= 0 && point->x < map->info.width &&
           point->y < map->info.height;
}

void shb_exact_ask_triangles(const shb_map *map, const shb_exact_points *points,
                             const shb_receivers *receivers, float *visibility) {
    const double rounding = points->are_exact ? SHB_WEIGHTS_ROUNDING : SHB_FLOAT_ROUNDING;
    asking a = {.map = map, .receivers = receivers};
    for (size_t i = 0; i < points->count; i++) {
        const double position[3] = {points->x[i], points->y[i], points->z[i]};
        visibility[i] = 1;
        a.number = i;
        a.own_id = points->own_ids[i];
        a.point = shb_light_point_at(&map->rows, position, rounding);
        if (!is_inside(map, &a.point))
            continue;
        a.column = (int32_t)a.point.x;
        a.row = (int32_t)a.point.y;
        visibility[i] = is_shadowed(&a) ? 0.0f : 1.0f;
    }
}
