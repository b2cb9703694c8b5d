/* Backprojection and bitmasks: what known occluders cover of the light.
 *
 * Under the orthographic light depth is (4 - z) / 8. An occluder at depth 1/4 is at z = 2 and a
 * receiver at depth 3/4 at z = -2, four units below; a light of width 1/4 at a distance of one
 * spans one unit at the occluder, half of the map. */
#include "allocator.h"
#include "contexts.h"
#include "depth_map.h"
#include "isas.h"
#include "probe.h"
#include "random.h"
#include "soup.h"
#include "test.h"

#include "shadowbias/area.h"

#include <math.h>
#include <string.h>

enum { SIZE = 64 };

static void fill(float *depths, float depth) {
    for (int i = 0; i < SIZE * SIZE; i++)
        depths[i] = depth;
}

static void fill_box(float *depths, int x0, int y0, int x1, int y1, float depth) {
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++)
            depths[y * SIZE + x] = depth;
}

static depth_map open_map(const shb_view *view, shb_format format, const float *depths) {
    return depth_map_open(NULL, &(shb_map_desc){.view = *view, .width = SIZE, .format = format},
                          depths);
}

static double ask(const float *depths, shb_filter filter, double x, double y) {
    const shb_view view = probe_orthographic(false);
    depth_map host = open_map(&view, SHB_FORMAT_FLOAT32, depths);
    depth_map_prepare(&host, &filter);
    const double visibility = depth_map_ask(&host, &filter, x, y, -2);
    depth_map_close(&host);
    return visibility;
}

/* From x the light spans x - 1/2 .. x + 1/2 at the occluder, which covers what is below 0. */
TEST(a_half_plane_gives_a_linear_penumbra) {
    float depths[SIZE * SIZE];
    fill(depths, 1);
    fill_box(depths, 0, 0, SIZE / 2, SIZE, 0.25f);
    const shb_view view = probe_orthographic(false);
    depth_map host = open_map(&view, SHB_FORMAT_FLOAT32, depths);
    const shb_filter areas = shb_filter_backprojection(0.25f, 64);
    const shb_filter bits = shb_filter_bitmask(0.25f, 64, 256);
    depth_map_prepare(&host, &areas);
    depth_map_prepare(&host, &bits);
    for (int i = -24; i <= 60; i++) {
        const double x = i / 64.0, expected = x > 0.5 ? 1 : x < -0.5 ? 0 : 0.5 + x;
        CHECK_NEAR(depth_map_ask(&host, &areas, x, 0.013, -2), expected, 1 / 1024.0);
        CHECK_NEAR(depth_map_ask(&host, &bits, x, 0.013, -2), expected, 1 / 256.0);
    }
    depth_map_close(&host);
}

/* Row 0 is the top: the upper half of the map is in the shadow of y > 0. */
TEST(rows_are_as_good_as_columns) {
    float depths[SIZE * SIZE];
    fill(depths, 1);
    fill_box(depths, 0, 0, SIZE, SIZE / 2, 0.25f);
    for (int i = -30; i <= 30; i += 5) {
        const double y = i / 64.0;
        CHECK_NEAR(ask(depths, shb_filter_backprojection(0.25f, 64), 0.01, y), 0.5 - y, 1 / 1024.0);
        CHECK_NEAR(ask(depths, shb_filter_bitmask(0.25f, 64, 64), 0.01, y), 0.5 - y, 1 / 64.0);
    }
}

/* Occluder at w = 1.2, depth 1/4, receiver at w = 2.4, depth 7/8: from x the occluder's edge is
 * seen at -x on the light, of width 1/2. */
