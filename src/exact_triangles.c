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
#include "kernels/shade.h"
#include "occluders.h"

#include <math.h>
#include <string.h>

/* Where a triangle that covers the fragment's place lies, as far as rounding can tell; HIT_NONE:
 * it has no plane that could tell. */
typedef enum hit { HIT_NONE, HIT_BEHIND, HIT_OWN, HIT_IN_FRONT } hit;

/* A point of a group. */
typedef struct asking {
    const shb_map *map;
    double rounding; /* of positions, as in light_point.h */
    const shb_walk_group *group;
    size_t i, number; /* in the group, and in the batch */
} asking;

static void place_of(const asking *a, double at[2]) {
    at[0] = a->group->x[a->i];
    at[1] = a->group->y[a->i];
}

/* Rounding moves the point by no more than its part of each coordinate, and so over the plane by
 * the sum of these times the normal's elements. */
static hit compare_depth(const asking *a, uint32_t triangle) {
    const shb_world_plane *plane = &a->map->occluders.world_planes[triangle];
    double parts[3];
    for (int k = 0; k < 3; k++)
        parts[k] = plane->normal[k] * a->group->world[k][a->i];
    const double behind = ((parts[0] + parts[1]) + parts[2]) + plane->offset;
    const double error =
        (a->rounding + SHB_PLANE_ROUNDING) * ((fabs(parts[0]) + fabs(parts[1])) + fabs(parts[2])) +
        1;
    return isnan(behind)      ? HIT_NONE
           : behind > error   ? HIT_IN_FRONT
           : behind >= -error ? HIT_OWN
                              : HIT_BEHIND;
}

