/* Lighting, callbacks and images of shading, by hand. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "contexts.h"
#include "shading.h"
#include "test.h"

TEST(shade_triangles_that_face_away_from_the_light_are_dark) {
    /* The quad z = 4 is seen from -z. Directional lights from the front, the back and along it; a
     * point light before and one behind. Nothing casts a shadow. */
    quad q;
    quad_init(&q, 4, 0);
    shb_context *context = shading_context(1);
    const shb_box bounds = {{0, 0, 4}, {8, 4, 4}};
    const shb_vec3 directions[3] = {{0, 0.6, -0.8}, {0, 0.6, 0.8}, {1, 0, 0}};
    const shb_vec3 points[2] = {{4, 2, -4}, {4, 2, 12}};
    const shb_bias bias = shb_bias_none();
    for (int i = 0; i < 5; i++) {
        shb_view view;
        CHECK_INT(i < 3 ? shb_view_fit_directional(directions[i], bounds, 64, false, &view)
                        : shb_view_fit_spot(points[i - 3], bounds, 64, false, &view),
                  SHB_OK);
        shb_map *map = shading_map(context, &view, 64, 64, NULL);
        const shb_shade_light light = {.map = map, .bias = &bias};
        seen_pixel *pixels = shade_and_record(
            context, (shb_shade_desc){.frame = q.frame, .lights = &light, .light_count = 1});
        const bool faces = i == 0 || i == 3;
        /* Pixel (5, 2): from the point light 8 units away and 1.5 by 0.5 aside. */
        const double cosine = i == 0 ? 0.8 : 8 / sqrt(64 + 2.25 + 0.25);
        CHECK_NEAR(pixels[21].visibility[0], faces, 0);
        CHECK_NEAR(pixels[21].cosine[0], faces ? cosine : 0, 1e-6);
        free(pixels);
        shb_map_destroy(map);
    }
    shb_context_destroy(context);
}

TEST(shade_cosine_is_that_of_the_shading_normal_and_never_negative) {
    /* The triangles have the normal (0, 0, -1); both lights, from (0, 0, -1) and (0.8, 0, -0.6),
     * see them. The mesh's normal (0.8, 0, 0.6), turned to the camera's side, is (-0.8, 0, -0.6):
     * cosines 0.6 and 0.36 - 0.64 < 0. (-0.6, 0.8, 0) stays: 0 and -0.48. */
    quad q;
    quad_init(&q, 4, 0);
    const float normals[2][3] = {{0.8f, 0, 0.6f}, {-0.6f, 0.8f, 0}};
    const double expected[2] = {0.6, 0};
    shb_context *context = shading_context(1);
    shb_view oblique;
    const shb_box bounds = {{0, 0, 4}, {8, 4, 4}};
    CHECK_INT(shb_view_fit_directional((shb_vec3){0.8, 0, -0.6}, bounds, 64, false, &oblique), 0);
    shb_map *maps[2] = {shading_map(context, &q.view, 8, 4, NULL),
                        shading_map(context, &oblique, 64, 64, NULL)};
    const shb_bias bias = shb_bias_none();
    const shb_shade_light lights[2] = {{.map = maps[0], .bias = &bias},
                                       {.map = maps[1], .bias = &bias}};
    q.mesh.normals = q.normals;
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 12; k++)
            q.normals[k] = normals[i][k % 3];
        seen_pixel *pixels = shade_and_record(
            context, (shb_shade_desc){.frame = q.frame, .lights = lights, .light_count = 2});
        CHECK_NEAR(pixels[3].visibility[0], 1, 0);
        CHECK_NEAR(pixels[3].visibility[1], 1, 0);
        CHECK_NEAR(pixels[3].cosine[0], expected[i], 1e-7);
        CHECK_NEAR(pixels[3].cosine[1], 0, 0);
        free(pixels);
    }
    shb_map_destroy(maps[0]);
    shb_map_destroy(maps[1]);
    shb_context_destroy(context);
}

