/* The hard test in float says what the double projection says, wherever fragments lie. */
#include "../src/context.h"
#include "../src/kernels/shade.h"

#include "contexts.h"
#include "isas.h"
#include "odd_views.h"
#include "random.h"
#include "shadowbias/shadowbias.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAP = 64, POINTS = 1500 };

typedef struct quick_case {
    float depths[MAP * MAP];
    float positions[3 * POINTS], normals[3 * POINTS];
    float quick[POINTS], expected[POINTS];
    shb_receivers receivers[POINTS / SHB_BATCH + 1];
    size_t batches;
} quick_case;

static void keep_batch(const shb_filter_args *args) {
    quick_case *const *place = args->filter->user;
    (*place)->receivers[(*place)->batches++] = *args->receivers;
    shb_filter_hard().filter(args);
}

/* By a filter of the host's, which the double projection is made for. */
static void ask_in_double(const shb_map *map, const shb_bias *bias, quick_case *c) {
    const shb_filter filter = {.filter = keep_batch, .user = &c};
    const shb_points points = {.count = POINTS, .positions = c->positions, .normals = c->normals};
    c->batches = 0;
    CHECK_INT(shb_map_visibility(map, &points, bias, &filter, c->expected), SHB_OK);
}

static unsigned count_differences(const shb_map *map, const shb_bias *bias, quick_case *c) {
    const shb_points points = {.count = POINTS, .positions = c->positions, .normals = c->normals};
    unsigned wrong = 0;
    ask_in_double(map, bias, c);
    CHECK_INT(shb_map_visibility(map, &points, bias, NULL, c->quick), SHB_OK);
    for (int i = 0; i < POINTS; i++)
        wrong += c->quick[i] != c->expected[i];
    return wrong;
}

/* Texels hold what some fragment is compared with, or its neighbours among floats. */
static void fill_with_own_depths(quick_case *c, bool reversed, test_random *random) {
    for (int i = 0; i < POINTS; i++) {
        const shb_receivers *r = &c->receivers[i / SHB_BATCH];
        const int k = i % SHB_BATCH;
        if (r->texel_x[k] < 0 || r->texel_x[k] >= MAP || r->texel_y[k] < 0 || r->texel_y[k] >= MAP)
            continue;
        float depth = reversed ? -r->ref[k] : r->ref[k];
        for (uint64_t steps = random_below(random, 5); steps > 0; steps--)
            depth = nextafterf(depth, random_below(random, 2) ? 2.0f : -2.0f);
        c->depths[r->texel_y[k] * MAP + r->texel_x[k]] = depth;
    }
}

/* On borders and centres of texels of a light straight above, and some floats beside them; every
 * third one anywhere. Normals are random ones, their planes' steps from none to steep. */
static void place_points(quick_case *c, shb_vec3 center, double scale, test_random *random) {
    const double base[3] = {center.x, center.y, center.z};
    for (int i = 0; i < 3 * POINTS; i++) {
        const double grid = ((double)random_below(random, 2 * MAP + 9) - MAP - 4) / MAP;
        const double way = i / 3 % 3 == 0 ? random_double(random, -1.2, 1.2) : grid;
        c->positions[i] = (float)(base[i % 3] + scale * way);
        for (uint64_t steps = random_below(random, 3); steps > 0; steps--)
            c->positions[i] = nextafterf(c->positions[i], (float)(base[i % 3] - 9 * scale));
        c->normals[i] = (float)random_double(random, -1, 1);
    }
}

enum { VIEWS = 5 };

/* Parallel light ends at its far plane amid the points. */
static shb_result make_view(int kind, shb_vec3 center, double scale, shb_view *view) {
    return odd_view(kind, center, scale, 4 * scale, view);
}

enum { BIASES = 9 };

static shb_bias make_bias(int number, double scale) {
    switch (number) {
    case 0:
        return shb_bias_none();
    case 1:
        return shb_bias_constant(1e-3f, SHB_UNIT_DEPTH);
    case 2:
        return shb_bias_constant(0.7f, SHB_UNIT_TEXEL);
    case 3:
        return shb_bias_constant((float)(-1e-3 * scale), SHB_UNIT_WORLD);
    case 4:
        return shb_bias_receiver_plane(0);
    case 5:
        return shb_bias_receiver_plane(1e-5f);
    case 6:
        return shb_bias_adaptive(1e-4f, 0);
    case 7:
        return shb_bias_texel_cone();
    default:
        return shb_bias_normal_offset(1.5f, 1e-5f);
    }
}

