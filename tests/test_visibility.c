/* Asking a map: any count, any layout, methods and filters of the host, and every refusal. */
#include "probe.h"
#include "random.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE = 16 };

/* A map of random depths under the orthographic light of the support. */
typedef struct noise {
    shb_context *context;
    shb_map *map;
    float texels[SIZE * SIZE];
    int failures; /* sentences that were logged */
    shb_result logged;
} noise;

static void count_failure(void *user, shb_result result, const char *sentence) {
    noise *host = user;
    host->failures++;
    host->logged = result;
    CHECK(strncmp(sentence, "shb_map_visibility: ", 20) == 0);
}

static void open_noise(noise *host, const shb_bias *holds) {
    test_random random = {4};
    *host = (noise){0};
    for (int i = 0; i < SIZE * SIZE; i++)
        host->texels[i] = (float)random_double(&random, 0.25, 0.75);
    const shb_context_desc context = {.threads = 1, .log = count_failure, .log_user = host};
    const shb_map_desc desc = {.view = probe_orthographic(false), .width = SIZE};
    CHECK_INT(shb_context_create(&context, &host->context), SHB_OK);
    CHECK_INT(shb_map_wrap(host->context, &desc, host->texels, 0, holds, &host->map), SHB_OK);
}

static void close_noise(noise *host) {
    shb_map_destroy(host->map);
    shb_context_destroy(host->context);
}

enum { POINTS = 1000 };

/* Positions and normals, six floats each. */
static void random_points(float *interleaved) {
    test_random random = {5};
    for (int i = 0; i < POINTS; i++) {
        for (int k = 0; k < 3; k++)
            interleaved[6 * i + k] = (float)random_double(&random, -1.1, 1.1);
        const shb_vec3 n = shb_vec3_normalize((shb_vec3){random_double(&random, -1, 1),
                                                         random_double(&random, -1, 1),
                                                         random_double(&random, -1, 1)});
        interleaved[6 * i + 3] = (float)n.x;
        interleaved[6 * i + 4] = (float)n.y;
        interleaved[6 * i + 5] = (float)n.z;
    }
}

TEST(visibility_does_not_depend_on_the_count) {
    static float data[6 * POINTS];
    random_points(data);
    size_t method_count;
    const shb_bias_method *methods = shb_bias_methods(&method_count);
    for (size_t m = 0; m < method_count; m++) {
        const shb_bias bias = methods[m].make();
        if (bias.needs & SHB_NEEDS_OCCLUDERS)
            continue; /* wrapped maps keep no occluders */
        noise host;
        open_noise(&host, &bias);
        float single[POINTS];
        int lit = 0;
        for (int i = 0; i < POINTS; i++) {
            const shb_points one = {
                .count = 1, .positions = data + 6 * i, .normals = data + 6 * i + 3};
            CHECK_INT(shb_map_visibility(host.map, &one, &bias, NULL, &single[i]), SHB_OK);
            lit += single[i] == 1;
        }
        CHECK(lit > POINTS / 4 && lit < POINTS * 3 / 4);
        const size_t counts[] = {0, 1, 15, 16, 17, 255, 256, 257, 512, 1000};
        for (int c = 0; c < 10; c++) {
            float together[POINTS + 1];
            for (int i = 0; i <= POINTS; i++)
                together[i] = -5;
            const shb_points all = {.count = counts[c],
                                    .positions = data,
                                    .position_stride = 24,
                                    .normals = data + 3,
                                    .normal_stride = 24};
            CHECK_INT(shb_map_visibility(host.map, &all, &bias, NULL, together), SHB_OK);
            CHECK(memcmp(together, single, counts[c] * sizeof *single) == 0);
            CHECK(together[counts[c]] == -5);
        }
        close_noise(&host);
    }
}

TEST(points_come_in_any_stride) {
    static float data[6 * POINTS], expected[POINTS];
    random_points(data);
    const shb_bias bias = shb_bias_adaptive(1e-4f, 0);
    noise host;
    open_noise(&host, NULL);
    const shb_points tight = {.count = POINTS,
                              .positions = data,
                              .position_stride = 24,
                              .normals = data + 3,
                              .normal_stride = 24};
    CHECK_INT(shb_map_visibility(host.map, &tight, &bias, NULL, expected), SHB_OK);
    const size_t strides[] = {12, 16, 20, 44, 0};
    for (int p = 0; p < 5; p++)
        for (int n = 0; n < 5; n++) {
            const size_t position_step = strides[p] ? strides[p] / 4 : 3;
            const size_t normal_step = strides[n] ? strides[n] / 4 : 3;
            /* exactly as long as needed: reading on past the last point is caught by a sanitizer */
            float *positions = malloc(((POINTS - 1) * position_step + 3) * sizeof(float));
            float *normals = malloc(((POINTS - 1) * normal_step + 3) * sizeof(float));
            for (size_t i = 0; i < POINTS; i++) {
                memcpy(positions + i * position_step, data + 6 * i, 12);
                memcpy(normals + i * normal_step, data + 6 * i + 3, 12);
            }
            const shb_points points = {.count = POINTS,
                                       .positions = positions,
                                       .position_stride = strides[p],
                                       .normals = normals,
                                       .normal_stride = strides[n]};
            float seen[POINTS];
            CHECK_INT(shb_map_visibility(host.map, &points, &bias, NULL, seen), SHB_OK);
            CHECK(memcmp(seen, expected, sizeof expected) == 0);
            free(positions);
            free(normals);
        }
    close_noise(&host);
}