/* Two lights from the camera's place whose maps have one texel a pixel: an occluder at depth 0.125
 * before columns 0 .. 3 of the first and before rows 0 .. 1 of the second. The quad lies at 0.25.
 */
typedef struct two_lights {
    quad q;
    shb_context *context;
    float depths[2][32];
    shb_map *maps[2];
    shb_bias bias;
    shb_shade_light lights[2];
    uint8_t pixels[4 * 32];
    shb_shade_desc desc;
} two_lights;

static void two_lights_init(two_lights *t) {
    quad_init(&t->q, 4, 0);
    t->context = shading_context(1);
    t->bias = shb_bias_none();
    for (int i = 0; i < 32; i++) {
        t->depths[0][i] = i % 8 < 4 ? 0.125f : 1;
        t->depths[1][i] = i / 8 < 2 ? 0.125f : 1;
    }
    for (int k = 0; k < 2; k++) {
        t->maps[k] = shading_map(t->context, &t->q.view, 8, 4, t->depths[k]);
        t->lights[k] = (shb_shade_light){.map = t->maps[k], .bias = &t->bias};
    }
    t->lights[0].color[0] = 0.32f;
    t->lights[1].color[1] = 0.6f;
    memset(t->pixels, 77, sizeof t->pixels);
    t->desc = (shb_shade_desc){.frame = t->q.frame,
                               .lights = t->lights,
                               .light_count = 2,
                               .shade = shb_shade_lambert,
                               .image = {t->pixels, 8, 4, 0}};
}

static void two_lights_destroy(two_lights *t) {
    shb_map_destroy(t->maps[0]);
    shb_map_destroy(t->maps[1]);
    shb_context_destroy(t->context);
}

static void check_pixel(const uint8_t *pixel, int red, int green, int blue) {
    CHECK_INT(pixel[0], red);
    CHECK_INT(pixel[1], green);
    CHECK_INT(pixel[2], blue);
}

TEST(shade_every_light_has_its_own_shadow) {
    two_lights t;
    two_lights_init(&t);
    seen_pixel *pixels = shade_and_record(t.context, t.desc);
    for (int i = 0; i < 32; i++) {
        CHECK_NEAR(pixels[i].visibility[0], i % 8 >= 4, 0);
        CHECK_NEAR(pixels[i].visibility[1], i / 8 >= 2, 0);
        CHECK_NEAR(pixels[i].cosine[0], 1, 0);
    }
    free(pixels);
    two_lights_destroy(&t);
}

TEST(shade_lambert_writes_the_square_root_of_the_light) {
    /* Normals (0, 0, -1): ambient light 0.08 / 2 = 0.04, whose root is 0.2 = 51 / 255. With the
     * first light 0.36: 0.6 = 153 / 255; with the second 0.64: 0.8 = 204 / 255. */
    two_lights t;
    two_lights_init(&t);
    CHECK_INT(shb_shade(t.context, &t.desc), SHB_OK);
    for (int i = 0; i < 32; i++)
        check_pixel(t.pixels + 3 * i, i % 8 >= 4 ? 153 : 51, i / 8 >= 2 ? 204 : 51, 51);
    CHECK_INT(t.pixels[96], 77);

    /* A surface of 1 / 16, 1 and 4 times white: a quarter of 153 is 38.25, twice 51 is 102. */
    const float surface[3] = {0.0625f, 1, 4};
    t.desc.user = surface;
    CHECK_INT(shb_shade(t.context, &t.desc), SHB_OK);
    check_pixel(t.pixels + 3 * 28, 38, 204, 102);
    two_lights_destroy(&t);
}

/* As a host does that has fragments of its own. */
static void lambert_without_kernels(const shb_shade_args *args) {
    shb_shade_args own = *args;
    own.kernels = NULL;
    shb_shade_lambert(&own);
}

