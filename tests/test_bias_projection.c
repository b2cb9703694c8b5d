/* What projection fills in for the methods: texels, centres, scales, and their limits. */
#include "probe.h"
#include "test.h"

#include <math.h>

static const shb_vec3 up = {0, 0, 1};

static probe project(shb_view view, uint32_t width, uint32_t height, shb_vec3 point) {
    const probe_light light = {view, width, height, 1};
    const shb_bias none = shb_bias_none();
    return probe_fragment(&light, &none, point, up);
}

/* The top left corner of the view, (-1, 1), is the corner of texel (0, 0). */
TEST(texels_count_from_the_top_left) {
    const shb_view view = probe_orthographic(false);
    probe seen = project(view, 8, 4, (shb_vec3){-0.96875, 0.875, 0});
    CHECK_INT(seen.texel_x, 0); /* column 0.125, row 0.25 */
    CHECK_INT(seen.texel_y, 0);
    CHECK_NEAR(seen.to_center_x, 0.375, 0);
    CHECK_NEAR(seen.to_center_y, 0.25, 0);
    seen = project(view, 8, 4, (shb_vec3){0.96875, -0.875, 0});
    CHECK_INT(seen.texel_x, 7);
    CHECK_INT(seen.texel_y, 3);
    CHECK_NEAR(seen.to_center_x, -0.375, 0);
    CHECK_NEAR(seen.to_center_y, -0.25, 0);
}

TEST(a_texel_holds_its_left_and_upper_edges) {
    const shb_view view = probe_orthographic(false);
    const probe seen = project(view, 8, 4, (shb_vec3){0.25, -0.5, 0}); /* column 5, row 3 */
    CHECK_INT(seen.texel_x, 5);
    CHECK_INT(seen.texel_y, 3);
    CHECK_NEAR(seen.to_center_x, 0.5, 0);
    CHECK_NEAR(seen.to_center_y, 0.5, 0);
}

TEST(texels_outside_the_map_are_numbered_on) {
    const shb_view view = probe_orthographic(false);
    probe seen = project(view, 8, 4, (shb_vec3){-1.0625, 1.125, 0}); /* column -0.25, row -0.25 */
    CHECK_INT(seen.texel_x, -1);
    CHECK_INT(seen.texel_y, -1);
    CHECK_NEAR(seen.to_center_x, -0.25, 0);
    CHECK_NEAR(seen.to_center_y, -0.25, 0);
    seen = project(view, 8, 4, (shb_vec3){-1.25, -1, 0}); /* exactly column -1, row 4 */
    CHECK_INT(seen.texel_x, -1);
    CHECK_INT(seen.texel_y, 4);
    CHECK_NEAR(seen.to_center_x, 0.5, 0);
}

TEST(far_coordinates_and_depths_end_at_a_limit) {
    const shb_view view = probe_orthographic(false);
    const probe seen = project(view, 8, 4, (shb_vec3){3e38, 3e38, -3e38});
    CHECK_INT(seen.texel_x, 1 << 30);
    CHECK_INT(seen.texel_y, -(1 << 30));
    CHECK_NEAR(seen.depth, 1 << 30, 0);
}

/* Every product and sum of its row is -0. */
TEST(a_depth_of_zero_has_no_sign) {
    shb_view view = probe_orthographic(true);
    view.clip_from_world = shb_mat4_identity();
    const probe seen = project(view, 8, 4, (shb_vec3){0.25, 0.25, 0});
    CHECK_INT(seen.texel_x, 5);
    CHECK(seen.depth == 0 && !signbit(seen.depth));
}

