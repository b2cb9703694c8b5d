#include "grid.h"

#include <stdlib.h>

static test_grid allocate(uint32_t vertices, uint32_t triangles) {
    test_grid grid = {malloc(sizeof(float) * 3 * vertices),
                      malloc(sizeof(uint32_t) * 3 * triangles),
                      {.vertex_count = vertices, .triangle_count = triangles}};
    grid.mesh.positions = grid.positions;
    grid.mesh.indices = grid.indices;
    return grid;
}

static void put_vertex(test_grid *grid, uint32_t vertex, double x, double y, double z) {
    grid->positions[3 * vertex] = (float)x;
    grid->positions[3 * vertex + 1] = (float)y;
    grid->positions[3 * vertex + 2] = (float)z;
}

static void put_triangle(test_grid *grid, uint32_t triangle, uint32_t a, uint32_t b, uint32_t c) {
    grid->indices[3 * triangle] = a;
    grid->indices[3 * triangle + 1] = b;
    grid->indices[3 * triangle + 2] = c;
}

test_grid test_grid_create(test_random *random, uint32_t columns, uint32_t rows, double x0,
                           double y0, double x1, double y1) {
    test_grid grid = allocate((columns + 1) * (rows + 1), 2 * columns * rows);
    for (uint32_t row = 0; row <= rows; row++)
        for (uint32_t column = 0; column <= columns; column++) {
            const bool inner = row > 0 && row < rows && column > 0 && column < columns;
            const double jitter = inner ? 0.15 : 0;
            const double u = column + random_double(random, -jitter, jitter);
            const double v = row + random_double(random, -jitter, jitter);
            put_vertex(&grid, row * (columns + 1) + column, x0 + (x1 - x0) * u / columns,
                       y0 + (y1 - y0) * v / rows, random_double(random, 0.4, 0.6));
        }
    for (uint32_t cell = 0; cell < columns * rows; cell++) {
        const uint32_t a = cell / columns * (columns + 1) + cell % columns;
        const uint32_t b = a + 1, c = b + columns, d = c + 1;
        const bool flip = random_below(random, 2);
        put_triangle(&grid, 2 * cell, a, b, flip ? d : c);
        put_triangle(&grid, 2 * cell + 1, flip ? a : b, d, c);
    }
    return grid;
}

test_grid test_grid_create_fan(test_random *random, uint32_t count, double x, double y, double a,
                               double b) {
    test_grid grid = allocate(count + 1, count);
    put_vertex(&grid, count, x + random_double(random, -0.5, 0.5) * a,
               y + random_double(random, -0.5, 0.5) * b, 0.5);
    for (uint32_t i = 0; i < count; i++) {
        /* Once around the rectangle's border, corners included. */
        const double t = 4.0 * i / count;
        const int border = (int)t;
        const double s = 2 * (t - border) - 1;
        const double u[4] = {s, 1, -s, -1}, v[4] = {-1, s, 1, -s};
        put_vertex(&grid, i, x + a * u[border], y + b * v[border], 0.5);
        put_triangle(&grid, i, count, i, (i + 1) % count);
    }
    return grid;
}

void test_grid_flatten(test_grid *grid, float z) {
    for (uint32_t i = 0; i < grid->mesh.vertex_count; i++)
        grid->positions[3 * i + 2] = z;
}

void test_grid_destroy(test_grid *grid) {
    free(grid->positions);
    free(grid->indices);
}
