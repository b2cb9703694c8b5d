/* The point under a pixel: by hand, against ray-plane intersection, and at the triangle's border.
 */
#include "../src/surface.h"

#include <math.h>
#include <string.h>

#include "random.h"
#include "target.h"
#include "test.h"

/* Looks along -z from the origin with an opening of 90 degrees both ways: clip = (x, y, ., -z). */
static shb_view pinhole(void) {
    shb_view view = {{{0}}, false};
    view.clip_from_world.m[0] = view.clip_from_world.m[5] = 1;
    view.clip_from_world.m[10] = view.clip_from_world.m[11] = -1;
    view.clip_from_world.m[14] = -1;
    return view;
}

/* The pinhole camera at a place, with its axes along the world's. */
static shb_view pinhole_at(shb_vec3 eye) {
    shb_view view = pinhole();
    double *m = view.clip_from_world.m;
    m[12] = -eye.x;
    m[13] = -eye.y;
    m[14] = eye.z - 1;
    m[15] = eye.z;
    return view;
}

static bool prepare(const float corners[9], const shb_view *camera,
                    shb_surface_triangle *triangle) {
    const shb_mesh mesh = {.positions = corners, .vertex_count = 3, .triangle_count = 1};
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene scene = {&instance, 1};
    return shb_surface_prepare(&scene, camera, 0, triangle);
}

static void check_weights(const double weights[3], double w0, double w1, double w2) {
    CHECK_NEAR(weights[0], w0, 1e-12);
    CHECK_NEAR(weights[1], w1, 1e-12);
    CHECK_NEAR(weights[2], w2, 1e-12);
}

/* All weights are at least 0 and their sum is 1. */
static void check_inside(const double weights[3]) {
    CHECK(weights[0] >= 0 && weights[1] >= 0 && weights[2] >= 0);
    CHECK_NEAR(weights[0] + weights[1] + weights[2], 1, 1e-15);
}

TEST(surface_weights_are_affine_in_an_orthographic_view) {
    /* The right angle lies at (0, 0), the legs are 64 pixels long: at the centre of pixel (8, 16)
     * the weights are 8.5 / 64 and 16.5 / 64, whatever the depths of the corners. */
    const float corners[9] = {0, 0, 0.5f, 64, 0, 0.25f, 0, 64, 0.125f};
    const shb_view view = test_pixel_view(128, 128);
    shb_surface_triangle triangle;
    CHECK(prepare(corners, &view, &triangle));
    double weights[3];
    shb_surface_weights(&triangle, 128, 128, 8, 16, weights);
    check_weights(weights, 39.0 / 64, 8.5 / 64, 16.5 / 64);
    const shb_vec3 point = shb_surface_point(&triangle, weights);
    CHECK_NEAR(point.x, 8.5, 1e-13);
    CHECK_NEAR(point.y, 16.5, 1e-13);
    CHECK_NEAR(point.z, (39 * 0.5 + 8.5 * 0.25 + 16.5 * 0.125) / 64, 1e-15);
}

TEST(surface_weights_are_correct_in_perspective) {
    /* On the screen the corners are (-1, -1), (1, -1), (-1, 1). Pixel (0, 1) of 1 x 2 has its
     * centre at (0, -0.5): affine weights 1/4, 1/2, 1/4. Divided by w = 2, 6, 2: 1/8, 1/12, 1/8,
     * whose sum is 1/3. So the weights are 3/8, 1/4, 3/8 and the point is (0, -1.5, -3). */
    const float corners[9] = {-2, -2, -2, 6, -6, -6, -2, 2, -2};
    const shb_view view = pinhole();
    shb_surface_triangle triangle;
    CHECK(prepare(corners, &view, &triangle));
    double weights[3];
    shb_surface_weights(&triangle, 1, 2, 0, 1, weights);
    check_weights(weights, 0.375, 0.25, 0.375);
    const shb_vec3 point = shb_surface_point(&triangle, weights);
    CHECK_NEAR(point.x, 0, 1e-15);
    CHECK_NEAR(point.y, -1.5, 1e-15);
    CHECK_NEAR(point.z, -3, 1e-15);
}