TEST(points_behind_the_light_or_not_finite_have_no_texel) {
    const shb_view spot = probe_perspective(false), sun = probe_orthographic(true);
    const shb_vec3 none_of_spot[] = {{0, 0, 5},       {0, 0, 4},        {0.5, 0.5, 4},
                                     {nan(""), 0, 0}, {0, HUGE_VAL, 0}, {0, 0, -HUGE_VAL}};
    for (int i = 0; i < 6; i++) {
        const probe seen = project(spot, 8, 8, none_of_spot[i]);
        CHECK_INT(seen.texel_x, SHB_TEXEL_NONE);
        CHECK_INT(seen.texel_y, SHB_TEXEL_NONE);
        CHECK(isfinite(seen.depth) && isfinite(seen.ref));
        CHECK(isfinite(seen.to_center_x) && isfinite(seen.to_center_y));
        CHECK(isfinite(seen.slope_x) && isfinite(seen.slope_y));
        CHECK(isfinite(seen.texel_size) && isfinite(seen.depth_per_world));
    }
    const shb_vec3 none_of_sun[] = {
        {nan(""), 0, 0}, {0, nan(""), 0}, {0, 0, nan("")}, {0, 0, HUGE_VAL}};
    for (int i = 0; i < 4; i++)
        CHECK_INT(project(sun, 8, 8, none_of_sun[i]).texel_x, SHB_TEXEL_NONE);
    CHECK_INT(project(sun, 8, 8, (shb_vec3){0, 0, 100}).texel_x, 4); /* no light to be behind */
}

/* The fraction of eq. 10 in Dou et al., from the standard depth of the same fragment. */
static double equation_10(double near_distance, double far_distance, double distance) {
    const double depth =
        far_distance / (far_distance - near_distance) * (1 - near_distance / distance);
    const double top = far_distance - depth * (far_distance - near_distance);
    return top * top / (far_distance * near_distance * (far_distance - near_distance));
}

/* Spots far from the origin and askew, so that the matrix holds no round numbers. */
TEST(depth_per_world_is_the_papers_fraction) {
    const double far_distances[] = {2, 10, 1000};
    for (int i = 0; i < 3; i++)
        for (int reversed = 0; reversed < 2; reversed++) {
            const shb_vec3 eye = {30, -70, 20}, along = {2 / 7.0, 3 / 7.0, -6 / 7.0};
            shb_view view;
            CHECK_INT(shb_view_perspective(eye, shb_vec3_add(eye, along), up, 0.7, 1, 0.5,
                                           far_distances[i], reversed, &view),
                      SHB_OK);
            for (double distance = 0.75; distance < 3; distance += 0.5) {
                const shb_vec3 point = shb_vec3_add(eye, shb_vec3_scale(along, distance));
                const double rate = project(view, 16, 16, point).depth_per_world;
                const double expected = equation_10(0.5, far_distances[i], distance);
                CHECK_NEAR(rate / expected, 1, 3e-5); /* of which 2e-5: the point is in float */
            }
        }
}

/* The same to full accuracy where points are exact in float: w = 4 - z. */
TEST(depth_per_world_is_exact_to_float) {
    for (int reversed = 0; reversed < 2; reversed++)
        for (double z = 0.5; z < 3; z += 0.25) {
            const probe seen = project(probe_perspective(reversed), 8, 8, (shb_vec3){0.25, 0, z});
            CHECK_NEAR(seen.depth_per_world / equation_10(1, 3, 4 - z), 1, 1e-7);
        }
}

TEST(depth_per_world_of_an_orthographic_light_is_one_over_its_range) {
    for (int reversed = 0; reversed < 2; reversed++) {
        const shb_vec3 eye = {3, -7, 2}, target = {1, 1, 1};
        shb_view view;
        shb_view_orthographic(eye, target, up, 3, 2, -4, 12, reversed, &view);
        CHECK_NEAR(project(view, 16, 16, (shb_vec3){1, 2, 3}).depth_per_world * 16, 1, 1e-7);
    }
}

TEST(depth_per_world_with_far_at_infinity) {
    for (int reversed = 0; reversed < 2; reversed++) {
        shb_view view;
        shb_view_perspective((shb_vec3){0, 0, 8}, (shb_vec3){0, 0, 0}, (shb_vec3){0, 1, 0}, 1, 1,
                             0.25, HUGE_VAL, reversed, &view);
        const probe seen = project(view, 16, 16, (shb_vec3){1, 0.5, 3}); /* w = 5 */
        CHECK_NEAR(seen.depth_per_world / (0.25 / 25), 1, 1e-7);
    }
}