/* One in three is empty. */
static void fill_at_random(quick_case *c, bool reversed, test_random *random) {
    for (int i = 0; i < MAP * MAP; i++)
        c->depths[i] = i % 3 ? (float)random_double(random, 0, 1) : reversed ? 0.0f : 1.0f;
}

/* All views and methods; nothing is changed by where the scene lies and how large it is. */
static void check_place(shb_isa isa, shb_vec3 center, double scale) {
    shb_context *context = test_context(1, isa);
    quick_case *c = malloc(sizeof *c);
    test_random random = {31};
    for (int kind = 0; kind < VIEWS; kind++) {
        shb_map_desc desc = {.width = MAP};
        shb_map *map = NULL;
        CHECK_INT(make_view(kind, center, scale, &desc.view), SHB_OK);
        memset(c->depths, 0, sizeof c->depths);
        CHECK_INT(shb_map_wrap(context, &desc, c->depths, 0, NULL, &map), SHB_OK);
        for (int number = 0; number < BIASES; number++) {
            const shb_bias bias = make_bias(number, scale);
            place_points(c, center, scale, &random);
            fill_at_random(c, desc.view.reversed, &random);
            CHECK_INT(count_differences(map, &bias, c), 0);
            fill_with_own_depths(c, desc.view.reversed, &random);
            CHECK_INT(count_differences(map, &bias, c), 0);
        }
        shb_map_destroy(map);
    }
    free(c);
    shb_context_destroy(context);
}

TEST(quick_test_says_what_doubles_say_at_any_scale) {
    for (shb_isa isa = test_isa_after(SHB_ISA_SCALAR); isa < SHB_ISA_COUNT;
         isa = test_isa_after(isa))
        for (double scale = 1e-4; scale < 2e7; scale *= 1e3)
            check_place(isa, (shb_vec3){0, 0, 0}, scale);
}

/* Where products of two sizes of texels are out of the range of floats, or lose their digits. */
TEST(quick_test_says_what_doubles_say_at_scales_that_floats_do_not_square) {
    const double scales[] = {0x1p-70, 0x1p-61, 0x1p68, 0x1p74};
    for (shb_isa isa = test_isa_after(SHB_ISA_SCALAR); isa < SHB_ISA_COUNT;
         isa = test_isa_after(isa))
        for (int i = 0; i < 4; i++)
            check_place(isa, (shb_vec3){0, 0, 0}, scales[i]);
}

TEST(quick_test_says_what_doubles_say_far_from_the_origin) {
    for (shb_isa isa = test_isa_after(SHB_ISA_SCALAR); isa < SHB_ISA_COUNT;
         isa = test_isa_after(isa))
        for (double far_away = 1e3; far_away < 2e7; far_away *= 1e2)
            check_place(isa, (shb_vec3){far_away, -far_away, 2 * far_away}, 1);
}

/* Numbers that no scene should hold, in positions, normals and texels. */
static void spoil(float *values, size_t count, test_random *random) {
    static const float odd[] = {NAN, INFINITY, -INFINITY, 0, -0.0f, 1e30f, -1e30f, 1e-40f, 3e38f};
    for (size_t i = 0; i < count; i++)
        if (random_below(random, 40) == 0)
            values[i] = odd[random_below(random, sizeof odd / sizeof *odd)];
}

typedef void check_fn(const shb_map *map, const shb_bias *bias, quick_case *c, test_random *random);

/* On a map of every view, for every bias and instruction set. */
static void check_everywhere(check_fn *check, uint64_t seed) {
    quick_case *c = malloc(sizeof *c);
    test_random random = {seed};
    for (shb_isa isa = test_isa_after(SHB_ISA_SCALAR); isa < SHB_ISA_COUNT;
         isa = test_isa_after(isa))
        for (int kind = 0; kind < VIEWS; kind++) {
            shb_context *context = test_context(1, isa);
            shb_map_desc desc = {.width = MAP};
            shb_map *map = NULL;
            CHECK_INT(make_view(kind, (shb_vec3){0, 0, 0}, 1, &desc.view), SHB_OK);
            CHECK_INT(shb_map_wrap(context, &desc, c->depths, 0, NULL, &map), SHB_OK);
            for (int number = 0; number < BIASES; number++) {
                const shb_bias bias = make_bias(number, 1);
                check(map, &bias, c, &random);
            }
            shb_map_destroy(map);
            shb_context_destroy(context);
        }
    free(c);
}

