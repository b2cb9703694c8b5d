/* Every instruction set has to shade with the very bits of the scalar kernels. */
#include "../src/context.h"
#include "../src/surface.h"

#include "contexts.h"
#include "depth_map.h"
#include "isas.h"
#include "random.h"
#include "shadowbias/shadowbias.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAP = 64 };

/* A map of random depths, of which some are empty, seen by a directional or a spot light. */
static depth_map new_map(shb_isa isa, bool spot, bool reversed, shb_format format) {
    static float depths[MAP * MAP];
    const shb_map_desc desc = {.width = MAP, .height = MAP, .format = format};
    test_random random = {7};
    for (int i = 0; i < MAP * MAP; i++)
        depths[i] = (float)random_double(&random, 0, 1);
    return depth_map_open_lit(isa, spot, reversed, desc, depths);
}

/* Mostly a number of the scene; else one that no scene should hold. */
static float nasty(test_random *random) {
    static const float odd[] = {NAN,    INFINITY, -INFINITY, 0.0f,   -0.0f, 1e30f, -1e30f,
                                1e-40f, 3e38f,    -3e38f,    1e-30f, 50.0f, -50.0f};
    if (random_below(random, 12) == 0)
        return odd[random_below(random, sizeof odd / sizeof *odd)];
    return (float)random_double(random, -1.1, 1.1);
}

enum { POINTS = 3000 };

typedef struct points {
    float positions[3 * POINTS], normals[3 * POINTS];
} points;

/* Some normals are those of planes along the light's rays, to both sides of parallel. */
static points *new_points(shb_vec3 to_light, uint64_t seed) {
    points *made = malloc(sizeof *made);
    test_random random = {seed};
    for (int i = 0; i < 3 * POINTS; i++) {
        made->positions[i] = nasty(&random);
        made->normals[i] = nasty(&random);
    }
    for (int i = 0; i < POINTS; i += 7) {
        const shb_vec3 side = {(double)made->positions[3 * i], 1, 0.5};
        const shb_vec3 normal = shb_vec3_normalize(shb_vec3_cross(to_light, side));
        made->normals[3 * i] = (float)normal.x;
        made->normals[3 * i + 1] = (float)normal.y;
        made->normals[3 * i + 2] = (float)normal.z;
    }
    return made;
}

/* All that a batch can hold, so that every array is compared. */
static const uint32_t all_needs = SHB_NEEDS_NORMAL | SHB_NEEDS_SCALE | SHB_NEEDS_SLOPE;

typedef struct outcome {
    float visibility[POINTS];
    shb_receivers receivers[POINTS / SHB_BATCH + 1];
    size_t batches;
} outcome;

static void keep_batch(const shb_filter_args *args) {
    outcome *const *place = args->filter->user;
    (*place)->receivers[(*place)->batches++] = *args->receivers;
    shb_filter_hard().filter(args);
}

static outcome *ask(const depth_map *asked, const points *given, size_t count, shb_bias bias) {
    outcome *made = calloc(1, sizeof *made);
    bias.needs |= all_needs;
    const shb_filter filter = {.filter = keep_batch, .user = &made};
    const shb_points list = {
        .count = count, .positions = given->positions, .normals = given->normals};
    CHECK_INT(shb_map_visibility(asked->map, &list, &bias, &filter, made->visibility), SHB_OK);
    return made;
}

static bool same_floats(const float *a, const float *b, size_t count) {
    return memcmp(a, b, count * sizeof *a) == 0;
}

