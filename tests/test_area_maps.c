/* Area lights by many shadow maps: hand-worked penumbrae, the rays' answer, and what may fail. */
#include "shadowbias/area.h"

#include <math.h>
#include <string.h>

#include "allocator.h"
#include "contexts.h"
#include "random.h"
#include "soup.h"
#include "test.h"

enum { POINTS = 64 };

static const shb_area_light square = {{{0, 0, 2}, 1}, {0.5, 0, 0}, {0, 0.5, 0}, false};

/* A roof in the plane z = 1 from x = -90 to the edge; what is asked lies on the ground z = 0. */
static void add_roof(soup *s, float edge) {
    soup_add_quad(s, (float[3]){-90, -90, 1}, (float[3]){edge, -90, 1}, (float[3]){edge, 90, 1},
                  (float[3]){-90, 90, 1});
}

/* From (0, 0, 2) down to the ground's x and y in -2 .. 2. */
static shb_view look_down(bool reversed) {
    shb_view view = {0};
    CHECK_INT(shb_view_perspective((shb_vec3){0, 0, 2}, (shb_vec3){0, 0, 0}, (shb_vec3){0, 1, 0},
                                   2 * atan(1), 1, 0.25, 4, reversed, &view),
              SHB_OK);
    return view;
}

/* The same part of the ground from the direction (0, 0, 1). */
static shb_view look_along(bool reversed) {
    shb_view view = {0};
    CHECK_INT(shb_view_orthographic((shb_vec3){0, 0, 2}, (shb_vec3){0, 0, 0}, (shb_vec3){0, 1, 0},
                                    2, 2, 0.25, 4, reversed, &view),
              SHB_OK);
    return view;
}

/* The square light over the soup. */
static shb_area_desc describe(soup *s, const shb_bias *bias, shb_view view, uint32_t width,
                              uint32_t samples) {
    return (shb_area_desc){.scene = soup_scene(s),
                           .area = square,
                           .map = {.view = view, .width = width},
                           .samples = samples,
                           .bias = bias};
}

static shb_result ask(shb_context *context, const shb_area_desc *desc, const float *positions,
                      float *visibility) {
    const shb_points points = {.count = POINTS, .positions = positions};
    return shb_area_visibility(context, desc, &points, visibility);
}

static void place_across(float *positions, double from, double to) {
    for (int i = 0; i < POINTS; i++) {
        positions[3 * i] = (float)(from + (to - from) * (i + 0.5) / POINTS);
        positions[3 * i + 1] = (float)(0.3 * (i % 7) - 1);
        positions[3 * i + 2] = 0;
    }
}

/* As worked out for rays: (h + x) / 2h is lit; a light x0 beside the middle moves this by x0. The
 * points span 1.4 along x, and a texel as much on the ground as of the light's image. */
static void check_straight_edge(const shb_area_light *area, const shb_view *view, double h,
                                uint32_t width, uint32_t samples) {
    shb_context *context = test_context(1, SHB_ISA_BEST);
    soup s = {0};
    add_roof(&s, 0);
    const shb_bias none = shb_bias_none();
    const shb_area_desc desc = {.scene = soup_scene(&s),
                                .area = *area,
                                .map = {.view = *view, .width = width},
                                .samples = samples,
                                .bias = &none};
    float positions[3 * POINTS], visibility[POINTS];
    place_across(positions, -0.7, 0.7);
    CHECK_INT(ask(context, &desc, positions, visibility), SHB_OK);
    for (int i = 0; i < POINTS; i++) {
        const double part = (h + (double)positions[3 * i] + area->light.position.x) / (2 * h);
        CHECK_NEAR(visibility[i],
                   part < 0   ? 0
                   : part > 1 ? 1
                              : part,
                   1.0 / samples + 2.0 / width / h);
    }
    soup_free(&s);
    shb_context_destroy(context);
}

TEST(maps_of_a_square_make_a_linear_penumbra) {
    for (int reversed = 0; reversed < 2; reversed++) {
        const shb_view view = look_down(reversed);
        check_straight_edge(&square, &view, 0.5, 512, 256);
    }
}