TEST(shade_lambert_called_by_a_host_writes_the_same) {
    quad q;
    quad_init(&q, 4, 0.5f);
    const float tint[3] = {0.9f, 0.5f, 0.1f};
    uint8_t pixels[2][3 * 32];
    shb_context *context = shading_context(1);
    for (int i = 0; i < 2; i++) {
        const shb_shade_desc desc = {.frame = q.frame,
                                     .shade = i ? lambert_without_kernels : shb_shade_lambert,
                                     .user = tint,
                                     .image = {pixels[i], 8, 4, 0}};
        CHECK_INT(shb_shade(context, &desc), SHB_OK);
    }
    CHECK(pixels[0][0] > 0 && memcmp(pixels[0], pixels[1], sizeof pixels[0]) == 0);
    shb_context_destroy(context);
}

/* Shading normals (0, 0.6, -0.8) at all corners. */
static void tilt_normals(two_lights *t) {
    for (int k = 0; k < 12; k++)
        t->q.normals[k] = k % 3 == 1 ? 0.6f : k % 3 == 2 ? -0.8f : 0;
    t->q.mesh.normals = t->q.normals;
}

TEST(shade_lambert_ambient_light_comes_from_above) {
    /* 0.04 * 1.6 = 0.064; its root 0.25298 is 64.51 / 255. */
    two_lights t;
    two_lights_init(&t);
    tilt_normals(&t);
    t.desc.light_count = 0;
    CHECK_INT(shb_shade(t.context, &t.desc), SHB_OK);
    check_pixel(t.pixels, 65, 65, 65);
    two_lights_destroy(&t);
}

/* The same normals have a cosine of 0.8 with both lights: the roots of 0.064 + 0.32 * 0.8, 0.064 +
 * 0.6 * 0.8 and 0.064 + 0.25 * 0.8 are 144.25, 188.08 and 131.02 of 255. */
TEST(shade_lambert_takes_the_cosine_for_every_colour) {
    two_lights t;
    two_lights_init(&t);
    tilt_normals(&t);
    t.lights[0].color[2] = 0.25f;
    CHECK_INT(shb_shade(t.context, &t.desc), SHB_OK);
    check_pixel(t.pixels + 3 * 28, 144, 188, 131);
    two_lights_destroy(&t);
}

static void write_odd_colors(const shb_shade_args *args) {
    const float *colors = args->user;
    for (size_t i = 0; i < args->count; i++) {
        args->red[i] = colors[0];
        args->green[i] = colors[1];
        args->blue[i] = colors[2];
    }
}

TEST(shade_colours_are_clamped_and_not_a_number_is_black) {
    two_lights t;
    two_lights_init(&t);
    const float colors[2][3] = {{NAN, 2, -1}, {INFINITY, -INFINITY, 0.25f}};
    t.desc.shade = write_odd_colors;
    t.desc.user = colors[0];
    CHECK_INT(shb_shade(t.context, &t.desc), SHB_OK);
    check_pixel(t.pixels, 0, 255, 0);
    t.desc.user = colors[1];
    CHECK_INT(shb_shade(t.context, &t.desc), SHB_OK);
    check_pixel(t.pixels, 255, 0, 128); /* 127.5 rounds up */
    two_lights_destroy(&t);
}

static void write_nothing(const shb_shade_args *args) {
    (void)args;
}

TEST(shade_callback_that_writes_nothing_leaves_black) {
    two_lights t;
    two_lights_init(&t);
    t.desc.shade = write_nothing;
    CHECK_INT(shb_shade(t.context, &t.desc), SHB_OK);
    for (int i = 0; i < 32; i++)
        check_pixel(t.pixels + 3 * i, 0, 0, 0);
    two_lights_destroy(&t);
}