static bool is_reversed(const shb_map *map) {
    return shb_map_get_info(map)->view.reversed;
}

static void check_spoilt(const shb_map *map, const shb_bias *bias, quick_case *c,
                         test_random *random) {
    place_points(c, (shb_vec3){0, 0, 0}, 1, random);
    fill_at_random(c, is_reversed(map), random);
    spoil(c->depths, MAP * MAP, random);
    spoil(c->normals, 3 * POINTS, random);
    CHECK_INT(count_differences(map, bias, c), 0);
    spoil(c->positions + 300, 600, random);
    CHECK_INT(count_differences(map, bias, c), 0);
}

TEST(quick_test_says_what_doubles_say_of_numbers_that_are_none) {
    check_everywhere(check_spoilt, 32);
}

/* Batch by batch a part of the scene: beside the batch before, or far from it; with normals that
 * grow. */
static void place_in_parts(quick_case *c, double scale, test_random *random) {
    static const double parts[][4] = {{0, 0, 0, 1},        {0.05, 0, 0.02, 1.1}, {0.08, 0.1, 0, 4},
                                      {-0.9, 0.8, 0.7, 1}, {-0.9, 0.8, 0.9, 9},  {0.9, 0, -0.5, 1}};
    place_points(c, (shb_vec3){0, 0, 0}, scale / 8, random);
    for (int i = 0; i < 3 * POINTS; i++) {
        const double *part = parts[i / 3 / SHB_BATCH];
        c->positions[i] += (float)(scale * part[i % 3]);
        c->normals[i] *= (float)part[3];
    }
}

static unsigned count_strided_differences(const shb_map *map, const shb_bias *bias, quick_case *c) {
    static float spread[2][5 * POINTS];
    const size_t stride = 5 * sizeof(float);
    for (size_t i = 0; i < POINTS; i++) {
        memcpy(spread[0] + 5 * i, c->positions + 3 * i, 3 * sizeof(float));
        memcpy(spread[1] + 5 * i, c->normals + 3 * i, 3 * sizeof(float));
    }
    const shb_points points = {.count = POINTS,
                               .positions = spread[0],
                               .normals = spread[1],
                               .position_stride = stride,
                               .normal_stride = stride};
    unsigned wrong = 0;
    CHECK_INT(shb_map_visibility(map, &points, bias, NULL, c->quick), SHB_OK);
    for (int i = 0; i < POINTS; i++)
        wrong += c->quick[i] != c->expected[i];
    return wrong;
}

static void check_parts(const shb_map *map, const shb_bias *bias, quick_case *c,
                        test_random *random) {
    place_in_parts(c, 1, random);
    fill_at_random(c, is_reversed(map), random);
    CHECK_INT(count_differences(map, bias, c), 0);
    CHECK_INT(count_strided_differences(map, bias, c), 0);
    fill_with_own_depths(c, is_reversed(map), random);
    CHECK_INT(count_differences(map, bias, c), 0);
    CHECK_INT(count_strided_differences(map, bias, c), 0);
}

TEST(quick_test_says_what_doubles_say_from_batch_to_batch) {
    check_everywhere(check_parts, 33);
}

typedef struct quick_batch {
    SHB_ALIGN float positions[3][SHB_BATCH], normals[3][SHB_BATCH];
    float visibility[SHB_BATCH];
    uint16_t doubtful[SHB_BATCH];
} quick_batch;

