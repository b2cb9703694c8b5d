#include "random.h"
#include "test.h"

#include "shadowbias/view.h"

#include <math.h>

static const shb_vec3 origin = {0, 0, 0}, up = {0, 1, 0};
static const shb_box unit_box = {{-1, -1, -1}, {1, 1, 1}};

typedef struct clip_point {
    double x, y, z, w;
} clip_point;

static clip_point project(const shb_view *view, shb_vec3 p) {
    const double *m = view->clip_from_world.m;
    double c[4];
    for (int row = 0; row < 4; row++)
        c[row] = m[row] * p.x + m[4 + row] * p.y + m[8 + row] * p.z + m[12 + row];
    return (clip_point){c[0], c[1], c[2], c[3]};
}

static void check_vector(shb_vec3 actual, shb_vec3 expected, double tolerance) {
    CHECK_NEAR(actual.x, expected.x, tolerance);
    CHECK_NEAR(actual.y, expected.y, tolerance);
    CHECK_NEAR(actual.z, expected.z, tolerance);
}

static shb_vec3 box_corner(shb_box box, int corner) {
    return (shb_vec3){corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
                      corner & 4 ? box.hi.z : box.lo.z};
}

static shb_vec3 random_vector(test_random *random, double size) {
    return (shb_vec3){random_double(random, -size, size), random_double(random, -size, size),
                      random_double(random, -size, size)};
}

static shb_box random_box(test_random *random, double distance, double size) {
    const shb_vec3 lo = random_vector(random, distance);
    const shb_vec3 extent = {random_double(random, 0, size), random_double(random, 0, size),
                             random_double(random, 0, size)};
    return (shb_box){lo, shb_vec3_add(lo, extent)};
}

/* How the box lies in the view, in texels and depth: 0 .. map_size and 0 .. 1 are the view. */
typedef struct box_fit {
    double margin;            /* the least distance of a corner from the map's edge */
    double nearest, farthest; /* depth, 0 towards the light whether reversed or not */
} box_fit;

static box_fit fit_of(const shb_view *view, shb_box box, uint32_t map_size) {
    box_fit fit = {1e300, 1e300, -1e300};
    for (int corner = 0; corner < 8; corner++) {
        const clip_point p = project(view, box_corner(box, corner));
        CHECK(p.w > 0);
        const double depth = view->reversed ? 1 - p.z / p.w : p.z / p.w;
        const double edge = fmax(fabs(p.x), fabs(p.y)) / p.w;
        fit.margin = fmin(fit.margin, (1 - edge) * 0.5 * map_size);
        fit.nearest = fmin(fit.nearest, depth);
        fit.farthest = fmax(fit.farthest, depth);
    }
    return fit;
}

TEST(perspective_view_by_hand) {
    shb_view view;
    /* From (0, 0, 5) along -z with 90 degrees: a point at distance d has x / w = x / d. */
    CHECK_INT(shb_view_perspective((shb_vec3){0, 0, 5}, origin, up, 3.14159265358979323846 / 2, 2,
                                   1, 3, false, &view),
              SHB_OK);
    const clip_point p = project(&view, (shb_vec3){1, 0.5, 3});
    CHECK_NEAR(p.w, 2, 1e-15);
    CHECK_NEAR(p.x, 0.5, 1e-15);
    CHECK_NEAR(p.y, 0.5, 1e-15);
    CHECK_NEAR(p.z, 1.5, 1e-15); /* 1.5 d - 1.5 */
    CHECK(!view.reversed);
    CHECK_INT(
        shb_view_perspective((shb_vec3){0, 0, 5}, origin, up, 1, 1, 0.5, HUGE_VAL, true, &view),
        SHB_OK);
    const clip_point q = project(&view, (shb_vec3){0, 0, -3});
    CHECK_NEAR(q.z / q.w, 0.0625, 1e-16); /* near / d */
    CHECK(view.reversed);
}

