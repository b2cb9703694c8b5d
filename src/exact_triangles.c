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
#include "kernels/shade.h"
#include "occluders.h"

#include <math.h>

/* Where a triangle that covers the fragment's place lies, as far as rounding can tell; HIT_NONE:
 * it has no plane that could tell. */
typedef enum hit { HIT_NONE, HIT_BEHIND, HIT_OWN, HIT_IN_FRONT } hit;

typedef struct asking {
    const shb_map *map;
    const shb_receivers *receivers;
    size_t number; /* of the fragment */
    uint32_t own_id;
    double x, y, z;
    int32_t column, row;
    double by_position[3]; /* the bounds of light_point.h: of the point's own rounding, */
    double error_x, error_y, error_z; /* and of calculation */
    uint32_t samples[4];              /* triangles; that of the fragment's own texel first */
} asking;

/* The vectors C - slope_x A - slope_y B of (1) have Tz - slope_x Tx - slope_y Ty - (Z - slope_x X -
 * slope_y Y) Tw. */
static hit compare_depth(const asking *a, uint32_t triangle) {
    const shb_occluder_plane *plane = &a->map->occluders.planes[triangle];
    const shb_light_rows *rows = &a->map->rows;
    const double slope_x = plane->slope_x, slope_y = plane->slope_y;
    const double behind = a->z - shb_occluder_depth(plane, a->x, a->y);
    const double at_origin = (a->z - slope_x * a->x) - slope_y * a->y;
    double error =
        plane->error + (a->error_z + fabs(slope_x) * a->error_x + fabs(slope_y) * a->error_y);
    for (int i = 0; i < 3; i++)
        error += fabs((rows->z[i] - at_origin * rows->w[i]) -
                      (slope_x * rows->x[i] + slope_y * rows->y[i])) *
                 a->by_position[i];
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

static void walk_from(const asking *a, int k, shb_walk *walk) {
    const int32_t beside = a->x - a->column < 0.5 ? -1 : 1;
    const int32_t above = a->y - a->row < 0.5 ? -1 : 1;
    const double from[2] = {a->column + (k & 1 ? beside : 0) + 0.5,
                            a->row + (k & 2 ? above : 0) + 0.5};
    const double to[2] = {a->x, a->y};
    shb_walk_begin(&a->map->occluders.mesh, a->samples[k], from, to, walk);
}

static bool are_joined(const shb_light_mesh *mesh, uint32_t triangle, uint32_t other) {
    const shb_walk_triangle *t = &mesh->triangles[triangle];
    for (uint32_t k = 0; k < 3; k++)
        if (shb_neighbour_of(t->beyond[k]) == other)
            return t->marks & SHB_EDGE_JOINED << k;
    return false;
}

/* The nearest sample's sheet has led to the fragment's own triangle, and the other samples see it,
 * too, on triangles so near that their walks need not be made. */
static bool are_near(const asking *a, const shb_walk *walk) {
    for (int k = 1; k < 4; k++)
        if (a->samples[k] != a->samples[0] && a->samples[k] != walk->triangle &&
            !are_joined(walk->mesh, walk->triangle, a->samples[k]))
            return false;
    return true;
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

static bool sees_all(const asking *a) {
    bool complete = true;
    for (int k = 0; k < 4; k++)
        complete &= a->samples[k] != SHB_ID_NONE;
    return complete;
}

static bool is_first(const asking *a, int k) {
    for (int i = 0; i < k; i++)
        if (a->samples[i] == a->samples[k])
            return false;
    return true;
}

/* One walk for each triangle. */
static bool is_shadowed(const asking *a) {
    bool is_plain = sees_all(a), are_cut = is_plain;
    shb_walk walks[4];
    int count = 0;
    for (int k = 0; k < 4; k++) {
        if (a->samples[k] == SHB_ID_NONE || !is_first(a, k))
            continue;
        shb_walk *walk = &walks[count++];
        walk_from(a, k, walk);
        const hit first = next_hit(a, walk);
        if (first == HIT_IN_FRONT)
            return true;
        are_cut &= first == HIT_NONE && walk->cut;
        is_plain &= first == HIT_OWN && !walk->turned;
        if (k == 0 && is_plain && are_near(a, walk))
            return false;
    }
    for (int i = 0; i < count && !is_plain; i++)
        for (hit next; (next = next_hit(a, &walks[i])) != HIT_NONE;)
            if (next == HIT_IN_FRONT)
                return true;
    return are_cut && is_shadowed_by_planes(a);
}

static void ask_about(const shb_walk_group *g, size_t i, asking *a) {
    a->own_id = g->own_ids[i];
    a->x = g->at.x[i];
    a->y = g->at.y[i];
    a->z = g->at.depth[i];
    a->column = g->at.column[i];
    a->row = g->at.row[i];
    a->error_x = g->error_x[i];
    a->error_y = g->error_y[i];
    a->error_z = g->error_z[i];
    for (int k = 0; k < 3; k++)
        a->by_position[k] = g->by_position[i] * fabs(g->at.world[k][i]);
    for (size_t k = 0; k < 4; k++)
        a->samples[k] = g->samples[i][g->nearest[i] ^ k];
}

/* The answers for fragments of a group that its nearest samples tell; returns the others, one bit
 * each. */
static uint64_t settle(const shb_walk_group *g, float *visibility) {
    uint64_t inside = 0;
    for (size_t i = 0; i < g->count; i++) {
        visibility[i] = g->in_front >> i & 1 ? 0.0f : 1.0f;
        inside |= (uint64_t)(g->at.column[i] >= 0) << i;
    }
    return inside & ~g->in_front & ~(g->own & g->joined);
}

void shb_exact_ask_triangles(const shb_map *map, const shb_exact_points *points,
                             const shb_receivers *receivers, float *visibility) {
    const shb_list_kernels *kernels = shb_list_kernels_of(map->context->isa);
    const double rounding = points->are_exact ? SHB_WEIGHTS_ROUNDING : SHB_FLOAT_ROUNDING;
    shb_walk_group group;
    asking a = {.map = map, .receivers = receivers};
    if (map->occluders.plane_count == 0) { /* the kernels read a triangle in any case */
        for (size_t i = 0; i < points->count; i++)
            visibility[i] = 1;
        return;
    }
    for (size_t i = 0; i < points->count; i += SHB_LIST_GROUP) {
        const size_t left = points->count - i;
        group.count = left < SHB_LIST_GROUP ? left : SHB_LIST_GROUP;
        group.own_ids = points->own_ids + i;
        group.at.world[0] = points->x + i;
        group.at.world[1] = points->y + i;
        group.at.world[2] = points->z + i;
        kernels->locate(&map->occluders.mesh.frame, &group.at);
        map->context->shade_kernels->nearest(map, rounding, &group);
        for (uint64_t open = settle(&group, visibility + i); open; open &= open - 1) {
            const size_t k = (size_t)__builtin_ctzll(open);
            a.number = i + k;
            ask_about(&group, k, &a);
            visibility[i + k] = is_shadowed(&a) ? 0.0f : 1.0f;
        }
    }
}
