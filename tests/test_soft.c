/* What tools show of soft shadows: lights, truth of frames, pictures. */
#include "scenes.h"
#include "soft.h"

#include "contexts.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 64, HEIGHT = 48 };

typedef struct setting {
    shb_context *context;
    example_scene *scene;
    measure_frame frame;
    shb_view light;
} setting;

/* Frames point into themselves: the setting must not move. */
static void open_setting(setting *s) {
    char error[256];
    s->context = test_context(0, SHB_ISA_BEST);
    CHECK(scene_open("box", &s->scene, error, sizeof error));
    CHECK_INT(measure_frame_create(s->context, s->scene, WIDTH, HEIGHT, &s->frame), SHB_OK);
    CHECK_INT(scene_light_view(s->scene, SCENE_SPOT, 64, true, &s->light), SHB_OK);
}

static void close_setting(setting *s) {
    measure_frame_destroy(&s->frame);
    scene_close(s->scene);
    shb_context_destroy(s->context);
}

/* A view along (0.6, 0, -0.8) whose picture is spanned by (0.8, 0, 0.6) and (0, 1, 0). */
TEST(soft_lights_are_parallel_to_the_picture) {
    const shb_vec3 eye = {1, 2, 3}, up = {0, 1, 0};
    const shb_vec3 target = {1 + 0.6, 2, 3 - 0.8};
    shb_view views[2];
    CHECK_INT(shb_view_perspective(eye, target, up, 1.1, 2, 0.5, 9, true, &views[0]), SHB_OK);
    CHECK_INT(shb_view_orthographic(eye, target, up, 3, 5, 0.5, 9, false, &views[1]), SHB_OK);
    for (int i = 0; i < 2; i++) {
        const shb_area_light area = soft_light(&views[i], 0.4, i);
        CHECK(area.disk == i && area.light.w == 1 - i);
        CHECK_NEAR(area.u.x, 0.16, 1e-12);
        CHECK_NEAR(area.u.y, 0, 1e-12);
        CHECK_NEAR(area.u.z, 0.12, 1e-12);
        CHECK_NEAR(area.v.x, 0, 1e-12);
        CHECK_NEAR(area.v.y, 0.2, 1e-12);
        CHECK_NEAR(area.v.z, 0, 1e-12);
    }
    CHECK_NEAR(soft_light(&views[0], 1, false).light.position.z, 3, 1e-9);
}

/* A light without extent: each fragment that faces it is lit or not by a single ray. */
TEST(soft_truth_of_a_point_is_that_of_single_rays) {
    setting s;
    open_setting(&s);
    const shb_area_light area = soft_light(&s.light, 0, false);
    soft_truth truth;
    shb_reference *reference;
    CHECK_INT(soft_truth_create(&s.frame, &s.light, &area, 3, &truth), SHB_OK);
    CHECK_INT(shb_reference_create(s.context, &s.scene->scene, &reference), SHB_OK);
    size_t lit = 0, wrong = 0, facing = 0;
    for (size_t i = 0; i < s.frame.fragment_count; i++) {
        const float *p = s.frame.positions + 3 * i, *n = s.frame.normals + 3 * i;
        const shb_vec3 point = {(double)p[0], (double)p[1], (double)p[2]};
        const shb_vec3 normal = {(double)n[0], (double)n[1], (double)n[2]};
        const uint32_t pixel = s.frame.pixels[i];
        const bool faces = shb_vec3_dot(normal, shb_vec3_subtract(area.light.position, point)) > 0;
        uint8_t occluded = 2;
        shb_reference_occluded(reference, &area.light, 1, &point, &s.frame.ids[pixel], &occluded);
        wrong += truth.visibility[pixel] != (faces && !occluded ? 1.0f : 0.0f);
        wrong += truth.mask[pixel] && !faces;
        lit += faces && !occluded;
        facing += faces;
    }
    CHECK_INT(wrong, 0);
    CHECK(lit > 0 && lit < facing && facing < s.frame.fragment_count);
    shb_reference_destroy(reference);
    soft_truth_destroy(&truth);
    close_setting(&s);
}

/* A light straight above the middle of the floor, whose view is 2 units wide there: of the
 * fragments that face it those count that lie within 0.9 of the middle. */
