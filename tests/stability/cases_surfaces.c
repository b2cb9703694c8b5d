/* Curved surfaces of few and many triangles. */
#include "cases.h"

#include "noise.h"
#include "shapes.h"

#include <math.h>
#include <stdlib.h>

static const double pi = 3.14159265358979323846;

/* value: number of triangles. */
static void build_sphere(owned_mesh *seen, owned_mesh *unseen, double value) {
    (void)unseen;
    const uint32_t columns = (uint32_t)sqrt(value), rows = columns / 2 + 1;
    shb_vec3 *points = malloc((size_t)columns * rows * sizeof *points);
    if (!points) {
        seen->failed = true;
        return;
    }
    for (uint32_t row = 0; row < rows; row++)
        for (uint32_t column = 0; column < columns; column++) {
            const double up = pi * row / (rows - 1), round = 2 * pi * column / columns;
            const bool pole = row == 0 || row == rows - 1;
            const double radius = pole ? 0 : 0.6 * sin(up);
            points[row * columns + column] =
                (shb_vec3){radius * sin(round), 0.6 - 0.6 * cos(up), radius * cos(round)};
        }
    shape_box(seen, (shb_vec3){-1, -0.1, -1}, (shb_vec3){1, 0, 1});
    shape_grid(seen, points, columns, rows, true);
    free(points);
}

/* A square of size by size points whose height is a function of the place. */
static void add_heights(owned_mesh *mesh, uint32_t size, double (*height)(double, double, double),
                        double value) {
    shb_vec3 *points = malloc((size_t)size * size * sizeof *points);
    if (!points) {
        mesh->failed = true;
        return;
    }
    for (uint32_t row = 0; row < size; row++)
        for (uint32_t column = 0; column < size; column++) {
            const double x = -1 + 2.0 * column / (size - 1), z = 1 - 2.0 * row / (size - 1);
            points[row * size + column] = (shb_vec3){x, height(x, z, value), z};
        }
    shape_grid(mesh, points, size, size, false);
    free(points);
}

static double bowl_height(double x, double z, double value) {
    return value * (x * x + z * z);
}

static double saddle_height(double x, double z, double value) {
    return value * (x * x - z * z);
}

static double terrain_height(double x, double z, double value) {
    return value * noise_fractal(4 * x + 31, 4 * z + 17, 6);
}

static void build_bowl(owned_mesh *seen, owned_mesh *unseen, double value) {
    (void)unseen;
    add_heights(seen, 97, bowl_height, value);
}

static void build_saddle(owned_mesh *seen, owned_mesh *unseen, double value) {
    (void)unseen;
    add_heights(seen, 97, saddle_height, value);
}

static void build_terrain(owned_mesh *seen, owned_mesh *unseen, double value) {
    (void)unseen;
    add_heights(seen, 257, terrain_height, value);
}

#define SPHERE(triangles, is_quick)                                                                \
    {                                                                                              \
        .group = "sphere", .name = "sphere-" #triangles, .build = build_sphere,                    \
        .value = triangles, .closed = true, .quick = is_quick                                      \
    }
#define SURFACE(text, builder, number, height, is_quick)                                           \
    {                                                                                              \
        .group = "surface", .name = text, .build = builder, .value = number, .sun_height = height, \
        .quick = is_quick                                                                          \
    }

static const stability_case cases[] = {
    SPHERE(1e2, false),
    SPHERE(1e3, true),
    SPHERE(1e4, false),
    SPHERE(1e5, false),
    SPHERE(1e6, false),
    SURFACE("bowl", build_bowl, 0.8, 35, true),
    SURFACE("bowl-low-sun", build_bowl, 0.4, 15, false),
    SURFACE("saddle", build_saddle, 0.7, 35, true),
    SURFACE("saddle-low-sun", build_saddle, 0.4, 15, false),
    SURFACE("terrain-45", build_terrain, 0.4, 45, true),
    SURFACE("terrain-80", build_terrain, 0.4, 10, false),
    SURFACE("terrain-85", build_terrain, 0.4, 5, true),
};

stability_cases stability_surface_cases(void) {
    return (stability_cases){cases, sizeof cases / sizeof *cases};
}
