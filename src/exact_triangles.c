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
#include "kernels/shade.h"
#include "occluders.h"

#include <string.h>

/* Takes point i of a group. */
static void take_point(const shb_walk_group *from, size_t i, size_t number, shb_way_points *to) {
    const size_t n = to->points.count++;
    to->points.x[n] = from->world[0][i];
    to->points.y[n] = from->world[1][i];
    to->points.z[n] = from->world[2][i];
    to->points.own_ids[n] = from->own_ids[i];
    to->x[n] = from->x[i];
    to->y[n] = from->y[i];
    for (int k = 0; k < 4; k++)
        to->samples[k][n] = from->samples[k][i];
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

/* The centre of the texel of sample k; the point is in the view. */
static void place_sample(const shb_way_points *p, size_t i, int k, double center[2]) {
    const double to[2] = {p->x[i], p->y[i]};
    for (int axis = 0; axis < 2; axis++) {
        const double own = (int32_t)to[axis], other = to[axis] - own < 0.5 ? -1 : 1;
        center[axis] = own + (k & 1 << axis ? other : 0) + 0.5;
    }
}

/* Walks go on where ways have ended. */
static void add_walks(const shb_way_points *p, size_t i, uint32_t point, shb_walk_crowd *crowd) {
    for (int k = 0; k < 4; k++) {
        double from[2];
        if (!(p->found[i] & SHB_WAY_GONE << k))
            continue;
        const size_t n = crowd->count++;
        place_sample(p, i, k, from);
        crowd->from_x[n] = from[0];
        crowd->from_y[n] = from[1];
        crowd->to_x[n] = p->x[i];
        crowd->to_y[n] = p->y[i];
        crowd->triangles[n] = p->ends[k][i];
        crowd->points[n] = point;
    }
}

static void leave_to_walks(shb_triangle_points *asked, size_t i) {
    const uint32_t met = 15 * SHB_WAY_OWN | SHB_WAY_BEHIND | SHB_WAY_EMPTY;
    const shb_way_points *p = &asked->open;
    shb_left_points *left = &asked->left;
    if (SHB_WALK_CROWD - left->crowd.count < 4)
        end_walks(asked);
    const uint32_t point = (uint32_t)shb_exact_points_add(&p->points, i, &left->points);
    left->numbers[point] = p->numbers[i];
    add_walks(p, i, point, &left->crowd);
    if (p->found[i] & met)
        return;
    shb_doubtful_point *doubtful = &left->doubtful[left->doubtful_count++];
    doubtful->point = point;
    doubtful->sample = p->samples[0][i];
    place_sample(p, i, 0, doubtful->center);
}

/* Answers what the samples themselves have left open, or leaves it to walks. */
static void ask_open(shb_triangle_points *asked) {
    shb_way_points *p = &asked->open;
    if (p->points.count)
        asked->map->context->shade_kernels->ways(asked->map, asked->rounding, p);
    for (size_t i = 0; i < p->points.count; i++) {
        const uint32_t gone = p->found[i] / SHB_WAY_GONE & 15, own = p->found[i] / SHB_WAY_OWN & 15;
        if (p->found[i] & SHB_WAY_IN_FRONT)
            asked->visibility[p->numbers[i]] = 0;
        else if (gone && (gone != own || p->found[i] & SHB_WAY_EMPTY))
            leave_to_walks(asked, i);
    }
    p->points.count = 0;
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
    asked->open.points.count = 0;
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
    shb_way_points *open = &asked->open;
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
            if (open->points.count == SHB_BATCH)
                ask_open(asked);
            take_point(&group, i, first + start + i, open);
        }
    }
}