TEST(there_may_be_as_many_maps_as_samples) {
    const shb_view view = look_down(false);
    check_straight_edge(&square, &view, 0.5, 64, SHB_AREA_SAMPLES_MAX);
}

TEST(maps_of_directions_make_a_linear_penumbra) {
    const shb_area_light sky = {{{0.1, 0, 1}, 0}, {0.25, 0, 0}, {0, 0.4, 0}, false};
    for (int reversed = 0; reversed < 2; reversed++) {
        const shb_view view = look_along(reversed);
        check_straight_edge(&sky, &view, 0.25, 512, 256);
    }
}

/* The view may stand anywhere: here 0.4 beside the light's middle. */
TEST(maps_are_those_of_the_light_wherever_the_view_stands) {
    shb_view view = {0};
    CHECK_INT(shb_view_perspective((shb_vec3){0.3, -0.4, 2.2}, (shb_vec3){0.1, 0, 0},
                                   (shb_vec3){0, 1, 0}, 2, 1, 0.25, 4, false, &view),
              SHB_OK);
    check_straight_edge(&square, &view, 0.5, 512, 256);
}

/* Lit is the part of the disk beyond c = -x / h: (acos(c) - c sqrt(1 - c^2)) / pi. */
TEST(maps_of_a_disk_make_the_area_of_a_segment) {
    const double pi = 3.14159265358979323846, h = 0.5;
    shb_context *context = test_context(1, SHB_ISA_BEST);
    soup s = {0};
    add_roof(&s, 0);
    const shb_bias none = shb_bias_none();
    shb_area_desc desc = {.scene = soup_scene(&s),
                          .area = square,
                          .map = {.view = look_down(false), .width = 512},
                          .samples = 512,
                          .bias = &none};
    desc.area.disk = true;
    float positions[3 * POINTS], visibility[POINTS];
    place_across(positions, -0.49, 0.49);
    CHECK_INT(ask(context, &desc, positions, visibility), SHB_OK);
    for (int i = 0; i < POINTS; i++) {
        const double c = -(double)positions[3 * i] / h;
        CHECK_NEAR(visibility[i], (acos(c) - c * sqrt(1 - c * c)) / pi, 0.02);
    }
    soup_free(&s);
    shb_context_destroy(context);
}

/* Under a roof without end nothing is lit: no point may leave the map of any sample, not at the
 * corners of the view and not for samples that lie 0.5 beside it. Beyond the view all is lit. */
TEST(every_map_holds_what_the_view_sees) {
    shb_context *context = test_context(1, SHB_ISA_BEST);
    soup s = {0};
    add_roof(&s, 90);
    const shb_bias none = shb_bias_none();
    for (int kind = 0; kind < 4; kind++) {
        const shb_area_light sky = {{{0.1, 0, 1}, 0}, {0.3, 0, 0}, {0, 0.3, 0.05}, true};
        shb_area_light lamp = square;
        lamp.v.z = 0.3;
        const bool reversed = kind % 2;
        const shb_area_desc desc = {
            .scene = soup_scene(&s),
            .area = kind < 2 ? lamp : sky,
            .map = {.view = kind < 2 ? look_down(reversed) : look_along(reversed), .width = 16},
            .samples = 37,
            .bias = &none};
        float positions[3 * POINTS] = {0}, visibility[POINTS];
        for (int i = 0; i < POINTS; i++) {
            const float reach = i < 40 ? 1.999f : 2.001f;
            positions[3 * i] = i & 1 ? reach : -reach;
            positions[3 * i + 1] = i & 2 ? reach : -reach;
        }
        CHECK_INT(ask(context, &desc, positions, visibility), SHB_OK);
        for (int i = 0; i < POINTS; i++)
            CHECK(visibility[i] == (i < 40 ? 0 : 1));
    }
    soup_free(&s);
    shb_context_destroy(context);
}

