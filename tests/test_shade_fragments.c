/* Fragments and their normals as shading hands them out, by hand. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "shading.h"
#include "test.h"

static void check_vec3(const float actual[3], double x, double y, double z, double tolerance) {
    CHECK_NEAR(actual[0], x, tolerance);
    CHECK_NEAR(actual[1], y, tolerance);
    CHECK_NEAR(actual[2], z, tolerance);
}

TEST(shade_fragments_of_an_orthographic_camera) {
    /* The plane z = 4 + y, normal (0, -1, 1) or back; the camera stands at -z, so (0, 1, -1). The
     * vertex normals (x / 8, 0, -1) interpolate linearly. */
    quad q;
    quad_init(&q, 4, 1);
    for (int k = 0; k < 4; k++) {
        q.normals[3 * k] = q.positions[3 * k] / 8;
        q.normals[3 * k + 1] = 0;
        q.normals[3 * k + 2] = -1;
    }
    q.mesh.normals = q.normals;
    shb_context *context = shading_context(1);
    seen_pixel *pixels = shade_and_record(context, (shb_shade_desc){.frame = q.frame});
    for (uint32_t i = 0; i < 32; i++) {
        const double x = i % 8 + 0.5, y = i / 8 + 0.5, length = sqrt(x * x / 64 + 1);
        CHECK_INT(pixels[i].times, 1);
        CHECK_INT(pixels[i].id, q.ids[i]);
        check_vec3(pixels[i].position, x, y, 4 + y, 1e-6);
        check_vec3(pixels[i].normal, 0, sqrt(0.5), -sqrt(0.5), 1e-7);
        check_vec3(pixels[i].shading, x / 8 / length, 0, -1 / length, 1e-7);
        /* corner 1 is (8, 0) and corner 2 (8, 4), or (8, 4) and (0, 4) */
        CHECK_NEAR(pixels[i].weight_1, q.ids[i] == 0 ? x / 8 - y / 4 : x / 8, 1e-7);
        CHECK_NEAR(pixels[i].weight_2, q.ids[i] == 0 ? y / 4 : y / 4 - x / 8, 1e-7);
    }
    free(pixels);
    shb_context_destroy(context);
}

/* The pixels' centres on the edge from the second to the third corner, where both weights, k / 101
 * and 1 - k / 101, may be rounded up. */
TEST(shade_weights_keep_points_of_an_edge_within_their_triangle) {
    enum { SIZE = 102, STEPS = SIZE - 1 };
    const float positions[9] = {0.5f, 0.5f, 4, 0.5f, SIZE - 0.5f, 4, SIZE - 0.5f, 0.5f, 4};
    const shb_mesh mesh = {.positions = positions, .vertex_count = 3, .triangle_count = 1};
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene scene = {&instance, 1};
    const shb_view view = pixel_space(SIZE, SIZE);
    static uint32_t ids[SIZE * SIZE];
    for (int i = 0; i < SIZE * SIZE; i++)
        ids[i] = i % SIZE + i / SIZE == STEPS ? 0 : SHB_ID_NONE;
    shb_context *context = shading_context(1);
    seen_pixel *pixels = shade_and_record(
        context,
        (shb_shade_desc){
            .frame = {.view = &view, .scene = &scene, .width = SIZE, .height = SIZE, .ids = ids}});
    for (int x = 0; x < SIZE; x++) {
        const seen_pixel *pixel = &pixels[(STEPS - x) * SIZE + x];
        const double weight_1 = (double)pixel->weight_1, weight_2 = (double)pixel->weight_2;
        CHECK_INT(pixel->times, 1);
        CHECK(weight_1 >= 0 && weight_2 >= 0 && weight_1 + weight_2 <= 1);
        CHECK_NEAR(weight_1, (double)(STEPS - x) / STEPS, 0x1p-23);
        CHECK_NEAR(weight_2, (double)x / STEPS, 0x1p-23);
    }
    free(pixels);
    shb_context_destroy(context);
}

