#include "slow_walk.h"

#include "../../src/exact_sheet.h"

#include <math.h>

static void set_way(slow_walk *walk, double from_x, double from_y) {
    const double x = walk->to[0] - from_x, y = walk->to[1] - from_y;
    const double squared = x * x + y * y, reach = SHB_WALK_REACH * sqrt(squared);
    walk->way[0] = x;
    walk->way[1] = y;
    walk->nearest = -(squared + reach);
    walk->farthest = reach;
}

static double across_at(const slow_walk *walk, const shb_walk_triangle *t, uint32_t corner) {
    return walk->way[0] * (t->y[corner] - walk->to[1]) -
           walk->way[1] * (t->x[corner] - walk->to[0]);
}

static double along_at(const slow_walk *walk, const shb_walk_triangle *t, uint32_t corner) {
    return walk->way[0] * (t->x[corner] - walk->to[0]) +
           walk->way[1] * (t->y[corner] - walk->to[1]);
}

/* Of the two edges of the first triangle that the line crosses, which meet in the corner that lies
 * alone on its side, the one that is crossed farther ahead; or the other one if to lies before
 * both. False: it crosses none. */
static bool choose_exit(slow_walk *walk) {
    static const uint8_t alone_of[8] = {3, 0, 1, 2, 2, 1, 0, 3};
    const shb_walk_triangle *triangle = &walk->mesh->triangles[walk->first];
    double across[3], along[3];
    uint32_t left = 0;
    for (uint32_t k = 0; k < 3; k++) {
        across[k] = across_at(walk, triangle, k);
        along[k] = along_at(walk, triangle, k);
        left |= (uint32_t)(across[k] < 0) << k;
    }
    const uint32_t alone = alone_of[left];
    if (alone == 3)
        return false;
    const uint32_t edges[2] = {shb_ends_of_edges[0][alone], shb_ends_of_edges[1][alone]};
    const double side = across[alone] < 0 ? 1 : -1;
    double crossings[2], extents[2];
    for (int k = 0; k < 2; k++) {
        const uint32_t end = edges[!k];
        crossings[k] = side * (across[end] * along[alone] - across[alone] * along[end]);
        extents[k] = side * (across[end] - across[alone]);
    }
    const bool is_farther = crossings[1] * extents[0] > crossings[0] * extents[1];
    const bool is_before = (crossings[0] > 0) & (crossings[1] > 0);
    const uint32_t number = is_farther != is_before, edge = edges[number], end = edges[!number];
    const uint32_t on_left = left >> alone & 1 ? alone : end, on_right = alone + end - on_left;
    walk->across[0] = across[on_left];
    walk->across[1] = across[on_right];
    walk->along[0] = along[on_left];
    walk->along[1] = along[on_right];
    walk->crossing = crossings[number];
    walk->lower = on_left > on_right;
    walk->beyond = triangle->beyond[edge];
    return true;
}

static uint32_t stop(slow_walk *walk, bool cut) {
    walk->first = SHB_ID_NONE;
    walk->cut = cut;
    return SHB_ID_NONE;
}

/* Where snapping covered a sample just outside the triangle, its middle is a better start. */
static void enter(slow_walk *walk) {
    const shb_walk_triangle *t = &walk->mesh->triangles[walk->first];
    const uint32_t whole = 7 * SHB_CORNER_SEEN;
    bool goes = (t->marks & whole) == whole;
    if (goes && !choose_exit(walk)) {
        set_way(walk, ((t->x[0] + t->x[1]) + t->x[2]) / 3, ((t->y[0] + t->y[1]) + t->y[2]) / 3);
        goes = choose_exit(walk);
    }
    if (!goes)
        stop(walk, true);
}

void slow_walk_begin(const shb_light_mesh *mesh, uint32_t triangle, const double from[2],
                     const double to[2], slow_walk *walk) {
    walk->mesh = mesh;
    walk->to[0] = to[0];
    walk->to[1] = to[1];
    walk->first = triangle;
    walk->steps = 1;
    set_way(walk, from[0], from[1]);
    enter(walk);
}

/* Over the exit to the next triangle, whose own exit is found: its third corner takes the place of
 * the exit's end on the same side of the line. The walk is over where it has come round, or gone
 * too far from both places for what it meets to come back to them. */
uint32_t slow_walk_next(slow_walk *walk) {
    if (walk->first == SHB_ID_NONE)
        return SHB_ID_NONE;
    uint32_t beyond = walk->beyond, lower = walk->lower, id;
    double before, crossing = walk->crossing;
    double across[2] = {walk->across[0], walk->across[1]};
    double along[2] = {walk->along[0], walk->along[1]};
    do {
        const double extent = across[1] - across[0];
        id = shb_neighbour_of(beyond);
        if (beyond >= SHB_TWIN || walk->steps++ == SHB_WALK_MAX)
            return stop(walk, true);
        if (crossing > walk->farthest * extent || crossing < walk->nearest * extent ||
            id == walk->first)
            return stop(walk, false);
        const uint32_t third = shb_neighbour_edge(beyond);
        const shb_walk_triangle *triangle = &walk->mesh->triangles[id];
        if (!(triangle->marks & SHB_CORNER_SEEN << third))
            return stop(walk, true);
        const double aside = across_at(walk, triangle, third);
        const uint32_t side = (uint32_t) !(aside < 0), keeps_lower = lower ^ side;
        const uint32_t rises = third + keeps_lower >= 2; /* from the kept end to the third corner */
        across[side] = aside;
        along[side] = along_at(walk, triangle, third);
        lower = side ^ rises;
        beyond = triangle->beyond[shb_ends_of_edges[keeps_lower][third]];
        before = crossing;
        crossing = across[1] * along[0] - across[0] * along[1];
    } while (!(((before <= 0) & (crossing >= 0)) | ((before >= 0) & (crossing <= 0))));
    walk->beyond = beyond;
    walk->lower = lower;
    walk->crossing = crossing;
    walk->across[0] = across[0];
    walk->across[1] = across[1];
    walk->along[0] = along[0];
    walk->along[1] = along[1];
    return id;
}