/* Scattered triangles over points on the ground, seen by many maps and by many rays. */
TEST(maps_converge_to_the_rays) {
    shb_context *context = test_context(2, SHB_ISA_BEST);
    test_random random = {77};
    soup s = {0};
    for (int i = 0; i < 25; i++) {
        float corners[3][3];
        const double x = random_double(&random, -1, 1), y = random_double(&random, -1, 1);
        for (int k = 0; k < 3; k++) {
            corners[k][0] = (float)(x + random_double(&random, -0.4, 0.4));
            corners[k][1] = (float)(y + random_double(&random, -0.4, 0.4));
            corners[k][2] = (float)random_double(&random, 0.2, 1.2);
        }
        soup_add(&s, corners[0], corners[1], corners[2]);
    }
    float positions[3 * POINTS], maps[POINTS], rays[POINTS];
    shb_vec3 places[POINTS];
    for (int i = 0; i < POINTS; i++) {
        positions[3 * i] = (float)random_double(&random, -1.4, 1.4);
        positions[3 * i + 1] = (float)random_double(&random, -1.4, 1.4);
        positions[3 * i + 2] = 0;
        places[i] = (shb_vec3){(double)positions[3 * i], (double)positions[3 * i + 1], 0};
    }
    const shb_bias none = shb_bias_none();
    const shb_area_desc desc = describe(&s, &none, look_down(true), 512, 512);
    const shb_area_points points = {.count = POINTS, .positions = places};
    shb_reference *reference;
    CHECK_INT(shb_reference_create(context, desc.scene, &reference), SHB_OK);
    CHECK_INT(shb_reference_area(reference, &square, 2048, &points, rays), SHB_OK);
    CHECK_INT(ask(context, &desc, positions, maps), SHB_OK);
    double largest = 0;
    int partly = 0;
    for (int i = 0; i < POINTS; i++) {
        largest = fmax(largest, fabs((double)maps[i] - (double)rays[i]));
        partly += rays[i] > 0.1f && rays[i] < 0.9f;
    }
    CHECK(partly > 20);
    CHECK_NEAR(largest, 0, 0.025);
    shb_reference_destroy(reference);
    soup_free(&s);
    shb_context_destroy(context);
}

/* A filter that needs nothing of the map: every point is lit by the share that it carries. */
static void constant_share(const shb_filter_args *args) {
    for (size_t i = 0; i < args->count; i++)
        args->visibility[i] = args->filter->params[0];
}

TEST(maps_are_asked_by_bias_and_filter) {
    shb_context *context = test_context(1, SHB_ISA_BEST);
    soup s = {0};
    add_roof(&s, 90);
    const shb_filter filter = {.name = "share", .filter = constant_share, .params = {0.25f}};
    const shb_bias none = shb_bias_none(), slope = shb_bias_slope(1, 0, 0);
    /* Nearly the whole range of depths: the ground appears in front of the roof. */
    const shb_bias lift = shb_bias_constant(0.9f, SHB_UNIT_DEPTH);
    shb_area_desc desc = {.scene = soup_scene(&s),
                          .area = square,
                          .map = {.view = look_down(true), .width = 32},
                          .samples = 8,
                          .bias = &none,
                          .filter = &filter};
    float positions[3 * POINTS], visibility[POINTS];
    place_across(positions, -1, 1);
    CHECK_INT(ask(context, &desc, positions, visibility), SHB_OK);
    CHECK(visibility[0] == 0.25f && visibility[POINTS - 1] == 0.25f);
    desc.filter = NULL;
    CHECK_INT(ask(context, &desc, positions, visibility), SHB_OK);
    CHECK(visibility[0] == 0);
    desc.bias = &lift;
    CHECK_INT(ask(context, &desc, positions, visibility), SHB_OK);
    CHECK(visibility[0] == 1);
    desc.bias = &slope;
    CHECK_INT(ask(context, &desc, positions, visibility), SHB_ERROR_UNSUPPORTED);
    CHECK(visibility[0] == 1);
    soup_free(&s);
    shb_context_destroy(context);
}

