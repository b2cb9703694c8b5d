/* Methods of the depth stage against planes worked out by hand.
 *
 * Orthographic: depth (4 - z) / 8 over [-1, 1]^2, 4 x 4 texels of width 0.5. The fragment (0.1,
 * -0.3, 0.2) has texel coordinates 4 * (0.1 / 2 + 0.5) = 2.2 and 4 * (0.5 + 0.3 / 2) = 2.6, so
 * texel (2, 2), and 0.3 and -0.1 to its centre; depth 3.8 / 8 = 0.475. A plane tilted by theta,
 * normal (sin, 0, cos), falls by tan per unit of x: depth grows by 0.5 tan / 8 = tan / 16 per
 * column.
 *
 * Perspective: light at z = 4, w = 4 - z, depth 1.5 - 1.5 / w, 32 x 16 texels. The fragment (0.2,
 * -0.6, 2) has w = 2, depth 0.75 and normalised coordinates 0.1, -0.3, so texel coordinates 32 *
 * 0.55 = 17.6 and 16 * 0.65 = 10.4: texel (17, 10), and -0.1 and 0.1 to its centre. The ray of
 * normalised (X, Y) is (X, Y, -1) w; it meets the plane n.(p - p0) = 0, T = tan: normal (sin, 0,
 * cos): 1 / w = (1 - X T) / (2 - 0.2 T), d depth / dX = 1.5 T / (2 - 0.2 T) normal (0, sin, cos): 1
 * / w = (1 - Y T) / (2 + 0.6 T), d depth / dY = 1.5 T / (2 + 0.6 T) A column is 1/16 in X, a row
 * -1/8 in Y. The derivative of depth by distance is 1.5 / w^2 = 0.375.
 *
 * Reversed maps hold 1 - depth; canonical depth is that negated, so depth - 1. */
#include "probe.h"
#include "test.h"

#include <math.h>

#define FLOAT_ERROR 2e-7

static const double degrees[] = {0, 45, 60, 80};

static double radians(double angle) {
    return angle * 3.14159265358979323846 / 180;
}

static probe ask_orthographic(bool reversed, const shb_bias *bias, double angle) {
    const probe_light light = {probe_orthographic(reversed), 4, 4, 10};
    return probe_fragment(&light, bias, (shb_vec3){0.1, -0.3, 0.2},
                          (shb_vec3){sin(angle), 0, cos(angle)});
}

static probe ask_perspective(bool reversed, const shb_bias *bias, shb_vec3 normal) {
    const probe_light light = {probe_perspective(reversed), 32, 16, 10};
    return probe_fragment(&light, bias, (shb_vec3){0.2, -0.6, 2}, normal);
}

static void check_plane(const probe *seen, double ref, double step_x, double step_y) {
    CHECK_NEAR(seen->ref, ref, FLOAT_ERROR);
    CHECK_NEAR(seen->step_x, step_x, FLOAT_ERROR);
    CHECK_NEAR(seen->step_y, step_y, FLOAT_ERROR);
}

/* A method that writes ref = depth - epsilon, in both lights' standard and reversed maps. */
static void check_flat(const shb_bias *bias, double angle, double orthographic,
                       double perspective) {
    for (int reversed = 0; reversed < 2; reversed++) {
        probe seen = ask_orthographic(reversed, bias, angle);
        check_plane(&seen, 0.475 - orthographic - reversed, 0, 0);
        const shb_vec3 normal = {sin(angle), 0, cos(angle)};
        seen = ask_perspective(reversed, bias, normal);
        check_plane(&seen, 0.75 - perspective - reversed, 0, 0);
    }
}

/* A method that writes the plane less epsilon. */
static void check_tilted(const shb_bias *bias, double angle, double orthographic,
                         double perspective) {
    const double t = tan(angle);
    for (int reversed = 0; reversed < 2; reversed++) {
        probe seen = ask_orthographic(reversed, bias, angle);
        check_plane(&seen, 0.475 + 0.3 * t / 16 - orthographic - reversed, t / 16, 0);
        const double column = 1.5 * t / (2 - 0.2 * t) / 16;
        seen = ask_perspective(reversed, bias, (shb_vec3){sin(angle), 0, cos(angle)});
        check_plane(&seen, 0.75 - 0.1 * column - perspective - reversed, column, 0);
    }
}

/* Between the normal and the direction (-0.2, 0.6, 2) to the spot. */
static double spot_cosine(double angle) {
    return (2 * cos(angle) - 0.2 * sin(angle)) / sqrt(0.04 + 0.36 + 4);
}

