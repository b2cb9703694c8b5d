/* Meshes that cover a rectangle of the x, y plane exactly once. */
#ifndef TESTS_SUPPORT_GRID_H
#define TESTS_SUPPORT_GRID_H

#include "random.h"
#include "shadowbias/scene.h"

typedef struct test_grid {
    float *positions;
    uint32_t *indices;
    shb_mesh mesh;
} test_grid;

/* columns by rows cells from (x0, y0) to (x1, y1), inner vertices moved by up to 0.15 cells on each
 * axis, each cell cut along a diagonal of its own; z is random within 0.4 .. 0.6. */
test_grid test_grid_create(test_random *random, uint32_t columns, uint32_t rows, double x0,
                           double y0, double x1, double y1);

/* A fan of count triangles around a point inside the rectangle of half sizes a, b about (x, y). */
test_grid test_grid_create_fan(test_random *random, uint32_t count, double x, double y, double a,
                               double b);

/* All vertices get this z. */
void test_grid_flatten(test_grid *grid, float z);

void test_grid_destroy(test_grid *grid);

#endif