TEST(shade_ids_that_do_not_exist_are_background) {
    two_lights t;
    two_lights_init(&t);
    t.q.ids[0] = SHB_ID_NONE;
    t.q.ids[5] = 2;
    t.q.ids[31] = 0xfffffffeu;
    const float background[3] = {0.36f, 0, 5};
    memcpy(t.desc.background, background, sizeof background);
    CHECK_INT(shb_shade(t.context, &t.desc), SHB_OK);
    check_pixel(t.pixels, 153, 0, 255);
    check_pixel(t.pixels + 15, 153, 0, 255);
    check_pixel(t.pixels + 93, 153, 0, 255);
    check_pixel(t.pixels + 3, 51, 51, 51);
    /* An index out of range takes its triangle away, here the second one. */
    t.q.indices[5] = 4;
    CHECK_INT(shb_shade(t.context, &t.desc), SHB_OK);
    check_pixel(t.pixels + 3, 51, 51, 51);
    check_pixel(t.pixels + 24, 153, 0, 255);
    t.q.indices[5] = 3;
    /* A corner that is not finite takes its triangle away, here the first one. */
    t.q.positions[3] = NAN;
    CHECK_INT(shb_shade(t.context, &t.desc), SHB_OK);
    check_pixel(t.pixels + 21, 153, 0, 255);
    check_pixel(t.pixels + 24, 51, 51, 51);
    two_lights_destroy(&t);
}

TEST(shade_strides_of_ids_and_image_are_kept) {
    two_lights t;
    two_lights_init(&t);
    uint32_t ids[4 * 11];
    for (int i = 0; i < 44; i++)
        ids[i] = i % 11 < 8 ? t.q.ids[i / 11 * 8 + i % 11] : 12345;
    t.desc.frame.ids = ids;
    t.desc.frame.id_stride = sizeof *ids * 11;
    t.desc.image.stride = 29;
    CHECK_INT(shb_shade(t.context, &t.desc), SHB_OK);
    for (int row = 0; row < 4; row++) {
        for (int column = 0; column < 8; column++)
            check_pixel(t.pixels + 29 * row + 3 * column, column >= 4 ? 153 : 51,
                        row >= 2 ? 204 : 51, 51);
        for (int i = 24; i < 29; i++)
            CHECK_INT(t.pixels[29 * row + i], 77);
    }
    two_lights_destroy(&t);
}

TEST(shade_without_an_image_still_calls_back) {
    two_lights t;
    two_lights_init(&t);
    t.desc.image = (shb_image){0};
    seen_pixel *pixels = shade_and_record(t.context, t.desc);
    for (int i = 0; i < 32; i++)
        CHECK_INT(pixels[i].times, 1);
    free(pixels);
    two_lights_destroy(&t);
}

TEST(shade_takes_the_longest_rows_and_columns) {
    static uint32_t ids[SHB_SIZE_MAX];
    two_lights t;
    two_lights_init(&t);
    memset(ids, 0xff, sizeof ids);
    t.desc.image = (shb_image){0};
    t.desc.frame.ids = ids;
    t.desc.frame.id_stride = 0;
    t.desc.frame.width = 1;
    t.desc.frame.height = SHB_SIZE_MAX;
    CHECK_INT(shb_shade(t.context, &t.desc), SHB_OK);
    t.desc.frame.width = SHB_SIZE_MAX;
    t.desc.frame.height = 1;
    CHECK_INT(shb_shade(t.context, &t.desc), SHB_OK);
    two_lights_destroy(&t);
}