static hit hit_of(const asking *a, uint32_t triangle) {
    return triangle == a->group->own_ids[a->i] ? HIT_OWN : compare_depth(a, triangle);
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

/* The centre of the texel of sample k; the point is in the view. */
static void place_sample(const asking *a, int k, double center[2]) {
    double to[2];
    place_of(a, to);
    for (int axis = 0; axis < 2; axis++) {
        const double own = (int32_t)to[axis], other = to[axis] - own < 0.5 ? -1 : 1;
        center[axis] = own + (k & 1 << axis ? other : 0) + 0.5;
    }
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

/* A way that comes beside where an earlier one has met the fragment's surface leads there, too.
 * steps: triangles that it has left behind. */
static void go(const asking *a, const surroundings *near, int steps, sheet_way *way) {
    const shb_light_mesh *mesh = &a->map->occluders.mesh;
    double to[2];
    place_of(a, to);
    for (; steps < WAY_MAX; steps++) {
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

static bool sees_all(const asking *a) {
    bool sees = true;
    for (int k = 0; k < 4; k++)
        sees &= a->group->samples[k][a->i] != SHB_ID_NONE;
    return sees;
}

/* One bit for each sample that holds a triangle which none before it does. */
static uint32_t first_samples(const asking *a) {
    uint32_t s[4], held = 0;
    for (int k = 0; k < 4; k++) {
        s[k] = a->group->samples[k][a->i];
        held |= (uint32_t)(s[k] != SHB_ID_NONE) << k;
    }
    const uint32_t again = (uint32_t)(s[1] == s[0]) << 1 |
                           (uint32_t)((s[2] == s[0]) | (s[2] == s[1])) << 2 |
                           (uint32_t)((s[3] == s[0]) | (s[3] == s[1]) | (s[3] == s[2])) << 3;
    return held & ~again;
}

/* What is known of where the first way has come; it covers the place then. */
static hit first_hit(const asking *a) {
    return a->group->own >> a->i & 1      ? HIT_OWN
           : a->group->behind >> a->i & 1 ? HIT_BEHIND
                                          : HIT_NONE;
}

/* Walks go on where ways have ended. */
static void add_walks(const asking *a, int count, const sheet_way *ways, shb_left_points *left) {
    shb_walk_crowd *crowd = &left->crowd;
    const shb_walk_group *g = a->group;
    bool is_known = !sees_all(a);
    if (count == 0)
        return;
    const uint32_t point = (uint32_t)left->points.count++;
    left->numbers[point] = a->number;
    left->points.x[point] = g->world[0][a->i];
    left->points.y[point] = g->world[1][a->i];
    left->points.z[point] = g->world[2][a->i];
    left->points.own_ids[point] = g->own_ids[a->i];
    for (int i = 0; i < count; i++) {
        const size_t n = crowd->count++;
        crowd->from_x[n] = ways[i].from[0];
        crowd->from_y[n] = ways[i].from[1];
        crowd->to_x[n] = g->x[a->i];
        crowd->to_y[n] = g->y[a->i];
        crowd->triangles[n] = ways[i].triangle;
        crowd->points[n] = point;
        is_known |= ways[i].hit != HIT_NONE;
    }
    if (is_known)
        return;
    shb_doubtful_point *doubtful = &left->doubtful[left->doubtful_count++];
    doubtful->point = point;
    doubtful->sample = g->samples[0][a->i];
    place_sample(a, 0, doubtful->center);
}

/* One way for each triangle. */
static bool is_shadowed(const asking *a, shb_left_points *left_over) {
    surroundings near = {{SHB_ID_NONE, SHB_ID_NONE, SHB_ID_NONE, SHB_ID_NONE}};
    bool is_plain = sees_all(a);
    sheet_way ways[4];
    int count = 0;
    for (uint32_t left = first_samples(a); left; left &= left - 1) {
        const int k = __builtin_ctz(left);
        sheet_way *way = &ways[count++];
        place_sample(a, k, way->from);
        way->triangle = a->group->ends[k][a->i];
        way->hit = k == 0 ? first_hit(a) : HIT_NONE;
        way->covers = way->hit != HIT_NONE;
        if (!way->covers)
            go(a, &near, way->triangle != a->group->samples[k][a->i], way);
        if (way->hit == HIT_IN_FRONT)
            return true;
        if (way->hit == HIT_OWN && way->covers)
            near = surroundings_of(&a->map->occluders.mesh, way->triangle);
        is_plain &= way->hit == HIT_OWN;
    }
    if (!is_plain)
        add_walks(a, count, ways, left_over);
    return false;
}

/* Takes point i of a group, as point n. */
static void take_point(const shb_walk_group *from, size_t i, size_t number, size_t n,
                       shb_open_points *to) {
    to->group.x[n] = from->x[i];
    to->group.y[n] = from->y[i];
    for (int k = 0; k < 3; k++)
        to->world[k][n] = from->world[k][i];
    for (int k = 0; k < 4; k++)
        to->group.samples[k][n] = from->samples[k][i];
    to->own_ids[n] = from->own_ids[i];
    to->numbers[n] = number;
}

/* One bit for each point of a group. */
static uint64_t all_of(const shb_walk_group *g) {
    return UINT64_MAX >> (SHB_LIST_GROUP - g->count);
}

/* The test of mutual planes with the nearest sample's triangle. */
static bool is_shadowed_by_planes(const shb_triangle_points *asked,
                                  const shb_doubtful_point *doubtful) {
    const shb_map *map = asked->map;
    const shb_walk_places *places = &asked->places;
    const size_t number = asked->left.numbers[doubtful->point];
    const shb_occluder_plane *plane = &map->occluders.planes[doubtful->sample];
    double position[3], normal[3];
    for (int k = 0; k < 3; k++) {
        position[k] = (double)places->position[k][number * places->position_step];
        normal[k] = (double)places->normal[k][number * places->normal_step];
    }
    const double *center = doubtful->center;
    const shb_exact_fragment fragment = shb_exact_fragment_of(&map->rows, position, normal);
    const shb_exact_sample sample = {.center_x = center[0],
                                     .center_y = center[1],
                                     .depth = shb_occluder_depth(plane, center[0], center[1]) +
                                              plane->error,
                                     .slope_x = plane->slope_x,
                                     .slope_y = plane->slope_y};
    return shb_exact_is_shadowed(&fragment, &sample);
}

static void leave_none(shb_left_points *left) {
    left->crowd.count = left->points.count = left->doubtful_count = 0;
    memset(left->crowd.are_shadowed, 0, sizeof left->crowd.are_shadowed);
    memset(left->crowd.are_known, 0, sizeof left->crowd.are_known);
}

static void end_walks(shb_triangle_points *asked) {
    shb_left_points *left = &asked->left;
    const shb_walk_crowd *crowd = &left->crowd;
    if (crowd->count == 0)
        return;
    asked->map->context->shade_kernels->walk(asked->map, asked->rounding, &left->points,
                                             &left->crowd);
    for (size_t i = 0; i < left->points.count; i++)
        if (crowd->are_shadowed[i])
            asked->visibility[left->numbers[i]] = 0;
    for (size_t k = 0; k < left->doubtful_count; k++) {
        const shb_doubtful_point *doubtful = &left->doubtful[k];
        if (!crowd->are_known[doubtful->point] && is_shadowed_by_planes(asked, doubtful))
            asked->visibility[left->numbers[doubtful->point]] = 0;
    }
    leave_none(left);
}

/* Answers what the samples themselves have left open, or leaves it to walks. */
static void ask_open(shb_triangle_points *asked) {
    const shb_map *map = asked->map;
    shb_open_points *open = &asked->open;
    shb_walk_group *g = &open->group;
    if (g->count == 0)
        return;
    for (size_t n = g->count; n % SHB_LANES; n++) /* vectors are read as a whole */
        take_point(g, g->count - 1, 0, n, open);
    map->context->shade_kernels->beside(map, asked->rounding, g);
    uint64_t shadowed = g->in_front & all_of(g);
    for (uint64_t left = all_of(g) & ~g->in_front & ~g->joined; left; left &= left - 1) {
        const size_t i = (size_t)__builtin_ctzll(left);
        const asking a = {map, asked->rounding, g, i, open->numbers[i]};
        if (SHB_WALK_CROWD - asked->left.crowd.count < 4)
            end_walks(asked);
        shadowed |= (uint64_t)is_shadowed(&a, &asked->left) << i;
    }
    for (; shadowed; shadowed &= shadowed - 1)
        asked->visibility[open->numbers[__builtin_ctzll(shadowed)]] = 0;
    g->count = 0;
}

static void start_group(const shb_exact_points *points, size_t first, shb_walk_group *group) {
    const size_t left = points->count - first;
    group->count = left < SHB_LIST_GROUP ? left : SHB_LIST_GROUP;
    group->world[0] = points->x + first;
    group->world[1] = points->y + first;
    group->world[2] = points->z + first;
    group->own_ids = points->own_ids + first;
}

void shb_triangle_points_begin(const shb_map *map, const shb_walk_places *places, float *visibility,
                               shb_triangle_points *asked) {
    asked->map = map;
    asked->places = *places;
    asked->visibility = visibility;
    asked->rounding = 0;
    asked->open.group.count = 0;
    asked->open.group.own_ids = asked->open.own_ids;
    for (int k = 0; k < 3; k++)
        asked->open.group.world[k] = asked->open.world[k];
    leave_none(&asked->left);
}

void shb_triangle_points_end(shb_triangle_points *asked) {
    ask_open(asked);
    end_walks(asked);
}

void shb_triangle_points_ask(shb_triangle_points *asked, const shb_exact_points *points,
                             size_t first) {
    const shb_map *map = asked->map;
    const double rounding = points->are_exact ? SHB_WEIGHTS_ROUNDING : SHB_FLOAT_ROUNDING;
    shb_open_points *open = &asked->open;
    float *visibility = asked->visibility + first;
    shb_walk_group group;
    if (rounding != asked->rounding)
        shb_triangle_points_end(asked);
    asked->rounding = rounding;
    for (size_t i = 0; i < points->count; i++)
        visibility[i] = 1;
    if (map->occluders.plane_count == 0) /* the kernels read a triangle in any case */
        return;
    for (size_t start = 0; start < points->count; start += SHB_LIST_GROUP) {
        start_group(points, start, &group);
        map->context->shade_kernels->nearest(map, rounding, &group);
        const uint64_t all = all_of(&group);
        for (uint64_t left = group.in_front & all; left; left &= left - 1)
            visibility[start + (size_t)__builtin_ctzll(left)] = 0;
        for (uint64_t left = all & ~group.in_front & ~group.joined; left; left &= left - 1) {
            const size_t i = (size_t)__builtin_ctzll(left);
            if (open->group.count == SHB_LIST_GROUP)
                ask_open(asked);
            take_point(&group, i, first + start + i, open->group.count++, open);
        }
    }
}