static bool same_receivers(const shb_receivers *a, const shb_receivers *b, size_t count) {
    return same_floats(a->x, b->x, count) && same_floats(a->y, b->y, count) &&
           same_floats(a->z, b->z, count) && same_floats(a->normal_x, b->normal_x, count) &&
           same_floats(a->normal_y, b->normal_y, count) &&
           same_floats(a->normal_z, b->normal_z, count) &&
           same_floats(a->cosine, b->cosine, count) &&
           same_floats(a->texel_size, b->texel_size, count) &&
           same_floats(a->depth_per_world, b->depth_per_world, count) &&
           memcmp(a->texel_x, b->texel_x, count * sizeof *a->texel_x) == 0 &&
           memcmp(a->texel_y, b->texel_y, count * sizeof *a->texel_y) == 0 &&
           same_floats(a->to_center_x, b->to_center_x, count) &&
           same_floats(a->to_center_y, b->to_center_y, count) &&
           same_floats(a->depth, b->depth, count) && same_floats(a->slope_x, b->slope_x, count) &&
           same_floats(a->slope_y, b->slope_y, count) && same_floats(a->ref, b->ref, count) &&
           same_floats(a->step_x, b->step_x, count) && same_floats(a->step_y, b->step_y, count);
}

static bool same_outcome(const outcome *a, const outcome *b, size_t count) {
    if (!same_floats(a->visibility, b->visibility, count) || a->batches != b->batches)
        return false;
    for (size_t i = 0; i < a->batches; i++) {
        const size_t left = count - i * SHB_BATCH;
        if (!same_receivers(&a->receivers[i], &b->receivers[i],
                            left < SHB_BATCH ? left : SHB_BATCH))
            return false;
    }
    return true;
}

static void check_methods(bool spot, bool reversed, shb_format format, size_t count) {
    depth_map scalar = new_map(SHB_ISA_SCALAR, spot, reversed, format);
    const shb_light_source light = shb_map_get_info(scalar.map)->light;
    points *given = new_points(light.position, count + spot);
    size_t method_count;
    const shb_bias_method *methods = shb_bias_methods(&method_count);
    for (shb_isa isa = test_isa_after(SHB_ISA_SCALAR); isa < SHB_ISA_COUNT;
         isa = test_isa_after(isa)) {
        depth_map other = new_map(isa, spot, reversed, format);
        for (size_t m = 0; m < method_count; m++) {
            const shb_bias bias = methods[m].make();
            if (bias.combine || bias.needs & (SHB_NEEDS_FLIPPED | SHB_NEEDS_OCCLUDERS))
                continue;
            outcome *expected = ask(&scalar, given, count, bias);
            outcome *actual = ask(&other, given, count, bias);
            CHECK(same_outcome(expected, actual, count));
            free(expected);
            free(actual);
        }
        depth_map_close(&other);
    }
    free(given);
    depth_map_close(&scalar);
}

TEST(shade_kernels_give_scalar_bits_for_every_method) {
    for (int spot = 0; spot < 2; spot++)
        for (int reversed = 0; reversed < 2; reversed++)
            check_methods(spot, reversed, SHB_FORMAT_FLOAT32, POINTS);
}

TEST(shade_kernels_give_scalar_bits_for_every_format) {
    check_methods(true, true, SHB_FORMAT_UNORM24, POINTS);
    check_methods(false, false, SHB_FORMAT_UNORM24, POINTS);
    check_methods(true, false, SHB_FORMAT_UNORM16, POINTS);
    check_methods(false, true, SHB_FORMAT_UNORM16, POINTS);
}

TEST(shade_kernels_give_scalar_bits_for_every_count) {
    for (size_t count = 1; count <= SHB_BATCH; count += count < 34 ? 1 : 37)
        check_methods(count % 2, false, SHB_FORMAT_FLOAT32, count);
    check_methods(false, false, SHB_FORMAT_FLOAT32, SHB_BATCH);
}