TEST(orthographic_view_by_hand) {
    shb_view view;
    CHECK_INT(shb_view_orthographic((shb_vec3){0, 0, 5}, origin, up, 4, 2, 1, 5, true, &view),
              SHB_OK);
    const clip_point p = project(&view, (shb_vec3){1, -1, 3});
    CHECK_NEAR(p.x, 0.25, 0);
    CHECK_NEAR(p.y, -0.5, 0);
    CHECK_NEAR(p.z, 0.75, 1e-16); /* distance 2 of 1 .. 5, from the far end */
    CHECK_NEAR(p.w, 1, 0);
    CHECK(view.reversed);
}

static void check_perspective_refused(shb_vec3 eye, double angle, double aspect,
                                      double near_distance, double far_distance,
                                      shb_result expected) {
    shb_view view = {shb_mat4_scaling(7, 7, 7), true};
    CHECK_INT(shb_view_perspective(eye, origin, up, angle, aspect, near_distance, far_distance,
                                   false, &view),
              expected);
    CHECK(view.reversed && view.clip_from_world.m[0] == 7);
}

TEST(perspective_view_refuses_bad_arguments) {
    const shb_vec3 eye = {0, 0, 5};
    const double nan = (double)NAN, inf = HUGE_VAL;
    check_perspective_refused(origin, 1, 1, 1, 2, SHB_ERROR_ARGUMENT);
    check_perspective_refused(eye, 0, 1, 1, 2, SHB_ERROR_ARGUMENT);
    check_perspective_refused(eye, -1, 1, 1, 2, SHB_ERROR_ARGUMENT);
    check_perspective_refused(eye, 3.1415926535897936, 1, 1, 2, SHB_ERROR_ARGUMENT);
    check_perspective_refused(eye, 1, 0, 1, 2, SHB_ERROR_ARGUMENT);
    check_perspective_refused(eye, 1, -1, 1, 2, SHB_ERROR_ARGUMENT);
    check_perspective_refused(eye, 1, 1, 0, 2, SHB_ERROR_ARGUMENT);
    check_perspective_refused(eye, 1, 1, 2, 2, SHB_ERROR_ARGUMENT);
    check_perspective_refused(eye, 1, 1, 2, -inf, SHB_ERROR_ARGUMENT);
    check_perspective_refused(eye, nan, 1, 1, 2, SHB_ERROR_NUMBER);
    check_perspective_refused(eye, 1, inf, 1, 2, SHB_ERROR_NUMBER);
    check_perspective_refused(eye, 1, 1, nan, 2, SHB_ERROR_NUMBER);
    check_perspective_refused(eye, 1, 1, inf, inf, SHB_ERROR_NUMBER);
    check_perspective_refused(eye, 1, 1, 1, nan, SHB_ERROR_NUMBER);
    check_perspective_refused(eye, 1, 1e-310, 1, 2, SHB_ERROR_NUMBER); /* 1 / aspect overflows */
    check_perspective_refused((shb_vec3){0, nan, 5}, 1, 1, 1, 2, SHB_ERROR_NUMBER);
    shb_view view;
    const shb_vec3 bad = {0, inf, 0};
    CHECK_INT(shb_view_perspective(eye, bad, up, 1, 1, 1, 2, false, &view), SHB_ERROR_NUMBER);
    CHECK_INT(shb_view_perspective(eye, origin, bad, 1, 1, 1, 2, false, &view), SHB_ERROR_NUMBER);
    CHECK_INT(shb_view_perspective(eye, origin, up, 1, 1, 1, 2, false, NULL), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_view_perspective(eye, origin, origin, 1, 1, 1, 2, false, &view), SHB_OK);
}

static void check_orthographic_refused(double half_width, double half_height, double near_distance,
                                       double far_distance, shb_result expected) {
    shb_view view = {shb_mat4_scaling(7, 7, 7), true};
    CHECK_INT(shb_view_orthographic((shb_vec3){0, 0, 5}, origin, up, half_width, half_height,
                                    near_distance, far_distance, false, &view),
              expected);
    CHECK(view.reversed && view.clip_from_world.m[0] == 7);
}