/* A homogeneous matrix may have any scale. */
TEST(scales_do_not_depend_on_the_scale_of_the_matrix) {
    const probe once = project(probe_perspective(true), 8, 8, (shb_vec3){0.25, 0.5, 1});
    shb_view scaled = probe_perspective(true);
    for (int i = 0; i < 16; i++)
        scaled.clip_from_world.m[i] *= 4;
    const probe seen = project(scaled, 8, 8, (shb_vec3){0.25, 0.5, 1});
    CHECK_NEAR(seen.depth_per_world, once.depth_per_world, 0);
    CHECK_NEAR(seen.texel_size, once.texel_size, 0);
    CHECK_NEAR(seen.slope_x, once.slope_x, 0);
    CHECK_NEAR(seen.depth, once.depth, 0);

    shb_view sun = probe_orthographic(false);
    for (int i = 0; i < 16; i++)
        sun.clip_from_world.m[i] *= 4;
    CHECK_NEAR(project(sun, 8, 8, (shb_vec3){0, 0, 1}).depth_per_world, 0.125, 0);
    CHECK_NEAR(project(sun, 8, 8, (shb_vec3){0, 0, 1}).texel_size, 0.25, 0);
    CHECK_NEAR(project(sun, 8, 8, (shb_vec3){0, 0, 1}).depth, 0.375, 0);
}

/* Half sizes 3 by 2 world units over 16 by 16 texels: 0.375 by 0.25; over 16 by 8, 0.375 by 0.5. */
TEST(texel_size_is_the_larger_side) {
    shb_view view;
    shb_view_orthographic((shb_vec3){3, -7, 2}, (shb_vec3){1, 1, 1}, up, 3, 2, 1, 12, false, &view);
    CHECK_NEAR(project(view, 16, 16, (shb_vec3){1, 2, 3}).texel_size, 0.375, 1e-7);
    CHECK_NEAR(project(view, 16, 8, (shb_vec3){1, 2, 3}).texel_size, 0.5, 1e-7);
}

/* Opening 90 degrees: 2 w wide at distance w. */
TEST(texel_size_grows_with_the_distance) {
    const shb_view view = probe_perspective(false);
    CHECK_NEAR(project(view, 8, 16, (shb_vec3){0.5, 1, 3}).texel_size, 0.25, 0);
    CHECK_NEAR(project(view, 8, 16, (shb_vec3){0.5, 1, 1}).texel_size, 0.75, 0);
}

/* Spots one unit from the origin, where w is 1 then, on each axis: twice as far w is 2. */
TEST(a_spot_may_have_a_w_of_1_at_the_origin) {
    for (int axis = 0; axis < 3; axis++) {
        double eye[3] = {0, 0, 0};
        eye[axis] = 1;
        const shb_vec3 position = {eye[0], eye[1], eye[2]};
        shb_view view;
        CHECK_INT(shb_view_perspective(position, (shb_vec3){0, 0, 0}, (shb_vec3){1, 2, 3},
                                       2 * atan(1), 1, 0.25, 4, false, &view),
                  SHB_OK);
        const shb_vec3 beyond = shb_vec3_scale(position, -1);
        CHECK_NEAR(project(view, 8, 8, (shb_vec3){0, 0, 0}).texel_size, 0.25, 1e-7);
        CHECK_NEAR(project(view, 8, 8, beyond).texel_size, 0.5, 1e-7);
    }
}