/* Row of a matrix times (p, 1), with more bits than double where the processor has them. */
static long double transform_row(const shb_mat4 *matrix, int row, shb_vec3 p) {
    const double *m = matrix->m + row;
    return (long double)m[0] * (long double)p.x + (long double)m[4] * (long double)p.y +
           (long double)m[8] * (long double)p.z + (long double)m[12];
}

/* How far, in pixels of a screen of size x size, the point's projection lies from a pixel's centre.
 */
static double projection_error(const shb_view *view, shb_vec3 p, uint32_t size, uint32_t column,
                               uint32_t row) {
    const long double w = transform_row(&view->clip_from_world, 3, p);
    const long double x = transform_row(&view->clip_from_world, 0, p) / w;
    const long double y = transform_row(&view->clip_from_world, 1, p) / w;
    return (double)hypotl((x + 1) * size / 2 - column - 0.5L, (1 - y) * size / 2 - row - 0.5L);
}

/* A triangle of about the given size around the point of a ray from the eye, in full double bits.
 */
static void random_triangle(test_random *random, const shb_view *view, shb_vec3 eye, double ray_x,
                            double ray_y, double size, shb_surface_triangle *triangle) {
    const float angle = (float)random_double(random, 0, 6.28);
    float corners[9];
    for (int k = 0; k < 3; k++) {
        const float depth = (float)random_double(random, -1, 1);
        corners[3 * k] = cosf(angle + 2.1f * (float)k) - depth * (float)ray_x;
        corners[3 * k + 1] = sinf(angle + 2.1f * (float)k) - depth * (float)ray_y;
        corners[3 * k + 2] = depth;
    }
    const shb_mesh mesh = {.positions = corners, .vertex_count = 3, .triangle_count = 1};
    shb_instance instance = {.mesh = &mesh, .world_from_mesh = shb_mat4_scaling(size, size, size)};
    instance.world_from_mesh.m[12] = eye.x + 10 * ray_x;
    instance.world_from_mesh.m[13] = eye.y + 10 * ray_y;
    instance.world_from_mesh.m[14] = eye.z - 10;
    const shb_scene scene = {&instance, 1};
    CHECK(shb_surface_prepare(&scene, view, 0, triangle));
}

/* The largest distance of projected points from the pixels' centres over random triangles of a size
 * that cover the pixel, 10 units before a camera at a distance from the origin. */
static double worst_projection(double origin, double size) {
    test_random random = {7};
    const shb_vec3 eye = {origin / 3, -origin / 7, origin / 11};
    shb_view view = pinhole_at(eye);
    double worst = 0;
    for (int i = 0; i < 2000; i++) {
        const uint32_t column = random_below(&random, 1024), row = random_below(&random, 1024);
        const double ray_x = (2.0 * column + 1 - 1024) / 1024, ray_y = (1023 - 2.0 * row) / 1024;
        shb_surface_triangle triangle;
        random_triangle(&random, &view, eye, ray_x, ray_y, size, &triangle);
        double weights[3];
        shb_surface_weights(&triangle, 1024, 1024, column, row, weights);
        check_inside(weights);
        const shb_vec3 point = shb_surface_point(&triangle, weights);
        const double error = projection_error(&view, point, 1024, column, row);
        worst = error > worst ? error : worst;
    }
    return worst;
}

TEST(surface_points_project_to_the_pixel_centre) {
    CHECK(worst_projection(0, 1) < 1e-12);
    CHECK(worst_projection(0, 0.01) < 1e-12);
    CHECK(worst_projection(1024, 1) < 5e-11);
    CHECK(worst_projection(1024, 0.01) < 5e-11);
    CHECK(worst_projection(1048576, 4) < 5e-8);
}