/* A method of the host: lifts the point by user[0], then takes user[1] off the depth. */
static void lift(const shb_bias_args *args) {
    const float *amounts = args->bias->user;
    for (size_t i = 0; i < args->count; i++)
        args->receivers->z[i] += amounts[0];
}

static void take_off(const shb_bias_args *args) {
    const float *amounts = args->bias->user;
    shb_receivers *r = args->receivers;
    CHECK(args->map->width == SIZE && args->map->height == SIZE);
    for (size_t i = 0; i < args->count; i++) {
        r->ref[i] = r->depth[i] - amounts[1];
        r->step_x[i] = r->step_y[i] = 0;
    }
}

/* A filter of the host: how far the fragment lies behind the stored depth. */
static void distance_behind(const shb_filter_args *args) {
    const shb_receivers *r = args->receivers;
    float stored[SHB_BATCH];
    CHECK(args->info == shb_map_get_info(args->map));
    CHECK(args->count == 1);
    CHECK((uintptr_t)args->visibility % 64 == 0);
    shb_map_fetch(args->map, args->count, r->texel_x, r->texel_y, stored);
    for (size_t i = 0; i < args->count; i++)
        args->visibility[i] = (r->ref[i] - stored[i]) * args->filter->params[0];
}

/* z 0.5 lifted by 0.25 has depth (4 - 0.75) / 8 = 0.40625; 1/32 less is 0.375. */
TEST(hosts_plug_in_methods_and_filters) {
    const float amounts[] = {0.25f, 0.03125f};
    const shb_bias bias = {.name = "own", .offset = lift, .depth = take_off, .user = amounts};
    const shb_filter filter = {.name = "own", .filter = distance_behind, .params = {8}};
    noise host;
    open_noise(&host, NULL);
    host.texels[3 * SIZE + 12] = 0.125f; /* column 12: x 0.5 .. 0.625; row 3: y 0.5 .. 0.625 */
    const float position[] = {0.5625f, 0.5625f, 0.5f};
    const shb_points points = {.count = 1, .positions = position};
    float visibility;
    CHECK_INT(shb_map_visibility(host.map, &points, &bias, &filter, &visibility), SHB_OK);
    CHECK_NEAR(visibility, 0.25 * 8, 0);
    close_noise(&host);
}

/* Leaves nothing in the batch that a later question could use by mistake. */
static void poison(const shb_bias_args *args) {
    memset(args->receivers, 0xff, sizeof *args->receivers); /* NaN */
}

static void write_ref(const shb_filter_args *args) {
    const shb_receivers *r = args->receivers;
    for (size_t i = 0; i < args->count; i++)
        args->visibility[i] = r->ref[i] + r->step_x[i] + r->step_y[i];
}

TEST(methods_name_all_that_they_need) {
    static float data[6 * POINTS];
    random_points(data);
    const shb_points points = {.count = 200,
                               .positions = data,
                               .position_stride = 24,
                               .normals = data + 3,
                               .normal_stride = 24};
    const shb_bias poisonous = {.name = "poison", .depth = poison};
    const shb_filter filter = {.name = "ref", .filter = write_ref};
    const shb_filter hard = shb_filter_hard();
    size_t count;
    const shb_bias_method *methods = shb_bias_methods(&count);
    for (size_t m = 0; m < count; m++) {
        const shb_bias bias = methods[m].make();
        if (bias.needs & SHB_NEEDS_OCCLUDERS)
            continue; /* has no stages, and wrapped maps keep no occluders */
        shb_bias greedy = bias;
        greedy.needs |= SHB_NEEDS_NORMAL | SHB_NEEDS_SCALE | SHB_NEEDS_SLOPE;
        noise plain, own;
        open_noise(&plain, NULL);
        open_noise(&own, &bias);
        float expected[200], seen[200];
        CHECK_INT(shb_map_visibility(own.map, &points, &greedy, &filter, expected), SHB_OK);
        CHECK_INT(shb_map_visibility(plain.map, &points, &poisonous, &hard, seen), SHB_OK);
        CHECK_INT(shb_map_visibility(own.map, &points, &bias, &filter, seen), SHB_OK);
        test_check(memcmp(seen, expected, sizeof seen) == 0, __FILE__, __LINE__,
                   "%s needs more than it says", bias.name);
        close_noise(&plain);
        close_noise(&own);
    }
}