TEST(orthographic_view_refuses_bad_arguments) {
    const double nan = (double)NAN, inf = HUGE_VAL;
    check_orthographic_refused(0, 1, 1, 2, SHB_ERROR_ARGUMENT);
    check_orthographic_refused(1, -1, 1, 2, SHB_ERROR_ARGUMENT);
    check_orthographic_refused(1, 1, 2, 2, SHB_ERROR_ARGUMENT);
    check_orthographic_refused(nan, 1, 1, 2, SHB_ERROR_NUMBER);
    check_orthographic_refused(1, inf, 1, 2, SHB_ERROR_NUMBER);
    check_orthographic_refused(1, 1, nan, 2, SHB_ERROR_NUMBER);
    check_orthographic_refused(1, 1, 1, inf, SHB_ERROR_NUMBER);
    check_orthographic_refused(1, 1, 1, 1 + 1e-320, SHB_ERROR_ARGUMENT); /* the sum is 1 */
    check_orthographic_refused(1, 1, 0, 1e-320, SHB_ERROR_NUMBER);       /* 1 / range overflows */
    shb_view view;
    const shb_vec3 bad = {nan, 0, 0}, eye = {0, 0, 5};
    CHECK_INT(shb_view_orthographic(bad, origin, up, 1, 1, 1, 2, false, &view), SHB_ERROR_NUMBER);
    CHECK_INT(shb_view_orthographic(eye, eye, up, 1, 1, 1, 2, false, &view), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_view_orthographic(eye, origin, up, 1, 1, 1, 2, false, NULL), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_view_orthographic(eye, origin, up, 1, 1, -2, 2, false, &view), SHB_OK);
}

static const uint32_t map_sizes[] = {8, 9, 512, 1000, 16384};

TEST(directional_fit_holds_the_box_with_its_margin) {
    test_random random = {11};
    for (int i = 0; i < 2000; i++) {
        const shb_box box = random_box(&random, 100, i % 2 ? 10 : 1000);
        const shb_vec3 to_light = random_vector(&random, 1);
        const uint32_t size = map_sizes[i % 5];
        shb_view view;
        CHECK_INT(shb_view_fit_directional(to_light, box, size, i % 3 == 0, &view), SHB_OK);
        const box_fit fit = fit_of(&view, box, size);
        CHECK(fit.margin >= 2 - 1e-9);
        CHECK(fit.nearest > 0 && fit.farthest < 1);
        const double *m = view.clip_from_world.m;
        CHECK(m[3] == 0 && m[7] == 0 && m[11] == 0 && m[15] == 1);
    }
}

TEST(directional_fit_wastes_little) {
    test_random random = {12};
    for (int i = 0; i < 500; i++) {
        const shb_box box = random_box(&random, 10, 10);
        shb_view view;
        CHECK_INT(shb_view_fit_directional(random_vector(&random, 1), box, 1024, false, &view),
                  SHB_OK);
        /* Rounding the size up costs at most a 16th of it, the margin 5 texels, snapping a half. */
        CHECK(fit_of(&view, box, 1024).margin <= 1024 / 2.0 / 17 + 3);
    }
}

TEST(directional_fit_lights_from_the_given_direction) {
    test_random random = {13};
    for (int i = 0; i < 500; i++) {
        const shb_box box = random_box(&random, 1000, 10);
        const shb_vec3 to_light = random_vector(&random, i % 2 ? 1e-200 : 50);
        shb_view view;
        shb_light_source source;
        CHECK_INT(shb_view_fit_directional(to_light, box, 777, i % 3 == 0, &view), SHB_OK);
        CHECK_INT(shb_view_light_source(&view, &source), SHB_OK);
        CHECK_NEAR(source.w, 0, 0);
        check_vector(source.position, shb_vec3_normalize(to_light), 1e-12);
    }
}

static double texel_fraction(double clip, uint32_t map_size) {
    const double texel = (0.5 + 0.5 * clip) * map_size;
    return texel - floor(texel);
}

/* Distance of two fractions on the circle 0 .. 1. */
static double fraction_distance(double a, double b) {
    const double d = fabs(a - b);
    return d < 0.5 ? d : 1 - d;
}

