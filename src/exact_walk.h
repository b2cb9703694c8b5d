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

/* A place of the map, texels. */
typedef struct shb_map_place {
    double x, y;
} shb_map_place;

typedef struct shb_walk {
    const shb_light_mesh *mesh;
    shb_map_place from, to;
    uint32_t triangle; /* the latest; SHB_ID_NONE: the walk has ended */
    /* The edge that it leaves by: its ends on the left and on the right of the line, and how far
     * they lie across it, negative on the left, times the line's length. */
    shb_map_place ends[2];
    double across[2];
    uint32_t lower;  /* which of them is the lower vertex */
    bool leaves;     /* the exit is known */
    uint32_t beyond; /* the neighbour there */
    double side;     /* where to lies to the edge, from its lower vertex to its higher one */
    double area;     /* of the triangle, positive if it lies on the left of the edge */
    int steps;
    bool straight; /* it ends where the mesh turns round */
    bool turned;   /* the mesh has turned round on the way, or may have: a triangle lies on the same
                      side of the edge that leads to it as the one before, told by places whatever
                      the winding, or is seen edge-on */
    bool passed;   /* it has met a triangle that covers to */
    bool cut;      /* it ended where no single triangle goes on, or at the light's near plane, or
                      was too long */
} shb_walk;

/* Begins a walk from a triangle that is seen at from, or nearly so, in the direction of to. */
void shb_walk_begin(const shb_light_mesh *mesh, uint32_t triangle, const double from[2],
                    const double to[2], shb_walk *walk);

/* Goes on to the next triangle that covers to, the first one included; SHB_ID_NONE: there is none
 * before the end. */
uint32_t shb_walk_next(shb_walk *walk);

/* The triangle of the same sheet that covers to; SHB_ID_NONE if the sheet ends on the way or turns
 * round. */
uint32_t shb_exact_walk(const shb_light_mesh *mesh, uint32_t triangle, const double from[2],
                        const double to[2]);

#endif
