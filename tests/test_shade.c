/* Fragments, lighting, callbacks and images of shading, by hand. */
#include "shadowbias/shadowbias.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "random.h"
#include "test.h"

/* World x and y are pixel columns and rows; depth is z / 16, away from camera or light. */
static shb_view pixel_space(uint32_t width, uint32_t height) {
    shb_view view = {{{0}}, false};
    double *m = view.clip_from_world.m;
    m[0] = 2.0 / width;
    m[12] = -1;
    m[5] = -2.0 / height;
    m[13] = 1;
    m[10] = 1.0 / 16;
    m[15] = 1;
    return view;
}

/* Looks along -z from the origin with an opening of 90 degrees both ways. */
static shb_view pinhole(void) {
    shb_view view = {{{0}}, false};
    view.clip_from_world.m[0] = view.clip_from_world.m[5] = 1;
    view.clip_from_world.m[10] = view.clip_from_world.m[11] = -1;
    view.clip_from_world.m[14] = -0.125;
    return view;
}

static shb_context *new_context(uint32_t threads) {
    const shb_context_desc desc = {.threads = threads};
    shb_context *context = NULL;
    CHECK_INT(shb_context_create(&desc, &context), SHB_OK);
    return context;
}

/* A map around a host's depths, or an empty one. */
static shb_map *new_map(shb_context *context, const shb_view *view, uint32_t width, uint32_t height,
                        const float *depths) {
    const shb_map_desc desc = {.view = *view, .width = width, .height = height};
    shb_map *map = NULL;
    if (depths)
        CHECK_INT(shb_map_wrap(context, &desc, depths, 0, NULL, &map), SHB_OK);
    else
        CHECK_INT(shb_map_create(context, &desc, &map), SHB_OK);
    return map;
}

/* What a callback saw of one pixel. */
typedef struct seen_pixel {
    unsigned times;
    float position[3], normal[3], shading[3], weight_1, weight_2;
    uint32_t id;
    float visibility[2], cosine[2];
} seen_pixel;

typedef struct recorder {
    uint32_t width;
    seen_pixel *pixels;
    unsigned *bad_batches; /* elements of one a pixel: the batch that started there broke a rule */
} recorder;

static bool padding_repeats_the_last(const shb_shade_args *args) {
    const shb_fragments *f = args->fragments;
    const size_t last = args->count - 1;
    for (size_t i = args->count; i % 16; i++)
        if (f->x[i] != f->x[last] || f->normal_z[i] != f->normal_z[last] ||
            f->shading_y[i] != f->shading_y[last] || f->id[i] != f->id[last] ||
            f->pixel_x[i] != f->pixel_x[last] || f->pixel_y[i] != f->pixel_y[last])
            return false;
    return true;
}

static void record(const shb_shade_args *args) {
    const recorder *to = args->user;
    const shb_fragments *f = args->fragments;
    const size_t row = (size_t)f->pixel_y[0] * to->width;
    bool good = args->count >= 1 && args->count <= SHB_BATCH && padding_repeats_the_last(args);
    for (size_t i = 0; i < args->count; i++) {
        good = good && f->pixel_y[i] == f->pixel_y[0];
        good = good && (i == 0 || f->pixel_x[i] > f->pixel_x[i - 1]);
        seen_pixel *pixel = &to->pixels[row + (size_t)f->pixel_x[i]];
        const unsigned times = pixel->times + 1;
        *pixel = (seen_pixel){times,
                              {f->x[i], f->y[i], f->z[i]},
                              {f->normal_x[i], f->normal_y[i], f->normal_z[i]},
                              {f->shading_x[i], f->shading_y[i], f->shading_z[i]},
                              f->weight_1[i],
                              f->weight_2[i],
                              f->id[i],
                              {0},
                              {0}};
        for (size_t k = 0; k < args->light_count && k < 2; k++) {
            pixel->visibility[k] = args->lighting[k].visibility[i];
            pixel->cosine[k] = args->lighting[k].cosine[i];
        }
        args->red[i] = args->green[i] = args->blue[i] = 1;
    }
    to->bad_batches[row + (size_t)f->pixel_x[0]] += !good;
}