TEST(a_spot_has_its_width_in_world_units) {
    float depths[SIZE * SIZE];
    fill(depths, 1);
    fill_box(depths, 0, 0, SIZE / 2, SIZE, 0.25f);
    for (int i = 0; i < 6; i++) {
        const shb_view view = probe_perspective(i & 1);
        const shb_filter filter = shb_filter_backprojection(0.5f, 64);
        depth_map host = open_map(&view, (shb_format)(i / 2), depths);
        depth_map_prepare(&host, &filter);
        for (int k = -20; k <= 20; k++) {
            const double x = 0.01 * k;
            CHECK_NEAR(depth_map_ask(&host, &filter, x, 0, 1.6), 0.5 + 2 * x, 0.002);
        }
        depth_map_close(&host);
    }
}

/* The same turned about (1, 2, 3) together with the light. */
TEST(a_turned_spot_has_its_width_in_world_units) {
    float depths[SIZE * SIZE];
    fill(depths, 1);
    fill_box(depths, 0, 0, SIZE / 2, SIZE, 0.25f);
    const shb_mat4 turn = shb_mat4_rotation((shb_vec3){1, 2, 3}, 2);
    const shb_mat4 back = shb_mat4_rotation((shb_vec3){1, 2, 3}, -2);
    const shb_filter filter = shb_filter_backprojection(0.5f, 64);
    shb_view view = probe_perspective(false);
    view.clip_from_world = shb_mat4_multiply(view.clip_from_world, back);
    depth_map host = open_map(&view, SHB_FORMAT_FLOAT32, depths);
    depth_map_prepare(&host, &filter);
    for (int k = -20; k <= 20; k++) {
        const shb_vec3 p = shb_mat4_transform_point(turn, (shb_vec3){0.01 * k, 0, 1.6});
        CHECK_NEAR(depth_map_ask(&host, &filter, p.x, p.y, p.z), 0.5 + 0.02 * k, 0.002);
    }
    depth_map_close(&host);
}

/* A texel is 1/32 wide, 1/32 of the light, and one above the middle covers its square. */
TEST(one_texel_covers_its_own_area) {
    float depths[SIZE * SIZE];
    fill(depths, 1);
    fill_box(depths, 40, 20, 41, 21, 0.25f);
    const double x = 40.5 / 32 - 1, y = 1 - 20.5 / 32;
    CHECK(ask(depths, shb_filter_backprojection(0.25f, 64), x, y) == 1 - 1 / 1024.0);
    CHECK(ask(depths, shb_filter_backprojection(0.25f, 64), x + 0.6, y) == 1);
}

/* The upper left quarter of the light: every fourth sample of the pattern lies there. */
TEST(a_quarter_is_counted_exactly) {
    float depths[SIZE * SIZE];
    fill(depths, 1);
    fill_box(depths, 0, 0, SIZE / 2, SIZE / 2, 0.25f);
    CHECK(ask(depths, shb_filter_backprojection(0.25f, 64), 0, 0) == 0.75);
    CHECK(ask(depths, shb_filter_bitmask(0.25f, 64, 64), 0, 0) == 0.75);
    CHECK(ask(depths, shb_filter_bitmask(0.25f, 64, 256), 0, 0) == 0.75);
}

/* Everything but the lower right quarter: from (1/4, -1/4) three quarters of the light are seen on
 * each axis. The corner's own empty quad has neighbours that block on both sides. */
TEST(a_corner_lets_its_part_through) {
    float depths[SIZE * SIZE];
    fill(depths, 0.25f);
    fill_box(depths, SIZE / 2, SIZE / 2, SIZE, SIZE, 1);
    CHECK(ask(depths, shb_filter_backprojection(0.25f, 64), 0.25, -0.25) == 9 / 16.0);
    CHECK(ask(depths, shb_filter_bitmask(0.25f, 64, 256), 0.25, -0.25) == 9 / 16.0);
}

/* Left of 0 at depth 1/4, the light one unit wide there; 0 .. 1/4 at depth 1/2, where it is half a
 * unit wide. From 1/16 the one covers 0 .. 7/16 of the light and the other 3/8 .. 7/8: the areas
 * add up to 15/16 and overlap by 1/16. Of 64 columns of samples the first 56 are covered. */