TEST(shade_fragments_of_a_perspective_camera) {
    /* The floor y = -1 from behind the camera to the horizon: the ray (x, y, -1) meets it at 1 / -y
     * times itself. The diagonal runs from (-100, 10) to (100, -190) in (x, z): z = -90 - x. */
    const float positions[12] = {-100, -1, 10, 100, -1, 10, 100, -1, -190, -100, -1, -190};
    const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
    const shb_mesh mesh = {
        .positions = positions, .vertex_count = 4, .indices = indices, .triangle_count = 2};
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene scene = {&instance, 1};
    const shb_view view = pinhole();
    uint32_t ids[64];
    double expected[64][3];
    for (int i = 0; i < 64; i++) {
        const double x = (2 * (i % 8) - 7) / 8.0, y = (7 - 2 * (i / 8)) / 8.0;
        expected[i][0] = x / -y;
        expected[i][1] = -1;
        expected[i][2] = 1 / y;
        ids[i] = i < 32 ? SHB_ID_NONE : expected[i][2] > -90 - expected[i][0] ? 0 : 1;
    }
    shb_context *context = shading_context(1);
    seen_pixel *pixels = shade_and_record(
        context,
        (shb_shade_desc){
            .frame = {.view = &view, .scene = &scene, .width = 8, .height = 8, .ids = ids}});
    for (int i = 0; i < 64; i++) {
        CHECK_INT(pixels[i].times, i >= 32);
        if (i < 32)
            continue;
        check_vec3(pixels[i].position, expected[i][0], expected[i][1], expected[i][2], 1e-6);
        check_vec3(pixels[i].normal, 0, 1, 0, 0);
        check_vec3(pixels[i].shading, 0, 1, 0, 0);
    }
    free(pixels);
    shb_context_destroy(context);
}

TEST(shade_normals_point_to_the_camera_for_every_winding_and_mirror) {
    quad q;
    quad_init(&q, 4, 1);
    for (int k = 0; k < 4; k++) { /* the wrong way round: they must be turned */
        q.normals[3 * k] = 0;
        q.normals[3 * k + 1] = -0.5f;
        q.normals[3 * k + 2] = 2;
    }
    q.mesh.normals = q.normals;
    shb_context *context = shading_context(1);
    for (int variant = 0; variant < 4; variant++) {
        const bool reversed_winding = variant & 1, mirrored = variant & 2;
        const uint16_t forward[6] = {0, 1, 2, 0, 2, 3}, backward[6] = {0, 2, 1, 0, 3, 2};
        memcpy(q.indices, reversed_winding ? backward : forward, sizeof q.indices);
        /* Mirrors x in the middle of the quad: the plane and the image stay as they are. */
        q.instance.world_from_mesh = shb_mat4_scaling(mirrored ? -1 : 1, 1, 1);
        q.instance.world_from_mesh.m[12] = mirrored ? 8 : 0;
        seen_pixel *pixels = shade_and_record(context, (shb_shade_desc){.frame = q.frame});
        const double length = sqrt(4.25);
        check_vec3(pixels[17].normal, 0, sqrt(0.5), -sqrt(0.5), 1e-7);
        check_vec3(pixels[17].shading, 0, 0.5 / length, -2 / length, 1e-7);
        free(pixels);
    }
    shb_context_destroy(context);
}

TEST(shade_normals_of_a_triangle_without_area_and_of_useless_mesh_normals) {
    const float positions[9] = {1, 1, 4, 1, 1, 4, 1, 1, 4};
    const shb_mesh point = {.positions = positions, .vertex_count = 3, .triangle_count = 1};
    quad q;
    quad_init(&q, 4, 0);
    const shb_instance instances[2] = {q.instance, {.mesh = &point}};
    const shb_scene scene = {instances, 2};
    q.frame.scene = &scene;
    q.ids[9] = 2;
    memset(q.normals, 0, sizeof q.normals);
    q.normals[3] = NAN; /* of the corner (8, 0), which only the first triangle has */
    q.mesh.normals = q.normals;
    shb_context *context = shading_context(1);
    shb_map *map = shading_map(context, &q.view, 8, 4, NULL);
    const shb_bias bias = shb_bias_none();
    const shb_shade_light light = {.map = map, .bias = &bias};
    seen_pixel *pixels = shade_and_record(
        context, (shb_shade_desc){.frame = q.frame, .lights = &light, .light_count = 1});
    for (int i = 0; i < 32; i++) {
        check_vec3(pixels[i].normal, 0, 0, -1, 0);
        check_vec3(pixels[i].shading, 0, 0, -1, 0);
        CHECK_NEAR(pixels[i].visibility[0], 1, 0);
    }
    check_vec3(pixels[9].position, 1, 1, 4, 0);
    free(pixels);
    shb_map_destroy(map);
    shb_context_destroy(context);
}
