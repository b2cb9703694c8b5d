/* Soft shadows have the same bits on every instruction set, with and without a pyramid. */
#include "../src/pyramid.h"

#include "depth_map.h"
#include "isas.h"
#include "random.h"
#include "shadowbias/shadowbias.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 96, HEIGHT = 80, POINTS = 700 };

/* A tilted floor with plates above it, and noise in one corner. */
static double depth_at(test_random *random, int x, int y) {
    const bool plate = (x / 20 + y / 16) % 3 == 0;
    if (x > 70 && y > 60)
        return random_double(random, 0, 1);
    return (plate ? 0.2 : 0.5) + x * 0.002 - y * 0.001;
}

static depth_map new_map(shb_isa isa, bool spot, bool reversed, shb_format format) {
    static float depths[WIDTH * HEIGHT];
    const shb_map_desc desc = {.width = WIDTH, .height = HEIGHT, .format = format};
    test_random random = {7};
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        depths[i] = (float)depth_at(&random, i % WIDTH, i / WIDTH);
    return depth_map_open_lit(isa, spot, reversed, desc, depths);
}

typedef struct points {
    float positions[3 * POINTS], normals[3 * POINTS];
} points;

/* Runs of near points as a camera sees them, then scattered ones, some of them odd. */
static points *new_points(void) {
    static const float odd[] = {NAN, INFINITY, -INFINITY, 1e30f, -3e38f, 50};
    points *made = malloc(sizeof *made);
    test_random random = {3};
    float start[3] = {0, 0, 0};
    for (int i = 0; i < POINTS; i++)
        for (int axis = 0; axis < 3; axis++) {
            const int k = 3 * i + axis;
            if (i % 50 == 0)
                start[axis] = (float)random_double(&random, -1, 1);
            made->positions[k] = i < POINTS / 2 ? start[axis] + (float)(i % 50) * 0.004f
                                                : (float)random_double(&random, -1.1, 1.1);
            made->normals[k] = (float)random_double(&random, -1, 1);
            if (i > POINTS / 2 && random_below(&random, 20) == 0)
                made->positions[k] = odd[random_below(&random, 6)];
        }
    return made;
}

static void ask(const depth_map *asked, const points *given, size_t count, const shb_filter *filter,
                float *visibility) {
    const shb_bias bias = shb_bias_adaptive(1e-3f, 0);
    const shb_points list = {
        .count = count, .positions = given->positions, .normals = given->normals};
    CHECK_INT(shb_map_visibility(asked->map, &list, &bias, filter, visibility), SHB_OK);
}

static bool same(const float *a, const float *b, size_t count) {
    return memcmp(a, b, count * sizeof *a) == 0;
}

static void check_kernels(bool spot, bool reversed, shb_format format, const shb_filter *filter,
                          size_t count) {
    float expected[POINTS], actual[POINTS];
    points *given = new_points();
    depth_map scalar = new_map(SHB_ISA_SCALAR, spot, reversed, format);
    ask(&scalar, given, count, filter, expected);
    CHECK_INT(shb_map_prepare(scalar.map, filter), SHB_OK);
    ask(&scalar, given, count, filter, actual);
    CHECK(same(expected, actual, count));
    for (shb_isa isa = test_isa_after(SHB_ISA_SCALAR); isa < SHB_ISA_COUNT;
         isa = test_isa_after(isa)) {
        depth_map other = new_map(isa, spot, reversed, format);
        ask(&other, given, count, filter, actual);
        CHECK(same(expected, actual, count));
        CHECK_INT(shb_map_prepare(other.map, filter), SHB_OK);
        ask(&other, given, count, filter, actual);
        CHECK(same(expected, actual, count));
        depth_map_close(&other);
    }
    depth_map_close(&scalar);
    free(given);
}

TEST(pcss_kernels_give_scalar_bits) {
    const float sizes[] = {0, 0.02f, 0.1f, 0.4f, 20};
    const int taps[][2] = {{25, 25}, {16, 0}, {0, 32}, {1, 1}, {0, 0}};
    for (int size = 0; size < 5; size++)
        for (int i = 0; i < 5; i++) {
            const shb_filter filter = shb_filter_pcss(sizes[size], taps[i][0], taps[i][1],
                                                      i == 3 ? SHB_TAPS_OWN : SHB_TAPS_PLANE);
            check_kernels(i & 1, size & 1, SHB_FORMAT_FLOAT32, &filter, POINTS);
            check_kernels(!(i & 1), i & 2, SHB_FORMAT_FLOAT32, &filter, POINTS);
        }
}

