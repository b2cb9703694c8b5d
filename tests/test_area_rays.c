/* What reaches a point of an area light, against areas worked out by hand. */
#include "shadowbias/area.h"

#include <math.h>
#include <string.h>

#include "contexts.h"
#include "random.h"
#include "ray_caster.h"
#include "soup.h"
#include "test.h"

static const double pi = 3.14159265358979323846;

typedef struct scene_truth {
    soup soup;
    shb_context *context;
    shb_reference *reference;
} scene_truth;

static void finish(scene_truth *t) {
    t->context = test_context(0, SHB_ISA_BEST);
    CHECK_INT(shb_reference_create(t->context, soup_scene(&t->soup), &t->reference), SHB_OK);
}

static void free_truth(scene_truth *t) {
    shb_reference_destroy(t->reference);
    shb_context_destroy(t->context);
    soup_free(&t->soup);
}

/* A roof in the plane z = 1 that covers x < 0 and ends at x = 0; points lie on the ground z = 0. */
static scene_truth make_roof(void) {
    scene_truth t = {0};
    soup_add_quad(&t.soup, (float[3]){-90, -90, 1}, (float[3]){0, -90, 1}, (float[3]){0, 90, 1},
                  (float[3]){-90, 90, 1});
    finish(&t);
    return t;
}

static float ask_one(const scene_truth *t, const shb_area_light *area, uint32_t samples,
                     shb_vec3 position) {
    float visibility = -1;
    const shb_area_points points = {.count = 1, .positions = &position};
    CHECK_INT(shb_reference_area(t->reference, area, samples, &points, &visibility), SHB_OK);
    return visibility;
}

/* The light lies at z = 2, so its point (a, b, 2) is seen from (x, y, 0) through ((x + a) / 2, ...)
 * on the roof's plane: lit where a > -x. With a in -h .. h that is (h + x) / 2h of a rectangle. The
 * pattern's elements are regular grids, so n samples are off by 1 / n at most. */
static double lit_part(double x, double h) {
    const double part = (h + x) / (2 * h);
    return part < 0 ? 0 : part > 1 ? 1 : part;
}

TEST(penumbra_of_a_straight_edge_under_a_rectangle_is_linear) {
    scene_truth t = make_roof();
    const double h = 0.5;
    for (uint32_t samples = 1; samples <= 4096; samples *= 4) {
        const shb_area_light along = {{{0, 0, 2}, 1}, {h, 0, 0}, {0, h, 0}, false};
        const shb_area_light across = {{{0, 0, 2}, 1}, {0, -0.1, 0}, {-h, 0, 0}, false};
        for (double x = -0.63; x < 0.64; x += 0.07) {
            const shb_vec3 p = {x, 3 * x, 0};
            CHECK_NEAR(ask_one(&t, &along, samples, p), lit_part(x, h), 1.0001 / samples);
            CHECK_NEAR(ask_one(&t, &across, samples, p), lit_part(x, h), 1.0001 / samples);
        }
    }
    free_truth(&t);
}

/* A sample's x is 0.3 a + 0.2 b with a and b in -1 .. 1; at x = 0.1 it is lit where that exceeds
 * -0.1. For a given b this is (1 + (0.1 + 0.2 b) / 0.3) / 2 of all a, whose mean over b is 2/3. */
TEST(both_sides_of_a_light_count) {
    scene_truth t = make_roof();
    const shb_area_light area = {{{0, 0, 2}, 1}, {0.3, 0.2, 0}, {0.2, -0.3, 0}, false};
    CHECK_NEAR(ask_one(&t, &area, 4096, (shb_vec3){0.1, 0, 0}), 2.0 / 3, 0.004);
    CHECK_NEAR(ask_one(&t, &area, 4096, (shb_vec3){-0.1, 0, 0}), 1.0 / 3, 0.004);
    free_truth(&t);
}

