/* Methods that decide what the map keeps: on arrays by hand, and drawn. */
#include "../src/kernels/shade.h"

#include "contexts.h"
#include "probe.h"
#include "soup.h"
#include "test.h"

#include <math.h>
#include <string.h>

TEST(midpoint_keeps_the_mean_of_both_layers) {
    const shb_bias bias = shb_bias_midpoint();
    const float nearest[] = {0.25f, 0.5f, 1, -0.75f}, second[] = {0.75f, 0.5f, 1, -0.25f};
    const float expected[] = {0.5f, 0.5f, 1, -0.5f};
    float combined[4];
    bias.combine(&bias, 4, nearest, second, combined);
    CHECK(memcmp(combined, expected, sizeof expected) == 0);
    CHECK(!bias.offset && !bias.depth && bias.needs == 0);
}

/* Weiskopf and Ertl, eq. 2: half the gap, at most 0.125. */
TEST(dual_layer_keeps_the_bounded_mean) {
    const shb_bias bias = shb_bias_dual_layer(0.125f);
    const float second[] = {0.75f, 0.375f, 0.25f, 1, -0.25f};
    const float expected[] = {0.375f, 0.3125f, 0.25f, 1, -0.625f};
    float layers[] = {0.25f, 0.25f, 0.25f, 1, -0.75f};
    bias.combine(&bias, 5, layers, second, layers); /* in place */
    CHECK(memcmp(layers, expected, sizeof expected) == 0);
}

TEST(back_face_only_asks_for_other_faces) {
    const shb_bias bias = shb_bias_back_face();
    CHECK(!bias.offset && !bias.depth && !bias.combine);
    CHECK_INT(bias.needs, SHB_NEEDS_FLIPPED);
}

/* Two squares under the orthographic light, which sees depth (4 - z) / 8: the upper one over the
 * left half at z = 2, depth 0.25, the lower one over everything at z = -2, depth 0.75. */
static const float corners[] = {-1, -1, 2,  0, -1, 2,  0, 1, 2,  -1, 1, 2,
                                -1, -1, -2, 1, -1, -2, 1, 1, -2, -1, 1, -2};
static const uint16_t squares[] = {0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7};
static const shb_mesh layers_mesh = {.positions = corners,
                                     .vertex_count = 8,
                                     .indices = squares,
                                     .index_size = 2,
                                     .triangle_count = 4};

/* The depths of the left and right half of a 4 x 4 map, in the view's own sense. */
static void draw_layers(const shb_bias *bias, shb_format format, bool reversed, double *left,
                        double *right) {
    const shb_instance instance = {.mesh = &layers_mesh};
    const shb_scene scene = {&instance, 1};
    shb_context *context;
    shb_map *map;
    context = test_context(1, SHB_ISA_BEST);
    const shb_map_desc desc = {.view = probe_orthographic(reversed), .width = 4, .format = format};
    CHECK_INT(shb_map_create(context, &desc, &map), SHB_OK);
    CHECK_INT(shb_map_draw(map, &scene, bias, NULL), SHB_OK);
    const int32_t columns[2] = {1, 2}, rows[2] = {1, 2};
    float depths[2];
    shb_map_fetch(map, 2, columns, rows, depths);
    *left = fabs((double)depths[0]);
    *right = fabs((double)depths[1]);
    shb_map_destroy(map);
    shb_context_destroy(context);
}

/* On the right there is no second layer, so the far depth takes its place. */
TEST(drawn_maps_keep_what_the_method_decides) {
    const shb_bias none = shb_bias_none(), midpoint = shb_bias_midpoint();
    const shb_bias dual = shb_bias_dual_layer(0.0625f);
    for (int reversed = 0; reversed < 2; reversed++) {
        double left, right;
        draw_layers(&none, SHB_FORMAT_FLOAT32, reversed, &left, &right);
        CHECK_NEAR(left, reversed ? 0.75 : 0.25, 0);
        CHECK_NEAR(right, reversed ? 0.25 : 0.75, 0);
        draw_layers(&midpoint, SHB_FORMAT_FLOAT32, reversed, &left, &right);
        CHECK_NEAR(left, 0.5, 0);
        CHECK_NEAR(right, reversed ? 0.125 : 0.875, 0);
        draw_layers(&dual, SHB_FORMAT_FLOAT32, reversed, &left, &right);
        CHECK_NEAR(left, reversed ? 0.6875 : 0.3125, 0);
        CHECK_NEAR(right, reversed ? 0.1875 : 0.8125, 0);
    }
}

