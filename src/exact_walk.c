/* Which side of an edge a place lies on is calculated from the edge's lower vertex to its higher
 * one, so that the two triangles of an edge always agree: a place lies in exactly one of them, or
 * on both; and which side of the plane a vertex lies on is the same for all its triangles.
 */
#include "strict.h"

#include "exact_walk.h"

#include <math.h>

/* Corners of the ordered edges, the lower one first. */
static const uint8_t corners_of[2][3] = {{1, 0, 0}, {2, 2, 1}};

static shb_map_place corner_of(const shb_walk_triangle *triangle, uint32_t corner) {
    return (shb_map_place){triangle->x[corner], triangle->y[corner]};
}

static bool is_seen(const shb_walk_triangle *triangle, uint32_t corner) {
    return triangle->marks & SHB_CORNER_SEEN << corner;
}

/* Positive on the left of the way from a to b. */
static double side_of(shb_map_place a, shb_map_place b, shb_map_place at) {
    return (b.x - a.x) * (at.y - a.y) - (b.y - a.y) * (at.x - a.x);
}

/* Does a place with this side of an edge lie on that of the triangle? area: the triangle's, with
 * the sign of its side; 0 covers nothing. */
static bool is_inside(double side, double area) {
    return area > 0 ? side >= 0 : area < 0 && side <= 0;
}

static double across(const shb_walk *walk, shb_map_place at) {
    return side_of(walk->from, walk->to, at);
}

/* Distance ahead of to, times that of both places. */
static double along(const shb_walk *walk, shb_map_place at) {
    return (walk->to.x - walk->from.x) * (at.x - walk->to.x) +
           (walk->to.y - walk->from.y) * (at.y - walk->to.y);
}

/* Where the line crosses the exit. */
static double crossing_of(const shb_walk *walk) {
    return (walk->across[0] * along(walk, walk->ends[1]) -
            walk->across[1] * along(walk, walk->ends[0])) /
           (walk->across[0] - walk->across[1]);
}

/* Has the line gone too far from both places for what it meets to come back to them? */
static bool is_lost(const shb_walk *walk) {
    const double x = walk->to.x - walk->from.x, y = walk->to.y - walk->from.y;
    const double squared = x * x + y * y, reach = SHB_WALK_REACH * sqrt(squared);
    const double crossing = crossing_of(walk);
    return crossing > reach || crossing < -(squared + reach);
}

static bool stop(shb_walk *walk, bool cut) {
    walk->triangle = SHB_ID_NONE;
    walk->cut = cut;
    return false;
}

/* area: of the triangle whose corners are in the order of their vertices' numbers. Edge 1 runs
 * against the others. */
static double area_at(double area, uint32_t edge) {
    return edge == 1 ? -area : area;
}

/* The two edges of the first triangle that the line crosses; left: its corners there. */
static void leave_by(shb_walk *walk, uint32_t edge, const bool left[3]) {
    const shb_walk_triangle *triangle = &walk->mesh->triangles[walk->triangle];
    const uint32_t corners[2] = {corners_of[0][edge], corners_of[1][edge]};
    walk->lower = left[corners[0]] ? 0 : 1;
    for (uint32_t k = 0; k < 2; k++) {
        const shb_map_place at = corner_of(triangle, corners[k]);
        walk->ends[walk->lower ^ k] = at;
        walk->across[walk->lower ^ k] = across(walk, at);
    }
    walk->side = side_of(walk->ends[walk->lower], walk->ends[walk->lower ^ 1], walk->to);
    walk->area = area_at(
        side_of(corner_of(triangle, 0), corner_of(triangle, 1), corner_of(triangle, 2)), edge);
    walk->beyond = triangle->beyond[edge];
    walk->leaves = true;
}

/* Does to lie beyond an edge of the first triangle? */
static bool is_beyond(const shb_walk *walk, uint32_t edge) {
    const shb_walk_triangle *t = &walk->mesh->triangles[walk->triangle];
    const double area = side_of(corner_of(t, 0), corner_of(t, 1), corner_of(t, 2));
    const shb_map_place lower = corner_of(t, corners_of[0][edge]);
    return !is_inside(side_of(lower, corner_of(t, corners_of[1][edge]), walk->to),
                      area_at(area, edge));
}

/* Of the two edges of the first triangle that the line crosses, which meet in the corner that lies
 * alone on its side, the one that lies ahead: the only one that to lies beyond, or else the one
 * that is crossed farther ahead. */