/* A direction (a, b, 1) leaves (x, y, 0) through (x + a, ...): lit where a > -x, as above. */
TEST(directions_make_the_penumbra_of_their_tangents) {
    scene_truth t = make_roof();
    const shb_area_light sky = {{{0, 0, 1}, 0}, {0.25, 0, 0}, {0, 0.25, 0}, false};
    for (double x = -0.3; x < 0.31; x += 0.05)
        CHECK_NEAR(ask_one(&t, &sky, 1024, (shb_vec3){x, 1, 0}), lit_part(x, 0.25), 1.01 / 1024);
    free_truth(&t);
}

/* Dark is the segment a < c = -x / h of the unit disk: (pi - acos(c) + c sqrt(1 - c^2)) / pi. */
TEST(penumbra_of_a_disk_is_the_area_of_a_segment) {
    scene_truth t = make_roof();
    const double h = 0.4;
    const shb_area_light along = {{{0, 0, 2}, 1}, {h, 0, 0}, {0, h, 0}, true};
    const shb_area_light across = {{{0, 0, 2}, 1}, {0, 0.7, 0}, {h, 0, 0}, true};
    for (double x = -0.39; x < 0.4; x += 0.06) {
        const double c = -x / h;
        const double lit = (acos(c) - c * sqrt(1 - c * c)) / pi;
        CHECK_NEAR(ask_one(&t, &along, 4096, (shb_vec3){x, 0, 0}), lit, 0.004);
        CHECK_NEAR(ask_one(&t, &across, 4096, (shb_vec3){x, 0, 0}), lit, 0.004);
    }
    CHECK(ask_one(&t, &along, 4096, (shb_vec3){-0.401, 0, 0}) == 0);
    CHECK(ask_one(&t, &along, 4096, (shb_vec3){0.401, 0, 0}) == 1);
    free_truth(&t);
}

/* The corners of the square that a disk lacks stay dark behind a roof with a hole in front of them:
 * the hole x, y in 0.36 .. 0.5 of the plane z = 1 shows the light's x, y in 0.72 .. 1, which is
 * beyond the radius 1: 0.72 * sqrt(2) = 1.018. */
TEST(a_disk_has_no_corners) {
    scene_truth t = {0};
    const float near = 0.36f, far = 9;
    soup_add_quad(&t.soup, (float[3]){-far, -far, 1}, (float[3]){near, -far, 1},
                  (float[3]){near, far, 1}, (float[3]){-far, far, 1});
    soup_add_quad(&t.soup, (float[3]){-far, -far, 1}, (float[3]){far, -far, 1},
                  (float[3]){far, near, 1}, (float[3]){-far, near, 1});
    finish(&t);
    shb_area_light area = {{{0, 0, 2}, 1}, {1, 0, 0}, {0, 1, 0}, true};
    CHECK(ask_one(&t, &area, 4096, (shb_vec3){0, 0, 0}) == 0);
    area.disk = false;
    /* 0.28^2 of the square's 4 */
    CHECK_NEAR(ask_one(&t, &area, 4096, (shb_vec3){0, 0, 0}), 0.28 * 0.28 / 4, 0.002);
    free_truth(&t);
}

/* The light's samples (a, b, 2) seen from the origin make a non-negative product with (1, 0, 0)
 * where a is not negative. */
TEST(samples_behind_the_surface_are_dark) {
    scene_truth t = make_roof();
    const shb_area_light area = {{{0.1, 0, 0.5}, 1}, {0.4, 0, 0}, {0, 0.4, 0}, false};
    const shb_vec3 positions[4] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    const shb_vec3 normals[4] = {{7, 0, 0}, {-1, 0, 0}, {0, 0, 0}, {(double)NAN, 0, 0}};
    const shb_area_points points = {.count = 4, .positions = positions, .normals = normals};
    float visibility[4];
    CHECK_INT(shb_reference_area(t.reference, &area, 1000, &points, visibility), SHB_OK);
    CHECK_NEAR(visibility[0], 0.5 / 0.8, 0.00101);
    CHECK_NEAR(visibility[1], 0.3 / 0.8, 0.00101);
    CHECK(visibility[2] == 1 && visibility[3] == 1);
    free_truth(&t);
}