TEST(surface_points_equal_ray_plane_intersections_behind_the_camera_too) {
    test_random random = {11};
    const shb_view view = pinhole();
    int covered = 0, crossing = 0;
    for (int i = 0; i < 20000; i++) {
        float corners[9];
        int behind = 0;
        for (int k = 0; k < 9; k++)
            corners[k] = (float)random_double(&random, -4, 4);
        for (int k = 0; k < 3; k++)
            behind += corners[3 * k + 2] > 0;
        shb_surface_triangle triangle;
        CHECK(prepare(corners, &view, &triangle));
        /* The ray s (x, y, -1) through the centre of pixel (3, 5) of 16 x 16 meets the plane at s.
         */
        const shb_vec3 ray = {(7.0 - 16) / 16, (16 - 11.0) / 16, -1};
        const shb_vec3 *c = triangle.corners;
        const shb_vec3 normal =
            shb_vec3_cross(shb_vec3_subtract(c[1], c[0]), shb_vec3_subtract(c[2], c[0]));
        const double slope = shb_vec3_dot(normal, ray);
        const double s = shb_vec3_dot(normal, c[0]) / slope;
        const shb_vec3 hit = shb_vec3_scale(ray, s);
        bool inside = s > 0 && fabs(slope) > 1e-2;
        for (int k = 0; k < 3; k++) {
            const shb_vec3 edge = shb_vec3_subtract(c[(k + 1) % 3], c[k]);
            const shb_vec3 to_hit = shb_vec3_subtract(hit, c[k]);
            inside = inside && shb_vec3_dot(shb_vec3_cross(edge, to_hit), normal) > 0;
        }
        double weights[3];
        shb_surface_weights(&triangle, 16, 16, 3, 5, weights);
        check_inside(weights);
        if (!inside)
            continue;
        covered++;
        crossing += behind > 0;
        const shb_vec3 point = shb_surface_point(&triangle, weights);
        CHECK_NEAR(shb_vec3_length(shb_vec3_subtract(point, hit)), 0, 1e-11);
    }
    CHECK(covered > 500 && crossing > 100);
}

/* Checks the point for every order of the corners. The pixel is (20, 40) of 128 x 128. */
static void check_every_order(const shb_view *view, const float corners[9], double x, double y,
                              double z) {
    static const int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1},
                                     {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    for (int i = 0; i < 6; i++) {
        float ordered[9];
        for (int k = 0; k < 3; k++)
            memcpy(ordered + 3 * k, corners + 3 * orders[i][k], 3 * sizeof *ordered);
        shb_surface_triangle triangle;
        CHECK(prepare(ordered, view, &triangle));
        double weights[3];
        shb_surface_weights(&triangle, 128, 128, 20, 40, weights);
        check_inside(weights);
        const shb_vec3 point = shb_surface_point(&triangle, weights);
        CHECK_NEAR(point.x, x, 1e-5);
        CHECK_NEAR(point.y, y, 1e-5);
        CHECK_NEAR(point.z, z, 1e-5);
    }
}

TEST(surface_centre_outside_a_sliver_gives_the_nearest_point_of_its_edge) {
    /* The centre (20.5, 40.5) lies 1/256 pixel above an edge that runs along row 40.50390625 from
     * column 0 to 100; the triangle is 1/1024 pixel high. Clamped weights would land 23 columns
     * off. */
    const float sliver[9] = {0, 40.50390625f, 0, 100, 40.50390625f, 1, 50, 40.5048828125f, 0};
    const shb_view view = test_pixel_view(128, 128);
    check_every_order(&view, sliver, 20.5, 40.50390625, 0.205);
}

TEST(surface_centre_outside_a_corner_gives_the_corner) {
    const float corner[9] = {20.501953125f, 40.501953125f, 0.5f, 60, 70, 0, 50, 90, 0};
    const shb_view view = test_pixel_view(128, 128);
    check_every_order(&view, corner, 20.501953125, 40.501953125, 0.5);
}

TEST(surface_centre_outside_an_edge_is_moved_in_perspective) {
    /* Pixel (20, 40) of 128 x 128 has its centre at ndc (-87/128, 47/128). The edge lies at ndc x =
     * -86.75/128, one eighth of a pixel to the right, and runs from ndc y = -1 at w = 1 to ndc y =
     * 1 at w = 3. At ndc y = 47/128 the affine weight is 175/256 at the far end; by w: 175/768
     * against 81/256 = 243/768. So the weight of the far end is 175/418, w = 1 + 350/418. */
    const float x = -86.75f / 128;
    const float corners[9] = {x, -1, -1, 3 * x, 3, -3, 1, 0, -1};
    const double w = 1 + 350.0 / 418;
    const shb_view view = pinhole();
    check_every_order(&view, corners, (double)x * w, 47 * w / 128, -w);
}