/* Shades with the recorder in place of the description's callback. */
static seen_pixel *shade_and_record(shb_context *context, shb_shade_desc desc) {
    const size_t count = (size_t)desc.frame.width * desc.frame.height;
    recorder to = {desc.frame.width, calloc(count, sizeof(seen_pixel)),
                   calloc(count, sizeof(unsigned))};
    desc.shade = record;
    desc.user = &to;
    CHECK_INT(shb_shade(context, &desc), SHB_OK);
    unsigned bad = 0;
    for (size_t i = 0; i < count; i++)
        bad += to.bad_batches[i];
    CHECK_INT(bad, 0);
    free(to.bad_batches);
    return to.pixels;
}

static void check_vec3(const float actual[3], double x, double y, double z, double tolerance) {
    CHECK_NEAR(actual[0], x, tolerance);
    CHECK_NEAR(actual[1], y, tolerance);
    CHECK_NEAR(actual[2], z, tolerance);
}

/* A rectangle of 8 x 4 pixels in the plane z = depth + slope * y, as two triangles that meet in the
 * diagonal from (0, 0) to (8, 4). */
typedef struct quad {
    float positions[12], normals[12];
    uint16_t indices[6];
    shb_mesh mesh;
    shb_instance instance;
    shb_scene scene;
    uint32_t ids[32];
    shb_view view;
    shb_frame frame;
} quad;

