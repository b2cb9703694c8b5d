/* The exact method on maps that keep planes: slopes, the bound of rounding, refusals. */
#include "../src/exact.h"
#include "../src/format.h"
#include "../src/occluders.h"
#include "../src/slopes.h"
#include "contexts.h"
#include "isas.h"
#include "probe.h"
#include "random.h"
#include "shadowbias/clusters.h"
#include "slow_taps.h"
#include "soup.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The fields of x, y and the exponent: mantissas of 14 bits, two's complement. */
static uint32_t packed(uint32_t x, uint32_t y, uint32_t exponent) {
    return x << 18 | y << 4 | exponent;
}

TEST(slopes_share_the_least_exponent_that_holds_the_larger_one) {
    CHECK_INT(shb_slopes_of(0, 0), 0);
    CHECK_INT(shb_slopes_of(-0.0, 1), packed(0, 1, 0));
    CHECK_INT(shb_slopes_of(8191, -8191), packed(0x1fff, 0x2001, 0));
    CHECK_INT(shb_slopes_of(-1, 8192), packed(0, 0x800, 1)); /* -1/4 is nearest to 0 */
    CHECK_INT(shb_slopes_of(-3, 8192), packed(0x3fff, 0x800, 1));
    CHECK_INT(shb_slopes_of(-32764, 40), packed(0x2001, 10, 1));
    CHECK_INT(shb_slopes_of(32768, 40), packed(0x800, 2, 2)); /* 2.5: the even one below */
    CHECK_INT(shb_slopes_of(8191 * 0x1p30, -0x1p30), packed(0x1fff, 0x3fff, 15));
}

TEST(slopes_round_to_nearest_even) {
    CHECK_INT(shb_slopes_of(0.5, -0.5), 0);
    CHECK_INT(shb_slopes_of(1.5, -1.5), packed(2, 0x3ffe, 0));
    CHECK_INT(shb_slopes_of(0.5 + 0x1p-40, 2.5 - 0x1p-40), packed(1, 2, 0));
    CHECK_INT(shb_slopes_of(8191.5 - 0x1p-39, 2), packed(0x1fff, 2, 0));
    CHECK_INT(shb_slopes_of(8191.5, 2), packed(0x800, 0, 1));
    CHECK_INT(shb_slopes_of(2, -8191.5), packed(0, 0x3800, 1));
    CHECK_INT(shb_slopes_of(4 * 8191.5, 0), packed(0x800, 0, 2));
}

TEST(slopes_that_are_too_large_or_no_numbers_are_none) {
    const double largest = 8191.5 * 0x1p30 - 0x1p-9;
    CHECK_INT(shb_slopes_of(largest, 0), packed(0x1fff, 0, 15));
    CHECK_INT(shb_slopes_of(0, -largest), packed(0, 0x2001, 15));
    const double none[4] = {8191.5 * 0x1p30, -HUGE_VAL, HUGE_VAL, (double)NAN};
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++) {
            const double other = k == 0 ? 0 : k == 1 ? 1e5 : none[i];
            CHECK_INT(shb_slopes_of(none[i], other), 0xffffffff);
            CHECK_INT(shb_slopes_of(other, none[i]), 0xffffffff);
        }
}

/* Steps but the least ones are 2^-11 of the larger slope at most, or a little more where that is
 * rounded up to 2^11 of them. */
TEST(slopes_survive_within_half_a_step) {
    test_random random = {1};
    for (int i = 0; i < 100000; i++) {
        const double size = ldexp(1, (int)random_below(&random, 48) - 5);
        const double x = random_double(&random, -size, size), y = random_double(&random, -1, 1) * x;
        const uint32_t slopes =
            random_below(&random, 2) ? shb_slopes_of(x, y) : shb_slopes_of(y, x);
        const bool is_turned = slopes != shb_slopes_of(x, y);
        const double step = shb_slopes_step(slopes);
        CHECK(step <= fmax(1, fabs(x) * (0x1p-11 + 0x1p-24)));
        CHECK(fabs(shb_slope_x(slopes) - (is_turned ? y : x)) <= step / 2);
        CHECK(fabs(shb_slope_y(slopes) - (is_turned ? x : y)) <= step / 2);
        CHECK_INT(shb_slopes_of(shb_slope_x(slopes), shb_slope_y(slopes)), slopes);
    }
}

