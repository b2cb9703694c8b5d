/* Which side of an edge a place lies on is calculated from the edge's lower vertex to its higher
 * one, so that the two triangles of an edge always agree: a place lies in exactly one of them, or
 * on both.
 */
#include "strict.h"

#include "exact_walk.h"

static double cross(const double *a, const double *b, const double *at) {
    return (b[0] - a[0]) * (at[1] - a[1]) - (b[1] - a[1]) * (at[0] - a[0]);
}

/* Positive on the left of the way from a to b. */
static double side_of(const shb_occluder_mesh *mesh, uint32_t a, uint32_t b, const double at[2]) {
    return a < b ? cross(mesh->places[a], mesh->places[b], at)
                 : -cross(mesh->places[b], mesh->places[a], at);
}

/* Where a place lies to the three sides of a triangle, positive inside. False for a triangle
 * without area in the map, or behind the light. */
static bool find_sides(const shb_occluder_mesh *mesh, const uint32_t corners[3], const double at[2],
                       double sides[3]) {
    const double area = side_of(mesh, corners[0], corners[1], mesh->places[corners[2]]);
    const double sign = area < 0 ? -1 : 1;
    for (int k = 0; k < 3; k++)
        sides[k] = sign * side_of(mesh, corners[k], corners[(k + 1) % 3], at);
    return area < 0 || area > 0;
}

/* The side through which the way leaves: of two that lie before the target, the one that the
 * straight line from the start crosses, which their common corner tells. -1: the target lies
 * inside. */
static int choose_exit(const shb_occluder_mesh *mesh, const uint32_t corners[3],
                       const double sides[3], const double from[2], const double to[2]) {
    int exit = -1;
    for (int k = 0; k < 3; k++) {
        if (!(sides[k] < 0))
            continue;
        if (exit < 0) {
            exit = k;
            continue;
        }
        const int first = k == 2 && exit == 0 ? 2 : exit, second = k == 2 && exit == 0 ? 0 : k;
        const double *common = mesh->places[corners[second]];
        const double *before = mesh->places[corners[first]];
        const double side = cross(from, to, common), of_before = cross(from, to, before);
        exit = (side < 0) != (of_before < 0) ? first : second;
    }
    return exit;
}

static uint32_t opposite_corner(const uint32_t corners[3], uint32_t a, uint32_t b) {
    for (int k = 0; k < 2; k++)
        if (corners[k] != a && corners[k] != b)
            return corners[k];
    return corners[2];
}

/* The neighbour through side k if it lies beyond that side. */
static uint32_t step(const shb_occluder_mesh *mesh, uint32_t triangle, int k) {
    const uint32_t next = mesh->neighbours[triangle][k];
    if (next == SHB_ID_NONE)
        return SHB_ID_NONE;
    const uint32_t *corners = mesh->corners[triangle];
    const uint32_t a = corners[k], b = corners[(k + 1) % 3], own = corners[(k + 2) % 3];
    const uint32_t other = opposite_corner(mesh->corners[next], a, b);
    const double own_side = side_of(mesh, a, b, mesh->places[own]);
    const double other_side = side_of(mesh, a, b, mesh->places[other]);
    const bool beyond = (own_side < 0 && other_side > 0) || (own_side > 0 && other_side < 0);
    return beyond ? next : SHB_ID_NONE;
}

uint32_t shb_exact_walk(const shb_occluder_mesh *mesh, uint32_t triangle, const double from[2],
                        const double to[2]) {
    for (int i = 0; i < SHB_WALK_MAX && triangle != SHB_ID_NONE; i++) {
        const uint32_t *corners = mesh->corners[triangle];
        double sides[3];
        if (!find_sides(mesh, corners, to, sides))
            return SHB_ID_NONE;
        const int exit = choose_exit(mesh, corners, sides, from, to);
        if (exit < 0)
            return triangle;
        triangle = step(mesh, triangle, exit);
    }
    return SHB_ID_NONE;
}
