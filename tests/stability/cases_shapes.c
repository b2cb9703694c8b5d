/* Creases, slender triangles, and meshes that are not what a mesh should be. */
#include "cases.h"

#include "noise.h"
#include "shapes.h"

#include <math.h>
#include <stdlib.h>

static void add_ground(owned_mesh *mesh) {
    shape_quad(mesh, (shb_vec3){-1, 0, 1}, (shb_vec3){1, 0, 1}, (shb_vec3){1, 0, -1},
               (shb_vec3){-1, 0, -1});
}

static void add_triangle(owned_mesh *mesh, shb_vec3 a, shb_vec3 b, shb_vec3 c) {
    const shb_vec3 corners[3] = {a, b, c};
    const shb_vec3 normal =
        shb_vec3_normalize(shb_vec3_cross(shb_vec3_subtract(b, a), shb_vec3_subtract(c, a)));
    const float shading[3] = {(float)normal.x, (float)normal.y, (float)normal.z};
    for (int i = 0; i < 3; i++) {
        const float position[3] = {(float)corners[i].x, (float)corners[i].y, (float)corners[i].z};
        owned_mesh_add_vertex(mesh, position, shading);
    }
    owned_mesh_add_triangle(mesh, mesh->vertex_count - 3, mesh->vertex_count - 2,
                            mesh->vertex_count - 1);
}

/* Boxes side by side; value: number of steps. */
static void build_stairs(owned_mesh *seen, owned_mesh *unseen, double value) {
    (void)unseen;
    const int count = (int)value;
    for (int i = 0; i < count; i++)
        shape_box(seen, (shb_vec3){1 - 2.0 * (i + 1) / count, 0, -0.8},
                  (shb_vec3){1 - 2.0 * i / count, 1.2 * (i + 1) / count, 0.8});
}

/* Treads and risers of a sheet; value: number of steps, negative if they climb to the light. */
static void build_stair_sheet(owned_mesh *seen, owned_mesh *unseen, double value) {
    (void)unseen;
    const int count = abs((int)value);
    const double side = value < 0 ? -1 : 1;
    for (int i = 0; i < count; i++) {
        const double near = side * (1 - 2.0 * i / count), far = side * (1 - 2.0 * (i + 1) / count);
        const double low = 1.2 * i / count, high = 1.2 * (i + 1) / count;
        shape_quad(seen, (shb_vec3){near, low, 0.8}, (shb_vec3){near, low, -0.8},
                   (shb_vec3){near, high, -0.8}, (shb_vec3){near, high, 0.8});
        shape_quad(seen, (shb_vec3){far, high, 0.8}, (shb_vec3){near, high, 0.8},
                   (shb_vec3){near, high, -0.8}, (shb_vec3){far, high, -0.8});
    }
}

/* The wall that stands before the camera is not seen. */
static void build_corner(owned_mesh *seen, owned_mesh *unseen, double unused) {
    (void)unused;
    add_ground(seen);
    shape_quad(seen, (shb_vec3){-1, 0, -1}, (shb_vec3){1, 0, -1}, (shb_vec3){1, 1, -1},
               (shb_vec3){-1, 1, -1});
    shape_quad(unseen, (shb_vec3){-1, 0, 1}, (shb_vec3){-1, 0, -1}, (shb_vec3){-1, 1, -1},
               (shb_vec3){-1, 1, 1});
}

/* Thin triangles that stand on the ground. */
static void build_needles(owned_mesh *seen, owned_mesh *unseen, double unused) {
    (void)unseen, (void)unused;
    add_ground(seen);
    for (uint32_t i = 0; i < 300; i++) {
        const double x = 0.9 * noise_random(3 * i), z = 0.9 * noise_random(3 * i + 1);
        const double lean = 0.2 * noise_random(3 * i + 2);
        add_triangle(seen, (shb_vec3){x, 0, z}, (shb_vec3){x + 0.003, 0, z - 0.003},
                     (shb_vec3){x + lean, 0.5, z + lean});
    }
}