typedef struct host {
    shb_context *context;
    shb_map *map;
    test_log log;
} host;

static void open_host(host *opened, const shb_map_desc *desc) {
    *opened = (host){0};
    const shb_context_desc context = {.threads = 1, .log = test_log_keep, .log_user = &opened->log};
    CHECK_INT(shb_context_create(&context, &opened->context), SHB_OK);
    CHECK_INT(shb_map_create(opened->context, desc, &opened->map), SHB_OK);
}

static void close_host(host *opened) {
    shb_map_destroy(opened->map);
    shb_context_destroy(opened->context);
}

/* What the exact method says of one point with a normal up. */
static shb_result ask(const host *asked, const float point[3], const shb_filter *filter,
                      float *visibility) {
    static const float up[3] = {0, 0, 1};
    const shb_points points = {.count = 1, .positions = point, .normals = up};
    const shb_bias exact = shb_bias_exact();
    return shb_map_visibility(asked->map, &points, &exact, filter, visibility);
}

/* A floor at z = 0 and a plate over its left half at z = height, seen from above. */
static void add_plate(soup *s, float height) {
    soup_add_quad(s, (float[]){-1, -1, 0}, (float[]){1, -1, 0}, (float[]){1, 1, 0},
                  (float[]){-1, 1, 0});
    soup_add_quad(s, (float[]){-1, -1, height}, (float[]){0, -1, height}, (float[]){0, 1, height},
                  (float[]){-1, 1, height});
}

TEST(exact_needs_a_map_that_keeps_occluders) {
    static const float point[3] = {0.5f, 0, 0}, up[3] = {0, 0, 1};
    const shb_bias exact = shb_bias_exact(), constant = shb_bias_constant(0, SHB_UNIT_DEPTH);
    shb_map_desc desc = {.view = probe_orthographic(false), .width = 16};
    float visibility = 7;
    soup s = {0};
    add_plate(&s, 0.5f);
    host h;
    open_host(&h, &desc);
    CHECK_INT(shb_map_draw(h.map, soup_scene(&s), &exact, NULL), SHB_OK);
    CHECK_INT(ask(&h, point, NULL, &visibility), SHB_ERROR_UNSUPPORTED);
    CHECK(strstr(h.log.sentence, "shb_map_visibility") && strstr(h.log.sentence, "desc.occluders"));
    CHECK(visibility == 7);
    const size_t plain = shb_map_get_info(h.map)->memory_bytes;
    close_host(&h);

    desc.occluders = SHB_OCCLUDERS_PLANES;
    open_host(&h, &desc);
    CHECK_INT(shb_map_get_info(h.map)->occluders, SHB_OCCLUDERS_PLANES);
    CHECK(shb_map_get_info(h.map)->memory_bytes >= plain + 16 * 16 * 4);
    CHECK_INT(ask(&h, point, NULL, &visibility), SHB_OK);
    CHECK(visibility == 1);
    CHECK_INT(shb_map_draw(h.map, soup_scene(&s), &constant, NULL), SHB_OK);
    CHECK_INT(ask(&h, point, NULL, &visibility), SHB_ERROR_UNSUPPORTED);
    CHECK_INT(shb_map_draw(h.map, soup_scene(&s), &exact, NULL), SHB_OK);
    CHECK_INT(ask(&h, point, NULL, &visibility), SHB_OK);
    CHECK(visibility == 1);
    CHECK_INT(ask(&h, (float[]){-0.5f, 0, 0}, NULL, &visibility), SHB_OK);
    CHECK(visibility == 0);

    const shb_filter own = {
        .name = "own", .filter = shb_filter_hard().filter, .exact = shb_filter_hard().exact};
    CHECK_INT(ask(&h, point, &own, &visibility), SHB_OK);
    const shb_filter other = {.name = "other", .filter = (shb_filter_fn *)(void (*)(void))free};
    CHECK_INT(ask(&h, point, &other, &visibility), SHB_ERROR_UNSUPPORTED);
    CHECK(strstr(h.log.sentence, "\"other\""));
    const shb_points bare = {.count = 1, .positions = point};
    CHECK_INT(shb_map_visibility(h.map, &bare, &exact, NULL, &visibility), SHB_ERROR_UNSUPPORTED);
    const shb_points full = {.count = 1, .positions = point, .normals = up};
    CHECK_INT(shb_map_visibility(h.map, &full, &constant, NULL, &visibility), SHB_OK);
    soup_free(&s);
    close_host(&h);
}

