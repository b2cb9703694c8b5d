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
#include "kernels/lists.h"
#include "occluders.h"

#include <math.h>

/* Where a triangle that covers the fragment's place lies, as far as rounding can tell; HIT_NONE:
 * it has no plane that could tell. */
typedef enum hit { HIT_NONE, HIT_BEHIND, HIT_OWN, HIT_IN_FRONT } hit;

/* What the rows' products can be off by at a place of the scene: 8 roundings of double each. */
typedef struct product_errors {
    double x, y, z, w;
} product_errors;

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
    shb_walk walks[4];
    int count;
} asking;

static double row_error(const shb_list_frame *frame, const double row[4]) {
    return 8 * SHB_DOUBLE_ROUNDING * shb_list_row_size(row, frame->reach);
}

static product_errors product_errors_of(const shb_list_frame *frame) {
    return (product_errors){row_error(frame, frame->rows[0]), row_error(frame, frame->rows[1]),
                            row_error(frame, frame->rows[2]), row_error(frame, frame->rows[3])};
}

/* (1) and (2) of light_point.h, for a point that may be off by rounding. */
static void bound_errors(asking *a, const shb_list_group *g, size_t i, double rounding,
                         const product_errors *errors) {
    const double *w = a->map->rows.w, inverse_w = g->inverse_w[i];
    const double p[3] = {fabs(g->world[0][i]), fabs(g->world[1][i]), fabs(g->world[2][i])};
    const double moved_w = rounding * inverse_w * shb_dot_abs(w, p);
    const double left = moved_w < 1 ? 1 - moved_w : 0;
    const double by_position = rounding * inverse_w * ((1 + 0x1p-10 + 2 * moved_w) / left);
    const double noise = inverse_w * g->scale[i];
    for (int k = 0; k < 3; k++)
        a->by_position[k] = by_position * p[k];
    a->error_x = noise * (errors->x + fabs(a->x) * errors->w);
    a->error_y = noise * (errors->y + fabs(a->y) * errors->w);
    a->error_z = noise * (errors->z + fabs(a->z) * errors->w);
}

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

/* The triangles that the four nearest samples see; whether all four see one. */
static bool read_samples(asking *a) {
    const shb_map *map = a->map;
    const int32_t left = a->column - (a->x - a->column < 0.5);
    const int32_t top = a->row - (a->y - a->row < 0.5);
    const int own = (a->column - left) + 2 * (a->row - top);
    bool complete = true;
    for (int k = 0; k < 4; k++) {
        const int32_t column = left + ((own ^ k) & 1), row = top + ((own ^ k) >> 1);
        const bool inside = (uint32_t)column < map->info.width && (uint32_t)row < map->info.height;
        a->samples[k] = inside ? shb_occluder_row(map, row)[column] : SHB_ID_NONE;
        complete &= a->samples[k] != SHB_ID_NONE;
    }
    return complete;
}

static shb_walk walk_from(const asking *a, int k) {
    const int32_t beside = a->x - a->column < 0.5 ? -1 : 1;
    const int32_t above = a->y - a->row < 0.5 ? -1 : 1;
    const double from[2] = {a->column + (k & 1 ? beside : 0) + 0.5,
                            a->row + (k & 2 ? above : 0) + 0.5};
    const double to[2] = {a->x, a->y};
    return shb_walk_begin(&a->map->occluders.mesh, a->samples[k], from, to);
}

/* One walk for each triangle. */
static void begin_walks(asking *a) {
    a->count = 0;
    for (int k = 0; k < 4; k++) {
        bool is_new = a->samples[k] != SHB_ID_NONE;
        for (int i = 0; i < k; i++)
            is_new &= a->samples[i] != a->samples[k];
        if (is_new)
            a->walks[a->count++] = walk_from(a, k);
    }
}

static bool are_joined(const shb_light_mesh *mesh, uint32_t triangle, uint32_t other) {
    for (int k = 0; k < 3; k++)
        if (shb_neighbour_of(mesh->topology->neighbours[triangle][k]) == other)
            return shb_light_mesh_beyond(mesh, triangle, k) == other;
    return false;
}

/* Most fragments: the nearest sample's sheet is their own, and the other samples see it, too, on
 * triangles so near that their walks need not be made. */
static hit ask_nearest(const asking *a) {
    shb_walk walk = walk_from(a, 0);
    const hit first = next_hit(a, &walk);
    if (first != HIT_OWN || walk.turned)
        return first == HIT_IN_FRONT ? HIT_IN_FRONT : HIT_NONE;
    for (int k = 1; k < 4; k++)
        if (a->samples[k] != a->samples[0] && a->samples[k] != walk.triangle &&
            !are_joined(walk.mesh, walk.triangle, a->samples[k]))
            return HIT_NONE;
    return HIT_OWN;
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
    bool is_plain = read_samples(a), are_cut = is_plain, meets_own = false;
    if (is_plain) {
        const hit nearest = ask_nearest(a);
        if (nearest != HIT_NONE)
            return nearest == HIT_IN_FRONT;
    }
    begin_walks(a);
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

/* What the first walks read is asked for before any of it is: a group's triangles come from all
 * over the memory. */
static void fetch_triangles(const shb_map *map, const shb_list_group *g, size_t count) {
    const shb_topology *t = &map->occluders.topology;
    uint32_t ids[SHB_LIST_GROUP];
    for (size_t k = 0; k < count; k++) {
        const bool inside = g->column[k] >= 0;
        ids[k] = inside ? shb_occluder_row(map, g->row[k])[g->column[k]] : SHB_ID_NONE;
        if (ids[k] == SHB_ID_NONE)
            continue;
        __builtin_prefetch(t->corners[ids[k]]);
        __builtin_prefetch(t->neighbours[ids[k]]);
        __builtin_prefetch(&map->occluders.planes[ids[k]]);
    }
    for (size_t k = 0; k < count; k++)
        for (int i = 0; i < 3 && ids[k] != SHB_ID_NONE; i++)
            __builtin_prefetch(&map->occluders.mesh.vertices[t->corners[ids[k]][i]]);
}

void shb_exact_ask_triangles(const shb_map *map, const shb_exact_points *points,
                             const shb_receivers *receivers, float *visibility) {
    const shb_list_frame *frame = &map->occluders.mesh.frame;
    const shb_list_kernels *kernels = shb_list_kernels_of(map->context->isa);
    const double rounding = points->are_exact ? SHB_WEIGHTS_ROUNDING : SHB_FLOAT_ROUNDING;
    const product_errors errors = product_errors_of(frame);
    shb_list_group group;
    asking a = {.map = map, .receivers = receivers};
    for (size_t i = 0; i < points->count; i++) {
        const size_t k = i % SHB_LIST_GROUP, left = points->count - i;
        if (k == 0) {
            group.world[0] = points->x + i;
            group.world[1] = points->y + i;
            group.world[2] = points->z + i;
            kernels->locate(frame, &group);
            fetch_triangles(map, &group, left < SHB_LIST_GROUP ? left : SHB_LIST_GROUP);
        }
        visibility[i] = 1;
        if (group.column[k] < 0)
            continue;
        a.number = i;
        a.own_id = points->own_ids[i];
        a.x = group.x[k];
        a.y = group.y[k];
        a.z = group.depth[k];
        a.column = group.column[k];
        a.row = group.row[k];
        bound_errors(&a, &group, k, rounding, &errors);
        visibility[i] = is_shadowed(&a) ? 0.0f : 1.0f;
    }
}