TEST(directional_fit_keeps_the_texel_grid_when_the_box_moves) {
    test_random random = {14};
    for (int i = 0; i < 300; i++) {
        const uint32_t size = map_sizes[i % 5];
        const shb_box box = random_box(&random, 20, 10);
        const shb_vec3 to_light = random_vector(&random, 1), point = random_vector(&random, 20);
        shb_view before, after;
        CHECK_INT(shb_view_fit_directional(to_light, box, size, false, &before), SHB_OK);
        const clip_point p = project(&before, point);
        for (int move = 0; move < 20; move++) {
            const shb_vec3 step = random_vector(&random, move < 10 ? 0.1 : 30);
            const shb_box moved = {shb_vec3_add(box.lo, step), shb_vec3_add(box.hi, step)};
            CHECK_INT(shb_view_fit_directional(to_light, moved, size, false, &after), SHB_OK);
            const clip_point q = project(&after, point);
            CHECK(fraction_distance(texel_fraction(p.x, size), texel_fraction(q.x, size)) < 1e-6);
            CHECK(fraction_distance(texel_fraction(p.y, size), texel_fraction(q.y, size)) < 1e-6);
        }
    }
}

TEST(directional_fit_has_few_sizes) {
    /* A box that grows from 1 to 2 passes the 16 steps of an octave. */
    double last = 0;
    int changes = 0;
    for (int i = 0; i <= 1000; i++) {
        const double half = 0.5 + 0.0005 * i;
        const shb_box box = {{-half, -half, -half}, {half, half, half}};
        shb_view view;
        CHECK_INT(shb_view_fit_directional((shb_vec3){0, 1, 0}, box, 1024, false, &view), SHB_OK);
        const double scale = shb_vec3_length((shb_vec3){
            view.clip_from_world.m[0], view.clip_from_world.m[4], view.clip_from_world.m[8]});
        changes += i && fabs(scale - last) > 1e-12;
        CHECK(!i || scale <= last * (1 + 1e-12));
        last = scale;
    }
    CHECK_INT(changes, 16);
}

TEST(directional_fit_of_degenerate_boxes_is_usable) {
    const shb_box boxes[] = {
        {{0, 0, 0}, {0, 0, 0}},
        {{5, -3, 2}, {5, -3, 2}},
        {{-1, 0, -1}, {1, 0, 1}},
        {{0, -4, 0}, {0, 4, 0}},
        {{1e7, 1e7, 1e7}, {1e7, 1e7, 1e7}},
        {{0, 0, 0}, {1e-30, 0, 1e-30}},
        {{1e6, 0, 0}, {1e6, 1e-3, 1e-3}},
    };
    const shb_vec3 lights[] = {{0, 1, 0}, {1, 0, 0}, {-0.3, 0.9, 0.2}};
    for (size_t i = 0; i < sizeof(boxes) / sizeof(boxes[0]); i++)
        for (int k = 0; k < 3; k++)
            for (int s = 0; s < 5; s++) {
                shb_view view;
                shb_light_source source;
                CHECK_INT(
                    shb_view_fit_directional(lights[k], boxes[i], map_sizes[s], k == 1, &view),
                    SHB_OK);
                const box_fit fit = fit_of(&view, boxes[i], map_sizes[s]);
                CHECK(fit.margin >= 1.5);
                CHECK(fit.nearest > 0 && fit.farthest < 1);
                CHECK_INT(shb_view_light_source(&view, &source), SHB_OK);
                check_vector(source.position, shb_vec3_normalize(lights[k]), 1e-9);
            }
}

/* Both fits must refuse these; a position outside the box is a direction as well. */
static void check_fits_refused(shb_vec3 light, shb_box box, uint32_t size, shb_result expected) {
    shb_view view = {shb_mat4_scaling(7, 7, 7), true};
    CHECK_INT(shb_view_fit_directional(light, box, size, false, &view), expected);
    CHECK_INT(shb_view_fit_spot(light, box, size, false, &view), expected);
    CHECK(view.reversed && view.clip_from_world.m[0] == 7);
}

