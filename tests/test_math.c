#include "random.h"
#include "test.h"

#include "shadowbias/math.h"

#include <float.h>
#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static void check_vector(shb_vec3 actual, double x, double y, double z, double tolerance) {
    CHECK_NEAR(actual.x, x, tolerance);
    CHECK_NEAR(actual.y, y, tolerance);
    CHECK_NEAR(actual.z, z, tolerance);
}

static void check_matrix(shb_mat4 actual, const double rows[16], double tolerance) {
    for (int row = 0; row < 4; row++)
        for (int column = 0; column < 4; column++)
            CHECK_NEAR(actual.m[4 * column + row], rows[4 * row + column], tolerance);
}

static shb_mat4 from_rows(const double rows[16]) {
    shb_mat4 a;
    for (int row = 0; row < 4; row++)
        for (int column = 0; column < 4; column++)
            a.m[4 * column + row] = rows[4 * row + column];
    return a;
}

/* z / w of a point on the axis of view at a distance. */
static double depth_at(shb_mat4 projection, double distance) {
    const double z = -distance * projection.m[10] + projection.m[14];
    const double w = -distance * projection.m[11] + projection.m[15];
    return z / w;
}

TEST(vector_arithmetic) {
    const shb_vec3 a = {1, 2, 3}, b = {-4, 5, 7};
    check_vector(shb_vec3_add(a, b), -3, 7, 10, 0);
    check_vector(shb_vec3_subtract(a, b), 5, -3, -4, 0);
    check_vector(shb_vec3_scale(a, -2), -2, -4, -6, 0);
    CHECK_NEAR(shb_vec3_dot(a, b), -4 + 10 + 21, 0);
    /* (2*7 - 3*5, 3*-4 - 1*7, 1*5 - 2*-4) */
    check_vector(shb_vec3_cross(a, b), -1, -19, 13, 0);
}

TEST(length_and_direction_hold_at_any_scale) {
    const double scales[] = {1, 1e-300, 1e-160, 1e160, 1e300, 0x1p-1074};
    for (int i = 0; i < 6; i++) {
        const double s = scales[i];
        const shb_vec3 a = {3 * s, -4 * s, 12 * s};
        CHECK_NEAR(shb_vec3_length(a) / s, 13, 1e-14);
        check_vector(shb_vec3_normalize(a), 3.0 / 13, -4.0 / 13, 12.0 / 13, 1e-15);
    }
    CHECK_NEAR(shb_vec3_length((shb_vec3){0, 0, 0}), 0, 0);
    check_vector(shb_vec3_normalize((shb_vec3){0, 0, 0}), 0, 0, 0, 0);
    CHECK(isinf(shb_vec3_length((shb_vec3){1, -HUGE_VAL, 0})));
    CHECK(isnan(shb_vec3_length((shb_vec3){1, 2, (double)NAN})));
}

TEST(product_lets_the_right_matrix_act_first) {
    const shb_mat4 a = shb_mat4_translation(1, 2, 3), b = shb_mat4_scaling(2, 3, 4);
    const shb_vec3 p = {1, 1, 1};
    check_vector(shb_mat4_transform_point(shb_mat4_multiply(a, b), p), 3, 5, 7, 0);
    check_vector(shb_mat4_transform_point(shb_mat4_multiply(b, a), p), 4, 9, 16, 0);
}

TEST(product_of_full_matrices) {
    const double a[16] = {1, 2, 0, -1, 3, 1, 1, 0, 0, -2, 1, 4, 1, 1, 1, 1};
    const double b[16] = {2, 0, 1, 1, 1, 1, 0, -1, 3, -1, 2, 0, 0, 1, 1, 2};
    /* Rows of a times columns of b, by hand. */
    const double product[16] = {4, 1, 0, -3, 10, 0, 5, 2, 1, 1, 6, 10, 6, 1, 4, 2};
    check_matrix(shb_mat4_multiply(from_rows(a), from_rows(b)), product, 0);
    check_matrix(shb_mat4_multiply(from_rows(a), shb_mat4_identity()), a, 0);
    check_matrix(shb_mat4_multiply(shb_mat4_identity(), from_rows(b)), b, 0);
}