TEST(overlap_counts_twice_in_areas_and_once_in_bits) {
    float depths[SIZE * SIZE];
    fill(depths, 1);
    fill_box(depths, 0, 0, SIZE / 2, SIZE, 0.25f);
    fill_box(depths, SIZE / 2, 0, SIZE / 2 + SIZE / 8, SIZE, 0.5f);
    CHECK(ask(depths, shb_filter_backprojection(0.25f, 64), 0.0625, 0) == 1 / 16.0);
    CHECK(ask(depths, shb_filter_bitmask(0.25f, 64, 64), 0.0625, 0) == 8 / 64.0);
    CHECK(ask(depths, shb_filter_bitmask(0.25f, 64, 256), 0.0625, 0) == 32 / 256.0);
}

/* From -1/16 the left one covers 0 .. 9/16 and the right one 5/8 .. 9/8: the gap between them is
 * closed, to the right as well as downwards. */
TEST(gaps_between_occluders_are_closed) {
    float depths[SIZE * SIZE];
    fill(depths, 0.5f);
    fill_box(depths, 0, 0, SIZE / 2, SIZE, 0.25f);
    CHECK(ask(depths, shb_filter_backprojection(0.25f, 64), -0.0625, 0) == 0);
    CHECK(ask(depths, shb_filter_bitmask(0.25f, 64, 256), -0.0625, 0) == 0);
    fill(depths, 0.5f);
    fill_box(depths, 0, 0, SIZE, SIZE / 2, 0.25f);
    CHECK(ask(depths, shb_filter_backprojection(0.25f, 64), 0, 0.0625) == 0);
    CHECK(ask(depths, shb_filter_bitmask(0.25f, 64, 256), 0, 0.0625) == 0);
    /* no neighbour that blocks, no gap: 0 .. 9/16 alone */
    fill(depths, 1);
    fill_box(depths, 0, 0, SIZE / 2, SIZE, 0.25f);
    CHECK(ask(depths, shb_filter_backprojection(0.25f, 64), -0.0625, 0) == 7 / 16.0);
}

/* Whatever the window, also where its quads are many texels wide. */
TEST(full_cover_is_exactly_dark_and_nothing_exactly_lit) {
    const int windows[] = {4, 7, 32, 64};
    float depths[SIZE * SIZE];
    for (int i = 0; i < 4; i++) {
        const shb_filter areas = shb_filter_backprojection(0.25f, windows[i]);
        const shb_filter bits = shb_filter_bitmask(0.25f, windows[i], 256);
        for (int k = 0; k < 7; k++) {
            const double place = 0.021 * k - 0.05;
            fill(depths, 0.25f);
            CHECK(ask(depths, areas, place, 0.1) == 0);
            CHECK(ask(depths, bits, 0.1, place) == 0);
            fill(depths, 0.75f);
            CHECK(ask(depths, areas, place, 0.1) == 1);
            CHECK(ask(depths, bits, 0.1, place) == 1);
        }
    }
}

/* 33 texels in 8 quads: five wide, so the edge is off by less than five texels of 32. */
TEST(large_windows_take_larger_quads) {
    float depths[SIZE * SIZE];
    fill(depths, 1);
    fill_box(depths, 0, 0, SIZE / 2, SIZE, 0.25f);
    bool differs = false;
    for (int i = -8; i <= 8; i++) {
        const double x = i / 32.0, lit = ask(depths, shb_filter_backprojection(0.25f, 8), x, 0);
        CHECK_NEAR(lit, 0.5 + x, 5 / 32.0);
        differs |= fabs(lit - 0.5 - x) > 1 / 1024.0;
    }
    CHECK(differs);
}

static shb_filter filter_of(int kind) {
    return kind ? shb_filter_bitmask(0.25f, 16, 64) : shb_filter_backprojection(0.25f, 16);
}