TEST(soft_errors_leave_out_what_the_map_does_not_hold) {
    setting s;
    open_setting(&s);
    const shb_vec3 eye = {0, 5, 0}, target = {0, 0, 0}, up = {0, 0, -1};
    shb_view view;
    CHECK_INT(shb_view_orthographic(eye, target, up, 1, 1, 0.5, 9, true, &view), SHB_OK);
    const shb_area_light area = soft_light(&view, 0.1, false);
    soft_truth truth;
    CHECK_INT(soft_truth_create(&s.frame, &view, &area, 1, &truth), SHB_OK);
    size_t wrong = 0, inside = 0, outside = 0;
    for (size_t i = 0; i < s.frame.fragment_count; i++) {
        const float *p = s.frame.positions + 3 * i, *n = s.frame.normals + 3 * i;
        const bool near = fabsf(p[0]) < 0.9f && fabsf(p[2]) < 0.9f;
        wrong += truth.mask[s.frame.pixels[i]] != (near && n[1] > 0);
        inside += near && n[1] > 0;
        outside += !near && n[1] > 0;
    }
    CHECK_INT(wrong, 0);
    CHECK(inside > 0 && outside > 0);
    soft_truth_destroy(&truth);
    close_setting(&s);
}

/* Everything lit: the mean error is the part of the light that truly is away. */
TEST(soft_errors_are_those_of_fragments_that_face_the_light) {
    setting s;
    open_setting(&s);
    const shb_area_light area = soft_light(&s.light, 0.5, true);
    soft_truth truth;
    shb_soft_errors errors;
    CHECK_INT(soft_truth_create(&s.frame, &s.light, &area, 32, &truth), SHB_OK);
    double dark = 0, facing = 0;
    for (size_t i = 0; i < s.frame.fragment_count; i++) {
        const uint32_t pixel = s.frame.pixels[i];
        s.frame.visibility[i] = truth.visibility[pixel];
        dark += truth.mask[pixel] ? 1 - (double)truth.visibility[pixel] : 0;
        facing += truth.mask[pixel];
    }
    CHECK_INT(soft_truth_compare(&s.frame, &truth, &errors), SHB_OK);
    CHECK(errors.rms == 0 && (double)errors.fragments == facing);
    for (size_t i = 0; i < s.frame.fragment_count; i++)
        s.frame.visibility[i] = 1;
    CHECK_INT(soft_truth_compare(&s.frame, &truth, &errors), SHB_OK);
    CHECK(dark > 0);
    CHECK_NEAR(errors.mean, dark / facing, 1e-9);
    soft_truth_destroy(&truth);
    close_setting(&s);
}

/* The picture of a map that lights everything, but for the rounding of cosines. */
TEST(soft_pictures_are_those_of_the_scene) {
    setting s;
    open_setting(&s);
    shb_map *map;
    const shb_map_desc desc = {.view = s.light, .width = 8};
    CHECK_INT(shb_map_create(s.context, &desc, &map), SHB_OK);
    static uint8_t pixels[2][WIDTH * HEIGHT * 3];
    static float lit[WIDTH * HEIGHT];
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        lit[i] = 1;
    const shb_image images[2] = {{pixels[0], WIDTH, HEIGHT, 0}, {pixels[1], WIDTH, HEIGHT, 0}};
    const float color[3] = {1, 0.8f, 0.6f};
    const shb_bias none = shb_bias_none();
    CHECK_INT(measure_paint(&s.frame, map, &none, NULL, color, &images[0]), SHB_OK);
    CHECK_INT(soft_paint(&s.frame, &shb_map_get_info(map)->light, color, lit, &images[1]), SHB_OK);
    int largest = 0;
    for (int i = 0; i < WIDTH * HEIGHT * 3; i++) {
        const int difference = abs(pixels[0][i] - pixels[1][i]);
        largest = difference > largest ? difference : largest;
    }
    CHECK(largest <= 1);
    shb_map_destroy(map);
    close_setting(&s);
}

TEST(soft_errors_are_red_where_light_is_missing_and_blue_where_it_is_false) {
    uint32_t ids[4] = {0, 0, 0, 0};
    float visibility[4] = {1, 0, 0.5f, 1}, seen[4] = {0, 1, 0.5f, 0};
    uint8_t mask[4] = {1, 1, 1, 0}, pixels[12];
    const measure_frame frame = {.ids = ids};
    const soft_truth truth = {visibility, seen, mask};
    soft_paint_errors(&frame, &truth, &(shb_image){pixels, 4, 1, 0});
    const uint8_t expected[12] = {255, 0, 0, 0, 0, 255, 65, 65, 65, 90, 90, 90};
    CHECK(memcmp(pixels, expected, sizeof expected) == 0);
}
