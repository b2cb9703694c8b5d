/* Filters over moments on maps of every kind: formats, tilted planes, threads, memory. */
#include "allocator.h"
#include "contexts.h"
#include "depth_map.h"
#include "isas.h"
#include "probe.h"
#include "random.h"
#include "soup.h"
#include "test.h"

#include <math.h>
#include <string.h>

static const char *const texts[] = {"variance",
                                    "exponential-variance",
                                    "moments",
                                    "variance-soft:light=0.02",
                                    "exponential-variance-soft:light=0.02",
                                    "moments-soft:light=0.02",
                                    "moments:size=63",
                                    "moments-soft:light=0.1"};

/* The first ones differ in more than their parameters. */
enum { KINDS = sizeof texts / sizeof *texts, FILTERS = 6, POINTS = 700 };

static shb_filter filter_of(int kind) {
    shb_filter filter = {0};
    CHECK_INT(shb_filter_parse(texts[kind], &filter), SHB_OK);
    return filter;
}

/* Depths in steps of 1/16 with noise; wider than the spans that rows are cut into. */
enum { WIDTH = 301, HEIGHT = 70 };

static void fill_depths(float *depths) {
    test_random random = {77};
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        const int place = i % WIDTH / 23 + i / WIDTH / 17;
        depths[i] = (float)(place % 4 * 0.25 + random_double(&random, 0, 0.05));
    }
}

static void fill_points(float *positions) {
    test_random random = {78};
    for (int i = 0; i < POINTS; i++) {
        positions[3 * i] = (float)random_double(&random, -1.01, 1.01);
        positions[3 * i + 1] = (float)random_double(&random, -1.01, 1.01);
        positions[3 * i + 2] = (float)random_double(&random, -4, 4);
    }
}

static void ask_all(const shb_context_desc *context, const shb_map_desc *desc,
                    const shb_filter *filter, float *visibility) {
    static float depths[WIDTH * HEIGHT];
    static float positions[3 * POINTS];
    fill_depths(depths);
    fill_points(positions);
    depth_map host = depth_map_open(context, desc, depths);
    depth_map_prepare(&host, filter);
    const shb_points points = {.count = POINTS, .positions = positions};
    const shb_bias none = shb_bias_none();
    CHECK_INT(shb_map_visibility(host.map, &points, &none, filter, visibility), SHB_OK);
    depth_map_close(&host);
}

TEST(prefiltered_bits_do_not_depend_on_instruction_set_or_threads) {
    static float expected[POINTS], visibility[POINTS];
    const shb_map_desc desc = {.view = probe_orthographic(true), .width = WIDTH, .height = HEIGHT};
    for (int kind = 0; kind < KINDS; kind++) {
        const shb_filter filter = filter_of(kind);
        ask_all(&(shb_context_desc){.threads = 1, .max_isa = SHB_ISA_SCALAR}, &desc, &filter,
                expected);
        for (shb_isa isa = test_isa_after(SHB_ISA_SCALAR); isa < SHB_ISA_COUNT;
             isa = test_isa_after(isa)) {
            const uint32_t threads = (uint32_t)isa % 3 + 1;
            ask_all(&(shb_context_desc){.threads = threads, .max_isa = isa}, &desc, &filter,
                    visibility);
            CHECK(memcmp(visibility, expected, sizeof expected) == 0);
        }
    }
}

/* 16 bits hold the depths within 2^-16, and few receivers lie that close to an occluder. */
TEST(prefiltered_formats_give_nearly_the_same) {
    static float expected[POINTS], visibility[POINTS];
    for (int kind = 0; kind < KINDS; kind++)
        for (int i = 0; i < 12; i++) {
            const shb_format format = (shb_format)(i / 4);
            const bool reversed = i & 1, spot = i & 2;
            const shb_map_desc desc = {.view = spot ? probe_perspective(reversed)
                                                    : probe_orthographic(reversed),
                                       .width = WIDTH,
                                       .height = HEIGHT,
                                       .format = format};
            const shb_map_desc plain = {.view = spot ? probe_perspective(false)
                                                     : probe_orthographic(false),
                                        .width = WIDTH,
                                        .height = HEIGHT};
            const shb_filter filter = filter_of(kind);
            ask_all(NULL, &plain, &filter, expected);
            ask_all(NULL, &desc, &filter, visibility);
            int different = 0, shadowed = 0;
            for (int k = 0; k < POINTS; k++) {
                different += fabsf(visibility[k] - expected[k]) > 0.01f;
                shadowed += visibility[k] < 0.5f;
            }
            CHECK(different <= POINTS / 100);
            CHECK(shadowed > POINTS / 20);
        }
}

/* A plane through the origin that falls by slope in x and half of it in y per unit, far larger than
 * what the light sees, and its normal. */