static void quad_init(quad *q, float depth, float slope) {
    const float positions[12] = {
        0, 0, depth, 8, 0, depth, 8, 4, depth + 4 * slope, 0, 4, depth + 4 * slope};
    const uint16_t indices[6] = {0, 1, 2, 0, 2, 3};
    memcpy(q->positions, positions, sizeof positions);
    memcpy(q->indices, indices, sizeof indices);
    q->mesh = (shb_mesh){.positions = q->positions,
                         .vertex_count = 4,
                         .indices = q->indices,
                         .index_size = 2,
                         .triangle_count = 2};
    q->instance = (shb_instance){.mesh = &q->mesh};
    q->scene = (shb_scene){&q->instance, 1};
    /* Centre (x, y) belongs to the first triangle where x > 2 y; none lies on the diagonal, as
     * column + 0.5 is never 2 row + 1. */
    for (uint32_t i = 0; i < 32; i++)
        q->ids[i] = i % 8 + 0.5 > 2 * (i / 8) + 1 ? 0 : 1;
    q->view = pixel_space(8, 4);
    q->frame =
        (shb_frame){.view = &q->view, .scene = &q->scene, .width = 8, .height = 4, .ids = q->ids};
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
    shb_context *context = new_context(1);
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
    shb_context *context = new_context(1);
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
    shb_context *context = new_context(1);
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
    shb_context *context = new_context(1);
    shb_map *map = new_map(context, &q.view, 8, 4, NULL);
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

TEST(shade_triangles_that_face_away_from_the_light_are_dark) {
    /* The quad z = 4 is seen from -z. Directional lights from the front, the back and along it; a
     * point light before and one behind. Nothing casts a shadow. */
    quad q;
    quad_init(&q, 4, 0);
    shb_context *context = new_context(1);
    const shb_box bounds = {{0, 0, 4}, {8, 4, 4}};
    const shb_vec3 directions[3] = {{0, 0.6, -0.8}, {0, 0.6, 0.8}, {1, 0, 0}};
    const shb_vec3 points[2] = {{4, 2, -4}, {4, 2, 12}};
    const shb_bias bias = shb_bias_none();
    for (int i = 0; i < 5; i++) {
        shb_view view;
        CHECK_INT(i < 3 ? shb_view_fit_directional(directions[i], bounds, 64, false, &view)
                        : shb_view_fit_spot(points[i - 3], bounds, 64, false, &view),
                  SHB_OK);
        shb_map *map = new_map(context, &view, 64, 64, NULL);
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
    shb_context *context = new_context(1);
    shb_view oblique;
    const shb_box bounds = {{0, 0, 4}, {8, 4, 4}};
    CHECK_INT(shb_view_fit_directional((shb_vec3){0.8, 0, -0.6}, bounds, 64, false, &oblique), 0);
    shb_map *maps[2] = {new_map(context, &q.view, 8, 4, NULL),
                        new_map(context, &oblique, 64, 64, NULL)};
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
    t->context = new_context(1);
    t->bias = shb_bias_none();
    for (int i = 0; i < 32; i++) {
        t->depths[0][i] = i % 8 < 4 ? 0.125f : 1;
        t->depths[1][i] = i / 8 < 2 ? 0.125f : 1;
    }
    for (int k = 0; k < 2; k++) {
        t->maps[k] = new_map(t->context, &t->q.view, 8, 4, t->depths[k]);
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

TEST(shade_lambert_ambient_light_comes_from_above) {
    /* Shading normals (0, 0.6, -0.8): 0.04 * 1.6 = 0.064; its root 0.25298 is 64.51 / 255. */
    two_lights t;
    two_lights_init(&t);
    for (int k = 0; k < 12; k++)
        t.q.normals[k] = k % 3 == 1 ? 0.6f : k % 3 == 2 ? -0.8f : 0;
    t.q.mesh.normals = t.q.normals;
    t.desc.light_count = 0;
    CHECK_INT(shb_shade(t.context, &t.desc), SHB_OK);
    check_pixel(t.pixels, 65, 65, 65);
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

/* A large frame of many random triangles with holes, two lights with random maps. */
enum { WIDE = 1000, TALL = 50, TRIANGLES = 100 };

typedef struct crowd {
    float positions[9 * TRIANGLES], normals[9 * TRIANGLES];
    uint32_t *ids;
    float *depths;
    shb_view view, light_views[2];
    shb_mesh mesh;
    shb_instance instance;
    shb_scene scene;
    shb_frame frame;
} crowd;

static void crowd_init(crowd *c) {
    test_random random = {3};
    for (int i = 0; i < 9 * TRIANGLES; i++) {
        c->positions[i] = (float)random_double(&random, -6, 6) - (i % 3 == 2 ? 8.0f : 0.0f);
        c->normals[i] = (float)random_double(&random, -1, 1);
    }
    c->ids = malloc(sizeof *c->ids * WIDE * TALL);
    for (int i = 0; i < WIDE * TALL; i++) {
        const uint32_t kind = random_below(&random, 8);
        c->ids[i] = kind == 0   ? SHB_ID_NONE
                    : kind == 1 ? TRIANGLES + random_below(&random, 5)
                                : random_below(&random, TRIANGLES);
    }
    memset(c->ids + 7 * WIDE, 0, sizeof *c->ids * WIDE);    /* a row of a single triangle */
    memset(c->ids + 8 * WIDE, 0xff, sizeof *c->ids * WIDE); /* an empty row */
    c->depths = malloc(sizeof *c->depths * 64 * 64);
    for (int i = 0; i < 64 * 64; i++)
        c->depths[i] = (float)random_double(&random, 0.3, 1);
    c->view = pinhole();
    const shb_box box = {{-6, -6, -14}, {6, 6, -2}};
    CHECK_INT(shb_view_fit_directional((shb_vec3){1, 2, 3}, box, 64, false, &c->light_views[0]), 0);
    CHECK_INT(shb_view_fit_spot((shb_vec3){-9, 20, 5}, box, 64, false, &c->light_views[1]), 0);
    c->mesh = (shb_mesh){.positions = c->positions,
                         .normals = c->normals,
                         .vertex_count = 3 * TRIANGLES,
                         .triangle_count = TRIANGLES};
    c->instance = (shb_instance){.mesh = &c->mesh};
    c->scene = (shb_scene){&c->instance, 1};
    c->frame = (shb_frame){&c->view, &c->scene, WIDE, TALL, c->ids, 0};
}

static void crowd_destroy(crowd *c) {
    free(c->ids);
    free(c->depths);
}

TEST(shade_batches_hold_every_covered_pixel_once) {
    crowd c;
    crowd_init(&c);
    shb_context *context = new_context(2);
    seen_pixel *pixels = shade_and_record(context, (shb_shade_desc){.frame = c.frame});
    unsigned wrong = 0;
    for (int i = 0; i < WIDE * TALL; i++) {
        const bool covered = c.ids[i] < TRIANGLES;
        wrong += pixels[i].times != covered || (covered && pixels[i].id != c.ids[i]);
    }
    CHECK_INT(wrong, 0);
    free(pixels);
    shb_context_destroy(context);
    crowd_destroy(&c);
}

/* Counts the batches by size. */
static void count_sizes(const shb_shade_args *args) {
    unsigned *const *sizes = args->user;
    (*sizes)[args->count]++;
}

TEST(shade_batches_are_full_until_the_row_ends) {
    /* A covered row of 1000 is seven times 128 and 104; 257 are 128 + 128 + 1. */
    quad q;
    quad_init(&q, 4, 0);
    uint32_t ids[1000] = {0};
    q.frame.width = 1000;
    q.frame.height = 1;
    q.frame.ids = ids;
    unsigned counts[SHB_BATCH + 1] = {0}, *sizes = counts;
    shb_context *context = new_context(1);
    shb_shade_desc desc = {.frame = q.frame, .shade = count_sizes, .user = &sizes};
    CHECK_INT(shb_shade(context, &desc), SHB_OK);
    CHECK_INT(counts[128], 7);
    CHECK_INT(counts[104], 1);
    desc.frame.width = 257;
    CHECK_INT(shb_shade(context, &desc), SHB_OK);
    CHECK_INT(counts[128], 9);
    CHECK_INT(counts[1], 1);
    shb_context_destroy(context);
}

TEST(shade_positions_lie_where_drawing_saw_the_triangle) {
    /* Drawn for real: the point projects to within the 1/512 pixel by which corners are snapped,
     * and has the drawn depth. A float position near 10 moves by up to 2^-21 each way. */
    crowd c;
    crowd_init(&c);
    shb_context *context = new_context(2);
    float *depths = malloc(sizeof *depths * WIDE * TALL);
    const shb_draw_desc draw = {.view = &c.view,
                                .scene = &c.scene,
                                .width = WIDE,
                                .height = TALL,
                                .depth = {depths, 0, SHB_FORMAT_FLOAT32},
                                .ids = c.ids};
    CHECK_INT(shb_draw(context, &draw, NULL), SHB_OK);
    seen_pixel *pixels = shade_and_record(context, (shb_shade_desc){.frame = c.frame});
    double worst_x = 0, worst_y = 0;
    unsigned covered = 0, wrong_depth = 0;
    for (int i = 0; i < WIDE * TALL; i++) {
        if (c.ids[i] == SHB_ID_NONE)
            continue;
        covered++;
        const float *p = pixels[i].position;
        const double w = -(double)p[2];
        const double off_x = fabs(((double)p[0] / w + 1) * WIDE / 2 - i % WIDE - 0.5);
        const double off_y = fabs((1 - (double)p[1] / w) * TALL / 2 - i / WIDE - 0.5);
        worst_x = off_x > worst_x ? off_x : worst_x;
        worst_y = off_y > worst_y ? off_y : worst_y;
        wrong_depth += fabs((w - 0.125) / w - (double)depths[i]) > 1e-5;
    }
    CHECK(covered > 10000);
    CHECK(worst_x < 0.003 && worst_y < 0.003);
    CHECK(wrong_depth <= covered / 1000);
    free(depths);
    free(pixels);
    shb_context_destroy(context);
    crowd_destroy(&c);
}

TEST(shade_visibility_is_what_the_map_says_of_the_position) {
    crowd c;
    crowd_init(&c);
    shb_context *context = new_context(2);
    const shb_bias bias = shb_bias_texel_cone();
    shb_shade_light lights[2] = {{.bias = &bias}, {.bias = &bias}};
    for (int k = 0; k < 2; k++)
        lights[k].map = new_map(context, &c.light_views[k], 64, 64, c.depths);
    seen_pixel *pixels = shade_and_record(
        context, (shb_shade_desc){.frame = c.frame, .lights = lights, .light_count = 2});
    unsigned differing = 0, lit = 0, shadowed = 0, away = 0;
    for (int k = 0; k < 2; k++) {
        float *visibility = malloc(sizeof *visibility * WIDE * TALL);
        const shb_points points = {.count = WIDE * TALL,
                                   .positions = pixels->position,
                                   .position_stride = sizeof *pixels,
                                   .normals = pixels->normal,
                                   .normal_stride = sizeof *pixels};
        CHECK_INT(shb_map_visibility(lights[k].map, &points, &bias, NULL, visibility), SHB_OK);
        const shb_light_source source = shb_map_get_info(lights[k].map)->light;
        for (int i = 0; i < WIDE * TALL; i++) {
            const seen_pixel *p = &pixels[i];
            if (!p->times)
                continue;
            double side = 0;
            const double light[3] = {source.position.x, source.position.y, source.position.z};
            for (int axis = 0; axis < 3; axis++)
                side +=
                    (double)p->normal[axis] * (light[axis] - source.w * (double)p->position[axis]);
            if (fabs(side) < 1e-4)
                continue;
            const float expected = side > 0 ? visibility[i] : 0;
            differing += p->visibility[k] != expected;
            lit += expected == 1;
            shadowed += side > 0 && expected == 0;
            away += side < 0;
        }
        free(visibility);
    }
    CHECK_INT(differing, 0);
    CHECK(lit > 1000 && shadowed > 1000 && away > 1000);
    free(pixels);
    for (int k = 0; k < 2; k++)
        shb_map_destroy((shb_map *)lights[k].map);
    shb_context_destroy(context);
    crowd_destroy(&c);
}

static void backwards(void *user, shb_task_fn *task, void *arg, size_t count) {
    (void)user;
    while (count)
        task(arg, --count);
}

TEST(shade_image_does_not_depend_on_threads_or_order) {
    crowd c;
    crowd_init(&c);
    uint8_t *images = calloc(4, 3 * WIDE * TALL);
    for (uint32_t i = 0; i < 4; i++) {
        const shb_context_desc context_desc = {.threads = i == 2 ? 7 : i + 1,
                                               .parallel_for = i == 3 ? backwards : NULL};
        shb_context *context = NULL;
        CHECK_INT(shb_context_create(&context_desc, &context), SHB_OK);
        const shb_bias bias = shb_bias_receiver_plane(1e-5f);
        shb_shade_light lights[2] = {{.bias = &bias, .color = {0.5f, 0.4f, 0.3f}},
                                     {.bias = &bias, .color = {0.2f, 0.4f, 0.6f}}};
        for (int k = 0; k < 2; k++)
            lights[k].map = new_map(context, &c.light_views[k], 64, 64, c.depths);
        const shb_shade_desc desc = {
            .frame = c.frame,
            .lights = lights,
            .light_count = 2,
            .shade = shb_shade_lambert,
            .image = {images + (size_t)i * 3 * WIDE * TALL, WIDE, TALL, 0}};
        CHECK_INT(shb_shade(context, &desc), SHB_OK);
        CHECK(memcmp(images, desc.image.pixels, 3 * WIDE * TALL) == 0);
        for (int k = 0; k < 2; k++)
            shb_map_destroy((shb_map *)lights[k].map);
        shb_context_destroy(context);
    }
    free(images);
    crowd_destroy(&c);
}

typedef struct logged {
    unsigned calls;
    bool names_shade;
} logged;

static void log_sentence(void *user, shb_result result, const char *sentence) {
    logged *log = user;
    log->calls++;
    log->names_shade = result != SHB_OK && strncmp(sentence, "shb_shade: ", 11) == 0;
}

/* The call fails with one logged sentence and leaves the image as it was. */
static void check_refused(const two_lights *t, shb_context *context, logged *log,
                          const shb_shade_desc *desc, shb_result expected, int line) {
    const unsigned calls = log->calls;
    const shb_result result = shb_shade(context, desc);
    unsigned touched = 0;
    for (size_t i = 0; i < sizeof t->pixels; i++)
        touched += t->pixels[i] != 77;
    test_check(result == expected && touched == 0 && log->names_shade && log->calls == calls + 1,
               __FILE__, line, "result %d, expected %d; %u bytes touched", result, expected,
               touched);
}

TEST(shade_refuses_bad_descriptions_and_leaves_the_image) {
    two_lights t;
    two_lights_init(&t);
    logged log = {0};
    const shb_context_desc context_desc = {.threads = 1, .log = log_sentence, .log_user = &log};
    shb_context *context = NULL;
    CHECK_INT(shb_context_create(&context_desc, &context), SHB_OK);
    for (int k = 0; k < 2; k++) { /* these log to this context, too */
        shb_map_destroy(t.maps[k]);
        t.maps[k] = new_map(context, &t.q.view, 8, 4, t.depths[k]);
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
    REFUSES(desc.light_count = SHB_LIGHTS_MAX + 1, SHB_ERROR_ARGUMENT);
    REFUSES(desc.lights = NULL, SHB_ERROR_ARGUMENT);
    REFUSES(desc.background[1] = NAN, SHB_ERROR_NUMBER);
    REFUSES(desc.background[2] = -INFINITY, SHB_ERROR_NUMBER);
    REFUSES(desc.image.width = 7, SHB_ERROR_SIZE);
    REFUSES(desc.image.height = 5, SHB_ERROR_SIZE);
    REFUSES(desc.image.stride = 23, SHB_ERROR_ARGUMENT);
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