TEST(fits_refuse_bad_arguments) {
    const shb_vec3 light = {0, 9, 0};
    const double nan = (double)NAN, inf = HUGE_VAL;
    check_fits_refused(light, unit_box, 0, SHB_ERROR_SIZE);
    check_fits_refused(light, unit_box, 7, SHB_ERROR_SIZE);
    check_fits_refused(light, unit_box, SHB_SIZE_MAX + 1, SHB_ERROR_SIZE);
    check_fits_refused(light, (shb_box){{1, 0, 0}, {0, 1, 1}}, 64, SHB_ERROR_ARGUMENT);
    check_fits_refused(light, (shb_box){{0, 1, 0}, {1, 0, 1}}, 64, SHB_ERROR_ARGUMENT);
    check_fits_refused(light, (shb_box){{0, 0, 1}, {1, 1, 0}}, 64, SHB_ERROR_ARGUMENT);
    check_fits_refused(light, (shb_box){{inf, inf, inf}, {-inf, -inf, -inf}}, 64,
                       SHB_ERROR_ARGUMENT);
    check_fits_refused(light, (shb_box){{0, nan, 0}, {1, 1, 1}}, 64, SHB_ERROR_NUMBER);
    check_fits_refused(light, (shb_box){{0, 0, 0}, {1, 1, inf}}, 64, SHB_ERROR_NUMBER);
    check_fits_refused((shb_vec3){nan, 9, 0}, unit_box, 64, SHB_ERROR_NUMBER);
    check_fits_refused((shb_vec3){0, inf, 0}, unit_box, 64, SHB_ERROR_NUMBER);
    CHECK_INT(shb_view_fit_directional(light, unit_box, 64, false, NULL), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_view_fit_spot(light, unit_box, 64, false, NULL), SHB_ERROR_ARGUMENT);
    shb_view view;
    CHECK_INT(shb_view_fit_directional(origin, unit_box, 64, false, &view), SHB_ERROR_ARGUMENT);
    const shb_box vast = {{-1.7e308, -1.7e308, -1.7e308}, {1.7e308, 1.7e308, 1.7e308}};
    CHECK_INT(shb_view_fit_directional(light, vast, 64, false, &view), SHB_ERROR_NUMBER);
    const shb_box wide = {{0, -1, -1}, {1e308, 1, 1}}; /* a matrix of numbers that vanish */
    CHECK_INT(shb_view_fit_directional(light, wide, 64, false, &view), SHB_ERROR_NUMBER);
}

TEST(spot_fit_by_hand) {
    /* From (0, 0, 5) the near face of the box, at distance 4, opens widest: tangent 1/4. With 64
     * texels, two of them free on each side, the corner lies at 60/64 of the edge. */
    shb_view view;
    CHECK_INT(shb_view_fit_spot((shb_vec3){0, 0, 5}, unit_box, 64, true, &view), SHB_OK);
    const clip_point p = project(&view, (shb_vec3){1, 1, 1});
    CHECK_NEAR(fabs(p.x) / p.w, 0.9375, 1e-14);
    CHECK_NEAR(fabs(p.y) / p.w, 0.9375, 1e-14);
    CHECK_NEAR(p.w, 4, 1e-14);
    CHECK(view.reversed);
    CHECK(fit_of(&view, unit_box, 64).nearest < 0.1);
    CHECK(fit_of(&view, unit_box, 64).farthest > 0.9);
}

TEST(spot_fit_holds_the_box_with_its_margin) {
    test_random random = {15};
    int fitted = 0;
    for (int i = 0; i < 2000; i++) {
        const shb_box box = random_box(&random, 100, i % 2 ? 10 : 60);
        const shb_vec3 position = random_vector(&random, 100);
        const uint32_t size = map_sizes[i % 5];
        shb_view view;
        shb_light_source source;
        if (shb_view_fit_spot(position, box, size, i % 3 == 0, &view))
            continue;
        fitted++;
        const box_fit fit = fit_of(&view, box, size);
        CHECK_NEAR(fit.margin, 2, 1e-6);
        CHECK(fit.nearest > 0 && fit.farthest < 1);
        CHECK_INT(shb_view_light_source(&view, &source), SHB_OK);
        CHECK_NEAR(source.w, 1, 0);
        check_vector(source.position, position, 1e-9);
    }
    CHECK(fitted > 1200);
}