/* 0.3125 * 65535 = 20479.7 and 0.8125 * 65535 = 53247.2: away from the light, up. Reversed: 0.6875
 * and 0.1875, 45055.3 and 12287.8, down. Likewise 5242879.7, 13631486.4; 11534335.3, 3145727.8. */
TEST(combined_depths_are_rounded_away_from_the_light) {
    const shb_bias dual = shb_bias_dual_layer(0.0625f);
    double left, right;
    draw_layers(&dual, SHB_FORMAT_UNORM16, false, &left, &right);
    CHECK_NEAR(left * 65535, 20480, 0.01);
    CHECK_NEAR(right * 65535, 53248, 0.01);
    draw_layers(&dual, SHB_FORMAT_UNORM16, true, &left, &right);
    CHECK_NEAR(left * 65535, 45055, 0.01);
    CHECK_NEAR(right * 65535, 12287, 0.01);
    draw_layers(&dual, SHB_FORMAT_UNORM24, false, &left, &right);
    CHECK_NEAR(left, 5242880 / 16777215.0, 2e-8);
    CHECK_NEAR(right, 13631488 / 16777215.0, 4e-8);
    draw_layers(&dual, SHB_FORMAT_UNORM24, true, &left, &right);
    CHECK_NEAR(left, 11534335 / 16777215.0, 4e-8);
    CHECK_NEAR(right, 3145727 / 16777215.0, 2e-8);
}

static void keep_nonsense(const shb_bias *bias, size_t count, const float *nearest,
                          const float *second, float *combined) {
    const float *values = bias->user;
    (void)second;
    for (size_t i = 0; i < count; i++)
        combined[i] = fabsf(nearest[i]) < 0.5f ? values[0] : values[1];
}

TEST(combined_depths_of_any_value_end_in_the_format) {
    const float values[] = {NAN, 7, -INFINITY, -2};
    const shb_format formats[] = {SHB_FORMAT_UNORM24, SHB_FORMAT_UNORM16};
    for (int i = 0; i < 2; i++) {
        shb_bias bias = {.name = "nonsense", .combine = keep_nonsense, .user = values};
        double left, right;
        draw_layers(&bias, formats[i], false, &left, &right);
        CHECK(left == 1 && right == 1);
        bias.user = values + 2;
        draw_layers(&bias, formats[i], false, &left, &right);
        CHECK(left == 0 && right == 0);
    }
    const shb_bias bias = {.combine = keep_nonsense, .user = values};
    double left, right;
    draw_layers(&bias, SHB_FORMAT_FLOAT32, true, &left, &right); /* left -0.75, right -0.25 */
    CHECK(left == 7 && right == 0);
}

enum { WIDTH = 75, HEIGHT = 41 };

/* What a map has to hold: two layers drawn as images, combined and stored. */
static void combine_images(shb_context *context, const shb_map_desc *desc, const shb_scene *scene,
                           const shb_bias *bias, char *texels) {
    float nearest[WIDTH * HEIGHT], second[WIDTH * HEIGHT];
    const shb_draw_desc images = {.view = &desc->view,
                                  .scene = scene,
                                  .width = WIDTH,
                                  .height = HEIGHT,
                                  .depth = {.texels = nearest},
                                  .second = {.texels = second}};
    CHECK_INT(shb_draw(context, &images, NULL), SHB_OK);
    for (int i = 0; desc->view.reversed && i < WIDTH * HEIGHT; i++) {
        nearest[i] = -nearest[i];
        second[i] = -second[i];
    }
    bias->combine(bias, WIDTH * HEIGHT, nearest, second, nearest);
    shb_shade_kernels_scalar.store(desc->format, desc->view.reversed, WIDTH * HEIGHT, nearest,
                                   texels);
}