TEST(pcss_kernels_give_scalar_bits_for_every_format_and_count) {
    for (size_t count = 1; count < 40; count += 6)
        for (int format = 0; format < 3; format++)
            for (int i = 0; i < 2; i++) {
                const int taps = i ? 19 : 0;
                const shb_filter filter = shb_filter_pcss(0.2f, taps, taps, SHB_TAPS_PLANE);
                check_kernels(i, format & 1, (shb_format)format, &filter, count);
            }
}

/* Few texels block over an empty floor, at the ends of searches as well: none may be missed. */
TEST(pcss_misses_no_blocker_by_the_pyramid) {
    test_random random = {11};
    points *given = new_points();
    for (int i = 0; i < 3 * POINTS; i++)
        given->normals[i] = (float)(i % 3 == 1);
    for (int round = 0; round < 60; round++) {
        depth_map asked = new_map(SHB_ISA_BEST, false, false, SHB_FORMAT_FLOAT32);
        float *const texels = asked.texels;
        for (int i = 0; i < WIDTH * HEIGHT; i++)
            texels[i] = random_below(&random, 400) ? 1 : 0.1f;
        const shb_filter filter =
            shb_filter_pcss((float)random_double(&random, 0, 0.5), 0, 0, SHB_TAPS_PLANE);
        float expected[POINTS], actual[POINTS];
        ask(&asked, given, POINTS, &filter, expected);
        CHECK_INT(shb_map_prepare(asked.map, &filter), SHB_OK);
        ask(&asked, given, POINTS, &filter, actual);
        CHECK(same(expected, actual, POINTS));
        depth_map_close(&asked);
    }
    free(given);
}

/* The pyramid of another map in place of the own one, by turns everything near and far. */
static void ask_with_other_pyramid(const shb_filter_args *args) {
    const shb_filter pcss = shb_filter_pcss(0.1f, 25, 25, SHB_TAPS_PLANE);
    shb_filter_args changed = *args;
    changed.filter = &pcss;
    changed.prepared = args->filter->user;
    pcss.filter(&changed);
}

static shb_pyramid *pyramid_of_constant(depth_map *asked, float depth) {
    size_t bytes;
    float *const texels = asked->texels;
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        texels[i] = depth;
    return shb_pyramid_create(asked->map, &bytes);
}

/* The map itself is a plate over everything, or nothing. */
TEST(pcss_answers_what_is_plain_by_the_pyramid) {
    for (shb_isa isa = SHB_ISA_SCALAR; isa < SHB_ISA_COUNT; isa = test_isa_after(isa)) {
        depth_map asked = new_map(isa, false, false, SHB_FORMAT_FLOAT32);
        shb_pyramid *empty = pyramid_of_constant(&asked, 1);
        shb_pyramid *covered = pyramid_of_constant(&asked, 0.1f);
        points *given = new_points();
        const float to_light[3] = {3, 4, 2};
        for (int i = 0; i < 300; i++) {
            given->positions[i] = 0.0001f * (float)(i / 3);
            given->normals[i] = to_light[i % 3];
        }
        float visibility[POINTS];
        const shb_filter lit = {.filter = ask_with_other_pyramid, .user = empty};
        const shb_filter dark = {.filter = ask_with_other_pyramid, .user = covered};
        ask(&asked, given, 100, &lit, visibility);
        for (int i = 0; i < 100; i++)
            CHECK(visibility[i] == 1);
        float *const texels = asked.texels;
        for (int i = 0; i < WIDTH * HEIGHT; i++)
            texels[i] = 1;
        ask(&asked, given, 100, &dark, visibility);
        for (int i = 0; i < 100; i++)
            CHECK(visibility[i] == 0);
        shb_pyramid_destroy(asked.map, empty);
        shb_pyramid_destroy(asked.map, covered);
        free(given);
        depth_map_close(&asked);
    }
}