TEST(a_wrapped_map_keeps_no_occluders) {
    float texels[16] = {0};
    host h = {0};
    const shb_context_desc context = {.threads = 1, .log = test_log_keep, .log_user = &h.log};
    CHECK_INT(shb_context_create(&context, &h.context), SHB_OK);
    const shb_map_desc desc = {
        .view = probe_orthographic(false), .width = 4, .occluders = SHB_OCCLUDERS_PLANES};
    CHECK_INT(shb_map_wrap(h.context, &desc, texels, 0, NULL, &h.map), SHB_ERROR_UNSUPPORTED);
    CHECK(h.map == NULL && strstr(h.log.sentence, "desc.occluders"));
    close_host(&h);
}

/* Depth is (4 - z) / 8: a gap g becomes g / 8, and floats near 1/2 lie 2^-24 apart (2^-25 just
 * below). So a gap of 2^-20 is many of them; the scene's size is 2. */
TEST(a_gap_of_a_millionth_of_the_scene_casts_its_shadow) {
    const shb_map_desc desc = {
        .view = probe_orthographic(false), .width = 16, .occluders = SHB_OCCLUDERS_PLANES};
    host h;
    open_host(&h, &desc);
    soup s = {0};
    add_plate(&s, 0x1p-20f);
    CHECK_INT(shb_map_draw(h.map, soup_scene(&s), NULL, NULL), SHB_OK);
    float visibility;
    for (int i = 0; i < 100; i++) {
        const float x = -1 + 0.02f * (float)i, y = 0.9f - 0.017f * (float)i;
        CHECK_INT(ask(&h, (float[]){x, y, 0}, NULL, &visibility), SHB_OK);
        CHECK(visibility == (x < 0 ? 0.0f : 1.0f));
        CHECK_INT(ask(&h, (float[]){x, y, 0x1p-20f}, NULL, &visibility), SHB_OK);
        CHECK(visibility == 1);
    }
    soup_free(&s);
    close_host(&h);
}

/* A point at (2.25, 3.5) and depth 0.5 and a texel whose centre is (2.25, -2) away. The point's
 * plane is there at 0.5 + 2.25 slope_x - 2 slope_y, within error + 2.25 * 0.001 + 2 * 0.002 and
 * what snapping moves the other plane's end by, 2^-9 texels (and 2^-10 of that); the texel's plane
 * is 0.5 * 2.25 - 0.125 * 2 nearer at the point, within 0.03 + 0.5 * 0.01 + 0.125 * 0.02 of the
 * point and 2.25 * 0.004 + 2 * 0.008 of its own. */
TEST(mutual_planes_shadow_by_more_than_both_bounds) {
    const shb_light_point point = {
        .x = 2.25, .y = 3.5, .z = 0.5, .w = 1, .error_x = 0.01, .error_y = 0.02, .error_z = 0.03};
    const double slopes[2][2] = {{0.25, -0.5}, {-0.25, 0.5}};
    const double snapped = 0x1p-9 * (1 + 0x1p-10), within = 0x1p-40;
    const double limits[2] = {
        /* the texel's plane decides */
        0.5 + (0.5 * 2.25 - 0.125 * 2) - (0.03 + 0.5 * 0.01 + 0.125 * 0.02) -
            (2.25 * 0.004 + 2 * 0.008),
        /* the point's own */
        0.5 - 0.25 * 2.25 - 0.5 * 2 - (0.05 + 2.25 * 0.001 + 2 * 0.002) - (0.75 + 0.375) * snapped};
    for (int i = 0; i < 2; i++) {
        const shb_exact_fragment fragment = {
            point, {slopes[i][0], slopes[i][1], 0.001, 0.002}, 0.05};
        shb_exact_sample sample = {4.5, 1.5, limits[i] - within, 0.5, 0.125, 0.004, 0.008};
        CHECK(shb_exact_is_shadowed(&fragment, &sample));
        sample.depth = limits[i] + within;
        CHECK(!shb_exact_is_shadowed(&fragment, &sample));
    }
}