/* A wave of long strips, each far narrower than a texel. */
static void build_slivers(owned_mesh *seen, owned_mesh *unseen, double unused) {
    (void)unseen, (void)unused;
    enum { columns = 4000 };
    shb_vec3 points[2 * columns];
    for (int i = 0; i < columns; i++) {
        const double x = -1 + 2.0 * i / (columns - 1), y = 0.1 * sin(6 * x);
        points[i] = (shb_vec3){x, y, 1};
        points[columns + i] = (shb_vec3){x, y, -1};
    }
    shape_grid(seen, points, columns, 2, false);
}

/* Leaves in the air, no two joined. */
static void build_foliage(owned_mesh *seen, owned_mesh *unseen, double value) {
    (void)unseen;
    add_ground(seen);
    for (uint32_t i = 0; i < (uint32_t)value; i++) {
        double r[9];
        for (uint32_t k = 0; k < 9; k++)
            r[k] = noise_random(9 * i + k);
        const shb_vec3 a = {0.8 * r[0], 0.5 + 0.4 * r[1], 0.8 * r[2]};
        add_triangle(seen, a, shb_vec3_add(a, (shb_vec3){0.05 * r[3], 0.05 * r[4], 0.05 * r[5]}),
                     shb_vec3_add(a, (shb_vec3){0.05 * r[6], 0.05 * r[7], 0.05 * r[8]}));
    }
}

static void build_crossing(owned_mesh *seen, owned_mesh *unseen, double unused) {
    (void)unseen, (void)unused;
    shape_box(seen, (shb_vec3){-1, -0.1, -1}, (shb_vec3){1, 0, 1});
    for (uint32_t i = 0; i < 24; i++) {
        const double x = 0.6 * noise_random(4 * i), z = 0.6 * noise_random(4 * i + 1);
        const double wide = 0.16 + 0.12 * noise_random(4 * i + 2);
        const double high = 0.3 + 0.2 * noise_random(4 * i + 3);
        shape_box(seen, (shb_vec3){x - wide, -0.05, z - 0.1}, (shb_vec3){x + wide, high, z + 0.1});
    }
}

/* Everything is there twice. */
static void build_duplicates(owned_mesh *seen, owned_mesh *unseen, double unused) {
    stability_build_blocks(seen, unseen, unused);
    stability_build_blocks(seen, unseen, unused);
}

/* A roof of one quad on one side and of many on the other: corners in the middle of an edge. */
static void build_t_junctions(owned_mesh *seen, owned_mesh *unseen, double unused) {
    (void)unseen, (void)unused;
    shape_quad(seen, (shb_vec3){0, 0.31, -1}, (shb_vec3){0, 0.31, 1}, (shb_vec3){1, 0, 1},
               (shb_vec3){1, 0, -1});
    for (int i = 0; i < 37; i++) {
        const double back = -1 + 2.0 * i / 37, front = -1 + 2.0 * (i + 1) / 37;
        shape_quad(seen, (shb_vec3){-1, 0, back}, (shb_vec3){-1, 0, front},
                   (shb_vec3){0, 0.31, front}, (shb_vec3){0, 0.31, back});
    }
}

#define SHAPE(text, builder, number, is_closed, is_quick)                                          \
    {                                                                                              \
        .group = "shape", .name = text, .build = builder, .value = number, .closed = is_closed,    \
        .quick = is_quick                                                                          \
    }

static const stability_case cases[] = {
    SHAPE("stairs-10", build_stairs, 10, true, true),
    SHAPE("stairs-100", build_stairs, 100, true, false),
    SHAPE("stair-sheet-10", build_stair_sheet, 10, false, false),
    SHAPE("stair-sheet-600", build_stair_sheet, 600, false, true),
    SHAPE("stair-sheet-30-to-light", build_stair_sheet, -30, false, true),
    SHAPE("corner", build_corner, 0, false, true),
    SHAPE("needles", build_needles, 0, false, true),
    SHAPE("slivers", build_slivers, 0, false, false),
    SHAPE("foliage", build_foliage, 3000, false, true),
    SHAPE("crossing", build_crossing, 0, true, true),
    SHAPE("duplicates", build_duplicates, 0, true, false),
    SHAPE("t-junctions", build_t_junctions, 0, false, true),
};

stability_cases stability_shape_cases(void) {
    return (stability_cases){cases, sizeof cases / sizeof *cases};
}