/* More points than one task takes, at strides of their own. */
TEST(maps_answer_the_same_for_any_number_of_threads) {
    enum { COUNT = 9000, STRIDE = 5 };
    static float positions[COUNT * STRIDE], visibility[2][COUNT];
    soup s = {0};
    add_roof(&s, 0);
    test_random random = {5};
    for (int i = 0; i < COUNT * STRIDE; i++)
        positions[i] = i % STRIDE == 2 ? 0 : (float)random_double(&random, -1, 1);
    const shb_bias none = shb_bias_none();
    const shb_area_desc desc = describe(&s, &none, look_down(false), 64, 10);
    for (uint32_t threads = 1; threads <= 3; threads += 2) {
        shb_context *context = test_context(threads, SHB_ISA_BEST);
        const shb_points points = {
            .count = COUNT, .positions = positions, .position_stride = STRIDE * sizeof(float)};
        CHECK_INT(shb_area_visibility(context, &desc, &points, visibility[threads / 2]), SHB_OK);
        shb_context_destroy(context);
    }
    CHECK(memcmp(visibility[0], visibility[1], sizeof visibility[0]) == 0);
    for (int i = 0; i < COUNT; i += 97) {
        const double part = 0.5 + (double)positions[STRIDE * i];
        CHECK_NEAR(visibility[0][i], part < 0 ? 0 : part > 1 ? 1 : part, 0.15);
    }
    soup_free(&s);
}

static void show_normal(const shb_filter_args *args) {
    for (size_t i = 0; i < args->count; i++)
        args->visibility[i] = args->receivers->normal_x[i];
}

TEST(maps_are_asked_with_each_points_own_normal) {
    enum { COUNT = 5000, STRIDE = 4 };
    static float positions[COUNT * 3], normals[COUNT * STRIDE], visibility[COUNT];
    for (int i = 0; i < COUNT; i++) {
        positions[3 * i] = (float)(i % 100) / 100;
        normals[STRIDE * i] = 0.5f * (float)i / COUNT;
        normals[STRIDE * i + 2] = sqrtf(1 - normals[STRIDE * i] * normals[STRIDE * i]);
    }
    soup s = {0};
    add_roof(&s, 0);
    const shb_filter filter = {.filter = show_normal, .needs = SHB_NEEDS_NORMAL};
    const shb_bias none = shb_bias_none();
    shb_area_desc desc = describe(&s, &none, look_down(false), 8, 1);
    desc.area.u = desc.area.v = (shb_vec3){0};
    desc.filter = &filter;
    const shb_points points = {.count = COUNT,
                               .positions = positions,
                               .normals = normals,
                               .normal_stride = STRIDE * sizeof(float)};
    shb_context *context = test_context(1, SHB_ISA_BEST);
    CHECK_INT(shb_area_visibility(context, &desc, &points, visibility), SHB_OK);
    for (int i = 0; i < COUNT; i++)
        CHECK_NEAR(visibility[i], normals[STRIDE * i], 1e-6);
    soup_free(&s);
    shb_context_destroy(context);
}

/* Seen from there the roof ends at x = 0. */
TEST(a_single_sample_is_the_middle_of_the_light) {
    soup s = {0};
    add_roof(&s, 0);
    const shb_bias none = shb_bias_none();
    shb_context *context = test_context(1, SHB_ISA_BEST);
    for (int disk = 0; disk < 2; disk++) {
        shb_area_desc desc = describe(&s, &none, look_down(false), 512, 1);
        desc.area.disk = disk;
        float positions[3 * POINTS], visibility[POINTS];
        place_across(positions, -0.7, 0.7);
        CHECK_INT(ask(context, &desc, positions, visibility), SHB_OK);
        for (int i = 0; i < POINTS; i++)
            CHECK(visibility[i] == (i < POINTS / 2 ? 0 : 1));
    }
    soup_free(&s);
    shb_context_destroy(context);
}

/* A light without an extent: away from the roof's edge all is dark or lit. */
TEST(maps_are_prepared_for_the_filter) {
    soup s = {0};
    add_roof(&s, 0);
    const shb_bias none = shb_bias_none();
    const shb_filter variance = shb_filter_variance(3, 0);
    shb_area_desc desc = describe(&s, &none, look_down(false), 64, 2);
    desc.area.u = desc.area.v = (shb_vec3){0};
    desc.filter = &variance;
    shb_context *context = test_context(1, SHB_ISA_BEST);
    float positions[3 * POINTS], visibility[POINTS];
    place_across(positions, -0.7, 0.7);
    CHECK_INT(ask(context, &desc, positions, visibility), SHB_OK);
    for (int i = 0; i < POINTS; i++)
        if (fabsf(positions[3 * i]) > 0.2f)
            CHECK_NEAR(visibility[i], positions[3 * i] > 0, 0.01);
    soup_free(&s);
    shb_context_destroy(context);
}

