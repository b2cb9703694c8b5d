/* The depth that a tap is compared with: the naive way, a ray cut with the fragment's plane in the
 * world, against the plane's steps over texels. */
#include "../src/taps.h"

#include "contexts.h"
#include "probe.h"
#include "random.h"
#include "shadowbias/shadowbias.h"
#include "test.h"

#include <math.h>

/* By hand: rows of a map whose texels and depths are those of the world, and the plane z = 2 + 3 x
 * - y through (1, 1, 4). */
TEST(naive_taps_meet_the_plane_under_a_parallel_light) {
    const shb_light_rows rows = {
        .x = {1, 0, 0, 0}, .y = {0, 1, 0, 0}, .z = {0, 0, 1, 0}, .w = {0, 0, 0, 1}};
    const double point[3] = {1, 1, 4}, normal[3] = {-3, 1, 1};
    CHECK_NEAR(shb_tap_occluder(&rows, point, normal, 1, 1), 4, 1e-14);
    CHECK_NEAR(shb_tap_occluder(&rows, point, normal, 5.5, -2), 2 + 16.5 + 2, 1e-14);
}

/* By hand: a light at the origin that looks along z, texel x = 8 x / z, depth 1 - 1 / z. Its ray
 * through (4, 0) is (t / 2, 0, t); it meets the plane x + z = 6 at t = 4, depth 3 / 4. */
TEST(naive_taps_meet_the_plane_under_a_central_light) {
    const shb_light_rows rows = {
        .x = {8, 0, 0, 0}, .y = {0, 8, 0, 0}, .z = {0, 0, 1, -1}, .w = {0, 0, 1, 0}};
    const double point[3] = {0, 0, 6}, normal[3] = {1, 0, 1};
    CHECK_NEAR(shb_tap_occluder(&rows, point, normal, 0, 0), 1 - 1 / 6.0, 1e-14);
    CHECK_NEAR(shb_tap_occluder(&rows, point, normal, 4, 0), 0.75, 1e-14);
}

enum { POINTS = 500 };

typedef struct comparison {
    double worst; /* difference over bound */
    int compared;
} comparison;

/* Naive depths against those of the plane, over boxes of 31 x 31 taps. Rounding to float costs the
 * plane's way up to u = 2^-24 of each step, each product and two sums, and the naive way u of its
 * result; the rest is double. Slopes that were cut off do not count. */
static void compare_taps(const shb_filter_args *args) {
    comparison *made = (comparison *)(uintptr_t)args->filter->user;
    const shb_receivers *r = args->receivers;
    const double u = 0x1p-24;
    for (size_t i = 0; i < args->count; i++) {
        const float ref = r->ref[i], x = r->step_x[i], y = r->step_y[i];
        if (r->texel_x[i] == SHB_TEXEL_NONE || !(fabsf(x) < 0.9f && fabsf(y) < 0.9f))
            continue;
        const shb_tap_surface surface = shb_tap_surface_of(&args->map->rows, r, i);
        for (int m = -15; m <= 15; m += 3)
            for (int n = -15; n <= 15; n += 5) {
                const double plane = (double)shb_tap_depth(ref, x, y, (float)m, (float)n);
                const double naive = (double)shb_tap_naive(&args->map->rows, &surface, m, n);
                const double mx = fabs((double)x * m), ny = fabs((double)y * n);
                const double sum = fabs((double)ref + (double)x * m);
                const double bound = u * (2 * mx + 2 * ny + sum + 2 * fabs(plane)) * (1 + 4 * u);
                made->worst = fmax(made->worst, fabs(naive - plane) / (bound + 1e-12));
                made->compared++;
            }
        args->visibility[i] = 1;
    }
}

static comparison compare(shb_view view, const shb_bias *bias) {
    comparison made = {0};
    const shb_filter filter = {
        .name = "compare", .filter = compare_taps, .needs = SHB_NEEDS_NORMAL, .user = &made};
    static float positions[3 * POINTS], normals[3 * POINTS], visibility[POINTS];
    test_random random = {11};
    for (int i = 0; i < 3 * POINTS; i++) {
        positions[i] = (float)random_double(&random, -0.9, 0.9);
        normals[i] = (float)random_double(&random, -1, 1);
    }
    const shb_points points = {.count = POINTS, .positions = positions, .normals = normals};
    const shb_map_desc desc = {.view = view, .width = 256, .height = 128};
    shb_context *context;
    shb_map *map;
    context = test_context(1, SHB_ISA_BEST);
    CHECK_INT(shb_map_create(context, &desc, &map), SHB_OK);
    CHECK_INT(shb_map_visibility(map, &points, bias, &filter, visibility), SHB_OK);
    shb_map_destroy(map);
    shb_context_destroy(context);
    return made;
}

TEST(naive_taps_are_those_of_the_plane_but_for_rounding) {
    const shb_bias biases[] = {shb_bias_receiver_plane(1e-4f), shb_bias_adaptive(1e-3f, 10),
                               shb_bias_adaptive_soft(1e-4f, 10, 100)};
    for (int reversed = 0; reversed < 2; reversed++)
        for (int b = 0; b < 3; b++) {
            const comparison parallel = compare(probe_orthographic(reversed), &biases[b]);
            const comparison central = compare(probe_perspective(reversed), &biases[b]);
            CHECK(parallel.compared > 20000 && central.compared > 20000);
            CHECK(parallel.worst <= 1 && parallel.worst > 0.1);
            CHECK(central.worst <= 1 && central.worst > 0.1);
        }
}

/* The naive way puts back the plane that a constant bias leaves out: a tilted surface that shadows
 * itself in a box of 9 texels with the own bias in all taps is lit with a naive one. */
TEST(naive_taps_clear_a_slope_that_the_own_bias_does_not) {
    const float corners[] = {-1, -1, -1, 1, -1, 1, 1, 1, 1, -1, -1, -1, 1, 1, 1, -1, 1, -1};
    const shb_mesh mesh = {.positions = corners, .vertex_count = 6, .triangle_count = 2};
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene scene = {&instance, 1};
    const shb_bias bias = shb_bias_receiver_plane(1e-5f);
    const float position[3] = {0.1f, 0.2f, 0.1f}, normal[3] = {-0.70710678f, 0, 0.70710678f};
    const shb_points points = {.count = 1, .positions = position, .normals = normal};
    for (int reversed = 0; reversed < 2; reversed++) {
        const shb_map_desc desc = {.view = probe_orthographic(reversed), .width = 64};
        shb_context *context = test_context(1, SHB_ISA_BEST);
        shb_map *map;
        CHECK_INT(shb_map_create(context, &desc, &map), SHB_OK);
        CHECK_INT(shb_map_draw(map, &scene, NULL, NULL), SHB_OK);
        float seen[3];
        for (int taps = SHB_TAPS_PLANE; taps <= SHB_TAPS_NAIVE; taps++) {
            const shb_filter filter = shb_filter_pcf(9, SHB_UNIT_TEXEL, (shb_taps)taps);
            CHECK_INT(shb_map_visibility(map, &points, &bias, &filter, &seen[taps]), SHB_OK);
        }
        CHECK(seen[SHB_TAPS_PLANE] == 1 && seen[SHB_TAPS_NAIVE] == 1);
        CHECK_NEAR(seen[SHB_TAPS_OWN], 5.0 / 9,
                   1e-6); /* the columns nearer to the light shadow it */
        shb_map_destroy(map);
        shb_context_destroy(context);
    }
}
