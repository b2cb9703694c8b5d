/* Which side of an edge a place lies on is calculated from the edge's lower vertex to its higher
 * one, so that the two triangles of an edge always agree: a place lies in exactly one of them, or
 * on both; and which side of the plane a vertex lies on is the same for all its triangles.
 */
#include "strict.h"

#include "exact_walk.h"

#include <math.h>

static double cross(shb_map_place a, shb_map_place b, shb_map_place at) {
    return (b.x - a.x) * (at.y - a.y) - (b.y - a.y) * (at.x - a.x);
}

static shb_map_place place_of(const shb_light_mesh *mesh, uint32_t vertex) {
    return (shb_map_place){mesh->vertices[vertex].x, mesh->vertices[vertex].y};
}

/* False for vertices in front of the near plane, or that are not finite. */
static bool is_seen(const shb_light_mesh *mesh, uint32_t vertex) {
    return mesh->vertices[vertex].inverse_w > 0;
}

/* Positive on the left of the way from a to b. */
static double side_of(const shb_light_mesh *mesh, uint32_t a, uint32_t b, shb_map_place at) {
    return a < b ? cross(place_of(mesh, a), place_of(mesh, b), at)
                 : -cross(place_of(mesh, b), place_of(mesh, a), at);
}

/* Does a place with this side of an edge lie on that of the triangle? area: the triangle's, with
 * the sign of its winding; 0 covers nothing. */
static bool is_inside(double side, double area) {
    return area > 0 ? side >= 0 : area < 0 && side <= 0;
}

static double across(const shb_walk *walk, uint32_t vertex) {
    return cross(walk->from, walk->to, place_of(walk->mesh, vertex));
}

/* Distance ahead of to, times that of both places. */
static double along(const shb_walk *walk, uint32_t vertex) {
    const shb_map_place at = place_of(walk->mesh, vertex), to = walk->to;
    return (to.x - walk->from.x) * (at.x - to.x) + (to.y - walk->from.y) * (at.y - to.y);
}

static bool is_left(const shb_walk *walk, uint32_t vertex) {
    return across(walk, vertex) < 0;
}

/* Where the line crosses an edge whose ends lie on different sides of it. */
static double crossing_of(const shb_walk *walk, uint32_t a, uint32_t b) {
    const double at_a = across(walk, a), at_b = across(walk, b);
    return (at_a * along(walk, b) - at_b * along(walk, a)) / (at_a - at_b);
}

/* Has the line gone too far from both places for what it meets to come back to them? */
static bool is_lost(const shb_walk *walk, uint32_t a, uint32_t b) {
    const double x = walk->to.x - walk->from.x, y = walk->to.y - walk->from.y;
    const double squared = x * x + y * y, reach = SHB_WALK_REACH * sqrt(squared);
    const double crossing = crossing_of(walk, a, b);
    return crossing > reach || crossing < -(squared + reach);
}

static bool stop(shb_walk *walk, bool cut) {
    walk->triangle = SHB_ID_NONE;
    walk->cut = cut;
    return false;
}

static void leave_by(shb_walk *walk, int k, bool is_left_of_it, double side) {
    walk->exit = k;
    walk->exit_is_left = is_left_of_it;
    walk->exit_side = side;
}

/* Of the two edges of the first triangle that the line crosses the one that lies ahead: the only
 * one that to lies beyond, or else the one that is crossed farther ahead. */
static bool choose_exit(shb_walk *walk) {
    const shb_light_mesh *mesh = walk->mesh;
    const uint32_t *corners = mesh->topology->corners[walk->triangle];
    bool left[3];
    int beyond = 0;
    double farthest = -HUGE_VAL;
    for (int k = 0; k < 3; k++)
        left[k] = is_left(walk, corners[k]);
    for (int k = 0; k < 3; k++) {
        const double side = side_of(mesh, corners[k], corners[(k + 1) % 3], walk->to);
        if (left[k] == left[(k + 1) % 3] || is_inside(side, walk->area))
            continue;
        leave_by(walk, k, left[k], side);
        beyond++;
    }
    for (int k = 0; k < 3 && beyond != 1; k++) {
        const uint32_t a = corners[k], b = corners[(k + 1) % 3];
        if (left[k] == left[(k + 1) % 3])
            continue;
        const double crossing = crossing_of(walk, a, b);
        if (crossing > farthest) {
            farthest = crossing;
            leave_by(walk, k, left[k], side_of(mesh, a, b, walk->to));
        }
    }
    return walk->exit >= 0;
}

