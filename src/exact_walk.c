#include "strict.h"

#include "exact_walk.h"

#include "exact_sheet.h"

#include <math.h>

static void set_way(shb_walk *walk, double from_x, double from_y) {
    const double x = walk->to[0] - from_x, y = walk->to[1] - from_y;
    const double squared = x * x + y * y, reach = SHB_WALK_REACH * sqrt(squared);
    walk->way[0] = x;
    walk->way[1] = y;
    walk->nearest = -(squared + reach);
    walk->farthest = reach;
}

static shb_walk_end end_at(const shb_walk *walk, const shb_walk_triangle *triangle,
                           uint32_t corner) {
    const double x = triangle->x[corner] - walk->to[0], y = triangle->y[corner] - walk->to[1];
    return (shb_walk_end){walk->way[0] * y - walk->way[1] * x, walk->way[0] * x + walk->way[1] * y};
}

static double crossing_of(const shb_walk_end ends[2]) {
    return ends[1].across * ends[0].along - ends[0].across * ends[1].along;
}

static double extent_of(const shb_walk_end ends[2]) {
    return ends[1].across - ends[0].across;
}

static void leave_by(shb_walk *walk, uint32_t edge, const shb_walk_end corners[3]) {
    const shb_walk_end lower = corners[shb_ends_of_edges[0][edge]];
    walk->lower = (uint32_t) !(lower.across < 0);
    walk->ends[walk->lower] = lower;
    walk->ends[!walk->lower] = corners[shb_ends_of_edges[1][edge]];
    walk->crossing = crossing_of(walk->ends);
    walk->beyond = walk->mesh->triangles[walk->triangle].beyond[edge];
}

/* Of the two edges of the first triangle that the line crosses, which meet in the corner that lies
 * alone on its side, the one that is crossed farther ahead; or the other one if to lies before
 * both. False: it crosses none. */
static bool choose_exit(shb_walk *walk) {
    static const uint8_t alone_of[8] = {3, 0, 1, 2, 2, 1, 0, 3};
    const shb_walk_triangle *triangle = &walk->mesh->triangles[walk->triangle];
    shb_walk_end corners[3];
    uint32_t left = 0;
    for (uint32_t k = 0; k < 3; k++) {
        corners[k] = end_at(walk, triangle, k);
        left |= (uint32_t)(corners[k].across < 0) << k;
    }
    const uint32_t alone = alone_of[left];
    if (alone == 3)
        return false;
    const uint32_t one = shb_ends_of_edges[0][alone], other = shb_ends_of_edges[1][alone];
    leave_by(walk, one, corners);
    const double crossing = walk->crossing, extent = extent_of(walk->ends);
    leave_by(walk, other, corners);
    const bool is_farther = walk->crossing * extent > crossing * extent_of(walk->ends);
    const bool is_before = crossing > 0 && walk->crossing > 0;
    if (is_farther == is_before)
        leave_by(walk, one, corners);
    return true;
}

static uint32_t stop(shb_walk *walk, bool cut) {
    walk->triangle = SHB_ID_NONE;
    walk->cut = cut;
    return SHB_ID_NONE;
}

/* The first triangle. Where snapping covered a sample just outside of it, its middle is a better
 * start. */
static uint32_t enter(shb_walk *walk) {
    const shb_walk_triangle *t = &walk->mesh->triangles[walk->triangle];
    const uint32_t whole = 7 * SHB_CORNER_SEEN;
    if ((t->marks & whole) != whole)
        return stop(walk, true);
    walk->steps = 1;
    if (!choose_exit(walk)) {
        set_way(walk, ((t->x[0] + t->x[1]) + t->x[2]) / 3, ((t->y[0] + t->y[1]) + t->y[2]) / 3);
        if (!choose_exit(walk))
            return stop(walk, true);
    }
    return shb_edges_before(t, walk->to) == 0 ? walk->triangle : shb_walk_next(walk);
}

void shb_walk_begin(const shb_light_mesh *mesh, uint32_t triangle, const double from[2],
                    const double to[2], shb_walk *walk) {
    *walk = (shb_walk){.mesh = mesh, .to = {to[0], to[1]}, .first = triangle, .triangle = triangle};
    set_way(walk, from[0], from[1]);
}

/* Over the exit to the next triangle, whose own exit is found: its third corner takes the place of
 * the exit's end on the same side of the line. The walk is over where it has come round, or gone
 * too far from both places for what it meets to come back to them. */
uint32_t shb_walk_next(shb_walk *walk) {
    if (walk->triangle == SHB_ID_NONE)
        return SHB_ID_NONE;
    if (walk->steps == 0)
        return enter(walk);
    uint32_t beyond = walk->beyond, lower = walk->lower, id;
    double before, crossing = walk->crossing;
    shb_walk_end ends[2] = {walk->ends[0], walk->ends[1]};
    do {
        const double extent = extent_of(ends);
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
        const shb_walk_end end = end_at(walk, triangle, third);
        const uint32_t side = (uint32_t) !(end.across < 0), keeps_lower = lower ^ side;
        const uint32_t rises = third + keeps_lower >= 2; /* from the kept end to the third corner */
        ends[side] = end;
        lower = side ^ rises;
        beyond = triangle->beyond[shb_ends_of_edges[keeps_lower][third]];
        before = crossing;
        crossing = crossing_of(ends);
    } while (!(((before <= 0) & (crossing >= 0)) | ((before >= 0) & (crossing <= 0))));
    walk->triangle = id;
    walk->beyond = beyond;
    walk->lower = lower;
    walk->crossing = crossing;
    walk->ends[0] = ends[0];
    walk->ends[1] = ends[1];
    return id;
}
