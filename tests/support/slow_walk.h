/* Walks as k_walks.inl makes them, one after the other and a triangle at a time. */
#ifndef TESTS_SUPPORT_SLOW_WALK_H
#define TESTS_SUPPORT_SLOW_WALK_H

#include "../../src/exact_triangles.h"

typedef struct slow_walk {
    const shb_light_mesh *mesh;
    double to[2], way[2];     /* texels; the way leads from the first place to the other */
    double nearest, farthest; /* along the line: what lies farther off does not come back */
    uint32_t first;           /* triangle; SHB_ID_NONE: the walk has ended */
    /* The ends, on the left and on the right, of the edge that it leaves by: how far they lie
     * across the line, negative on the left, and along it beyond to; both times the line's length.
     */
    double across[2], along[2];
    uint32_t lower;  /* which of them is the lower vertex */
    uint32_t beyond; /* the neighbour there */
    double
        crossing; /* where the line crosses that edge, along it, times the edge's extent across */
    int steps;
    bool cut; /* of one that has ended: where no single triangle goes on, or at the light's near
                 plane, or because it was too long */
} slow_walk;

/* Begins a walk from a triangle that the line from one place to another crosses, or nearly so. */
void slow_walk_begin(const shb_light_mesh *mesh, uint32_t triangle, const double from[2],
                     const double to[2], slow_walk *walk);

/* Goes on to the next triangle that covers to; SHB_ID_NONE: there is none before the end. */
uint32_t slow_walk_next(slow_walk *walk);

#endif
