/* Methods of the offset stage: the moved point, worked out by hand.
 *
 * Orthographic light straight down, depth (4 - z) / 8 over [-1, 1]^2, 4 x 4 texels of width 0.5. */
#include "probe.h"
#include "test.h"

#include <math.h>

#define FLOAT_ERROR 2e-7

static const double degrees[] = {0, 45, 60, 80};

static void check_moved(const shb_bias *bias, double angle, double distance, double taken_off) {
    const probe_light light = {probe_orthographic(false), 4, 4, 10};
    const shb_vec3 normal = {sin(angle), 0, cos(angle)};
    const probe seen = probe_fragment(&light, bias, (shb_vec3){-0.3, 0.1, 0.2}, normal);
    const double x = -0.3 + distance * normal.x, z = 0.2 + distance * normal.z;
    CHECK_NEAR(seen.x, x, FLOAT_ERROR);
    CHECK_NEAR(seen.y, 0.1, FLOAT_ERROR);
    CHECK_NEAR(seen.z, z, FLOAT_ERROR);
    const double column = 4 * (x / 2 + 0.5);
    CHECK_INT(seen.texel_x, floor(column));
    CHECK_NEAR(seen.to_center_x, floor(column) + 0.5 - column, 4 * FLOAT_ERROR);
    CHECK_NEAR(seen.depth, (4 - z) / 8, FLOAT_ERROR);
    CHECK_NEAR(seen.ref, (4 - z) / 8 - taken_off, FLOAT_ERROR);
    CHECK_NEAR(seen.step_x, 0, 0);
    /* the slope is that of the plane through the unmoved point, which is the same plane here */
    CHECK_NEAR(seen.slope_x, tan(angle) / 16, FLOAT_ERROR);
}

/* 1.5 texels of 0.5, times the sine. */
TEST(normal_offset_moves_by_texels_and_the_sine) {
    const shb_bias bias = shb_bias_normal_offset(1.5f, 1e-3f);
    for (int i = 0; i < 4; i++) {
        const double angle = degrees[i] * 3.14159265358979323846 / 180;
        check_moved(&bias, angle, 0.75 * sin(angle), 1e-3);
    }
}

/* The half diagonal is 0.5 / sqrt 2. */
TEST(texel_cone_moves_by_the_half_diagonal) {
    const shb_bias bias = shb_bias_texel_cone();
    for (int i = 0; i < 4; i++) {
        const double angle = degrees[i] * 3.14159265358979323846 / 180;
        check_moved(&bias, angle, 0.5 / sqrt(2.0) * (1.16 * sin(angle) + 0.195), 0);
    }
}

TEST(offsets_go_to_the_side_of_the_light) {
    const probe_light light = {probe_orthographic(false), 4, 4, 10};
    const shb_bias bias = shb_bias_texel_cone();
    const probe seen =
        probe_fragment(&light, &bias, (shb_vec3){0, 0, 0}, (shb_vec3){0, -0.6, -0.8});
    CHECK(seen.y > 0);
    CHECK(seen.z > 0);
}

/* The spot of the support: light at z = 4, w = 4 - z. A move along z changes w, and with it the map
 * coordinate: the projection is that of the moved point, scales and slopes are of the unmoved one.
 */
static void move_up_by_one(const shb_bias_args *args) {
    for (size_t i = 0; i < args->count; i++)
        args->receivers->z[i] += 1;
}

TEST(slopes_and_scales_are_of_the_unmoved_point) {
    const probe_light light = {probe_perspective(false), 32, 16, 10};
    const shb_bias bias = {.name = "up", .offset = move_up_by_one};
    const shb_vec3 point = {0.2, -0.6, 1}, normal = {sqrt(0.5), 0, sqrt(0.5)};
    const shb_bias none = shb_bias_none();
    const probe still = probe_fragment(&light, &none, point, normal);
    const probe moved = probe_fragment(&light, &bias, point, normal);
    CHECK_NEAR(still.texel_size, 2.0 / 16 * 3, FLOAT_ERROR);
    CHECK_NEAR(still.depth_per_world, 1.5 / 9, FLOAT_ERROR);
    CHECK_NEAR(moved.texel_size, still.texel_size, 0);
    CHECK_NEAR(moved.depth_per_world, still.depth_per_world, 0);
    CHECK_NEAR(moved.slope_x, still.slope_x, 0);
    CHECK(still.slope_x > 0);
    CHECK_NEAR(still.depth, 1.5 - 1.5 / 3, FLOAT_ERROR);
    CHECK_NEAR(moved.depth, 1.5 - 1.5 / 2, FLOAT_ERROR);
    CHECK_INT(moved.texel_x, 17); /* 32 * (0.1 / 2 + 0.5) = 17.6 */
    CHECK_INT(still.texel_x, 17); /* 32 * (0.0667 / 2 + 0.5) = 17.07 */
    CHECK_NEAR(moved.to_center_x, -0.1, 1e-6);
    CHECK_NEAR(still.to_center_x, 0.5 - 16 * 0.2 / 3 + 1, 1e-6);
}