TEST(surface_nearest_point_is_measured_in_pixels_of_an_oblong_image) {
    /* In an image of 128 x 64 the centre (20.5, 40.5) lies (1/8, -1/8) pixel before an edge that
     * runs down to the right at 45 degrees, at a quarter of its length. */
    const float corners[9] = {10.625f, 30.375f, 0, 50.625f, 70.375f, 1, 60, 30, 0};
    shb_view view = test_pixel_view(128, 128);
    view.clip_from_world.m[5] = -2.0 / 64;
    shb_surface_triangle triangle;
    CHECK(prepare(corners, &view, &triangle));
    double weights[3];
    shb_surface_weights(&triangle, 128, 64, 20, 40, weights);
    check_weights(weights, 0.75, 0.25, 0);
}

TEST(surface_triangle_seen_from_its_edge_gives_the_nearest_point) {
    /* The triangle lies in the plane x = 20 pixels: a line of the screen from row 30 to row 50. */
    const float corners[9] = {20, 30, 0, 20, 50, 0, 20, 40, 0.5f};
    const shb_view view = test_pixel_view(128, 128);
    shb_surface_triangle triangle;
    CHECK(prepare(corners, &view, &triangle));
    double weights[3];
    shb_surface_weights(&triangle, 128, 128, 20, 40, weights);
    check_inside(weights);
    CHECK_NEAR(shb_surface_point(&triangle, weights).y, 40.5, 1e-5);
}

TEST(surface_without_area_has_no_normal_and_still_has_a_point) {
    const float corners[9] = {1, 2, -3, 1, 2, -3, 1, 2, -3};
    const float behind[9] = {1, 2, 3, 1, 2, 3, 1, 2, 3};
    const shb_view view = pinhole();
    shb_surface_triangle triangle;
    double weights[3];
    CHECK(prepare(corners, &view, &triangle));
    CHECK_NEAR(shb_vec3_length(triangle.normal), 0, 0);
    shb_surface_weights(&triangle, 128, 128, 20, 40, weights);
    check_inside(weights);
    CHECK(prepare(behind, &view, &triangle));
    shb_surface_weights(&triangle, 128, 128, 20, 40, weights);
    check_weights(weights, 1, 0, 0);
}

TEST(surface_extremes_of_float_give_a_point_or_the_first_corner) {
    const float scales[4] = {1e-45f, 1e-38f, 1e30f, 3e38f};
    const shb_view view = pinhole();
    for (int i = 0; i < 4; i++) {
        const float s = scales[i];
        const float corners[9] = {-s, -s, -s, s, -s, -s, 0, s, -s};
        shb_surface_triangle triangle;
        CHECK(prepare(corners, &view, &triangle));
        CHECK_NEAR(triangle.normal.z, 1, 1e-12);
        double weights[3];
        shb_surface_weights(&triangle, 128, 128, 64, 64, weights);
        check_inside(weights);
        const shb_vec3 point = shb_surface_point(&triangle, weights);
        CHECK_NEAR(point.x / (double)s, 1.0 / 128, 1e-12);
        CHECK_NEAR(point.y / (double)s, -1.0 / 128, 1e-12);
    }
}

