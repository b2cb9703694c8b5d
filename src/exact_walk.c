/* Which side of an edge a place lies on is calculated from the edge's lower vertex to its higher
 * one, so that the two triangles of an edge always agree: a place lies in exactly one of them, or
 * on both.
 */
#include "strict.h"

#include "exact_walk.h"

/* In the map, texels. */
typedef struct map_place {
    double x, y;
} map_place;

static double cross(map_place a, map_place b, map_place at) {
    return (b.x - a.x) * (at.y - a.y) - (b.y - a.y) * (at.x - a.x);
}

static map_place place_of(const shb_light_mesh *mesh, uint32_t vertex) {
    return (map_place){mesh->vertices[vertex].x, mesh->vertices[vertex].y};
}

/* Positive on the left of the way from a to b. */
static double side_of(const shb_light_mesh *mesh, uint32_t a, uint32_t b, map_place at) {
    return a < b ? cross(place_of(mesh, a), place_of(mesh, b), at)
                 : -cross(place_of(mesh, b), place_of(mesh, a), at);
}

/* Where a place lies to the three sides of a triangle, positive inside. False for a triangle
 * without area in the map, or behind the light. */
static bool find_sides(const shb_light_mesh *mesh, const uint32_t corners[3], map_place at,
                       double sides[3]) {
    const double area = side_of(mesh, corners[0], corners[1], place_of(mesh, corners[2]));
    const double sign = area < 0 ? -1 : 1;
    for (int k = 0; k < 3; k++)
        sides[k] = sign * side_of(mesh, corners[k], corners[(k + 1) % 3], at);
    return area < 0 || area > 0;
}

/* The side through which the way leaves: of two that lie before the target, the one that the
 * straight line from the start crosses, which their common corner tells. -1: the target lies
 * inside. */
static int choose_exit(const shb_light_mesh *mesh, const uint32_t corners[3], const double sides[3],
                       map_place from, map_place to) {
    int exit = -1;
    for (int k = 0; k < 3; k++) {
        if (!(sides[k] < 0))
            continue;
        if (exit < 0) {
            exit = k;
            continue;
        }
        const int first = k == 2 && exit == 0 ? 2 : exit, second = k == 2 && exit == 0 ? 0 : k;
        const map_place common = place_of(mesh, corners[second]);
        const map_place before = place_of(mesh, corners[first]);
        const double side = cross(from, to, common), of_before = cross(from, to, before);
        exit = (side < 0) != (of_before < 0) ? first : second;
    }
    return exit;
}

uint32_t shb_exact_walk(const shb_light_mesh *mesh, uint32_t triangle, const double from[2],
                        const double to[2]) {
    const map_place start = {from[0], from[1]}, target = {to[0], to[1]};
    for (int i = 0; i < SHB_WALK_MAX && triangle != SHB_ID_NONE; i++) {
        const uint32_t *corners = mesh->topology->corners[triangle];
        double sides[3];
        if (!find_sides(mesh, corners, target, sides))
            return SHB_ID_NONE;
        const int exit = choose_exit(mesh, corners, sides, start, target);
        if (exit < 0)
            return triangle;
        triangle = shb_light_mesh_beyond(mesh, triangle, exit);
    }
    return SHB_ID_NONE;
}