/* A cube of points, 0.1 to each side of (x, 0, 0). */
static size_t ask_cube(const shb_map *map, const shb_shade_kernels *kernels, float x, float normal,
                       shb_quick_test *test) {
    quick_batch batch;
    test_random random = {34};
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < SHB_BATCH; i++) {
            batch.positions[k][i] = (float)random_double(&random, -0.1, 0.1) + (k == 0 ? x : 0);
            batch.normals[k][i] = normal;
        }
    const shb_quick_bias bias = {.plane = true, .epsilon = {1e-4}};
    const shb_quick_points points = {
        .position = {batch.positions[0], batch.positions[1], batch.positions[2]},
        .normal = {batch.normals[0], batch.normals[1], batch.normals[2]}};
    return kernels->quick(map, &bias, SHB_BATCH, &points, test, batch.visibility, batch.doubtful);
}

/* A box of 0.3 around the first batch, its size of 0.2 and a quarter to each side. */
TEST(quick_test_serves_batches_in_its_box) {
    static float depths[MAP * MAP];
    for (shb_isa isa = test_isa_after(SHB_ISA_SCALAR); isa < SHB_ISA_COUNT;
         isa = test_isa_after(isa)) {
        shb_context *context = test_context(1, isa);
        const shb_shade_kernels *kernels = context->shade_kernels;
        shb_map_desc desc = {.width = MAP};
        shb_map *map = NULL;
        CHECK_INT(make_view(0, (shb_vec3){0, 0, 0}, 1, &desc.view), SHB_OK);
        CHECK_INT(shb_map_wrap(context, &desc, depths, 0, NULL, &map), SHB_OK);
        shb_quick_test test = {.known = false};
        if (kernels->quick) {
            CHECK(ask_cube(map, kernels, 0, 0.5f, &test) < 8);
            CHECK(test.known);
            const float origin = test.origin[0];
            CHECK(fabsf(test.reach[0] - 0.15f) < 0.005f);
            CHECK(ask_cube(map, kernels, 0.04f, 0.5f, &test) < 8);
            CHECK(test.origin[0] == origin);
            CHECK(ask_cube(map, kernels, 0.04f, 0.7f, &test) < 8);
            CHECK(test.origin[0] > origin + 0.03f && test.normal > 0.7f);
            CHECK(ask_cube(map, kernels, -0.5f, 0.5f, &test) < 8);
            CHECK(test.origin[0] < -0.4f && test.normal < 0.7f);
            CHECK(ask_cube(map, kernels, NAN, 0.5f, &test) == SHB_BATCH);
            CHECK(!test.known);
        }
        shb_map_destroy(map);
        shb_context_destroy(context);
    }
}

/* A slanted floor, lit and in shadow by turns: the bounds leave little to be asked again. */
TEST(quick_test_is_sure_of_nearly_all_fragments) {
    static float depths[1024 * 1024];
    for (int i = 0; i < 1024 * 1024; i++)
        depths[i] = i / 64 % 2 ? 0.1f : 1.0f;
    for (shb_isa isa = test_isa_after(SHB_ISA_SCALAR); isa < SHB_ISA_COUNT;
         isa = test_isa_after(isa))
        for (int kind = 0; kind < 4; kind++) {
            shb_context *context = test_context(1, isa);
            shb_map_desc desc = {.width = 1024};
            shb_map *map = NULL;
            CHECK_INT(make_view(kind, (shb_vec3){300, 0, 0}, 1, &desc.view), SHB_OK);
            CHECK_INT(shb_map_wrap(context, &desc, depths, 0, NULL, &map), SHB_OK);
            shb_receivers r;
            float visibility[SHB_BATCH];
            uint16_t doubtful[SHB_BATCH];
            for (int i = 0; i < SHB_BATCH; i++) {
                r.x[i] = 300 + (float)i * 0.0017f;
                r.y[i] = (float)i * 0.0003f;
                r.z[i] = 0.1f;
                r.normal_x[i] = 0.2f;
                r.normal_y[i] = 0.97f;
                r.normal_z[i] = 0.1f;
            }
            const shb_quick_bias bias = {.plane = true, .epsilon = {1e-4}};
            const shb_quick_points points = {.position = {r.x, r.y, r.z},
                                             .normal = {r.normal_x, r.normal_y, r.normal_z}};
            shb_quick_test test = {.known = false};
            if (context->shade_kernels->quick)
                CHECK(context->shade_kernels->quick(map, &bias, SHB_BATCH, &points, &test,
                                                    visibility, doubtful) < 8);
            shb_map_destroy(map);
            shb_context_destroy(context);
        }
}