TEST(surface_normals_follow_the_instance) {
    /* The plane x + y = 1 under a scale of 2 along x is x / 2 + y = 1: its normal is (1, 2, 0). A
     * mirror keeps the front in front. */
    const float positions[9] = {1, 0, 0, 0, 1, 0, 1, 0, 1};
    const float normals[9] = {1, 1, 0, 1, 1, 0, 1, 1, 0};
    const shb_mesh mesh = {
        .positions = positions, .normals = normals, .vertex_count = 3, .triangle_count = 1};
    shb_instance instances[3] = {{.mesh = &mesh}, {.mesh = &mesh}, {.mesh = &mesh}};
    instances[1].world_from_mesh = shb_mat4_scaling(2, 1, 1);
    instances[2].world_from_mesh = shb_mat4_scaling(-2, 1, 1);
    const shb_scene scene = {instances, 3};
    const shb_vec3 expected[3] = {{1, 1, 0}, {1, 2, 0}, {-1, 2, 0}};
    const shb_view view = pinhole();
    shb_surface_triangle triangle;
    for (uint32_t id = 0; id < 3; id++) {
        CHECK(shb_surface_prepare(&scene, &view, id, &triangle));
        CHECK_INT(triangle.id, id);
        const shb_vec3 unit = shb_vec3_normalize(expected[id]);
        for (int k = 0; k < 4; k++) {
            const shb_vec3 normal =
                k < 3 ? shb_vec3_normalize(triangle.shading[k]) : triangle.normal;
            CHECK_NEAR(shb_vec3_length(shb_vec3_subtract(normal, unit)), 0, 1e-15);
        }
    }
    CHECK_NEAR(triangle.corners[0].x, -2, 0);
}

TEST(surface_refuses_ids_and_corners_that_cannot_be_drawn) {
    float positions[18] = {0, 0, -1, 1, 0, -1, 0, 1, -1, 0, 0, -2, 1, 0, -2, 0, NAN, -2};
    const shb_mesh mesh = {.positions = positions, .vertex_count = 6, .triangle_count = 2};
    const shb_instance instances[2] = {{.mesh = &mesh}, {.mesh = &mesh}};
    const shb_scene scene = {instances, 2};
    const shb_view view = pinhole();
    shb_surface_triangle triangle;
    CHECK(shb_surface_prepare(&scene, &view, 0, &triangle));
    CHECK(!shb_surface_prepare(&scene, &view, 1, &triangle));
    CHECK(shb_surface_prepare(&scene, &view, 2, &triangle));
    CHECK(!shb_surface_prepare(&scene, &view, 4, &triangle));
    CHECK_INT(triangle.id, 2);
    CHECK_NEAR(triangle.corners[2].z, -1, 0); /* of triangle 2, not of 1 or 3 */
    CHECK(!shb_surface_prepare(&scene, &view, SHB_ID_NONE, &triangle));
    positions[13] = INFINITY;
    CHECK(!shb_surface_prepare(&scene, &view, 3, &triangle));
    CHECK_NEAR(triangle.corners[2].z, -1, 0);
}

TEST(surface_refuses_indices_out_of_range) {
    const float positions[9] = {0, 0, -1, 1, 0, -1, 0, 1, -1};
    const uint32_t indices[6] = {0, 1, 2, 0, 1, 3};
    const shb_mesh mesh = {
        .positions = positions, .vertex_count = 3, .indices = indices, .triangle_count = 2};
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene scene = {&instance, 1};
    const shb_view view = pinhole();
    shb_surface_triangle triangle;
    CHECK(shb_surface_prepare(&scene, &view, 0, &triangle));
    CHECK(!shb_surface_prepare(&scene, &view, 1, &triangle));
}

TEST(surface_faces_the_side_of_its_normal) {
    const float corners[9] = {0, 0, -2, 1, 0, -2, 0, 1, -2}; /* normal +z */
    const shb_view view = pinhole();
    shb_surface_triangle triangle;
    CHECK(prepare(corners, &view, &triangle));
    const shb_light_source point_before = {{5, 5, -1.999}, 1}, point_behind = {{5, 5, -2.001}, 1};
    const shb_light_source to_front = {{0.6, 0, 0.8}, 0}, to_back = {{0.6, 0, -0.8}, 0};
    const shb_light_source in_plane = {{1, 0, 0}, 0};
    CHECK(shb_surface_faces(&triangle, &point_before));
    CHECK(!shb_surface_faces(&triangle, &point_behind));
    CHECK(shb_surface_faces(&triangle, &to_front));
    CHECK(!shb_surface_faces(&triangle, &to_back));
    CHECK(!shb_surface_faces(&triangle, &in_plane));
}