TEST(none_tests_the_own_depth) {
    const shb_bias bias = shb_bias_none();
    check_flat(&bias, radians(60), 0, 0);
}

TEST(constant_takes_off_map_depth) {
    const shb_bias bias = shb_bias_constant(0.002f, SHB_UNIT_DEPTH);
    check_flat(&bias, radians(45), 0.002, 0.002);
    CHECK_INT(bias.needs, 0);
}

/* The texel of the spot is 2 / 16 * w = 0.25 high and 2 / 32 * w wide: the larger side counts. */
TEST(constant_takes_off_texels) {
    const shb_bias bias = shb_bias_constant(0.25f, SHB_UNIT_TEXEL);
    check_flat(&bias, 0, 0.25 * 0.5 / 8, 0.25 * 0.25 * 0.375);
    CHECK_INT(bias.needs, SHB_NEEDS_SCALE);
}

TEST(constant_takes_off_world_units) {
    const shb_bias bias = shb_bias_constant(0.125f, SHB_UNIT_WORLD);
    check_flat(&bias, 0, 0.125 / 8, 0.125 * 0.375);
    CHECK_INT(bias.needs, SHB_NEEDS_SCALE);
}

TEST(slope_takes_off_the_larger_slope) {
    const shb_bias bias = shb_bias_slope(1.5f, 4, 0);
    const double units = 4.0 / 16777216;
    for (int i = 0; i < 4; i++) {
        const double t = tan(radians(degrees[i]));
        check_flat(&bias, radians(degrees[i]), 1.5 * t / 16 + units,
                   1.5 * (1.5 * t / (2 - 0.2 * t) / 16) + units);
    }
    /* along y at 60 degrees, both ways: the magnitude of the slope counts */
    for (int side = -1; side <= 1; side += 2) {
        const double t = side * tan(radians(60));
        const double row = fabs(1.5 * t / (2 + 0.6 * t) / 8);
        const shb_vec3 normal = {0, side * sin(radians(60)), cos(radians(60))};
        const probe seen = ask_perspective(false, &bias, normal);
        check_plane(&seen, 0.75 - 1.5 * row - units, 0, 0);
    }
}

/* Planes that rise by 1 and by 2 along the axes: 2 / 16 is the larger of both slopes. */
TEST(slope_takes_the_larger_axis_whatever_the_signs) {
    const shb_bias bias = shb_bias_slope(1.5f, 4, 0);
    const probe_light light = {probe_orthographic(false), 4, 4, 10};
    for (int i = 0; i < 8; i++) {
        const double one = i & 1 ? 1 : -1, two = i & 2 ? 2 : -2;
        const shb_vec3 normal =
            shb_vec3_normalize(i & 4 ? (shb_vec3){one, two, 1} : (shb_vec3){two, one, 1});
        const probe seen = probe_fragment(&light, &bias, (shb_vec3){0.1, -0.3, 0.2}, normal);
        check_plane(&seen, 0.475 - 1.5 * 2 / 16 - 4.0 / 16777216, 0, 0);
    }
}

TEST(slope_is_clamped) {
    const shb_bias bias = shb_bias_slope(1, 0, 0.05f);
    check_flat(&bias, radians(60), 0.05, 0.05); /* tan / 16 = 0.108 */
    check_flat(&bias, radians(0), 0, 0);
}

/* 0.002 * 10 world units over the cosine, 0.1 at most: reached at 80 degrees, 0.02 / 0.174. */
TEST(angle_grows_with_the_angle_up_to_its_limit) {
    const shb_bias bias = shb_bias_angle(0.002f, 0.01f);
    for (int i = 0; i < 4; i++) {
        const double angle = radians(degrees[i]);
        check_flat(&bias, angle, fmin(0.02 / cos(angle), 0.1) / 8,
                   fmin(0.02 / spot_cosine(angle), 0.1) * 0.375);
    }
}

TEST(receiver_plane_runs_to_the_texel_centre) {
    const shb_bias bias = shb_bias_receiver_plane(1e-3f);
    for (int i = 0; i < 4; i++)
        check_tilted(&bias, radians(degrees[i]), 1e-3, 1e-3);
}