TEST(shade_kernels_constant_units_give_scalar_bits) {
    depth_map scalar = new_map(SHB_ISA_SCALAR, true, false, SHB_FORMAT_FLOAT32);
    points *given = new_points((shb_vec3){1, 2, 3}, 5);
    for (shb_isa isa = test_isa_after(SHB_ISA_SCALAR); isa < SHB_ISA_COUNT;
         isa = test_isa_after(isa)) {
        depth_map other = new_map(isa, true, false, SHB_FORMAT_FLOAT32);
        for (int unit = SHB_UNIT_DEPTH; unit <= SHB_UNIT_WORLD; unit++) {
            const shb_bias bias = shb_bias_constant(0.7f, (shb_unit)unit);
            outcome *expected = ask(&scalar, given, POINTS, bias);
            outcome *actual = ask(&other, given, POINTS, bias);
            CHECK(same_outcome(expected, actual, POINTS));
            free(expected);
            free(actual);
        }
        depth_map_close(&other);
    }
    free(given);
    depth_map_close(&scalar);
}

/* Texels of the map and two around it. */
TEST(shade_kernels_fetch_far_depth_outside_the_map) {
    for (shb_isa isa = SHB_ISA_SCALAR; isa < SHB_ISA_COUNT; isa = test_isa_after(isa)) {
        shb_context *context = test_context(1, isa);
        shb_map_desc map_desc = {.width = 8, .height = 8};
        const shb_box box = {{-1, -1, -1}, {1, 1, 1}};
        CHECK_INT(shb_view_fit_directional((shb_vec3){0, 0, 1}, box, 8, false, &map_desc.view),
                  SHB_OK);
        float texels[64];
        for (int i = 0; i < 64; i++)
            texels[i] = (float)i / 128;
        shb_map *map;
        CHECK_INT(shb_map_wrap(context, &map_desc, texels, 0, NULL, &map), SHB_OK);
        enum { COUNT = 300 };
        int32_t x[COUNT], y[COUNT];
        float depth[COUNT + 1];
        depth[COUNT] = 42;
        test_random random = {3};
        for (int i = 0; i < COUNT; i++) {
            x[i] = (int32_t)random_below(&random, 12) - 2;
            y[i] = (int32_t)random_below(&random, 12) - 2;
        }
        x[0] = INT32_MIN;
        y[1] = INT32_MAX;
        shb_map_fetch(map, COUNT, x, y, depth);
        for (int i = 0; i < COUNT; i++) {
            const bool inside = x[i] >= 0 && x[i] < 8 && y[i] >= 0 && y[i] < 8;
            CHECK(depth[i] == (inside ? (float)(8 * y[i] + x[i]) / 128 : 1.0f));
        }
        CHECK(depth[COUNT] == 42.0f);
        shb_map_destroy(map);
        shb_context_destroy(context);
    }
}

TEST(shade_kernels_a_stage_called_by_a_host_writes_the_same) {
    depth_map asked = new_map(SHB_ISA_BEST, false, false, SHB_FORMAT_FLOAT32);
    points *given = new_points((shb_vec3){1, 2, 3}, 6);
    const shb_bias bias = shb_bias_adaptive_soft(1e-3f, 0, 50);
    outcome *made = ask(&asked, given, SHB_BATCH, bias);
    shb_receivers again = made->receivers[0];
    memset(again.ref, 0, sizeof again.ref);
    memset(again.step_x, 0, sizeof again.step_x);
    memset(again.step_y, 0, sizeof again.step_y);
    const shb_bias_args args = {
        .count = SHB_BATCH, .bias = &bias, .map = shb_map_get_info(asked.map), .receivers = &again};
    bias.depth(&args);
    CHECK(same_receivers(&again, &made->receivers[0], SHB_BATCH));
    free(made);
    free(given);
    depth_map_close(&asked);
}

enum { WIDTH = 301, HEIGHT = 75, TRIANGLES = 700, INSTANCES = 6, IDS = INSTANCES * TRIANGLES };

/* Triangles around and behind the camera, with ids drawn at random beside those that it saw, so
 * that many centres lie outside of their triangles. */
typedef struct frame_case {
    float positions[9 * TRIANGLES], normals[9 * TRIANGLES];
    uint32_t ids[WIDTH * HEIGHT];
    shb_mesh mesh;
    shb_instance instances[INSTANCES];
    shb_scene scene;
    shb_view view;
    shb_frame frame;
} frame_case;