static void check_combined(shb_context *context, const shb_map_desc *desc, const shb_scene *scene,
                           const shb_bias *bias) {
    char expected[WIDTH * HEIGHT * sizeof(float)];
    combine_images(context, desc, scene, bias, expected);
    shb_map *map = NULL;
    CHECK_INT(shb_map_create(context, desc, &map), SHB_OK);
    CHECK_INT(shb_map_draw(map, scene, bias, NULL), SHB_OK);
    const shb_depth_image depth = shb_map_get_depth(map);
    const size_t row = WIDTH * shb_format_size(desc->format);
    for (size_t y = 0; y < HEIGHT; y++)
        CHECK(memcmp((const char *)depth.texels + y * depth.stride, expected + y * row, row) == 0);
    shb_map_destroy(map);
}

TEST(maps_hold_both_layers_of_a_scene_combined) {
    const shb_bias methods[] = {shb_bias_midpoint(), shb_bias_dual_layer(0.01f)};
    test_random random = {41};
    soup s = {0};
    for (int i = 0; i < 8; i++)
        soup_add_patch(&s, &random);
    const shb_scene *scene = soup_scene(&s);
    for (int how = 0; how < 4; how++) {
        shb_context *context =
            test_context(how & 1 ? 3 : 1, how & 2 ? SHB_ISA_SCALAR : SHB_ISA_BEST);
        for (int i = 0; i < 12; i++) {
            const shb_map_desc desc = {.view = probe_orthographic(i & 1),
                                       .width = WIDTH,
                                       .height = HEIGHT,
                                       .format = (shb_format)(i / 4)};
            check_combined(context, &desc, scene, &methods[i / 2 % 2]);
        }
        shb_context_destroy(context);
    }
    soup_free(&s);
}

/* A solid cube from z = -1 to 1: its front face is at depth 0.375, its back at 0.625. */
static const float cube[] = {-.5f, -.5f, -1, .5f, -.5f, -1, .5f, .5f, -1, -.5f, .5f, -1,
                             -.5f, -.5f, 1,  .5f, -.5f, 1,  .5f, .5f, 1,  -.5f, .5f, 1};
static const uint16_t cube_faces[] = {4, 5, 6, 4, 6, 7, 0, 2, 1, 0, 3, 2, 0, 1, 5, 0, 5, 4,
                                      1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7};

TEST(back_face_maps_hold_back_faces) {
    const shb_mesh mesh = {.positions = cube,
                           .vertex_count = 8,
                           .indices = cube_faces,
                           .index_size = 2,
                           .triangle_count = 12};
    const shb_bias bias = shb_bias_back_face();
    const int32_t column = 2, row = 2;
    shb_context *context = test_context(1, SHB_ISA_BEST);
    const struct {
        shb_cull cull;
        const shb_bias *bias;
        float expected;
    } cases[] = {{SHB_CULL_BACK, NULL, 0.375f},
                 {SHB_CULL_BACK, &bias, 0.625f},
                 {SHB_CULL_FRONT, &bias, 0.375f},
                 {SHB_CULL_NONE, &bias, 0.375f}};
    for (int i = 0; i < 4; i++) {
        const shb_instance instance = {.mesh = &mesh, .cull = cases[i].cull};
        const shb_scene scene = {&instance, 1};
        const shb_map_desc desc = {.view = probe_orthographic(false), .width = 4};
        shb_map *map;
        float depth;
        CHECK_INT(shb_map_create(context, &desc, &map), SHB_OK);
        CHECK_INT(shb_map_draw(map, &scene, cases[i].bias, NULL), SHB_OK);
        shb_map_fetch(map, 1, &column, &row, &depth);
        CHECK(depth == cases[i].expected);
        shb_map_destroy(map);
    }
    shb_context_destroy(context);
}