/* Rows run down, so a plane that rises towards +y grows deeper by rows; 0.1 rows to the centre. */
TEST(receiver_plane_runs_down_the_rows) {
    const shb_bias bias = shb_bias_receiver_plane(0);
    for (int i = 0; i < 4; i++) {
        const double angle = radians(degrees[i]), t = tan(angle);
        const double row = -1.5 * t / (2 + 0.6 * t) / 8;
        const probe seen = ask_perspective(false, &bias, (shb_vec3){0, sin(angle), cos(angle)});
        check_plane(&seen, 0.75 + 0.1 * row, 0, row);
    }
}

/* Dou et al., eq. 10: (3 - 0.75 * 2)^2 / (3 * 1 * 2) = 0.375, times scene scale times K. */
TEST(adaptive_takes_off_the_papers_epsilon) {
    const shb_bias of_map = shb_bias_adaptive(1e-3f, 0);
    const shb_bias given = shb_bias_adaptive(1e-3f, 20);
    for (int i = 0; i < 4; i++) {
        check_tilted(&of_map, radians(degrees[i]), 10 * 1e-3 / 8, 10 * 1e-3 * 0.375);
        check_tilted(&given, radians(degrees[i]), 20 * 1e-3 / 8, 20 * 1e-3 * 0.375);
    }
}

/* Ehm et al., eq. 4: 1 / cos^2 is 1, 2, 4 and 33 for the directional light; cut off at 10. */
TEST(adaptive_soft_scales_the_epsilon_by_the_angle) {
    const shb_bias bias = shb_bias_adaptive_soft(1e-3f, 0, 10);
    for (int i = 0; i < 4; i++) {
        const double angle = radians(degrees[i]);
        const double directional = fmin(1 / (cos(angle) * cos(angle)), 10);
        const double spot = fmin(1 / (spot_cosine(angle) * spot_cosine(angle)), 10);
        check_tilted(&bias, angle, 10 * 1e-3 / 8 * directional, 10 * 1e-3 * 0.375 * spot);
    }
}

/* 4.01 world units over 0.5 texels: the depth per texel passes 1 at tan = 16. */
TEST(slopes_are_cut_off_at_the_depth_of_the_map) {
    const shb_bias bias = shb_bias_receiver_plane(0);
    probe seen = ask_orthographic(false, &bias, radians(86));
    check_plane(&seen, 0.475 + 0.3 * tan(radians(86)) / 16, tan(radians(86)) / 16, 0);
    seen = ask_orthographic(false, &bias, radians(87));
    check_plane(&seen, 0.475 + 0.3, 1, 0);
    const probe_light light = {probe_orthographic(false), 4, 4, 10};
    seen = probe_fragment(&light, &bias, (shb_vec3){0.1, -0.3, 0.2}, (shb_vec3){-1, 0, 0});
    CHECK_NEAR(fabs(seen.step_x), 1, 0);
    CHECK_NEAR(seen.step_y, 0, 0);
}

TEST(receivers_without_a_normal_face_the_light) {
    const shb_vec3 unusable[] = {{0, 0, 0}, {nan(""), 0, 1}, {0, HUGE_VAL, 0}, {0, 0, -HUGE_VAL}};
    const shb_bias bias = shb_bias_adaptive_soft(1e-3f, 0, 100);
    for (int i = 0; i < 4; i++) {
        const probe seen = ask_perspective(false, &bias, unusable[i]);
        CHECK_NEAR(seen.cosine, 1, 0);
        CHECK_NEAR(seen.normal_x, -0.2 / sqrt(4.4), FLOAT_ERROR);
        CHECK_NEAR(seen.normal_y, 0.6 / sqrt(4.4), FLOAT_ERROR);
        CHECK_NEAR(seen.normal_z, 2 / sqrt(4.4), FLOAT_ERROR);
        check_plane(&seen, 0.75 - 10 * 1e-3 * 0.375, 0, 0);
    }
}

TEST(normals_of_either_side_give_one_plane) {
    const shb_bias bias = shb_bias_adaptive_soft(1e-3f, 0, 100);
    const shb_vec3 up = {sin(1.0), 0, cos(1.0)}, down = {-sin(1.0), 0, -cos(1.0)};
    const probe above = ask_perspective(false, &bias, up);
    const probe below = ask_perspective(false, &bias, down);
    CHECK(above.normal_z > 0);
    CHECK(above.normal_x == below.normal_x && above.normal_z == below.normal_z);
    CHECK(above.cosine == below.cosine && above.ref == below.ref);
    CHECK(above.step_x == below.step_x && above.step_y == below.step_y);
}