TEST(maps_of_area_lights_refuse_bad_arguments) {
    shb_context *context = test_context(1, SHB_ISA_BEST);
    soup s = {0};
    add_roof(&s, 0);
    const shb_bias none = shb_bias_none();
    const shb_area_desc good = describe(&s, &none, look_down(false), 8, 2);
    const float position[3] = {0, 0, 0};
    const shb_points points = {.count = 1, .positions = position};
    float v = 9;
    CHECK_INT(shb_area_visibility(NULL, &good, &points, &v), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_area_visibility(context, NULL, &points, &v), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_area_visibility(context, &good, NULL, &v), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_area_visibility(context, &good, &points, NULL), SHB_ERROR_ARGUMENT);
    shb_points bad_points = {.count = 1};
    CHECK_INT(shb_area_visibility(context, &good, &bad_points, &v), SHB_ERROR_ARGUMENT);
    bad_points = (shb_points){.count = 1, .positions = position, .position_stride = 13};
    CHECK_INT(shb_area_visibility(context, &good, &bad_points, &v), SHB_ERROR_ARGUMENT);
    shb_area_desc bad = good;
    bad.scene = NULL;
    CHECK_INT(shb_area_visibility(context, &bad, &points, &v), SHB_ERROR_ARGUMENT);
    bad = good;
    bad.bias = NULL;
    CHECK_INT(shb_area_visibility(context, &bad, &points, &v), SHB_ERROR_ARGUMENT);
    bad = good;
    bad.map.view = look_along(false);
    CHECK_INT(shb_area_visibility(context, &bad, &points, &v), SHB_ERROR_ARGUMENT);
    bad = good;
    bad.samples = 4097;
    CHECK_INT(shb_area_visibility(context, &bad, &points, &v), SHB_ERROR_SIZE);
    bad = good;
    bad.map.width = 0;
    CHECK_INT(shb_area_visibility(context, &bad, &points, &v), SHB_ERROR_SIZE);
    bad = good;
    bad.area.u.x = (double)NAN;
    CHECK_INT(shb_area_visibility(context, &bad, &points, &v), SHB_ERROR_NUMBER);
    bad = good;
    bad.map.view.clip_from_world.m[0] = (double)NAN;
    CHECK_INT(shb_area_visibility(context, &bad, &points, &v), SHB_ERROR_NUMBER);
    CHECK(v == 9);
    CHECK_INT(shb_area_visibility(context, &good, &(shb_points){0}, NULL), SHB_OK);
    soup_free(&s);
    shb_context_destroy(context);
}

TEST(maps_of_area_lights_survive_the_end_of_memory) {
    soup s = {0};
    add_roof(&s, 0);
    const shb_bias none = shb_bias_none();
    const shb_area_desc desc = describe(&s, &none, look_down(false), 8, 2);
    const float position[3] = {0, 0, 0};
    const shb_points points = {.count = 1, .positions = position};
    size_t failures = 0;
    shb_result result = SHB_ERROR_MEMORY;
    while (result == SHB_ERROR_MEMORY && failures < 100) {
        test_allocator allocator = {0};
        shb_context *context;
        const shb_context_desc context_desc = {.allocator = test_allocator_hooks(&allocator),
                                               .threads = 1};
        CHECK_INT(shb_context_create(&context_desc, &context), SHB_OK);
        allocator.fail_at = allocator.calls + failures + 1;
        float v = 9;
        result = shb_area_visibility(context, &desc, &points, &v);
        CHECK(result == SHB_OK || v == 9);
        failures += result == SHB_ERROR_MEMORY;
        shb_context_destroy(context);
        CHECK_INT(allocator.live, 0);
    }
    CHECK_INT(result, SHB_OK);
    CHECK(failures > 5);
    soup_free(&s);
}
