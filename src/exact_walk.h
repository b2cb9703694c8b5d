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
    int exit;          /* the edge that it leaves by, from this corner to the next; -1: not yet */
    bool exit_is_left; /* is the exit's first corner on the left of the line? */
    double exit_side;  /* where to lies to the exit */
    double area;       /* of the triangle, with the sign of its winding */
    int steps;
    bool straight; /* it ends where the mesh turns round */
    bool turned;   /* the mesh has turned round on the way, or may have: a triangle lies on the same
                      side of the edge that leads to it as the one before, told by places whatever
                      the winding, or is seen edge-on */
    bool passed;   /* it has met a triangle that covers to */
    bool cut;      /* it ended where no single triangle goes on, or at the light's near plane, or
                      was too long */
} shb_walk;

/* A walk from a triangle that is seen at from, or nearly so, in the direction of to. */
shb_walk shb_walk_begin(const shb_light_mesh *mesh, uint32_t triangle, const double from[2],
                        const double to[2]);

/* Goes on to the next triangle that covers to, the first one included; SHB_ID_NONE: there is none
 * before the end. */
uint32_t shb_walk_next(shb_walk *walk);

/* The triangle of the same sheet that covers to; SHB_ID_NONE if the sheet ends on the way or turns
 * round. */
uint32_t shb_exact_walk(const shb_light_mesh *mesh, uint32_t triangle, const double from[2],
                        const double to[2]);

#endif
