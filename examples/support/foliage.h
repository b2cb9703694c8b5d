/* Leaves. */
#ifndef EXAMPLES_FOLIAGE_H
#define EXAMPLES_FOLIAGE_H

#include "owned_mesh.h"

/* A bent lozenge of two triangles without thickness, its stalk at a point, that grows roughly in
 * the direction out, a unit vector; number makes each of them another one. */
void foliage_leaf(owned_mesh *mesh, shb_vec3 at, shb_vec3 out, double size, uint32_t number);

#endif