static void write_nan(const shb_bias_args *args) {
    for (size_t i = 0; i < args->count; i++)
        args->receivers->ref[i] = NAN;
}

TEST(backprojection_lights_what_is_no_number_or_outside) {
    float depths[SIZE * SIZE];
    const shb_view view = probe_orthographic(true);
    const shb_bias undefined = {.name = "undefined", .depth = write_nan};
    const shb_points points = {.count = 1, .positions = (float[]){0, 0, 0}};
    fill(depths, 0.25f);
    for (int kind = 0; kind < 2; kind++) {
        const shb_filter filter = filter_of(kind);
        depth_map host = open_map(&view, SHB_FORMAT_FLOAT32, depths);
        depth_map_prepare(&host, &filter);
        float visibility = -1;
        CHECK(depth_map_ask(&host, &filter, 0, 0, -2) == 0);
        CHECK(depth_map_ask(&host, &filter, 0, 0, -1000) == 0);
        CHECK(depth_map_ask(&host, &filter, 0, 0, (double)NAN) == 1);
        CHECK(depth_map_ask(&host, &filter, 1.01, 0, -2) == 1);
        CHECK(depth_map_ask(&host, &filter, 0, -1.01, -2) == 1);
        CHECK_INT(shb_map_visibility(host.map, &points, &undefined, &filter, &visibility), SHB_OK);
        CHECK(visibility == 1);
        float *texels = host.texels;
        for (int i = 0; i < SIZE * SIZE; i++)
            texels[i] = NAN;
        depth_map_prepare(&host, &filter);
        CHECK(depth_map_ask(&host, &filter, 0, 0, -2) == 1);
        for (int i = 0; i < SIZE * SIZE; i++)
            texels[i] = HUGE_VALF;
        depth_map_prepare(&host, &filter);
        CHECK(depth_map_ask(&host, &filter, 0, 0, -2) == 0);
        CHECK(depth_map_ask(&host, &filter, 0, 0, -1000) == 0);
        depth_map_close(&host);
    }
}

static void write_steep_plane(const shb_bias_args *args) {
    shb_receivers *r = args->receivers;
    for (size_t i = 0; i < args->count; i++) {
        r->ref[i] = r->depth[i] + 0.04f * r->to_center_x[i];
        r->step_x[i] = 0.04f;
        r->step_y[i] = 0;
    }
}

/* A plane that goes down to the right passes below depth 0.8, which is farther than the fragment
 * all the same. To the left it rises, above the quarter at 1/4 from the thirteenth column on:
 * twelve of 32 columns cover half of their height. */
TEST(what_is_farther_than_the_fragment_covers_nothing) {
    float depths[SIZE * SIZE];
    const shb_view view = probe_orthographic(false);
    const shb_bias steep = {.name = "steep", .depth = write_steep_plane};
    const shb_points points = {.count = 1, .positions = (float[]){0, 0, -2}};
    fill(depths, 0.8f);
    fill_box(depths, 0, 0, SIZE / 2, SIZE / 2, 0.25f);
    const shb_filter filters[] = {shb_filter_backprojection(0.25f, 64),
                                  shb_filter_bitmask(0.25f, 64, 64)};
    for (int kind = 0; kind < 2; kind++) {
        depth_map host = open_map(&view, SHB_FORMAT_FLOAT32, depths);
        depth_map_prepare(&host, &filters[kind]);
        float visibility = -1;
        CHECK_INT(shb_map_visibility(host.map, &points, &steep, &filters[kind], &visibility),
                  SHB_OK);
        CHECK(visibility == 1 - 12 / 64.0f);
        depth_map_close(&host);
    }
}

enum { POINTS = 500 };

/* A plate some 0.8 above a tilted floor. */
static void build_scene(soup *scene) {
    soup_add_quad(scene, (float[]){-2, -2, -0.6f}, (float[]){2, -2, -0.2f}, (float[]){2, 2, 0.2f},
                  (float[]){-2, 2, -0.2f});
    soup_add_quad(scene, (float[]){-0.3f, -0.3f, 0.6f}, (float[]){0.3f, -0.3f, 0.6f},
                  (float[]){0.3f, 0.3f, 0.6f}, (float[]){-0.3f, 0.3f, 0.6f});
}

