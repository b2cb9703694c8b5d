/* Building blocks of scenes: each adds triangles with normals to a mesh. Solids are closed, front
 * faces outwards. */
#ifndef EXAMPLES_SHAPES_H
#define EXAMPLES_SHAPES_H

#include "owned_mesh.h"

/* A point of a plane: of a lathe's profile (radius, height) or of an outline (x, y). */
typedef struct shape_point {
    double x, y;
} shape_point;

/* A flat sheet with its corners counter-clockwise. */
void shape_quad(owned_mesh *mesh, shb_vec3 a, shb_vec3 b, shb_vec3 c, shb_vec3 d);

void shape_box(owned_mesh *mesh, shb_vec3 lo, shb_vec3 hi);

/* The profile turned round the vertical through centre, in segments steps. It runs from bottom to
 * top and starts and ends with radius 0. Bends below 40 degrees are shaded smoothly. */
void shape_lathe(owned_mesh *mesh, shb_vec3 center, const shape_point *profile, size_t count,
                 uint32_t segments);

/* A ball of segments times segments / 2 faces; segments even, at most 128. */
void shape_ball(owned_mesh *mesh, shb_vec3 center, double radius, uint32_t segments);

/* A counter-clockwise outline pulled from z = back to z = front. The first point must see all
 * others: the caps are fans around it. */
void shape_prism(owned_mesh *mesh, const shape_point *outline, size_t count, double back,
                 double front);

/* A wall over a lower edge whose x never falls, up to a level top, from z = back to z = front. */
void shape_wall(owned_mesh *mesh, const shape_point *lower, size_t count, double top, double back,
                double front);

/* The points of a grid, row by row, joined by triangles and shaded smoothly; front faces where
 * columns run to the right and rows run up. closed joins the last column to the first; triangles
 * between equal points are left out, so a row may shrink to a point. */
void shape_grid(owned_mesh *mesh, const shb_vec3 *points, uint32_t columns, uint32_t rows,
                bool closed);

#endif