static shb_map_place middle_of(const shb_light_mesh *mesh, const uint32_t corners[3]) {
    const shb_map_place a = place_of(mesh, corners[0]), b = place_of(mesh, corners[1]);
    const shb_map_place c = place_of(mesh, corners[2]);
    return (shb_map_place){((a.x + b.x) + c.x) / 3, ((a.y + b.y) + c.y) / 3};
}

/* Where snapping covered a sample just outside the triangle, its middle is a better start. */
static bool leave_first(shb_walk *walk) {
    if (choose_exit(walk))
        return true;
    walk->from = middle_of(walk->mesh, walk->mesh->topology->corners[walk->triangle]);
    return choose_exit(walk) || stop(walk, true);
}

static int corner_beside(const uint32_t corners[3], uint32_t a, uint32_t b) {
    for (int k = 0; k < 3; k++)
        if (corners[k] != a && corners[k] != b)
            return k;
    return -1;
}

/* Over the exit to the next triangle, whose own exit is found. False: the walk ends. */
static bool step(shb_walk *walk, bool *covers) {
    const shb_light_mesh *mesh = walk->mesh;
    const shb_topology *t = mesh->topology;
    const uint32_t *last = t->corners[walk->triangle];
    const uint32_t a = last[walk->exit], b = last[(walk->exit + 1) % 3];
    const uint32_t neighbour = t->neighbours[walk->triangle][walk->exit];
    if (neighbour >= SHB_TWIN || walk->steps++ == SHB_WALK_MAX)
        return stop(walk, true);
    if ((walk->turned || walk->passed) && is_lost(walk, a, b))
        return stop(walk, false);
    const uint32_t next = shb_neighbour_of(neighbour);
    const uint32_t *corners = t->corners[next];
    const int k = corner_beside(corners, a, b);
    if (k < 0 || !is_seen(mesh, corners[k]))
        return stop(walk, true);
    const uint32_t third = corners[k];
    const double area = side_of(mesh, a, b, place_of(mesh, third));
    walk->turned |= !is_inside(-walk->area, area);
    if (walk->turned && walk->straight)
        return stop(walk, false);
    const bool third_is_left = is_left(walk, third);
    const bool leaves_by_a = third_is_left != walk->exit_is_left;
    const uint32_t kept = leaves_by_a ? a : b;
    const double side =
        leaves_by_a ? side_of(mesh, third, a, walk->to) : side_of(mesh, b, third, walk->to);
    *covers = is_inside(walk->exit_side, area) && is_inside(side, area);
    walk->passed |= *covers;
    const bool is_alike = corners[(k + 1) % 3] == a; /* as the edge is run along by the last one */
    const bool begins_at_third = corners[(k + 1) % 3] == kept;
    walk->triangle = next;
    walk->exit = begins_at_third ? k : (k + 2) % 3;
    walk->exit_is_left = begins_at_third == third_is_left;
    walk->exit_side = is_alike ? side : -side;
    walk->area = is_alike ? area : -area;
    return true;
}

/* The first triangle; false: the walk ends there. */
static bool enter(shb_walk *walk, bool *covers) {
    const shb_light_mesh *mesh = walk->mesh;
    const uint32_t *corners = mesh->topology->corners[walk->triangle];
    *covers = true;
    walk->steps = 1;
    if (!is_seen(mesh, corners[0]) || !is_seen(mesh, corners[1]) || !is_seen(mesh, corners[2]))
        return stop(walk, true);
    walk->area = side_of(mesh, corners[0], corners[1], place_of(mesh, corners[2]));
    for (int k = 0; k < 3 && *covers; k++)
        *covers = is_inside(side_of(mesh, corners[k], corners[(k + 1) % 3], walk->to), walk->area);
    return true;
}

shb_walk shb_walk_begin(const shb_light_mesh *mesh, uint32_t triangle, const double from[2],
                        const double to[2]) {
    return (shb_walk){.mesh = mesh,
                      .from = {from[0], from[1]},
                      .to = {to[0], to[1]},
                      .triangle = triangle,
                      .exit = -1};
}

uint32_t shb_walk_next(shb_walk *walk) {
    bool met = false;
    if (walk->triangle != SHB_ID_NONE && walk->steps == 0)
        met = enter(walk, &walk->passed) && walk->passed;
    if (met || walk->triangle == SHB_ID_NONE)
        return walk->triangle;
    if (walk->exit < 0 && !leave_first(walk))
        return SHB_ID_NONE;
    while (!met && step(walk, &met))
        ;
    return walk->triangle;
}

uint32_t shb_exact_walk(const shb_light_mesh *mesh, uint32_t triangle, const double from[2],
                        const double to[2]) {
    shb_walk walk = shb_walk_begin(mesh, triangle, from, to);
    walk.straight = true;
    return shb_walk_next(&walk);
}