static void add_plane(soup *scene, double slope) {
    const float r = 2, z = (float)slope;
    soup_add_quad(scene, (float[]){-r, -r, -1.5f * r * z}, (float[]){r, -r, 0.5f * r * z},
                  (float[]){r, r, 1.5f * r * z}, (float[]){-r, r, -0.5f * r * z});
}

/* The least visibility of points on the plane, asked with the adaptive bias. */
static double darkest_on_plane(const shb_view *view, double slope, const shb_filter *filter) {
    static float positions[3 * POINTS], normals[3 * POINTS], visibility[POINTS];
    test_random random = {79};
    const shb_vec3 normal = shb_vec3_normalize((shb_vec3){-slope, -0.5 * slope, 1});
    for (int i = 0; i < POINTS; i++) {
        const double x = random_double(&random, -0.8, 0.8), y = random_double(&random, -0.8, 0.8);
        const double values[6] = {x, y, slope * x + 0.5 * slope * y, normal.x, normal.y, normal.z};
        for (int k = 0; k < 3; k++) {
            positions[3 * i + k] = (float)values[k];
            normals[3 * i + k] = (float)values[3 + k];
        }
    }
    soup scene = {0};
    add_plane(&scene, slope);
    shb_context *context = NULL;
    shb_map *map = NULL;
    const shb_bias adaptive = shb_bias_adaptive(1e-4f, 0);
    const shb_points points = {.count = POINTS, .positions = positions, .normals = normals};
    context = test_context(0, SHB_ISA_BEST);
    CHECK_INT(shb_map_create(context, &(shb_map_desc){.view = *view, .width = 128}, &map), SHB_OK);
    CHECK_INT(shb_map_draw(map, soup_scene(&scene), &adaptive, NULL), SHB_OK);
    CHECK_INT(shb_map_prepare(map, filter), SHB_OK);
    CHECK_INT(shb_map_visibility(map, &points, &adaptive, filter, visibility), SHB_OK);
    double darkest = 1;
    for (int i = 0; i < POINTS; i++)
        darkest = (double)visibility[i] < darkest ? (double)visibility[i] : darkest;
    soup_free(&scene);
    shb_map_destroy(map);
    shb_context_destroy(context);
    return darkest;
}

/* The bounds are exactly 1: the plane's own spread over the box is no occluder. */
TEST(tilted_planes_in_the_light_have_no_false_shadow) {
    const double slopes[] = {0, 0.1, 0.5, 1, 1.3};
    for (int i = 0; i < 5; i++)
        for (int kind = 0; kind < FILTERS; kind++) {
            const shb_filter filter = filter_of(kind);
            const shb_view parallel = probe_orthographic(i & 1), spot = probe_perspective(i & 1);
            CHECK(darkest_on_plane(&parallel, slopes[i], &filter) == 1);
            CHECK(darkest_on_plane(&spot, 0.4 * slopes[i], &filter) == 1);
            shb_filter wide = filter;
            wide.params[0] = kind < FILTERS / 2 ? 31 : 0.3f;
            CHECK(darkest_on_plane(&parallel, slopes[i], &wide) == 1);
        }
}

/* A failed preparation leaves the earlier one, and nothing leaks. */
TEST(prefiltered_maps_survive_every_lack_of_memory) {
    static float depths[WIDTH * HEIGHT];
    fill_depths(depths);
    for (int kind = 0; kind < FILTERS; kind++) {
        test_allocator memory = {0};
        const shb_context_desc context = {.allocator = test_allocator_hooks(&memory), .threads = 1};
        const shb_map_desc desc = {
            .view = probe_perspective(true), .width = WIDTH, .height = HEIGHT};
        depth_map host = depth_map_open(&context, &desc, depths);
        shb_filter first = filter_of(kind), second = first;
        second.params[0] = 9;
        depth_map_prepare(&host, &first);
        const size_t bytes = shb_map_get_info(host.map)->memory_bytes;
        const double before = depth_map_ask(&host, &first, 0.1, 0.1, 0.5);
        const size_t live = memory.live;
        int failures = 0;
        for (;; failures++) {
            memory.fail_at = memory.calls + (size_t)failures + 1;
            const shb_result result = shb_map_prepare(host.map, &second);
            if (result == SHB_OK)
                break;
            CHECK_INT(result, SHB_ERROR_MEMORY);
            CHECK_INT(memory.live, live);
            CHECK_INT(shb_map_get_info(host.map)->memory_bytes, bytes);
            CHECK(depth_map_ask(&host, &first, 0.1, 0.1, 0.5) == before);
        }
        CHECK(failures >= 2);
        memory.fail_at = 0;
        CHECK_INT(memory.live, live);
        CHECK_INT(shb_map_get_info(host.map)->memory_bytes, bytes);
        depth_map_close(&host);
        CHECK_INT(memory.live, 0);
    }
}