static frame_case *new_frame(bool has_normals) {
    frame_case *f = calloc(1, sizeof *f);
    test_random random = {17};
    for (int i = 0; i < 9 * TRIANGLES; i++) {
        const int corner = i / 9 * 9 + i % 3;
        f->positions[i] =
            (float)random_double(&random, -0.2, 0.2) +
            (i == corner ? (float)random_double(&random, -1, 1) : f->positions[corner]);
        f->normals[i] = nasty(&random);
    }
    f->mesh = (shb_mesh){.positions = f->positions,
                         .normals = has_normals ? f->normals : NULL,
                         .vertex_count = 3 * TRIANGLES,
                         .triangle_count = TRIANGLES};
    for (int i = 0; i < INSTANCES; i++)
        f->instances[i] = (shb_instance){
            .mesh = &f->mesh, .world_from_mesh = shb_mat4_rotation((shb_vec3){1, 1, 0}, 1.1 * i)};
    f->scene = (shb_scene){f->instances, INSTANCES};
    CHECK_INT(shb_view_perspective((shb_vec3){0.3, 0.2, 2}, (shb_vec3){0, 0, 0},
                                   (shb_vec3){0, 1, 0}, 1, 2, 0.01, 100, false, &f->view),
              SHB_OK);
    shb_context *context = test_context(1, SHB_ISA_BEST);
    const shb_draw_desc draw = {
        .view = &f->view, .scene = &f->scene, .width = WIDTH, .height = HEIGHT, .ids = f->ids};
    CHECK_INT(shb_draw(context, &draw, NULL), SHB_OK);
    shb_context_destroy(context);
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        if (random_below(&random, 4) == 0)
            f->ids[i] = random_below(&random, IDS + 3);
    f->frame = (shb_frame){&f->view, &f->scene, WIDTH, HEIGHT, f->ids, 0};
    return f;
}

typedef struct frame_outcome {
    float fragments[WIDTH * HEIGHT][13];
    uint8_t pixels[3 * WIDTH * HEIGHT];
} frame_outcome;

static void keep_and_light(const shb_shade_args *args) {
    frame_outcome *made = (frame_outcome *)(uintptr_t)args->user;
    const shb_fragments *f = args->fragments;
    for (size_t i = 0; i < args->count; i++) {
        const float kept[13] = {f->x[i],
                                f->y[i],
                                f->z[i],
                                f->normal_x[i],
                                f->normal_y[i],
                                f->normal_z[i],
                                f->shading_x[i],
                                f->shading_y[i],
                                f->shading_z[i],
                                f->weight_1[i],
                                f->weight_2[i],
                                args->lighting[0].cosine[i],
                                args->lighting[1].visibility[i]};
        memcpy(made->fragments[f->pixel_y[i] * WIDTH + f->pixel_x[i]], kept, sizeof kept);
    }
    shb_shade_args plain = *args;
    plain.user = NULL;
    shb_shade_lambert(&plain);
}

static frame_outcome *shade_frame(const frame_case *f, shb_isa isa, uint32_t threads) {
    frame_outcome *made = calloc(1, sizeof *made);
    depth_map sun = new_map(isa, false, false, SHB_FORMAT_FLOAT32);
    depth_map spot = new_map(isa, true, true, SHB_FORMAT_UNORM16);
    const shb_bias adaptive = shb_bias_adaptive(1e-4f, 0), offset = shb_bias_normal_offset(1.5f, 0);
    const shb_shade_light lights[2] = {
        {.map = sun.map, .bias = &adaptive, .color = {1, 0.5f, 2}},
        {.map = spot.map, .bias = &offset, .color = {0.2f, 0.9f, 0}}};
    shb_context *context = test_context(threads, isa);
    const shb_shade_desc shade = {
        .frame = f->frame,
        .lights = lights,
        .light_count = 2,
        .shade = keep_and_light,
        .user = made,
        .background = {0.3f, 0.1f, 2},
        .image = {.pixels = made->pixels, .width = WIDTH, .height = HEIGHT}};
    CHECK_INT(shb_shade(context, &shade), SHB_OK);
    shb_context_destroy(context);
    depth_map_close(&sun);
    depth_map_close(&spot);
    return made;
}