/* Points of the floor, or of its upper right part that nothing shadows. */
static void fill_points(float *positions, float *normals, double least) {
    const shb_vec3 normal = shb_vec3_normalize((shb_vec3){-0.1, -0.1, 1});
    test_random random = {12};
    for (int i = 0; i < POINTS; i++) {
        const double x = random_double(&random, least, 0.9), y = random_double(&random, least, 0.9);
        const double values[6] = {x, y, 0.1 * (x + y) - 0.2, normal.x, normal.y, normal.z};
        for (int k = 0; k < 3; k++) {
            positions[3 * i + k] = (float)values[k];
            normals[3 * i + k] = (float)values[3 + k];
        }
    }
}

static void ask_scene(const shb_context_desc *desc, uint32_t size, const shb_filter *filter,
                      double least, float *visibility) {
    static float positions[3 * POINTS], normals[3 * POINTS];
    soup scene = {0};
    build_scene(&scene);
    fill_points(positions, normals, least);
    shb_context *context = NULL;
    shb_map *map = NULL;
    const shb_bias adaptive = shb_bias_adaptive(1e-4f, 0);
    const shb_points points = {.count = POINTS, .positions = positions, .normals = normals};
    const shb_map_desc map_desc = {.view = probe_orthographic(true), .width = size};
    CHECK_INT(shb_context_create(desc, &context), SHB_OK);
    CHECK_INT(shb_map_create(context, &map_desc, &map), SHB_OK);
    CHECK_INT(shb_map_draw(map, soup_scene(&scene), &adaptive, NULL), SHB_OK);
    CHECK_INT(shb_map_prepare(map, filter), SHB_OK);
    CHECK_INT(shb_map_visibility(map, &points, &adaptive, filter, visibility), SHB_OK);
    shb_map_destroy(map);
    shb_context_destroy(context);
    soup_free(&scene);
}

TEST(backprojection_has_no_false_shadow_on_a_tilted_plane) {
    static float visibility[POINTS];
    for (int kind = 0; kind < 2; kind++)
        for (uint32_t size = 32; size <= 512; size *= 4) {
            const shb_filter filter = filter_of(kind);
            ask_scene(NULL, size, &filter, 0.6, visibility);
            for (int i = 0; i < POINTS; i++)
                CHECK(visibility[i] == 1);
        }
}

/* Rays to 1024 samples of the light say what is right. A texel of 1/128 is some 1/40 of the light's
 * width at the plate, and the plate's sides lie half a texel off at most. */
TEST(backprojection_is_near_the_truth) {
    static float positions[3 * POINTS], normals[3 * POINTS], expected[POINTS], visibility[POINTS];
    static shb_vec3 places[POINTS];
    fill_points(positions, normals, -0.9);
    for (int i = 0; i < POINTS; i++)
        places[i] = (shb_vec3){(double)positions[3 * i], (double)positions[3 * i + 1],
                               (double)positions[3 * i + 2] + 1e-6};
    soup scene = {0};
    build_scene(&scene);
    shb_context *context = NULL;
    shb_reference *reference = NULL;
    context = test_context(0, SHB_ISA_BEST);
    CHECK_INT(shb_reference_create(context, soup_scene(&scene), &reference), SHB_OK);
    const shb_area_light light = {.light = {{0, 0, 1}, 0}, .u = {0.2, 0, 0}, .v = {0, 0.2, 0}};
    const shb_area_points points = {.count = POINTS, .positions = places};
    CHECK_INT(shb_reference_area(reference, &light, 1024, &points, expected), SHB_OK);
    for (int kind = 0; kind < 2; kind++) {
        const shb_filter filter =
            kind ? shb_filter_bitmask(0.4f, 64, 256) : shb_filter_backprojection(0.4f, 64);
        ask_scene(NULL, 256, &filter, -0.9, visibility);
        double sum = 0, worst = 0;
        int partly = 0;
        for (int i = 0; i < POINTS; i++) {
            const double error = fabs((double)visibility[i] - (double)expected[i]);
            sum += error;
            worst = error > worst ? error : worst;
            partly += expected[i] > 0.04f && expected[i] < 0.95f;
        }
        CHECK(partly > POINTS / 10);
        CHECK(sum / POINTS < 0.004);
        CHECK(worst < 0.04);
    }
    shb_reference_destroy(reference);
    shb_context_destroy(context);
    soup_free(&scene);
}