TEST(planes_without_a_usable_normal_are_known_to_face_the_light) {
    static const double normals[][3] = {{0, 0, 0}, {(double)NAN, 0, 1}, {HUGE_VAL, 0, 0}};
    const double position[3] = {0.25, 0.5, 1};
    const shb_map_desc desc = {
        .view = probe_orthographic(false), .width = 16, .occluders = SHB_OCCLUDERS_PLANES};
    host h;
    open_host(&h, &desc);
    for (int i = 0; i < 3; i++) {
        const shb_exact_fragment fragment =
            shb_exact_fragment_of(&h.map->rows, position, normals[i]);
        const shb_light_slopes *s = &fragment.slopes;
        CHECK(s->x == 0 && s->y == 0 && s->error_x == 0 && s->error_y == 0);
        CHECK(fragment.error >= 0 && fragment.error < 1e-5);
    }
    close_host(&h);
}

/* The test of one fragment by the scalar functions. */
static float mutual_answer(const shb_map *map, const float at[3], const float turned[3]) {
    const double position[3] = {(double)at[0], (double)at[1], (double)at[2]};
    const double normal[3] = {(double)turned[0], (double)turned[1], (double)turned[2]};
    const shb_exact_fragment fragment = shb_exact_fragment_of(&map->rows, position, normal);
    const shb_light_point *point = &fragment.point;
    if (!(point->w > 0 && point->x >= 0 && point->x < map->info.width && point->y >= 0 &&
          point->y < map->info.height))
        return 1;
    const int32_t column = (int32_t)point->x, row = (int32_t)point->y;
    const shb_exact_sample sample = slow_sample_of(map, column, row);
    const bool is_far = sample.depth >= (map->info.view.reversed ? 0 : 1);
    return !is_far && shb_exact_is_shadowed(&fragment, &sample) &&
                   !slow_is_fine_sheet(map, &fragment, column, row)
               ? 0.0f
               : 1.0f;
}

enum { SAME_POINTS = 999 };

/* The same points with gaps. */
static shb_points spread_points(const shb_points *points) {
    static float spread[SAME_POINTS][7];
    for (size_t i = 0; i < SAME_POINTS; i++) {
        memcpy(spread[i], points->positions + 3 * i, 3 * sizeof(float));
        memcpy(spread[i] + 3, points->normals + 3 * i, 3 * sizeof(float));
    }
    return (shb_points){.count = SAME_POINTS,
                        .positions = spread[0],
                        .position_stride = sizeof spread[0],
                        .normals = spread[0] + 3,
                        .normal_stride = sizeof spread[0]};
}

/* Every instruction set that there is, on a map of its own. */
static void check_same_answers(const shb_scene *scene, const shb_map_desc *desc,
                               const shb_points *points) {
    static float expected[SAME_POINTS], visibility[SAME_POINTS];
    const shb_points spread = spread_points(points);
    const shb_bias exact = shb_bias_exact();
    for (shb_isa isa = SHB_ISA_SCALAR; isa < SHB_ISA_COUNT; isa = test_isa_after(isa)) {
        const shb_context_desc capped = {.threads = 1, .max_isa = isa};
        shb_context *context = NULL;
        shb_map *map = NULL;
        CHECK_INT(shb_context_create(&capped, &context), SHB_OK);
        CHECK_INT(shb_map_create(context, desc, &map), SHB_OK);
        CHECK_INT(shb_map_draw(map, scene, NULL, NULL), SHB_OK);
        if (isa == SHB_ISA_SCALAR) {
            int shadowed = 0;
            for (int i = 0; i < SAME_POINTS; i++) {
                expected[i] =
                    mutual_answer(map, points->positions + 3 * i, points->normals + 3 * i);
                shadowed += expected[i] == 0;
            }
            CHECK(shadowed > SAME_POINTS / 20 && shadowed < SAME_POINTS * 3 / 4);
        }
        CHECK_INT(shb_map_visibility(map, points, &exact, NULL, visibility), SHB_OK);
        CHECK(memcmp(visibility, expected, sizeof expected) == 0);
        CHECK_INT(shb_map_visibility(map, &spread, &exact, NULL, visibility), SHB_OK);
        CHECK(memcmp(visibility, expected, sizeof expected) == 0);
        shb_map_destroy(map);
        shb_context_destroy(context);
    }
}