static void check_lanes(const shb_bias_args *args) {
    const shb_receivers *r = args->receivers;
    CHECK(args->count == 5);
    for (size_t i = args->count; i < 16; i++) {
        CHECK(r->x[i] == r->x[4] && r->y[i] == r->y[4] && r->z[i] == r->z[4]);
        CHECK(r->normal_x[i] == r->normal_x[4] && r->cosine[i] == r->cosine[4]);
        CHECK(r->texel_size[i] == r->texel_size[4] && r->depth[i] == r->depth[4]);
        CHECK(r->slope_x[i] == r->slope_x[4] && r->texel_x[i] == r->texel_x[4]);
    }
    memcpy(args->receivers->ref, r->depth, sizeof r->depth);
}

TEST(lanes_after_the_count_repeat_the_last_fragment) {
    static float data[6 * POINTS];
    random_points(data);
    const shb_bias bias = {.name = "lanes",
                           .depth = check_lanes,
                           .needs = SHB_NEEDS_NORMAL | SHB_NEEDS_SCALE | SHB_NEEDS_SLOPE};
    noise host;
    open_noise(&host, NULL);
    for (size_t stride = 12; stride <= 24; stride += 12) {
        const shb_points points = {.count = 5,
                                   .positions = data,
                                   .position_stride = stride,
                                   .normals = stride == 12 ? data + 3 * POINTS : data + 3,
                                   .normal_stride = stride};
        float visibility[5];
        CHECK_INT(shb_map_visibility(host.map, &points, &bias, NULL, visibility), SHB_OK);
    }
    close_noise(&host);
}

/* Every refusal logs one sentence and leaves the output alone. */
static void refuse(noise *host, const shb_points *points, const shb_bias *bias,
                   const shb_filter *filter, shb_result expected) {
    float visibility[2] = {-1, -2};
    host->failures = 0;
    host->logged = SHB_OK;
    CHECK_INT(shb_map_visibility(host->map, points, bias, filter, visibility), expected);
    CHECK_INT(host->failures, 1);
    CHECK_INT(host->logged, expected);
    CHECK(visibility[0] == -1 && visibility[1] == -2);
}

TEST(visibility_refuses_what_it_cannot_answer) {
    const float position[] = {0, 0, 0, 0, 0, 0, 0};
    const shb_points good = {.count = 2, .positions = position, .normals = position};
    const shb_bias none = shb_bias_none();
    const shb_filter nothing = {.name = "nothing"};
    noise host;
    open_noise(&host, NULL);
    refuse(&host, NULL, &none, NULL, SHB_ERROR_ARGUMENT);
    refuse(&host, &good, NULL, NULL, SHB_ERROR_ARGUMENT);
    refuse(&host, &good, &none, &nothing, SHB_ERROR_ARGUMENT);
    shb_points bad = good;
    bad.positions = NULL;
    refuse(&host, &bad, &none, NULL, SHB_ERROR_ARGUMENT);
    bad = good;
    bad.position_stride = 13;
    refuse(&host, &bad, &none, NULL, SHB_ERROR_ARGUMENT);
    bad.position_stride = 8; /* triples would overlap */
    refuse(&host, &bad, &none, NULL, SHB_ERROR_ARGUMENT);
    bad = good;
    bad.normal_stride = 2;
    refuse(&host, &bad, &none, NULL, SHB_ERROR_ARGUMENT);
    bad = good;
    bad.normals = (const float *)(const void *)((const char *)position + 2);
    refuse(&host, &bad, &none, NULL, SHB_ERROR_ARGUMENT);
    bad = good;
    bad.own.ids = (const uint32_t *)(const void *)((const char *)position + 1);
    refuse(&host, &bad, &none, NULL, SHB_ERROR_ARGUMENT);
    shb_bias unknown = none;
    unknown.needs = 32;
    refuse(&host, &good, &unknown, NULL, SHB_ERROR_ARGUMENT);
    host.failures = 0;
    CHECK_INT(shb_map_visibility(host.map, &good, &none, NULL, NULL), SHB_ERROR_ARGUMENT);
    CHECK_INT(host.failures, 1);
    float visibility;
    CHECK_INT(shb_map_visibility(NULL, &good, &none, NULL, &visibility), SHB_ERROR_ARGUMENT);
    close_noise(&host);
}