TEST(spot_fit_refuses_to_open_too_wide) {
    shb_view view = {shb_mat4_scaling(7, 7, 7), true};
    const shb_vec3 inside[] = {{0, 0, 0}, {0.5, -0.5, 0.9}, {1, 1, 1}, {0, -1, 0}};
    for (int i = 0; i < 4; i++)
        CHECK_INT(shb_view_fit_spot(inside[i], unit_box, 64, false, &view), SHB_ERROR_ARGUMENT);
    /* Above a face by h the tangent is 1 / h, times 16384 / 16380 for the margin: tan 85 degrees is
     * 11.43, so h = 0.0876 is just too close and 0.0877 just far enough. */
    const uint32_t size = SHB_SIZE_MAX;
    CHECK_INT(shb_view_fit_spot((shb_vec3){0, 0, 1.0874}, unit_box, size, false, &view),
              SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_view_fit_spot((shb_vec3){0, 0, 1}, unit_box, size, false, &view),
              SHB_ERROR_ARGUMENT);
    CHECK(view.reversed && view.clip_from_world.m[0] == 7);
    CHECK_INT(shb_view_fit_spot((shb_vec3){0, 0, 1.0877}, unit_box, size, false, &view), SHB_OK);
}

TEST(spot_fit_of_degenerate_boxes_is_usable) {
    const shb_box boxes[] = {{{1, 2, 3}, {1, 2, 3}},
                             {{-1, -1, 0}, {1, 1, 0}},
                             {{0, 0, -4}, {0, 0, 4}},
                             {{0, 0, 0}, {1e-30, 0, 0}}};
    for (int i = 0; i < 4; i++)
        for (int s = 0; s < 5; s++) {
            const shb_vec3 position = {0, 0, 20};
            shb_view view;
            CHECK_INT(shb_view_fit_spot(position, boxes[i], map_sizes[s], s % 2, &view), SHB_OK);
            const box_fit fit = fit_of(&view, boxes[i], map_sizes[s]);
            CHECK(fit.margin >= 1.5);
            CHECK(fit.nearest > 0 && fit.farthest < 1);
        }
}

/* Far from the origin, where coordinates resolve 1e-7 of the distance. */
TEST(spot_fit_of_a_distant_point_holds_it) {
    const shb_vec3 place = {1e9, -2e9, 3e9}, eye = {1e9 + 0.75, -2e9 + 0.25, 3e9 + 1.5};
    const shb_box point = {place, place};
    for (int s = 0; s < 5; s++) {
        shb_view view;
        CHECK_INT(shb_view_fit_spot(eye, point, map_sizes[s], s % 2, &view), SHB_OK);
        const box_fit fit = fit_of(&view, point, map_sizes[s]);
        CHECK(fit.margin >= 1.5);
        CHECK(fit.nearest > 0 && fit.farthest < 1);
    }
}

TEST(views_have_an_inverse_or_are_refused) {
    const shb_vec3 to_light = {1, 2, 3};
    int refused = 0;
    for (int exponent = 0; exponent < 1000; exponent += 40) {
        const double far = ldexp(1, exponent);
        const shb_vec3 eye = {-3 * far, -2, -1}, target = {0, 1, 1};
        const shb_box box = {{0, 0, 0}, {1, 1, far}};
        shb_view views[4];
        const shb_result results[4] = {
            shb_view_perspective(eye, target, up, 1, 1, 0.1, 10, false, &views[0]),
            shb_view_orthographic(eye, target, up, 1, 1, 0, 10, false, &views[1]),
            shb_view_fit_directional(to_light, box, 64, false, &views[2]),
            shb_view_fit_spot(eye, box, 64, false, &views[3])};
        for (int i = 0; i < 4; i++) {
            shb_mat4 inverse;
            refused += results[i] == SHB_ERROR_NUMBER;
            CHECK(results[i] == SHB_ERROR_NUMBER ||
                  shb_mat4_inverse(views[i].clip_from_world, &inverse) == SHB_OK);
            CHECK(exponent > 0 || results[i] == SHB_OK);
        }
    }
    CHECK(refused > 0);
}

