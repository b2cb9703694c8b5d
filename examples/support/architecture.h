/* Columns and arches. */
#ifndef EXAMPLES_ARCHITECTURE_H
#define EXAMPLES_ARCHITECTURE_H

#include "shapes.h"

/* A column of the given radius on a square foot, with a moulded base and capital. */
void architecture_column(owned_mesh *mesh, shb_vec3 base, double radius, double height,
                         uint32_t segments);

/* A row of round arches from x = -bays * bay / 2 to the other end: a wall from z = back to z =
 * front that stands on pillars of the given width, with arches between them that begin at height
 * spring. */
typedef struct arcade_shape {
    uint32_t bays;  /* at most 16 */
    uint32_t steps; /* of an arch, at most 24 */
    double bay;     /* from the middle of a pillar to the next */
    double pillar;  /* width; 0: the arches meet */
    double spring, top;
    double back, front;
} arcade_shape;

void architecture_arcade(owned_mesh *mesh, const arcade_shape *arcade);

#endif