TEST(rotation_is_counter_clockwise_about_an_axis_of_any_length) {
    const shb_mat4 about_z = shb_mat4_rotation((shb_vec3){0, 0, 5}, pi / 2);
    check_vector(shb_mat4_transform_point(about_z, (shb_vec3){1, 0, 7}), 0, 1, 7, 1e-15);
    /* A third of a turn about the diagonal takes x to y, y to z and z to x. */
    const shb_mat4 third = shb_mat4_rotation((shb_vec3){1, 1, 1}, 2 * pi / 3);
    check_vector(shb_mat4_transform_point(third, (shb_vec3){1, 2, 3}), 3, 1, 2, 3e-15);
    const shb_mat4 back = shb_mat4_rotation((shb_vec3){-2, 0, 0}, pi / 6);
    check_vector(shb_mat4_transform_point(back, (shb_vec3){0, 2, 0}), 0, sqrt(3.0), -1, 1e-15);
    /* A quarter about n = (2, 3, 6) / 7 takes v to n (n . v) + n x v. */
    const shb_mat4 quarter = shb_mat4_rotation((shb_vec3){2, 3, 6}, pi / 2);
    check_vector(shb_mat4_transform_point(quarter, (shb_vec3){49, 0, 0}), 4, 48, -9, 1e-13);
    check_vector(shb_mat4_transform_point(quarter, (shb_vec3){0, 49, 0}), -36, 9, 32, 1e-13);
    check_vector(shb_mat4_transform_point(quarter, (shb_vec3){0, 0, 49}), 33, 4, 36, 1e-13);
}

/* Against the C library, which is good to an ulp: the own series may add one. */
TEST(rotation_has_accurate_sine_and_cosine) {
    test_random random = {3};
    for (int i = 0; i < 20000; i++) {
        const double angle =
            i < 10000 ? random_double(&random, -7, 7) : random_double(&random, -1e5, 1e5);
        const shb_mat4 a = shb_mat4_rotation((shb_vec3){0, 0, 1}, angle);
        CHECK_NEAR(a.m[0], cos(angle), 2.5e-16);
        CHECK_NEAR(a.m[1], sin(angle), 2.5e-16);
        CHECK_NEAR(a.m[4], -sin(angle), 2.5e-16);
    }
}

TEST(look_at_by_hand) {
    /* Forward is -x, right = forward x up = (0, 0, -1): eye x is -z, eye y is y, eye z is x - 10.
     */
    const double rows[16] = {0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, -10, 0, 0, 0, 1};
    const shb_mat4 a =
        shb_mat4_look_at((shb_vec3){10, 0, 0}, (shb_vec3){-3, 0, 0}, (shb_vec3){0, 2, 0});
    check_matrix(a, rows, 0);
    /* An up that leans forward is straightened. */
    const shb_mat4 b =
        shb_mat4_look_at((shb_vec3){10, 0, 0}, (shb_vec3){9, 0, 0}, (shb_vec3){-5, 1, 0});
    check_matrix(b, rows, 1e-15);
}

static void check_is_view_of(shb_mat4 a, shb_vec3 eye, shb_vec3 target) {
    const shb_vec3 x = {a.m[0], a.m[4], a.m[8]}, y = {a.m[1], a.m[5], a.m[9]},
                   z = {a.m[2], a.m[6], a.m[10]};
    CHECK_NEAR(shb_vec3_length(x), 1, 1e-14);
    CHECK_NEAR(shb_vec3_length(y), 1, 1e-14);
    const shb_vec3 right_handed = shb_vec3_cross(x, y);
    check_vector(right_handed, z.x, z.y, z.z, 1e-14);
    check_vector(shb_mat4_transform_point(a, eye), 0, 0, 0, 1e-13);
    const double distance = shb_vec3_length(shb_vec3_subtract(target, eye));
    check_vector(shb_mat4_transform_point(a, target), 0, 0, -distance, 1e-13);
}

TEST(look_at_along_up_takes_the_least_parallel_axis) {
    const shb_vec3 eye = {1, 2, 3};
    const shb_vec3 directions[] = {{1, 2, 3}, {3, -1, 2}, {2, -3, 1},
                                   {0, 4, 0}, {0, 0, -2}, {1, 0, 0}};
    for (int i = 0; i < 6; i++) {
        const shb_vec3 target = shb_vec3_add(eye, directions[i]);
        for (int sign = -1; sign <= 1; sign++) {
            const shb_mat4 a =
                shb_mat4_look_at(eye, target, shb_vec3_scale(directions[i], 3.0 * sign));
            check_is_view_of(a, eye, target);
            /* The eye's right is at right angles to the axis that stands in for up: x, y, z. */
            if (i < 3)
                CHECK_NEAR(a.m[4 * i], 0, 1e-15);
        }
    }
}