TEST(shade_error_view_tells_the_errors_apart) {
    /* The first light says: shadowed in columns 0 .. 3. */
    two_lights t;
    two_lights_init(&t);
    uint8_t truth[4 * 9] = {0};
    truth[0] = SHB_TRUTH_LIT;                           /* false shadow */
    truth[1] = SHB_TRUTH_LIT | SHB_TRUTH_BOUNDARY;      /* the same by sampling */
    truth[2] = SHB_TRUTH_SHADOWED;                      /* right */
    truth[4] = SHB_TRUTH_SHADOWED;                      /* false light */
    truth[5] = SHB_TRUTH_SHADOWED | SHB_TRUTH_BOUNDARY; /* the same by sampling */
    truth[6] = SHB_TRUTH_LIT | SHB_TRUTH_BOUNDARY;      /* right */
    truth[9] = SHB_TRUTH_LIT;                           /* false shadow in the second row */
    const shb_shade_error_params params = {truth, 9};
    t.desc.shade = shb_shade_error;
    t.desc.user = &params;
    CHECK_INT(shb_shade(t.context, &t.desc), SHB_OK);
    const uint8_t *p = t.pixels;
    CHECK(p[0] == 255 && p[1] < 64 && p[2] < 64);
    CHECK(p[3] > 180 && p[4] == p[5] && p[4] > 128 && p[4] < p[3]);
    CHECK(p[14] == 255 && p[12] < 64 && p[13] < 128);
    CHECK(p[17] > 180 && p[15] > 128 && p[15] < p[17] && p[16] < p[17]);
    CHECK(memcmp(p + 24, p, 3) == 0);
    /* A quarter of the light: roots of 0.01 and 0.26 times 255 are 25.5 and 130.02. */
    for (int i = 2; i < 8; i += i == 3 ? 3 : 1)
        check_pixel(p + 3 * i, i < 4 ? 26 : 130, i < 4 ? 26 : 130, i < 4 ? 26 : 130);
    two_lights_destroy(&t);
}

/* 0.5 is not below 0.5. */
TEST(shade_error_view_takes_half_a_light_for_lit) {
    static shb_fragments fragments;
    static shb_lighting lighting;
    static const uint8_t truth[] = {SHB_TRUTH_LIT, SHB_TRUTH_SHADOWED};
    const shb_shade_error_params params = {truth, 2};
    SHB_ALIGN float red[SHB_BATCH], green[SHB_BATCH], blue[SHB_BATCH];
    fragments.pixel_x[1] = 1;
    lighting.visibility[0] = lighting.visibility[1] = 0.5f;
    shb_shade_error(&(shb_shade_args){.count = 2,
                                      .fragments = &fragments,
                                      .light_count = 1,
                                      .lighting = &lighting,
                                      .user = &params,
                                      .red = red,
                                      .green = green,
                                      .blue = blue});
    CHECK(red[0] == green[0] && green[0] == blue[0]);
    CHECK(blue[1] == 1 && red[1] < 0.1f);
}

/* The call fails with one logged sentence and leaves the image as it was. */
static void check_refused(const two_lights *t, shb_context *context, test_log *log,
                          const shb_shade_desc *desc, shb_result expected, int line) {
    const int calls = log->calls;
    const shb_result result = shb_shade(context, desc);
    unsigned touched = 0;
    for (size_t i = 0; i < sizeof t->pixels; i++)
        touched += t->pixels[i] != 77;
    test_check(result == expected && touched == 0 &&
                   strncmp(log->sentence, "shb_shade: ", 11) == 0 && log->calls == calls + 1,
               __FILE__, line, "result %d, expected %d; %u bytes touched", result, expected,
               touched);
}

