#include "asked_map.h"

#include "random.h"
#include "test.h"

#include <math.h>
#include <string.h>

asked_map asked_map_draw(shb_isa isa, const shb_map_desc *map, soup *s) {
    asked_map made;
    const shb_context_desc desc = {.max_isa = isa, .threads = 1};
    const shb_bias exact = shb_bias_exact();
    CHECK_INT(shb_context_create(&desc, &made.context), SHB_OK);
    CHECK_INT(shb_map_create(made.context, map, &made.map), SHB_OK);
    CHECK_INT(shb_map_draw(made.map, soup_scene(s), &exact, NULL), SHB_OK);
    return made;
}

void asked_map_close(asked_map *made) {
    shb_map_destroy(made->map);
    shb_context_destroy(made->context);
}

static shb_vec3 corner_of(const soup *s, uint32_t triangle, int k) {
    const float *p = s->positions + 9 * triangle + 3 * k;
    return (shb_vec3){(double)p[0], (double)p[1], (double)p[2]};
}

/* A point of a random triangle, half the time of one of the first two, with its unit normal. */
static void random_point(const soup *s, test_random *random, float *position, float *normal) {
    const uint32_t triangle = random_below(random, random_below(random, 2) ? s->count : 2);
    const shb_vec3 a = corner_of(s, triangle, 0), b = corner_of(s, triangle, 1);
    const shb_vec3 c = corner_of(s, triangle, 2);
    double u = random_double(random, 0, 1), v = random_double(random, 0, 1);
    if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
    }
    const shb_vec3 ab = shb_vec3_subtract(b, a), ac = shb_vec3_subtract(c, a);
    const shb_vec3 n = shb_vec3_normalize(shb_vec3_cross(ab, ac));
    position[0] = (float)(a.x + u * ab.x + v * ac.x);
    position[1] = (float)(a.y + u * ab.y + v * ac.y);
    position[2] = (float)(a.z + u * ab.z + v * ac.z);
    normal[0] = (float)n.x;
    normal[1] = (float)n.y;
    normal[2] = (float)n.z;
}

void asked_points_fill(const soup *s, uint64_t seed, asked_points *made) {
    test_random random = {seed};
    for (int i = 0; i < ASKED_POINTS; i++)
        random_point(s, &random, made->positions + 3 * i, made->normals + 3 * i);
    made->positions[5] = NAN;
    made->positions[9] = 3e38f;
    memset(made->normals + 12, 0, 3 * sizeof(float));
}

bool asked_point_fragment(const shb_map *map, const asked_points *given, int i,
                          shb_exact_fragment *fragment) {
    double position[3], normal[3];
    for (int k = 0; k < 3; k++) {
        position[k] = (double)given->positions[3 * i + k];
        normal[k] = (double)given->normals[3 * i + k];
    }
    *fragment = shb_exact_fragment_of(&map->rows, position, normal);
    return fragment->point.w > 0 && fabs(fragment->point.x) < 1e6 && fabs(fragment->point.y) < 1e6;
}

shb_result asked_map_answer(const asked_map *made, const asked_points *given,
                            const shb_filter *filter, float *visibility) {
    const shb_points list = {
        .count = ASKED_POINTS, .positions = given->positions, .normals = given->normals};
    const shb_bias exact = shb_bias_exact();
    return shb_map_visibility(made->map, &list, &exact, filter, visibility);
}

void asked_map_ask(const asked_map *made, const asked_points *given, const shb_filter *filter,
                   float *visibility) {
    CHECK_INT(asked_map_answer(made, given, filter, visibility), SHB_OK);
}

void asked_scene_add(soup *s) {
    double radii[24 * 11 + 2];
    for (size_t i = 0; i < sizeof radii / sizeof *radii; i++)
        radii[i] = 0.4;
    soup_add_quad(s, (float[]){-1, -1, -0.7f}, (float[]){1, -1, -0.5f}, (float[]){1, 1, -0.4f},
                  (float[]){-1, 1, -0.6f});
    soup_add_ball(s, (float[]){-0.3f, 0, 0.3f}, 24, 12, radii);
    soup_add_box(s, (float[]){0.3f, -0.9f, -0.8f}, (float[]){0.5f, 0.9f, 0.9f});
}

void asked_scene_add_relief(soup *s) {
    enum { CELLS = 14 };
    float corners[CELLS + 1][CELLS + 1][3];
    test_random random = {10};
    for (int row = 0; row <= CELLS; row++)
        for (int column = 0; column <= CELLS; column++) {
            float *corner = corners[row][column];
            corner[0] = -0.4f + 0.1f * (float)column;
            corner[1] = 0.1f + 0.065f * (float)row;
            corner[2] = (float)random_double(&random, -0.25, -0.1);
        }
    for (int row = 0; row < CELLS; row++)
        for (int column = 0; column < CELLS; column++)
            soup_add_quad(s, corners[row][column], corners[row][column + 1],
                          corners[row + 1][column + 1], corners[row + 1][column]);
}

void asked_scene_add_steep(soup *s) {
    soup_add_quad(s, (float[]){-0.9f, -0.9f, -0.8f}, (float[]){-0.86f, -0.9f, 0.8f},
                  (float[]){-0.86f, 0.9f, 0.8f}, (float[]){-0.9f, 0.9f, -0.8f});
    for (int i = 0; i < 60; i++) {
        const float x = -0.8f + 0.0151f * (float)i, wide = x + 0.0001f;
        soup_add_quad(s, (float[]){x, -0.7f, -0.9f}, (float[]){wide, -0.7f, 0.9f},
                      (float[]){wide + 0.6f, 0.9f, 0.9f}, (float[]){x + 0.6f, 0.9f, -0.9f});
    }
}

void asked_scene_lift(soup *s) {
    for (uint32_t i = 2; i < 9 * s->count; i += 3)
        s->positions[i] += 2;
}