/* Points on a ball, beside it and around it; some normals and positions are unusable. */
TEST(planes_answer_as_the_scalar_test_by_every_instruction_set) {
    static float points[3 * SAME_POINTS], normals[3 * SAME_POINTS];
    const shb_points all = {.count = SAME_POINTS, .positions = points, .normals = normals};
    const float center[3] = {0.2f, 0.1f, 1.6f};
    test_random random = {41};
    soup s = {0};
    soup_add_ball(&s, center, 24, 24, NULL);
    for (int i = 0; i < SAME_POINTS; i++)
        for (int k = 0; k < 3; k++) {
            const float along = (float)random_double(&random, -1, 1);
            const float around = (float)random_double(&random, -1.2, k == 2 ? 3 : 1.2);
            normals[3 * i + k] = i % 50 ? along : 0;
            points[3 * i + k] = i % 3 ? around : center[k] + along;
        }
    points[4] = NAN;
    points[8] = INFINITY;
    normals[12] = INFINITY;
    for (int i = 0; i < 8; i++) {
        const bool reversed = i & 1;
        shb_map_desc desc = {.width = 40, .occluders = SHB_OCCLUDERS_PLANES};
        desc.view = i & 2 ? probe_perspective(reversed) : probe_orthographic(reversed);
        desc.format = i & 4 ? SHB_FORMAT_UNORM16 : SHB_FORMAT_FLOAT32;
        check_same_answers(soup_scene(&s), &desc, &all);
    }
    soup_free(&s);
}

/* Points on a plate and below it, by up to twice of what rounding may hide, and behind the spot. */
TEST(planes_answer_as_the_scalar_test_where_little_decides) {
    static float points[3 * SAME_POINTS], normals[3 * SAME_POINTS];
    const shb_points all = {.count = SAME_POINTS, .positions = points, .normals = normals};
    const shb_vec3 normal = shb_vec3_normalize((shb_vec3){-0.5, 0.25, 1});
    test_random random = {42};
    soup s = {0};
    soup_add_quad(&s, (float[]){-2, -2, 1.5f}, (float[]){2, -2, 3.5f}, (float[]){2, 2, 2.5f},
                  (float[]){-2, 2, 0.5f});
    for (int i = 0; i < 8; i++) {
        const bool reversed = i & 1;
        shb_map_desc desc = {.width = 40, .height = 24, .occluders = SHB_OCCLUDERS_PLANES};
        desc.view = i & 2 ? probe_perspective(reversed) : probe_orthographic(reversed);
        desc.format = i & 4 ? SHB_FORMAT_UNORM16 : SHB_FORMAT_FLOAT32;
        const double deepest = i & 4 ? 1e-4 : 1e-5;
        for (int k = 0; k < SAME_POINTS; k++) {
            const double x = random_double(&random, -0.9, 0.9);
            const double y = random_double(&random, -0.9, 0.9);
            const double below = random_double(&random, 0, deepest);
            points[3 * k] = (float)x;
            points[3 * k + 1] = (float)y;
            points[3 * k + 2] = (float)(k % 20 ? 2 + 0.5 * x - 0.25 * y - below : 5 + x);
            normals[3 * k] = (float)normal.x;
            normals[3 * k + 1] = (float)normal.y;
            normals[3 * k + 2] = (float)normal.z;
        }
        check_same_answers(soup_scene(&s), &desc, &all);
    }
    soup_free(&s);
}