TEST(shade_refuses_bad_descriptions_and_leaves_the_image) {
    two_lights t;
    two_lights_init(&t);
    test_log log = {0};
    const shb_context_desc context_desc = {.threads = 1, .log = test_log_keep, .log_user = &log};
    shb_context *context = NULL;
    CHECK_INT(shb_context_create(&context_desc, &context), SHB_OK);
    for (int k = 0; k < 2; k++) { /* these log to this context, too */
        shb_map_destroy(t.maps[k]);
        t.maps[k] = shading_map(context, &t.q.view, 8, 4, t.depths[k]);
        t.lights[k].map = t.maps[k];
    }
    const shb_shade_desc good = t.desc;
    shb_shade_desc desc;
#define REFUSES(change, expected)                                                                  \
    do {                                                                                           \
        desc = good;                                                                               \
        change;                                                                                    \
        check_refused(&t, context, &log, &desc, expected, __LINE__);                               \
    } while (0)
    REFUSES(desc.shade = NULL, SHB_ERROR_ARGUMENT);
    REFUSES(desc.frame.view = NULL, SHB_ERROR_ARGUMENT);
    REFUSES(desc.frame.scene = NULL, SHB_ERROR_ARGUMENT);
    REFUSES(desc.frame.ids = NULL, SHB_ERROR_ARGUMENT);
    REFUSES(desc.frame.width = 0, SHB_ERROR_SIZE);
    REFUSES(desc.frame.height = 0, SHB_ERROR_SIZE);
    REFUSES(desc.frame.width = SHB_SIZE_MAX + 1, SHB_ERROR_SIZE);
    REFUSES(desc.frame.height = SHB_SIZE_MAX + 1, SHB_ERROR_SIZE);
    REFUSES(desc.frame.id_stride = 34, SHB_ERROR_ARGUMENT);
    REFUSES(desc.frame.id_stride = 28, SHB_ERROR_ARGUMENT);
    REFUSES(desc.frame.id_stride = SIZE_MAX - 3, SHB_ERROR_SIZE);
    REFUSES(desc.frame.ids = (const uint32_t *)(const void *)((const char *)desc.frame.ids + 1),
            SHB_ERROR_ARGUMENT);
    REFUSES(desc.light_count = SHB_LIGHTS_MAX + 1, SHB_ERROR_ARGUMENT);
    REFUSES(desc.lights = NULL, SHB_ERROR_ARGUMENT);
    REFUSES(desc.background[1] = NAN, SHB_ERROR_NUMBER);
    REFUSES(desc.background[2] = -INFINITY, SHB_ERROR_NUMBER);
    REFUSES(desc.image.width = 7, SHB_ERROR_SIZE);
    REFUSES(desc.image.height = 5, SHB_ERROR_SIZE);
    REFUSES(desc.image.stride = 23, SHB_ERROR_ARGUMENT);
    REFUSES(desc.image.stride = SIZE_MAX / 2, SHB_ERROR_SIZE);
    check_refused(&t, context, &log, NULL, SHB_ERROR_ARGUMENT, __LINE__);
    CHECK_INT(shb_shade(NULL, &good), SHB_ERROR_ARGUMENT);

    shb_view singular = t.q.view;
    singular.clip_from_world.m[0] = 0;
    REFUSES(desc.frame.view = &singular, SHB_ERROR_NUMBER);
    singular.clip_from_world.m[0] = (double)NAN;
    REFUSES(desc.frame.view = &singular, SHB_ERROR_NUMBER);
    t.q.mesh.index_size = 3;
    REFUSES((void)desc, SHB_ERROR_ARGUMENT);
    t.q.mesh.index_size = 2;

    shb_shade_light lights[2];
    const shb_filter no_filter = {.name = "none"};
    const shb_bias needs_flipped = shb_bias_back_face();
#define REFUSES_LIGHT(change, expected)                                                            \
    do {                                                                                           \
        memcpy(lights, t.lights, sizeof lights);                                                   \
        change;                                                                                    \
        REFUSES(desc.lights = lights, expected);                                                   \
        CHECK(strstr(log.sentence, "desc.lights[1]"));                                             \
    } while (0)
    REFUSES_LIGHT(lights[1].map = NULL, SHB_ERROR_ARGUMENT);
    REFUSES_LIGHT(lights[1].bias = NULL, SHB_ERROR_ARGUMENT);
    REFUSES_LIGHT(lights[1].filter = &no_filter, SHB_ERROR_ARGUMENT);
    REFUSES_LIGHT(lights[1].color[2] = NAN, SHB_ERROR_NUMBER);
    REFUSES_LIGHT(lights[1].bias = &needs_flipped, SHB_ERROR_UNSUPPORTED);
#undef REFUSES_LIGHT
#undef REFUSES
    CHECK_INT(shb_shade(context, &good), SHB_OK);
    CHECK_INT(t.pixels[95], 51);
    for (int k = 0; k < 2; k++)
        shb_map_destroy(t.maps[k]);
    shb_context_destroy(context);
    shb_context_destroy(t.context);
}