TEST(perspective_by_hand) {
    /* Half angle 45 degrees, so y / w = y / distance and x half of that; w = -z;
     * depth * w = -1.5 z - 1.5: 0 at z = -1 and 3 at z = -3. */
    const double rows[16] = {0.5, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1.5, -1.5, 0, 0, -1, 0};
    check_matrix(shb_mat4_perspective(pi / 2, 2, 1, 3, false), rows, 4e-16);
    /* Reversed: 0.5 z + 1.5: 1 at z = -1 and 0 at z = -3. */
    const double reversed[16] = {0.5, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0.5, 1.5, 0, 0, -1, 0};
    check_matrix(shb_mat4_perspective(pi / 2, 2, 1, 3, true), reversed, 4e-16);
    /* tan 60 degrees = sqrt 3 */
    CHECK_NEAR(1 / shb_mat4_perspective(2 * pi / 3, 1, 1, 3, true).m[5], sqrt(3.0), 2e-15);
    CHECK_NEAR(1 / shb_mat4_perspective(3.1, 1, 1, 3, true).m[5], tan(1.55), 1e-13);
}

TEST(perspective_depth_runs_from_near_to_far) {
    const double near_distance = 0.125, far_distance = 4096;
    const shb_mat4 a = shb_mat4_perspective(1, 1, near_distance, far_distance, false);
    CHECK_NEAR(depth_at(a, near_distance), 0, 1e-16);
    CHECK_NEAR(depth_at(a, far_distance), 1, 1e-15);
    const shb_mat4 b = shb_mat4_perspective(1, 1, near_distance, far_distance, true);
    CHECK_NEAR(depth_at(b, near_distance), 1, 1e-15);
    CHECK_NEAR(depth_at(b, far_distance), 0, 1e-16);
}

TEST(perspective_without_a_far_plane) {
    const double far_distances[] = {HUGE_VAL, 1e300, DBL_MAX};
    for (int i = 0; i < 3; i++) {
        const shb_mat4 a = shb_mat4_perspective(1, 1, 2, far_distances[i], false);
        CHECK_NEAR(depth_at(a, 2), 0, 0);
        CHECK_NEAR(depth_at(a, 8), 0.75, 1e-15); /* 1 - near / distance */
        const shb_mat4 b = shb_mat4_perspective(1, 1, 2, far_distances[i], true);
        CHECK_NEAR(depth_at(b, 2), 1, 1e-15);
        CHECK_NEAR(depth_at(b, 8), 0.25, 1e-15);
    }
    CHECK_NEAR(depth_at(shb_mat4_perspective(1, 1, 2, HUGE_VAL, true), 1e30), 2e-30, 1e-45);
}

TEST(orthographic_by_hand) {
    /* depth = (-z - 1) / 4: 0 at z = -1, 1 at z = -5. */
    const double rows[16] = {0.5, 0, 0, 0, 0, 0.25, 0, 0, 0, 0, -0.25, -0.25, 0, 0, 0, 1};
    check_matrix(shb_mat4_orthographic(2, 4, 1, 5, false), rows, 0);
    const double reversed[16] = {0.5, 0, 0, 0, 0, 0.25, 0, 0, 0, 0, 0.25, 1.25, 0, 0, 0, 1};
    check_matrix(shb_mat4_orthographic(2, 4, 1, 5, true), reversed, 0);
    /* The near plane may lie behind the eye. */
    const shb_mat4 behind = shb_mat4_orthographic(1, 1, -3, 1, false);
    CHECK_NEAR(depth_at(behind, -3), 0, 0);
    CHECK_NEAR(depth_at(behind, 0), 0.75, 0);
    CHECK_NEAR(depth_at(behind, 1), 1, 0);
}

TEST(transform_ignores_the_last_row) {
    shb_mat4 a = shb_mat4_translation(1, 2, 3);
    a.m[3] = a.m[7] = a.m[11] = 9;
    check_vector(shb_mat4_transform_point(a, (shb_vec3){1, 1, 1}), 2, 3, 4, 0);
}