TEST(visibility_refuses_points_beyond_the_reach_of_a_pointer) {
    const float position[] = {0, 0, 0};
    const shb_points good = {.count = 2, .positions = position, .normals = position};
    const shb_bias none = shb_bias_none();
    noise host;
    open_noise(&host, NULL);
    shb_points bad = good;
    bad.position_stride = SIZE_MAX - 3;
    refuse(&host, &bad, &none, NULL, SHB_ERROR_SIZE);
    bad = good;
    bad.normal_stride = SIZE_MAX / 2 - 3;
    refuse(&host, &bad, &none, NULL, SHB_ERROR_SIZE);
    bad = good;
    bad.count = SIZE_MAX;
    refuse(&host, &bad, &none, NULL, SHB_ERROR_SIZE);
    close_noise(&host);
}

TEST(visibility_refuses_missing_normals) {
    const float position[] = {0, 0, 0};
    const shb_points points = {.count = 1, .positions = position};
    const shb_bias needing[] = {shb_bias_slope(1, 1, 0),         shb_bias_angle(1, 1),
                                shb_bias_normal_offset(1, 0),    shb_bias_receiver_plane(0),
                                shb_bias_texel_cone(),           shb_bias_adaptive(1, 1),
                                shb_bias_adaptive_soft(1, 1, 1), {.needs = SHB_NEEDS_SLOPE}};
    const shb_bias free_of_them[] = {shb_bias_none(), shb_bias_constant(1, SHB_UNIT_DEPTH),
                                     shb_bias_constant(1, SHB_UNIT_WORLD)};
    noise host;
    open_noise(&host, NULL);
    for (int i = 0; i < 8; i++)
        refuse(&host, &points, &needing[i], NULL, SHB_ERROR_UNSUPPORTED);
    float visibility;
    for (int i = 0; i < 3; i++)
        CHECK_INT(shb_map_visibility(host.map, &points, &free_of_them[i], NULL, &visibility),
                  SHB_OK);
    /* no points, no normals */
    const shb_points nothing = {0};
    CHECK_INT(shb_map_visibility(host.map, &nothing, &needing[0], NULL, &visibility), SHB_OK);
    close_noise(&host);
}

static void keep_second(const shb_bias *bias, size_t count, const float *nearest,
                        const float *second, float *combined) {
    (void)bias;
    (void)nearest;
    memmove(combined, second, count * sizeof *combined);
}

TEST(visibility_refuses_a_map_that_holds_something_else) {
    const float position[] = {0, 0, 0};
    const shb_points points = {.count = 1, .positions = position};
    const int one = 1, other = 2;
    const shb_bias kinds[] = {shb_bias_none(),
                              shb_bias_midpoint(),
                              shb_bias_dual_layer(0.01f),
                              shb_bias_dual_layer(0.02f),
                              shb_bias_back_face(),
                              {.name = "own", .combine = keep_second, .user = &one},
                              {.combine = keep_second, .user = &other},
                              {.combine = keep_second, .user = &one, .needs = SHB_NEEDS_FLIPPED}};
    for (int held = 0; held < 8; held++) {
        noise host;
        open_noise(&host, &kinds[held]);
        for (int asked = 0; asked < 8; asked++) {
            float visibility = -1;
            if (asked != held)
                refuse(&host, &points, &kinds[asked], NULL, SHB_ERROR_UNSUPPORTED);
            else
                CHECK_INT(shb_map_visibility(host.map, &points, &kinds[asked], NULL, &visibility),
                          SHB_OK);
        }
        close_noise(&host);
    }
}

/* Methods that need nothing of the map share one; their parameters do not matter to it. */
TEST(methods_of_the_receiver_share_a_map) {
    const float position[] = {0, 0, 0}, normal[] = {0, 0, 1};
    const shb_points points = {.count = 1, .positions = position, .normals = normal};
    const shb_bias held = shb_bias_constant(0.5f, SHB_UNIT_DEPTH);
    const shb_bias asked[] = {shb_bias_none(), shb_bias_constant(0.25f, SHB_UNIT_DEPTH),
                              shb_bias_adaptive(1e-4f, 0), shb_bias_texel_cone()};
    noise host;
    open_noise(&host, &held);
    for (int i = 0; i < 4; i++) {
        float visibility = -1;
        CHECK_INT(shb_map_visibility(host.map, &points, &asked[i], NULL, &visibility), SHB_OK);
        CHECK(visibility == 0 || visibility == 1);
    }
    close_noise(&host);
}