TEST(light_source_of_cameras) {
    test_random random = {16};
    for (int i = 0; i < 500; i++) {
        const shb_vec3 eye = random_vector(&random, 50), target = random_vector(&random, 50);
        const bool reversed = i % 2;
        shb_view view;
        shb_light_source source;
        CHECK_INT(shb_view_perspective(eye, target, up, random_double(&random, 0.1, 3), 1.5, 0.1,
                                       i % 3 ? 1000 : HUGE_VAL, reversed, &view),
                  SHB_OK);
        CHECK_INT(shb_view_light_source(&view, &source), SHB_OK);
        CHECK_NEAR(source.w, 1, 0);
        check_vector(source.position, eye, 1e-9);
        CHECK_INT(shb_view_orthographic(eye, target, up, 3, 2, -1, 9, reversed, &view), SHB_OK);
        CHECK_INT(shb_view_light_source(&view, &source), SHB_OK);
        CHECK_NEAR(source.w, 0, 0);
        check_vector(source.position, shb_vec3_normalize(shb_vec3_subtract(eye, target)), 1e-12);
    }
}

TEST(light_source_of_a_matrix_whose_w_vanishes_by_rounding) {
    /* A perspective whose rays are parallel after all: w = 1 + 0.1 x + 0.2 y, x and y themselves
     * mixed by a rotation, so that the null vector's w is a sum that cancels. Rays run along z. */
    const shb_mat4 rotation = shb_mat4_rotation((shb_vec3){1, 2, 3}, 0.7);
    const shb_mat4 skewed = {{1, 0, 0, 0.1, 0, 1, 0, 0.2, 0, 0, 0.01, 0, 0, 0, 0.5, 1}};
    const shb_view view = {shb_mat4_multiply(skewed, rotation), false};
    shb_light_source source;
    CHECK_INT(shb_view_light_source(&view, &source), SHB_OK);
    CHECK_NEAR(source.w, 0, 0);
    /* Depth grows along the third row of the rotation, so the light lies the other way. */
    check_vector(source.position, (shb_vec3){-rotation.m[2], -rotation.m[6], -rotation.m[10]},
                 1e-14);
}

TEST(light_source_of_a_very_distant_point_stays_a_point) {
    shb_view view;
    shb_light_source source;
    const shb_vec3 sun = {1e11, 5e10, -7e10};
    CHECK_INT(shb_view_fit_spot(sun, unit_box, 1024, true, &view), SHB_OK);
    CHECK_INT(shb_view_light_source(&view, &source), SHB_OK);
    CHECK_NEAR(source.w, 1, 0);
    check_vector(shb_vec3_scale(source.position, 1e-11), shb_vec3_scale(sun, 1e-11), 1e-3);
}

TEST(light_source_refuses_what_is_no_view) {
    shb_light_source source = {{7, 7, 7}, 7};
    shb_view view = {0};
    CHECK_INT(shb_view_light_source(&view, &source), SHB_ERROR_NUMBER);
    view.clip_from_world = shb_mat4_identity();
    view.clip_from_world.m[5] = (double)NAN;
    CHECK_INT(shb_view_light_source(&view, &source), SHB_ERROR_NUMBER);
    view.clip_from_world = shb_mat4_scaling(1, 1, 0); /* depth is the same everywhere */
    CHECK_INT(shb_view_light_source(&view, &source), SHB_ERROR_NUMBER);
    view.clip_from_world = shb_mat4_scaling(1, 0, 1);
    CHECK_INT(shb_view_light_source(&view, &source), SHB_ERROR_NUMBER);
    /* a point at x = 1e310 */
    view.clip_from_world = (shb_mat4){{1e-10, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, -1e300, 0, 1, 1}};
    CHECK_INT(shb_view_light_source(&view, &source), SHB_ERROR_NUMBER);
    CHECK(source.w == 7 && source.position.z == 7);
    view.clip_from_world = shb_mat4_identity();
    CHECK_INT(shb_view_light_source(NULL, &source), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_view_light_source(&view, NULL), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_view_light_source(&view, &source), SHB_OK);
    check_vector(source.position, (shb_vec3){0, 0, -1}, 0);
}
