/* From each of the four samples around a fragment a way over the sheet of the mesh that is seen
 * there leads to the fragment's place.
 *
 * A triangle met there in front of the fragment blocks its ray, whatever led to it. If all four
 * sheets are the fragment's own surface there, there is no silhouette near, and the fragment is
 * lit. Otherwise walks go on, over folds and beyond the fragment, because what the samples have
 * missed may hang on the mesh on its other side; and a fragment that none of them finds a blocker
 * for is lit, too: what is in front of it at the samples is known to end before it. Only if all
 * four were cut before they met anything, the planes are asked instead: what is not one mesh may go
 * on all the same. */
#include "strict.h"

#include "exact_triangles.h"

#include "exact.h"
#include "exact_sheet.h"
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
    hit nearest;                      /* what is known of the first one where it covers the place */
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

static hit hit_of(const asking *a, uint32_t triangle) {
    return triangle == a->own_id ? HIT_OWN : compare_depth(a, triangle);
}

/* Of the next triangle whose plane is known; HIT_NONE: the walk has ended. */
static hit next_hit(const asking *a, shb_walk *walk) {
    hit found = HIT_NONE;
    for (uint32_t met; !found && (met = shb_walk_next(walk)) != SHB_ID_NONE;)
        found = hit_of(a, met);
    return found;
}

/* Triangles of a way over a sheet. */
enum { WAY_MAX = 64 };

/* The way from a sample as far as its sheet goes. */
typedef struct sheet_way {
    double from[2];
    uint32_t triangle; /* the last one */
    bool covers;       /* it covers the fragment's place */
    hit hit;
} sheet_way;

static void place_sample(const asking *a, int k, double at[2]) {
    const int32_t beside = a->x - a->column < 0.5 ? -1 : 1;
    const int32_t above = a->y - a->row < 0.5 ? -1 : 1;
    at[0] = a->column + (k & 1 ? beside : 0) + 0.5;
    at[1] = a->row + (k & 2 ? above : 0) + 0.5;
}

/* A triangle that is the fragment's surface, and those that its sheet goes on with. */
typedef struct surroundings {
    uint32_t triangles[4];
} surroundings;

static surroundings surroundings_of(const shb_light_mesh *mesh, uint32_t triangle) {
    const shb_walk_triangle *t = &mesh->triangles[triangle];
    surroundings near = {{triangle, triangle, triangle, triangle}};
    for (uint32_t k = 0; k < 3; k++)
        if (t->marks & SHB_EDGE_JOINED << k)
            near.triangles[1 + k] = shb_neighbour_of(t->beyond[k]);
    return near;
}

static bool is_among(const surroundings *near, uint32_t triangle) {
    const uint32_t *t = near->triangles;
    return (triangle == t[0]) | (triangle == t[1]) | (triangle == t[2]) | (triangle == t[3]);
}

/* A way that comes beside where an earlier one has met the fragment's surface leads there, too. */
static void go(const asking *a, const surroundings *near, sheet_way *way) {
    const shb_light_mesh *mesh = &a->map->occluders.mesh;
    const double to[2] = {a->x, a->y};
    for (int steps = 0; steps < WAY_MAX; steps++) {
        if (is_among(near, way->triangle)) {
            way->hit = HIT_OWN;
            return;
        }
        const uint32_t next = shb_sheet_next(mesh, way->triangle, way->from, to, &way->covers);
        if (next == way->triangle)
            break;
        way->triangle = next;
    }
    if (way->covers)
        way->hit = hit_of(a, way->triangle);
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
    const uint32_t *s = a->samples;
    return !((s[0] == SHB_ID_NONE) | (s[1] == SHB_ID_NONE) | (s[2] == SHB_ID_NONE) |
             (s[3] == SHB_ID_NONE));
}

/* One bit for each sample that holds a triangle which none before it does. */
static uint32_t first_samples(const asking *a) {
    const uint32_t *s = a->samples;
    const uint32_t again = (uint32_t)(s[1] == s[0]) << 1 |
                           (uint32_t)((s[2] == s[0]) | (s[2] == s[1])) << 2 |
                           (uint32_t)((s[3] == s[0]) | (s[3] == s[1]) | (s[3] == s[2])) << 3;
    uint32_t held = 0;
    for (int k = 0; k < 4; k++)
        held |= (uint32_t)(s[k] != SHB_ID_NONE) << k;
    return held & ~again;
}

/* Walks go on where ways have ended. All of them are begun before the first goes on: what one
 * waits for the others can use. */
static bool walks_meet_shadow(const asking *a, int count, const sheet_way *ways) {
    const double to[2] = {a->x, a->y};
    bool are_cut = sees_all(a);
    shb_walk walks[4];
    for (int i = 0; i < count; i++)
        shb_walk_begin(&a->map->occluders.mesh, ways[i].triangle, ways[i].from, to, &walks[i]);
    for (int i = 0; i < count; i++) {
        bool is_cut = ways[i].hit == HIT_NONE;
        for (hit next; (next = next_hit(a, &walks[i])) != HIT_NONE;) {
            if (next == HIT_IN_FRONT)
                return true;
            is_cut = false;
        }
        are_cut &= is_cut && walks[i].cut;
    }
    return are_cut && is_shadowed_by_planes(a);
}

/* One way for each triangle. */
static bool is_shadowed(const asking *a) {
    surroundings near = {{SHB_ID_NONE, SHB_ID_NONE, SHB_ID_NONE, SHB_ID_NONE}};
    bool is_plain = sees_all(a);
    sheet_way ways[4];
    int count = 0;
    for (uint32_t left = first_samples(a); left; left &= left - 1) {
        const int k = __builtin_ctz(left);
        sheet_way *way = &ways[count++];
        place_sample(a, k, way->from);
        way->triangle = a->samples[k];
        way->hit = k == 0 ? a->nearest : HIT_NONE;
        way->covers = way->hit != HIT_NONE;
        if (!way->covers)
            go(a, &near, way);
        if (way->hit == HIT_IN_FRONT)
            return true;
        if (way->hit == HIT_OWN && way->covers)
            near = surroundings_of(&a->map->occluders.mesh, way->triangle);
        is_plain &= way->hit == HIT_OWN;
    }
    return !is_plain && walks_meet_shadow(a, count, ways);
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
    a->nearest = g->own >> i & 1 ? HIT_OWN : g->behind >> i & 1 ? HIT_BEHIND : HIT_NONE;
    for (size_t k = 0; k < 4; k++)
        a->samples[k] = g->samples[g->nearest[i] ^ k][i];
}

/* The answers for fragments of a group that its nearest samples tell; returns the others, one bit
 * each. */
static uint64_t settle(const shb_walk_group *g, float *visibility) {
    for (size_t i = 0; i < g->count; i++)
        visibility[i] = 1;
    for (uint64_t dark = g->in_front; dark; dark &= dark - 1)
        visibility[__builtin_ctzll(dark)] = 0;
    return g->inside & ~g->in_front & ~(g->own & g->joined);
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
