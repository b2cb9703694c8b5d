/* Walks over the mesh of a map's occluders, along the line where an upright plane of the light cuts
 * it: from triangle to triangle, over folds and back under them.
 *
 * The line that the light sees from one place of the map to another lies under one straight line of
 * the mesh, its section by a plane. On a closed mesh that section is a closed curve, which may fold
 * over and pass the same place several times, each time on a triangle that the light's ray meets
 * there. It leaves a triangle by the one other edge whose ends lie on different sides of the plane,
 * so that a walk cannot go astray whatever is rounded. */
#ifndef SRC_EXACT_WALK_H
#define SRC_EXACT_WALK_H

#include "map.h"

/* Triangles of a walk, and how far it goes beyond both places, texels. */
#define SHB_WALK_MAX 256
#define SHB_WALK_REACH 2.0

typedef struct shb_walk {
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
} shb_walk;

/* Begins a walk from a triangle that the line from one place to another crosses, or nearly so. */
void shb_walk_begin(const shb_light_mesh *mesh, uint32_t triangle, const double from[2],
                    const double to[2], shb_walk *walk);

/* Goes on to the next triangle that covers to; SHB_ID_NONE: there is none before the end. */
uint32_t shb_walk_next(shb_walk *walk);

#endif
