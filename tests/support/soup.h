/* A growing list of triangles as a scene of one instance. */
#ifndef TESTS_SUPPORT_SOUP_H
#define TESTS_SUPPORT_SOUP_H

#include "random.h"
#include "shadowbias/scene.h"

typedef struct soup {
    float *positions; /* nine a triangle */
    uint32_t count, capacity;
    shb_mat4 transform; /* all zeros: the identity */
    shb_mesh mesh;
    shb_instance instance;
    shb_scene scene;
} soup;

/* Start from {0}. The corner arrays hold x, y, z. */
void soup_add(soup *s, const float a[3], const float b[3], const float c[3]);

/* The quad a, b, c, d as the triangles a b c and a c d. */
void soup_add_quad(soup *s, const float a[3], const float b[3], const float c[3], const float d[3]);

/* A closed box of 12 triangles, counter-clockwise from outside. */
void soup_add_box(soup *s, const float lo[3], const float hi[3]);

/* A closed ball of 2 * columns * (rows - 1) triangles round a centre, its poles along z. radii: one
 * a vertex, row by row, rows - 1 rows of columns and the two poles last; NULL: all 1. */
void soup_add_ball(soup *s, const float center[3], uint32_t columns, uint32_t rows,
                   const double *radii);

/* 20 or 400 triangles near one place of what the views of probe.h see, of a size of their own;
 * those near the light of a spot are cut. */
void soup_add_patch(soup *s, test_random *random);

/* The scene; valid until the next change. */
const shb_scene *soup_scene(soup *s);

void soup_free(soup *s);

#endif