/* A ball and triangles of all sizes, so that texels hold runs of all lengths. */
static void add_clutter(soup *s) {
    test_random random = {43};
    soup_add_ball(s, (float[]){0.2f, 0.1f, 1.6f}, 24, 24, NULL);
    for (int i = 0; i < 60; i++) {
        const double size = ldexp(1, -(int)random_below(&random, 7));
        float corners[3][3];
        for (int k = 0; k < 9; k++)
            corners[k / 3][k % 3] =
                (float)((k < 3 ? 0 : (double)corners[0][k % 3]) +
                        random_double(&random, -1, 1) * (k < 3 ? 1 : size) + (k == 2 ? 1 : 0));
        soup_add(s, corners[0], corners[1], corners[2]);
    }
}

/* Depths and slopes of a map that is drawn by so many threads; rows without gaps. */
static void draw_planes(const shb_scene *scene, const shb_map_desc *desc, shb_isa isa,
                        uint32_t threads, uint32_t *out) {
    const shb_context_desc capped = {.threads = threads, .max_isa = isa};
    shb_context *context = NULL;
    shb_map *map = NULL;
    CHECK_INT(shb_context_create(&capped, &context), SHB_OK);
    CHECK_INT(shb_map_create(context, desc, &map), SHB_OK);
    CHECK_INT(shb_map_draw(map, scene, NULL, NULL), SHB_OK);
    const shb_depth_image depth = shb_map_get_depth(map);
    for (uint32_t row = 0; row < desc->height; row++) {
        memcpy(out, (const char *)depth.texels + row * depth.stride, desc->width * sizeof *out);
        memcpy(out + desc->width, shb_occluder_row(map, (int32_t)row), desc->width * sizeof *out);
        for (uint32_t i = 0; i < desc->width; i++)
            if (((const float *)(const void *)out)[i] == shb_far_depth(desc->view.reversed))
                out[desc->width + i] = SHB_ID_NONE;
        out += 2 * desc->width;
    }
    shb_map_destroy(map);
    shb_context_destroy(context);
}

TEST(maps_of_planes_are_the_same_by_every_instruction_set_and_number_of_threads) {
    enum { WIDTH = 150, HEIGHT = 90 };
    static uint32_t expected[2 * WIDTH * HEIGHT], drawn[2 * WIDTH * HEIGHT];
    soup s = {0};
    shb_context *context = NULL;
    shb_clusters *clusters = NULL;
    add_clutter(&s);
    soup_scene(&s);
    context = test_context(0, SHB_ISA_BEST);
    CHECK_INT(shb_clusters_create(context, &s.mesh, &clusters), SHB_OK);
    for (int i = 0; i < 4; i++) {
        shb_map_desc desc = {.width = WIDTH, .height = HEIGHT, .occluders = SHB_OCCLUDERS_PLANES};
        desc.view = i & 2 ? probe_perspective(i & 1) : probe_orthographic(i & 1);
        s.mesh.clusters = i & 1 ? clusters : NULL;
        s.instance.world_from_mesh =
            i & 2 ? shb_mat4_rotation((shb_vec3){0, 0, 1}, 0.7) : shb_mat4_identity();
        draw_planes(&s.scene, &desc, SHB_ISA_SCALAR, 1, expected);
        uint32_t held = 0;
        for (int k = 0; k < WIDTH; k++)
            held += expected[HEIGHT * WIDTH + WIDTH + k] != SHB_ID_NONE;
        CHECK(held > WIDTH / 4);
        for (shb_isa isa = SHB_ISA_SCALAR; isa < SHB_ISA_COUNT; isa = test_isa_after(isa))
            for (uint32_t threads = 1; threads <= 3; threads += 2) {
                draw_planes(&s.scene, &desc, isa, threads, drawn);
                CHECK(memcmp(drawn, expected, sizeof drawn) == 0);
            }
    }
    shb_clusters_destroy(clusters);
    shb_context_destroy(context);
    soup_free(&s);
}