/* Texels of 2^200 units and depths of 2^200 per unit are beyond floats. */
TEST(scales_of_any_view_are_finite) {
    const double tiny = 0x1p-200, huge = 0x1p200;
    const double suns[2][4][4] = {
        {{tiny, 0, 0, 0}, {0, tiny, 0, 0}, {0, 0, -0.125, 0.5}, {0, 0, 0, 1}},
        {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, -huge, 0.5}, {0, 0, 0, 1}}};
    const double spots[2][4][4] = {
        {{tiny, 0, 0, 0}, {0, tiny, 0, 0}, {0, 0, -1.5, 4.5}, {0, 0, -1, 4}},
        {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, -1.5 * huge, 4.5 * huge}, {0, 0, -1, 4}}};
    for (int i = 0; i < 4; i++) {
        const shb_view view = probe_view(i < 2 ? suns[i] : spots[i - 2], false);
        const probe seen = project(view, 8, 8, (shb_vec3){0, 0, 1});
        CHECK(isfinite(seen.texel_size) && isfinite(seen.depth_per_world));
    }
}

/* A frustum that looks half a width to the side. */
TEST(texel_size_of_an_off_centre_frustum) {
    shb_view view = probe_perspective(false);
    for (int column = 0; column < 4; column++)
        view.clip_from_world.m[4 * column] += view.clip_from_world.m[4 * column + 3];
    CHECK_NEAR(project(view, 4, 8, (shb_vec3){-1.5, 1, 1}).texel_size, 1.5, 0);
}

/* A spot at (3, 0, 4) looking down, w = 4 - z, whose near plane is tilted about the y axis: depth
 * is 1.5 + tilt * x / w - 1.5 / w, x counted from the spot, and so grows along any ray as it does
 * without the tilt. */
TEST(depth_per_world_of_an_oblique_near_plane) {
    for (int reversed = 0; reversed < 2; reversed++)
        for (double tilt = -1; tilt <= 1; tilt += 0.5) {
            const double sign = reversed ? -1 : 1;
            const double rows[4][4] = {{1, 0, 0, -3},
                                       {0, 1, 0, 0},
                                       {sign * tilt, 0, reversed ? 0.5 : -1.5,
                                        sign * (4.5 - 3 * tilt) + (reversed ? 4 : 0)},
                                       {0, 0, -1, 4}};
            const probe seen = project(probe_view(rows, reversed), 8, 8, (shb_vec3){3.25, 0, 1});
            CHECK_NEAR(seen.depth_per_world, 1.5 / 9, 1e-7);
        }
}

TEST(a_directional_light_has_one_direction) {
    shb_view view;
    shb_view_orthographic((shb_vec3){3, 0, 4}, (shb_vec3){0, 0, 0}, (shb_vec3){0, 1, 0}, 9, 9, 1,
                          20, false, &view);
    CHECK_NEAR(project(view, 16, 16, (shb_vec3){0, 0, 0}).cosine, 0.8, 1e-7);
    CHECK_NEAR(project(view, 16, 16, (shb_vec3){2, -3, 5}).cosine, 0.8, 1e-7);
}

/* As long as rounding to floats may make it. */
TEST(a_normal_a_little_too_long_has_a_cosine_of_one) {
    const shb_bias offset = shb_bias_normal_offset(1, 0);
    const probe_light light = {probe_orthographic(false), 8, 8, 1};
    const probe seen =
        probe_fragment(&light, &offset, (shb_vec3){0.25, 0.5, 1}, (shb_vec3){0, 0, 1 + 0x1p-22});
    CHECK_NEAR(seen.cosine, 1, 0);
    CHECK_NEAR(seen.z, 1, 0);
}

/* 20000 units from the origin, where a float resolves 1/512: the cosine still is that of the exact
 * difference between light and point. */
TEST(light_directions_are_taken_in_double) {
    const shb_vec3 eye = {20000, 20000, 20008};
    shb_view view;
    shb_view_perspective(eye, (shb_vec3){20000, 20000, 20000}, (shb_vec3){0, 1, 0}, 1, 1, 1, 20,
                         true, &view);
    const probe seen = project(view, 16, 16, (shb_vec3){20001.5, 20000, 20006});
    CHECK_NEAR(seen.cosine, 2 / 2.5, 1e-6);
}
