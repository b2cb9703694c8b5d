/* Figure 2 of Dou et al., without any of the library's formulas: the potential occluder in a texel
 * is where the light ray through the texel's centre meets the fragment's plane. Rays come from the
 * inverse of the view's matrix, and everything is in double. */
#include "oracle.h"
#include "probe.h"
#include "random.h"
#include "test.h"

#include <math.h>

static shb_vec3 unproject(const shb_mat4 *world_from_clip, double x, double y, double z) {
    const double *m = world_from_clip->m;
    double p[4];
    for (int row = 0; row < 4; row++)
        p[row] = m[row] * x + m[4 + row] * y + m[8 + row] * z + m[12 + row];
    return (shb_vec3){p[0] / p[3], p[1] / p[3], p[2] / p[3]};
}

static double depth_of(const shb_mat4 *clip_from_world, shb_vec3 p) {
    const double *m = clip_from_world->m;
    const double z = m[2] * p.x + m[6] * p.y + m[10] * p.z + m[14];
    return z / (m[3] * p.x + m[7] * p.y + m[11] * p.z + m[15]);
}

/* The view's depth where the ray through (column, row), in texels, meets the plane. */
static double occluder_depth(const probe_light *light, double column, double row, shb_vec3 point,
                             shb_vec3 normal) {
    const double x = column / light->width * 2 - 1, y = 1 - row / light->height * 2;
    shb_mat4 inverse;
    CHECK_INT(shb_mat4_inverse(light->view.clip_from_world, &inverse), SHB_OK);
    const shb_vec3 start = unproject(&inverse, x, y, 0.25);
    const shb_vec3 along = shb_vec3_subtract(unproject(&inverse, x, y, 0.75), start);
    const double t =
        shb_vec3_dot(normal, shb_vec3_subtract(point, start)) / shb_vec3_dot(normal, along);
    return depth_of(&light->view.clip_from_world, shb_vec3_add(start, shb_vec3_scale(along, t)));
}

static shb_vec3 random_vector(test_random *random) {
    return (shb_vec3){random_double(random, -1, 1), random_double(random, -1, 1),
                      random_double(random, -1, 1)};
}

/* What the probe receives is rounded to float. */
static shb_vec3 as_floats(shb_vec3 v) {
    return (shb_vec3){oracle_float(v.x), oracle_float(v.y), oracle_float(v.z)};
}

/* A fragment about the origin that the light sees, with a plane of at most 80 degrees. */
static void check_random_plane(const probe_light *light, shb_vec3 eye, test_random *random) {
    const shb_vec3 to_light = shb_vec3_normalize(eye);
    shb_vec3 normal;
    do
        normal = shb_vec3_normalize(random_vector(random));
    while (fabs(shb_vec3_dot(normal, to_light)) < 0.17);
    normal = as_floats(normal);
    const shb_vec3 point = as_floats(random_vector(random));
    const shb_bias bias = shb_bias_receiver_plane(0);
    const probe seen = probe_fragment(light, &bias, point, normal);
    const double sign = light->view.reversed ? -1 : 1;
    for (int m = -3; m <= 3; m++)
        for (int n = -3; n <= 3; n++) {
            const double expected = occluder_depth(light, seen.texel_x + m + 0.5,
                                                   seen.texel_y + n + 0.5, point, normal);
            CHECK_NEAR(seen.ref + m * seen.step_x + n * seen.step_y, sign * expected, 1e-6);
        }
}

TEST(planes_have_the_depth_of_the_light_rays_through_texel_centres) {
    test_random random = {1};
    for (int i = 0; i < 400; i++) {
        const bool reversed = i & 1, central = i & 2;
        const shb_vec3 eye = shb_vec3_scale(shb_vec3_normalize(random_vector(&random)), 6);
        const shb_vec3 target = shb_vec3_scale(random_vector(&random), 0.3);
        const shb_vec3 up = random_vector(&random);
        probe_light light = {.width = 64, .height = 48, .scene_scale = 1};
        if (central)
            shb_view_perspective(eye, target, up, 0.8, 1.2, 3, i % 8 == 6 ? HUGE_VAL : 10, reversed,
                                 &light.view);
        else
            shb_view_orthographic(eye, target, up, 2.5, 2, 2, 10, reversed, &light.view);
        check_random_plane(&light, eye, &random);
    }
}

/* Sheared and scaled rows are a light like any other: the matrix is its definition. */
TEST(planes_follow_any_matrix_of_the_host) {
    test_random random = {2};
    for (int i = 0; i < 100; i++) {
        const shb_vec3 eye = shb_vec3_scale(shb_vec3_normalize(random_vector(&random)), 6);
        probe_light light = {.width = 48, .height = 64, .scene_scale = 1};
        shb_view_perspective(eye, (shb_vec3){0, 0, 0}, random_vector(&random), 0.8, 1, 3, 10, false,
                             &light.view);
        const shb_mat4 shear = {
            {1.5, 0.25, 0.1, 0, 0.5, 0.75, -0.2, 0, 0, 0, 1.5, 0, 0.125, 0, 0, 1.5}};
        light.view.clip_from_world = shb_mat4_multiply(shear, light.view.clip_from_world);
        check_random_plane(&light, eye, &random);
    }
}