static bool choose_exit(shb_walk *walk) {
    const shb_walk_triangle *t = &walk->mesh->triangles[walk->triangle];
    bool left[3];
    for (uint32_t k = 0; k < 3; k++)
        left[k] = across(walk, corner_of(t, k)) < 0;
    if (left[0] == left[1] && left[1] == left[2])
        return false;
    const uint32_t alone = left[0] == left[1] ? 2 : left[0] == left[2] ? 1 : 0;
    const uint32_t one = corners_of[0][alone], other = corners_of[1][alone];
    const bool is_beyond_one = is_beyond(walk, one);
    leave_by(walk, one, left);
    if (is_beyond_one != is_beyond(walk, other)) {
        if (!is_beyond_one)
            leave_by(walk, other, left);
        return true;
    }
    const double crossing = crossing_of(walk);
    leave_by(walk, other, left);
    if (!(crossing_of(walk) > crossing))
        leave_by(walk, one, left);
    return true;
}

static shb_map_place middle_of(const shb_walk_triangle *t) {
    return (shb_map_place){((t->x[0] + t->x[1]) + t->x[2]) / 3,
                           ((t->y[0] + t->y[1]) + t->y[2]) / 3};
}

/* Where snapping covered a sample just outside the triangle, its middle is a better start. */
static bool leave_first(shb_walk *walk) {
    if (choose_exit(walk))
        return true;
    walk->from = middle_of(&walk->mesh->triangles[walk->triangle]);
    return choose_exit(walk) || stop(walk, true);
}

/* Over the exit to the next triangle, whose own exit is found: its third corner takes the place of
 * the exit's end on the same side of the line. False: the walk ends. */
static bool step(shb_walk *walk, bool *covers) {
    static const double signs[2] = {1, -1};
    if (walk->beyond >= SHB_TWIN || walk->steps++ == SHB_WALK_MAX)
        return stop(walk, true);
    if ((walk->turned || walk->passed) && is_lost(walk))
        return stop(walk, false);
    const uint32_t third = shb_neighbour_edge(walk->beyond);
    walk->triangle = shb_neighbour_of(walk->beyond);
    const shb_walk_triangle *triangle = &walk->mesh->triangles[walk->triangle];
    if (!is_seen(triangle, third))
        return stop(walk, true);
    const shb_map_place at = corner_of(triangle, third);
    const double at_across = across(walk, at), last_side = walk->side;
    const double area = side_of(walk->ends[walk->lower], walk->ends[walk->lower ^ 1], at);
    walk->turned |= !is_inside(-walk->area, area);
    if (walk->turned && walk->straight)
        return stop(walk, false);
    const bool is_right = !(at_across < 0);
    const uint32_t side = is_right, keeps_lower = walk->lower ^ side;
    const uint32_t rises =
        third + keeps_lower >= 2 ? 1 : 0; /* from the kept end to the third corner */
    walk->ends[side] = at;
    walk->across[side] = at_across;
    walk->lower = side ^ rises;
    walk->beyond = triangle->beyond[corners_of[keeps_lower][third]];
    walk->side = side_of(walk->ends[walk->lower], walk->ends[walk->lower ^ 1], walk->to);
    walk->area = signs[rises == keeps_lower] * area;
    *covers = is_inside(last_side, area) && is_inside(walk->side, walk->area);
    walk->passed |= *covers;
    return true;
}

/* The first triangle; false: the walk ends there. */
static bool enter(shb_walk *walk, bool *covers) {
    const shb_walk_triangle *t = &walk->mesh->triangles[walk->triangle];
    walk->steps = 1;
    if (!is_seen(t, 0) || !is_seen(t, 1) || !is_seen(t, 2))
        return stop(walk, true);
    *covers = !is_beyond(walk, 0) && !is_beyond(walk, 1) && !is_beyond(walk, 2);
    return true;
}

void shb_walk_begin(const shb_light_mesh *mesh, uint32_t triangle, const double from[2],
                    const double to[2], shb_walk *walk) {
    walk->mesh = mesh;
    walk->from = (shb_map_place){from[0], from[1]};
    walk->to = (shb_map_place){to[0], to[1]};
    walk->triangle = triangle;
    walk->steps = 0;
    walk->leaves = walk->straight = walk->turned = walk->passed = walk->cut = false;
}

uint32_t shb_walk_next(shb_walk *walk) {
    bool met = false;
    if (walk->triangle != SHB_ID_NONE && walk->steps == 0)
        met = enter(walk, &walk->passed) && walk->passed;
    if (met || walk->triangle == SHB_ID_NONE)
        return walk->triangle;
    if (!walk->leaves && !leave_first(walk))
        return SHB_ID_NONE;
    while (!met && step(walk, &met))
        ;
    return walk->triangle;
}

uint32_t shb_exact_walk(const shb_light_mesh *mesh, uint32_t triangle, const double from[2],
                        const double to[2]) {
    shb_walk walk;
    shb_walk_begin(mesh, triangle, from, to, &walk);
    walk.straight = true;
    return shb_walk_next(&walk);
}