/* Texels and a border, two or four floats each, and little beside them; and for kernels of all
 * widths two whole levels, of a quarter as many boxes each the next, and bounds of depth. */
TEST(prefiltered_maps_tell_what_they_take) {
    static float depths[WIDTH * HEIGHT];
    const size_t floats[] = {2, 4, 4, 2, 4, 4};
    for (int kind = 0; kind < FILTERS; kind++) {
        const shb_map_desc desc = {
            .view = probe_orthographic(false), .width = WIDTH, .height = HEIGHT};
        depth_map host = depth_map_open(NULL, &desc, depths);
        const size_t before = shb_map_get_info(host.map)->memory_bytes;
        const shb_filter filter = filter_of(kind);
        depth_map_prepare(&host, &filter);
        const size_t texels = 4 * floats[kind] * (WIDTH + 2) * (HEIGHT + 2);
        const size_t bytes = shb_map_get_info(host.map)->memory_bytes - before;
        if (kind < FILTERS / 2)
            CHECK(bytes >= texels && bytes < texels + 512);
        else
            CHECK(bytes >= texels / 3 * 7 && bytes < texels / 2 * 5 + 4096);
        depth_map_close(&host);
    }
}

TEST(prefiltered_parameters_out_of_range_are_refused) {
    const struct {
        const char *text, *named;
    } cases[] = {{"variance:size=0", "size 0"},
                 {"variance:size=4", "size 4"},
                 {"variance:size=65", "size 65"},
                 {"variance:size=3.5", "size 3.5"},
                 {"variance:bleeding=-0.1", "bleeding -0.1"},
                 {"variance:bleeding=1", "bleeding 1"},
                 {"exponential-variance:positive=0", "positive 0"},
                 {"exponential-variance:positive=81", "positive 81"},
                 {"exponential-variance:negative=-1", "negative -1"},
                 {"exponential-variance:size=2", "size 2"},
                 {"exponential-variance:bleeding=2", "bleeding 2"},
                 {"moments:size=-1", "size -1"},
                 {"variance-soft:light=0", "light 0"},
                 {"variance-soft:bleeding=1", "bleeding 1"},
                 {"exponential-variance-soft:light=-1", "light -1"},
                 {"exponential-variance-soft:negative=81", "negative 81"},
                 {"exponential-variance-soft:positive=0", "positive 0"},
                 {"exponential-variance-soft:bleeding=-1", "bleeding -1"},
                 {"moments-soft:light=-2", "light -2"}};
    static const float depths[16];
    test_log log = {0};
    const shb_context_desc context = {.log = test_log_keep, .log_user = &log};
    depth_map host = depth_map_open(
        &context, &(shb_map_desc){.view = probe_orthographic(false), .width = 4}, depths);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        shb_filter filter;
        CHECK_INT(shb_filter_parse(cases[i].text, &filter), SHB_OK);
        CHECK_INT(shb_map_prepare(host.map, &filter), SHB_ERROR_ARGUMENT);
        CHECK(strstr(log.sentence, cases[i].named) != NULL);
    }
    shb_filter nan_size = shb_filter_moments(5);
    nan_size.params[0] = NAN;
    CHECK_INT(shb_map_prepare(host.map, &nan_size), SHB_ERROR_ARGUMENT);
    const shb_filter endless = shb_filter_moments_soft(HUGE_VALF);
    CHECK_INT(shb_map_prepare(host.map, &endless), SHB_ERROR_ARGUMENT);
    depth_map_close(&host);
}

TEST(prefiltered_maps_without_their_preparation_say_so_unless_that_would_not_help) {
    static const float depths[16];
    test_log log = {0};
    const shb_context_desc context = {.log = test_log_keep, .log_user = &log};
    depth_map host = depth_map_open(
        &context, &(shb_map_desc){.view = probe_orthographic(false), .width = 4}, depths);
    const shb_bias none = shb_bias_none(), exact = shb_bias_exact();
    const shb_filter filter = shb_filter_variance(5, 0);
    const float position[3] = {0};
    const shb_points points = {.count = 1, .positions = position, .normals = position};
    float visibility;
    CHECK_INT(shb_map_visibility(host.map, &points, &none, &filter, &visibility),
              SHB_ERROR_UNSUPPORTED);
    CHECK(strstr(log.sentence, "needs shb_map_prepare"));
    CHECK_INT(shb_map_visibility(host.map, &points, &exact, &filter, &visibility),
              SHB_ERROR_UNSUPPORTED);
    CHECK(strstr(log.sentence, "desc.occluders"));
    depth_map_close(&host);
}