TEST(own_triangles_are_left_out_of_area_truth) {
    scene_truth t = make_roof();
    const shb_area_light area = {{{-5, -5, 2}, 1}, {0.5, 0, 0}, {0, 0.5, 0}, false};
    const shb_vec3 positions[3] = {{-5, -5.5, 0}, {-5, -5.5, 0}, {-5, -5.5, 0}};
    const uint32_t own_ids[3] = {0, 1, SHB_ID_NONE};
    const shb_area_points points = {.count = 3, .positions = positions, .own_ids = own_ids};
    float visibility[3];
    CHECK_INT(shb_reference_area(t.reference, &area, 64, &points, visibility), SHB_OK);
    /* The roof's diagonal y = 2x + 90 passes far to the side: triangle 0 covers the rays. */
    CHECK(visibility[0] == 1);
    CHECK(visibility[1] == 0);
    CHECK(visibility[2] == 0);
    free_truth(&t);
}

TEST(points_that_are_not_finite_or_on_the_light_are_lit) {
    scene_truth t = make_roof();
    const shb_area_light area = {{{-5, -5, 2}, 1}, {0, 0, 0}, {0, 0, 0}, true};
    CHECK(ask_one(&t, &area, 16, (shb_vec3){-5, -5, 0}) == 0);
    CHECK(ask_one(&t, &area, 16, (shb_vec3){-5, -5, 2}) == 1);
    CHECK(ask_one(&t, &area, 16, (shb_vec3){(double)NAN, -5, 0}) == 1);
    CHECK(ask_one(&t, &area, 16, (shb_vec3){-5, -(double)INFINITY, 0}) == 1);
    free_truth(&t);
}

/* ---- against single rays ---- */

/* The mean over a grid of the light's points, each asked by its own ray. Rings of a disk at radius
 * sqrt((i + 0.5) / n) and equal angles have equal areas. */
static double mean_of_rays(const scene_truth *t, const shb_area_light *area, shb_vec3 point) {
    enum { SIDE = 64 };
    unsigned lit = 0;
    for (int i = 0; i < SIDE; i++)
        for (int j = 0; j < SIDE; j++) {
            const double s = (i + 0.5) / SIDE, angle = 2 * pi * (j + 0.5) / SIDE;
            const double a = area->disk ? sqrt(s) * cos(angle) : 2 * s - 1;
            const double b = area->disk ? sqrt(s) * sin(angle) : (2.0 * j + 1) / SIDE - 1;
            const shb_vec3 along =
                shb_vec3_add(shb_vec3_scale(area->u, a), shb_vec3_scale(area->v, b));
            const shb_light_source light = {shb_vec3_add(area->light.position, along),
                                            area->light.w};
            uint8_t occluded = 2;
            shb_reference_occluded(t->reference, &light, 1, &point, NULL, &occluded);
            lit += !occluded;
        }
    return lit / (double)(SIDE * SIDE);
}

static scene_truth make_random(test_random *random, unsigned count, double size) {
    scene_truth t = {0};
    for (unsigned i = 0; i < count; i++) {
        const shb_vec3 at = random_point(random, 4);
        float corners[3][3];
        for (int k = 0; k < 3; k++) {
            const shb_vec3 p = shb_vec3_add(at, random_point(random, size));
            corners[k][0] = (float)p.x;
            corners[k][1] = (float)p.y;
            corners[k][2] = (float)p.z;
        }
        soup_add(&t.soup, corners[0], corners[1], corners[2]);
    }
    finish(&t);
    return t;
}

/* Few large triangles, which the shaft gathers, and many small ones, which it does not; lights of
 * all kinds, near and far, seen from the front, the side and from within. */