TEST(inverse_by_hand) {
    /* Unit triangular, so the inverse follows by substitution from the bottom up. */
    const double rows[16] = {1, 2, 0, 3, 0, 1, 4, 0, 0, 0, 1, 5, 0, 0, 0, 1};
    const double expected[16] = {1, -2, 8, -43, 0, 1, -4, 20, 0, 0, 1, -5, 0, 0, 0, 1};
    shb_mat4 inverse;
    CHECK_INT(shb_mat4_inverse(from_rows(rows), &inverse), SHB_OK);
    check_matrix(inverse, expected, 0);
    /* A permutation with scales: x' = 2y, y' = 4w, z' = -x, w' = 8z. */
    const double mixed[16] = {0, 2, 0, 0, 0, 0, 0, 4, -1, 0, 0, 0, 0, 0, 8, 0};
    const double unmixed[16] = {0, 0, -1, 0, 0.5, 0, 0, 0, 0, 0, 0, 0.125, 0, 0.25, 0, 0};
    CHECK_INT(shb_mat4_inverse(from_rows(mixed), &inverse), SHB_OK);
    check_matrix(inverse, unmixed, 0);
}

TEST(inverse_times_matrix_is_the_identity) {
    test_random random = {5};
    for (int i = 0; i < 2000; i++) {
        shb_mat4 a;
        for (int k = 0; k < 16; k++)
            a.m[k] = random_double(&random, -1, 1);
        shb_mat4 inverse;
        CHECK_INT(shb_mat4_inverse(a, &inverse), SHB_OK);
        double largest = 1;
        for (int k = 0; k < 16; k++)
            largest = fmax(largest, fabs(inverse.m[k]));
        check_matrix(shb_mat4_multiply(a, inverse), shb_mat4_identity().m, 1e-14 * largest);
    }
}

TEST(inverse_of_a_far_camera) {
    const shb_mat4 a = shb_mat4_multiply(
        shb_mat4_perspective(1, 1.5, 1e-3, 1e9, true),
        shb_mat4_look_at((shb_vec3){1e6, -2e6, 3e6}, (shb_vec3){0, 0, 0}, (shb_vec3){0, 1, 0}));
    shb_mat4 inverse;
    CHECK_INT(shb_mat4_inverse(a, &inverse), SHB_OK);
    /* The near plane's middle, clip (0, 0, near, near), is 1 mm in front of the eye. */
    const double w = 1e-3 * (inverse.m[11] + inverse.m[15]);
    CHECK_NEAR(1e-3 * (inverse.m[8] + inverse.m[12]) / w, 1e6, 1e-2);
    CHECK_NEAR(1e-3 * (inverse.m[9] + inverse.m[13]) / w, -2e6, 1e-2);
    CHECK_NEAR(1e-3 * (inverse.m[10] + inverse.m[14]) / w, 3e6, 1e-2);
}

TEST(inverse_does_not_mind_units) {
    const double scales[] = {1e-290, 1e-100, 1e100, 1e290};
    for (int i = 0; i < 4; i++) {
        const double s = scales[i];
        const double rows[16] = {s, s, 0, 0, -s, s, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1};
        shb_mat4 inverse;
        CHECK_INT(shb_mat4_inverse(from_rows(rows), &inverse), SHB_OK);
        CHECK_NEAR(inverse.m[0] * s, 0.5, 1e-15);
        CHECK_NEAR(inverse.m[4] * s, -0.5, 1e-15);
        CHECK_NEAR(inverse.m[10], 0.5, 0);
    }
}

TEST(inverse_refuses_what_has_none) {
    const double nan = (double)NAN;
    const double singular[][16] = {
        {0},
        {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16},
        {0.1, 0.2, 0.3, 0, 0.4, 0.5, 0.6, 0, 0.7, 0.8, 0.9, 0, 0, 0, 0, 1},
        {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1},
        {1, 0, 0, nan, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
        {1, 0, 0, 0, 0, HUGE_VAL, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
        {1e-310, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, /* 1e310 is out of range */
    };
    for (size_t i = 0; i < sizeof(singular) / sizeof(singular[0]); i++) {
        shb_mat4 inverse = shb_mat4_scaling(7, 7, 7);
        const shb_mat4 before = inverse;
        CHECK_INT(shb_mat4_inverse(from_rows(singular[i]), &inverse), SHB_ERROR_NUMBER);
        CHECK(memcmp(&inverse, &before, sizeof(before)) == 0);
    }
    CHECK_INT(shb_mat4_inverse(shb_mat4_identity(), NULL), SHB_ERROR_ARGUMENT);
}
