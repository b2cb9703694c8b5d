/* What moments are made of: distance from depth, and exponentials. */
#include "../src/depth_rows.h"
#include "../src/distance.h"
#include "../src/exponential.h"

#include "depth_map.h"
#include "probe.h"
#include "test.h"

#include <float.h>
#include <math.h>

TEST(exponential_keeps_its_bound_everywhere) {
    double worst = 0;
    for (int i = -870000; i <= 870000; i++) {
        const float x = (float)i * 1e-4f;
        const double expected = exp((double)x);
        const double error = fabs((double)shb_exponential(x) / expected - 1);
        worst = error > worst ? error : worst;
    }
    CHECK(worst <= 0x1p-22);
    CHECK(shb_exponential(0) == 1);
    CHECK(shb_exponential(87) <= FLT_MAX);
    CHECK(shb_exponential(-87) >= FLT_MIN);
}

TEST(logarithm_keeps_its_bound_everywhere) {
    double worst = 0;
    for (int i = -870000; i <= 870000; i++) {
        const float x = (float)exp(i * 1e-4);
        const double expected = log((double)x), size = fabs(expected);
        const double error = fabs((double)shb_logarithm(x) - expected) / (size > 1 ? size : 1);
        worst = error > worst ? error : worst;
    }
    CHECK(worst <= 0x1p-22);
    CHECK(shb_logarithm(1) == 0);
    CHECK_NEAR(shb_logarithm(FLT_MAX), log((double)FLT_MAX), 1e-5);
    CHECK_NEAR(shb_logarithm(FLT_MIN), log((double)FLT_MIN), 1e-5);
}

/* One texel is nearer than all others, one is farther, and one holds nothing. */
TEST(the_range_of_depths_is_that_of_all_rows_and_columns) {
    enum { WIDTH = 300, HEIGHT = 150 };
    static const int places[][2] = {{0, 0}, {255, 63}, {256, 64}, {299, 128}, {17, 149}};
    static float depths[WIDTH * HEIGHT];
    const shb_map_desc desc = {.view = probe_orthographic(false), .width = WIDTH, .height = HEIGHT};
    for (int k = 0; k < 5; k++) {
        const int *near = places[k], *far = places[(k + 1) % 5], *none = places[(k + 2) % 5];
        for (int i = 0; i < WIDTH * HEIGHT; i++)
            depths[i] = 0.5f;
        depths[near[1] * WIDTH + near[0]] = 0.25f;
        depths[far[1] * WIDTH + far[0]] = 0.75f;
        depths[none[1] * WIDTH + none[0]] = 1;
        depth_map host = depth_map_open(NULL, &desc, depths);
        const shb_depth_range range = shb_depth_range_of(host.map);
        CHECK(range.nearest == 0.25f && range.farthest == 0.75f);
        depth_map_close(&host);
    }
}

/* The map's farthest texel is given; the others lie at the near plane. */
static shb_distance distance_of(shb_view view, shb_format format, float farthest) {
    const float depths[4] = {0, 0, farthest, 0};
    depth_map host =
        depth_map_open(NULL, &(shb_map_desc){.view = view, .width = 2, .format = format}, depths);
    const shb_distance distance = shb_distance_of(host.map);
    depth_map_close(&host);
    return distance;
}

/* Depth 1.5 - 1.5 / w for w in 1 .. 3; the farthest texel, 0.9 of it, is at w = 2.5, and twice that
 * lies beyond the far plane. */
TEST(distance_grows_evenly_under_a_spot) {
    for (int reversed = 0; reversed < 2; reversed++) {
        const shb_distance distance =
            distance_of(probe_perspective(reversed), SHB_FORMAT_FLOAT32, 0.9f);
        for (int i = 0; i <= 16; i++) {
            const double w = 1 + i / 8.0, depth = 1.5 - 1.5 / w;
            const float canonical = (float)(reversed ? depth - 1 : depth);
            CHECK_NEAR(shb_distance_at(&distance, canonical), i / 16.0, 1e-6);
            CHECK_NEAR(shb_distance_to_depth(&distance, (float)i / 16), (double)canonical, 1e-6);
        }
        CHECK(shb_distance_at(&distance, reversed ? 0.0f : 1.0f) == 1);
        CHECK(shb_distance_at(&distance, reversed ? 5.0f : 6.0f) == 1);
        CHECK(shb_distance_at(&distance, reversed ? -1.0f : 0.0f) == 0);
        CHECK(shb_distance_at(&distance, -9) == 0);
        CHECK(shb_distance_at(&distance, NAN) == 0);
    }
}

TEST(distance_is_depth_under_a_directional_light) {
    for (int reversed = 0; reversed < 2; reversed++) {
        const shb_distance distance =
            distance_of(probe_orthographic(reversed), SHB_FORMAT_UNORM16, 0.5f);
        for (int i = 0; i <= 8; i++)
            CHECK(shb_distance_at(&distance, (float)i / 8 - (reversed ? 1 : 0)) == (float)i / 8);
    }
}

/* w = 4 - z and reversed depth 1 / w: the far plane is at infinity, the near one at w = 1. The
 * farthest texel is at depth 1 / 4, so the range ends at w = 8; a map without depths has an end,
 * too. */
TEST(distance_ends_at_twice_the_farthest_texel_without_a_far_plane) {
    const double rows[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 0, 1}, {0, 0, -1, 4}};
    const shb_distance distance = distance_of(probe_view(rows, true), SHB_FORMAT_FLOAT32, 0.75f);
    for (int w = 1; w <= 8; w++)
        CHECK_NEAR(shb_distance_at(&distance, -1 / (float)w), (w - 1) / 7.0, 1e-6);
    CHECK(shb_distance_at(&distance, -1 / 20.0f) == 1);
    CHECK(shb_distance_at(&distance, 0) == 1);
    const shb_distance empty = distance_of(probe_view(rows, true), SHB_FORMAT_FLOAT32, 0);
    CHECK(shb_distance_at(&empty, 0) == 1);
    CHECK(shb_distance_at(&empty, -1) == 0);
    CHECK(shb_distance_at(&empty, -0.5f) >= 0);
}

/* Half a step of depth moves a distance by less than the error says, at any depth; the error is no
 * more than some steps. */
TEST(distance_error_covers_a_step_of_the_format) {
    const shb_distance distance = distance_of(probe_perspective(false), SHB_FORMAT_UNORM16, 0.9f);
    for (int i = 1; i < 16; i++) {
        const float depth = (float)i / 16;
        const float moved =
            shb_distance_at(&distance, depth + 1.0f / 65535) - shb_distance_at(&distance, depth);
        CHECK(shb_distance_error(&distance, depth) >= 0.99f * moved);
        CHECK(shb_distance_error(&distance, depth) <= 1.2f * moved);
    }
}