TEST(area_truth_is_the_mean_of_single_rays) {
    test_random random = {20};
    double largest = 0;
    unsigned partly = 0;
    for (int round = 0; round < 12; round++) {
        scene_truth t = make_random(&random, round % 2 ? 12 : 900, round % 2 ? 1.5 : 0.4);
        const double w = round % 3 ? 1 : 0;
        const shb_area_light area = {{random_point(&random, w > 0 ? 6 : 1), w},
                                     random_point(&random, w > 0 ? 1.5 : 0.4),
                                     random_point(&random, w > 0 ? 1.5 : 0.4),
                                     round % 4 > 1};
        for (int i = 0; i < 12; i++) {
            const shb_vec3 point = random_point(&random, 4);
            const double seen = (double)ask_one(&t, &area, 4096, point);
            const double expected = mean_of_rays(&t, &area, point);
            partly += expected > 0.02 && expected < 0.98;
            largest = fmax(largest, fabs(seen - expected));
        }
        free_truth(&t);
    }
    CHECK(partly > 40);
    CHECK_NEAR(largest, 0, 0.025);
}

/* ---- reproducible, refused ---- */

TEST(area_truth_depends_on_neither_threads_nor_neighbours) {
    enum { COUNT = 200 };
    test_random random = {21};
    scene_truth t = make_random(&random, 60, 1);
    const shb_area_light area = {{{1, 2, 5}, 1}, {0.5, 0, 0}, {0, 0.5, 0.1}, true};
    shb_vec3 positions[COUNT];
    float together[COUNT], threaded[COUNT];
    for (int i = 0; i < COUNT; i++)
        positions[i] = random_point(&random, 4);
    shb_area_points points = {.count = COUNT, .positions = positions};
    CHECK_INT(shb_reference_area(t.reference, &area, 100, &points, together), SHB_OK);
    for (int i = 0; i < COUNT; i++)
        CHECK(ask_one(&t, &area, 100, positions[i]) == together[i]);

    shb_context *context;
    shb_reference *reference;
    context = test_context(3, SHB_ISA_BEST);
    CHECK_INT(shb_reference_create(context, soup_scene(&t.soup), &reference), SHB_OK);
    CHECK_INT(shb_reference_area(reference, &area, 100, &points, threaded), SHB_OK);
    CHECK(memcmp(threaded, together, sizeof together) == 0);
    shb_reference_destroy(reference);
    shb_context_destroy(context);
    free_truth(&t);
}

TEST(area_truth_of_an_empty_scene_is_lit) {
    scene_truth t = {0};
    finish(&t);
    const shb_area_light area = {{{0, 0, 2}, 1}, {1, 0, 0}, {0, 1, 0}, false};
    CHECK(ask_one(&t, &area, 5, (shb_vec3){0, 0, 0}) == 1);
    CHECK_INT(shb_reference_area(t.reference, &area, 5, &(shb_area_points){0}, NULL), SHB_OK);
    free_truth(&t);
}

TEST(area_truth_refuses_bad_arguments) {
    scene_truth t = make_roof();
    const shb_area_light good = {{{0, 0, 2}, 1}, {1, 0, 0}, {0, 1, 0}, false};
    const shb_vec3 position = {0, 0, 0};
    const shb_area_points points = {.count = 1, .positions = &position};
    const shb_area_points missing = {.count = 1};
    float v = 9;
    CHECK_INT(shb_reference_area(NULL, &good, 1, &points, &v), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_reference_area(t.reference, NULL, 1, &points, &v), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_reference_area(t.reference, &good, 1, NULL, &v), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_reference_area(t.reference, &good, 1, &missing, &v), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_reference_area(t.reference, &good, 1, &points, NULL), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_reference_area(t.reference, &good, 0, &points, &v), SHB_ERROR_SIZE);
    CHECK_INT(shb_reference_area(t.reference, &good, 4097, &points, &v), SHB_ERROR_SIZE);
    shb_area_light bad[5] = {good, good, good, good, good};
    bad[0].light.w = 0.5;
    bad[1].light = (shb_light_source){{0, 0, 0}, 0};
    bad[2].light.position.y = (double)NAN;
    bad[3].u.z = (double)INFINITY;
    bad[4].v.x = (double)NAN;
    for (int i = 0; i < 5; i++)
        CHECK_INT(shb_reference_area(t.reference, &bad[i], 1, &points, &v), SHB_ERROR_NUMBER);
    CHECK(v == 9);
    free_truth(&t);
}