static void check_frames(bool has_normals) {
    frame_case *f = new_frame(has_normals);
    frame_outcome *expected = shade_frame(f, SHB_ISA_SCALAR, 1);
    for (shb_isa isa = test_isa_after(SHB_ISA_SCALAR); isa < SHB_ISA_COUNT;
         isa = test_isa_after(isa))
        for (uint32_t threads = 1; threads <= 4; threads++) {
            frame_outcome *actual = shade_frame(f, isa, threads);
            CHECK(memcmp(expected, actual, sizeof *expected) == 0);
            free(actual);
        }
    free(expected);
    free(f);
}

TEST(shade_kernels_shade_frames_with_scalar_bits_on_any_threads) {
    check_frames(true);
    check_frames(false);
}

/* The weight as it is, or what the other one leaves if they would sum to more than 1. */
static float stored_weight(double weight, double other) {
    const double rounded = (double)(float)weight, left = 1 - (double)(float)other;
    return (float)(rounded > left && weight < 0.5 ? left : rounded);
}

/* The fragment of a pixel, by the formulas of one triangle at a time. */
static void check_fragment(const frame_case *f, uint32_t column, uint32_t row, const float *actual,
                           unsigned *wrong) {
    static const float none[3] = {0};
    shb_surface_triangle triangle;
    double weights[3];
    if (!shb_surface_prepare(&f->scene, &f->view, f->ids[row * WIDTH + column], &triangle)) {
        *wrong += memcmp(actual, none, sizeof none) != 0;
        return;
    }
    shb_surface_weights(&triangle, WIDTH, HEIGHT, column, row, weights);
    const shb_vec3 point = shb_surface_point(&triangle, weights);
    const float expected[3] = {(float)point.x, (float)point.y, (float)point.z};
    *wrong += memcmp(actual, expected, sizeof expected) != 0 ||
              actual[9] != stored_weight(weights[1], weights[2]) ||
              actual[10] != stored_weight(weights[2], weights[1]);

    shb_light_source eye;
    CHECK_INT(shb_view_light_source(&f->view, &eye), SHB_OK);
    if (!shb_surface_faces(&triangle, &eye))
        triangle.normal = (shb_vec3){-triangle.normal.x, -triangle.normal.y, -triangle.normal.z};
    const shb_vec3 normal = shb_surface_shading_normal(&triangle, weights);
    const float shading[3] = {(float)normal.x, (float)normal.y, (float)normal.z};
    *wrong += memcmp(actual + 6, shading, sizeof shading) != 0;
}

static void check_fragments(const frame_case *f) {
    frame_outcome *made = shade_frame(f, SHB_ISA_BEST, 1);
    unsigned wrong = 0;
    for (uint32_t row = 0; row < HEIGHT; row++)
        for (uint32_t column = 0; column < WIDTH; column++)
            check_fragment(f, column, row, made->fragments[row * WIDTH + column], &wrong);
    CHECK_INT(wrong, 0);
    free(made);
}

/* Normals of corners lie on the triangle's side, on the other, on both, or are no numbers. */
TEST(shade_fragments_are_those_of_one_triangle_at_a_time) {
    frame_case *f = new_frame(true);
    check_fragments(f);
    free(f);
}

TEST(shade_fragments_are_right_however_many_triangles_a_block_sees) {
    /* Most of 4200 triangles and some that are not there, in no order; many of them have the same
     * lowest bits of their ids. */
    frame_case *f = new_frame(true);
    test_random random = {23};
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        f->ids[i] = random_below(&random, IDS + 9);
    check_fragments(f);
    free(f);
}