TEST(backprojection_bits_do_not_depend_on_instruction_set_or_threads) {
    static float expected[POINTS], visibility[POINTS];
    for (int kind = 0; kind < 2; kind++) {
        const shb_filter filter = filter_of(kind);
        ask_scene(&(shb_context_desc){.threads = 1, .max_isa = SHB_ISA_SCALAR}, 200, &filter, -1,
                  expected);
        for (shb_isa isa = test_isa_after(SHB_ISA_SCALAR); isa < SHB_ISA_COUNT;
             isa = test_isa_after(isa)) {
            const uint32_t threads = (uint32_t)isa % 3 + 1;
            ask_scene(&(shb_context_desc){.threads = threads, .max_isa = isa}, 200, &filter, -1,
                      visibility);
            CHECK(memcmp(expected, visibility, sizeof expected) == 0);
        }
    }
}

TEST(backprojection_survives_every_lack_of_memory) {
    static float depths[SIZE * SIZE];
    for (int kind = 0; kind < 2; kind++) {
        test_allocator memory = {0};
        const shb_context_desc context = {.allocator = test_allocator_hooks(&memory), .threads = 1};
        const shb_filter filter = filter_of(kind);
        depth_map host = depth_map_open(
            &context, &(shb_map_desc){.view = probe_orthographic(false), .width = SIZE}, depths);
        const size_t live = memory.live;
        size_t failures = 0;
        for (;; failures++) {
            memory.fail_at = memory.calls + failures + 1;
            const shb_result result = shb_map_prepare(host.map, &filter);
            if (result == SHB_OK)
                break;
            CHECK_INT(result, SHB_ERROR_MEMORY);
            CHECK_INT(memory.live, live);
        }
        CHECK_INT(failures, 2);
        memory.fail_at = 0;
        depth_map_close(&host);
        CHECK_INT(memory.live, 0);
    }
}

TEST(backprojection_parameters_out_of_range_are_refused) {
    const char *texts[] = {"backprojection:light=0",  "backprojection:light=-1",
                           "backprojection:window=3", "backprojection:window=65",
                           "bitmask:light=0",         "bitmask:window=1000",
                           "bitmask:samples=128",     "bitmask:samples=0"};
    static float depths[SIZE * SIZE];
    const shb_view view = probe_orthographic(false);
    depth_map host = open_map(&view, SHB_FORMAT_FLOAT32, depths);
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        shb_filter filter;
        CHECK_INT(shb_filter_parse(texts[i], &filter), SHB_OK);
        CHECK_INT(shb_map_prepare(host.map, &filter), SHB_ERROR_ARGUMENT);
    }
    shb_filter large = shb_filter_backprojection(3e38f, 64);
    CHECK_INT(shb_map_prepare(host.map, &large), SHB_OK);
    CHECK(depth_map_ask(&host, &large, 0, 0, -2) <= 1);
    shb_filter small = shb_filter_backprojection(1e-37f, 64);
    CHECK_INT(shb_map_prepare(host.map, &small), SHB_OK);
    CHECK(depth_map_ask(&host, &small, 0.01, 0.01, -2) == 0);
    depth_map_close(&host);
}
