#include "soup.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void soup_add(soup *s, const float a[3], const float b[3], const float c[3]) {
    if (s->count == s->capacity) {
        s->capacity = s->capacity ? 2 * s->capacity : 64;
        s->positions = realloc(s->positions, s->capacity * 9 * sizeof(float));
        if (!s->positions)
            abort();
    }
    float *corners = s->positions + 9 * (size_t)s->count++;
    memcpy(corners, a, 3 * sizeof(float));
    memcpy(corners + 3, b, 3 * sizeof(float));
    memcpy(corners + 6, c, 3 * sizeof(float));
}

void soup_add_quad(soup *s, const float a[3], const float b[3], const float c[3],
                   const float d[3]) {
    soup_add(s, a, b, c);
    soup_add(s, a, c, d);
}

void soup_add_box(soup *s, const float lo[3], const float hi[3]) {
    float corners[8][3];
    for (int k = 0; k < 8; k++)
        for (int i = 0; i < 3; i++)
            corners[k][i] = k >> i & 1 ? hi[i] : lo[i];
    static const int faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                    {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (int f = 0; f < 6; f++)
        soup_add_quad(s, corners[faces[f][0]], corners[faces[f][1]], corners[faces[f][2]],
                      corners[faces[f][3]]);
}

/* A vertex of the ball; row 0 and the last one are the poles. */
static void ball_vertex(const float center[3], uint32_t columns, uint32_t rows, const double *radii,
                        uint32_t column, uint32_t row, float vertex[3]) {
    const double pi = 3.14159265358979323846;
    column %= columns;
    size_t number = (size_t)(row - 1) * columns + column;
    if (row == 0 || row == rows)
        number = (size_t)(rows - 1) * columns + (row == rows);
    const double radius = radii ? radii[number] : 1;
    const double latitude = pi * row / rows, longitude = 2 * pi * column / columns;
    const bool pole = row == 0 || row == rows;
    vertex[0] = (float)((double)center[0] + (pole ? 0 : radius * sin(latitude) * cos(longitude)));
    vertex[1] = (float)((double)center[1] + (pole ? 0 : radius * sin(latitude) * sin(longitude)));
    vertex[2] = (float)((double)center[2] + radius * cos(latitude));
}

void soup_add_ball(soup *s, const float center[3], uint32_t columns, uint32_t rows,
                   const double *radii) {
    for (uint32_t row = 0; row < rows; row++)
        for (uint32_t column = 0; column < columns; column++) {
            float a[3], b[3], c[3], d[3];
            ball_vertex(center, columns, rows, radii, column, row, a);
            ball_vertex(center, columns, rows, radii, column, row + 1, b);
            ball_vertex(center, columns, rows, radii, column + 1, row + 1, c);
            ball_vertex(center, columns, rows, radii, column + 1, row, d);
            if (row + 1 < rows)
                soup_add(s, a, b, c);
            if (row > 0)
                soup_add(s, a, c, d);
        }
}

void soup_add_patch(soup *s, test_random *random) {
    const double x = random_double(random, -1, 1), y = random_double(random, -1, 1);
    const double z = random_double(random, -2, 3.5), size = random_double(random, 0.01, 0.8);
    for (uint32_t i = random_below(random, 3) ? 20 : 400; i > 0; i--) {
        float corners[3][3];
        for (int k = 0; k < 3; k++) {
            corners[k][0] = (float)(x + random_double(random, -size, size));
            corners[k][1] = (float)(y + random_double(random, -size, size));
            corners[k][2] = (float)(z + random_double(random, -size, size));
        }
        soup_add(s, corners[0], corners[1], corners[2]);
    }
}

const shb_scene *soup_scene(soup *s) {
    s->mesh = (shb_mesh){
        .positions = s->positions, .vertex_count = 3 * s->count, .triangle_count = s->count};
    s->instance = (shb_instance){.mesh = &s->mesh, .world_from_mesh = s->transform};
    s->scene = (shb_scene){&s->instance, 1};
    return &s->scene;
}

void soup_free(soup *s) {
    free(s->positions);
    *s = (soup){0};
}
