/* Percentage-closer soft shadows: penumbras worked out on paper, and a slow search in double. */
#include "contexts.h"
#include "oracle.h"
#include "probe.h"
#include "random.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE = 64 };

typedef struct host_map {
    shb_context *context;
    shb_map *map;
    uint32_t width, height;
    bool reversed;
    float *texels;
} host_map;

static host_map open_map(shb_view view, uint32_t width, uint32_t height) {
    host_map host = {.width = width, .height = height, .reversed = view.reversed, .texels = NULL};
    host.texels = malloc((size_t)width * height * sizeof *host.texels);
    host.context = test_context(1, SHB_ISA_BEST);
    const shb_map_desc desc = {.view = view, .width = width, .height = height, .scene_scale = 1};
    CHECK_INT(shb_map_wrap(host.context, &desc, host.texels, 0, NULL, &host.map), SHB_OK);
    return host;
}

static void close_map(host_map *host) {
    shb_map_destroy(host->map);
    shb_context_destroy(host->context);
    free(host->texels);
}

/* depth is that of a standard map. */
static void put(host_map *host, uint32_t x, uint32_t y, double depth) {
    host->texels[y * host->width + x] = (float)(host->reversed ? 1 - depth : depth);
}

static void fill(host_map *host, double depth) {
    for (uint32_t y = 0; y < host->height; y++)
        for (uint32_t x = 0; x < host->width; x++)
            put(host, x, y, depth);
}

/* The left half is nearer, or the upper one. */
static void fill_halves(host_map *host, double depth, double other, bool upper) {
    for (uint32_t y = 0; y < host->height; y++)
        for (uint32_t x = 0; x < host->width; x++)
            put(host, x, y, (upper ? y < host->height / 2 : x < host->width / 2) ? depth : other);
}

static double ask(const host_map *host, const shb_filter *filter, double x, double y, double z) {
    const float position[3] = {(float)x, (float)y, (float)z}, normal[3] = {0, 0, 1};
    const shb_points points = {.count = 1, .positions = position, .normals = normal};
    const shb_bias none = shb_bias_none();
    float visibility = -1;
    CHECK_INT(shb_map_visibility(host->map, &points, &none, filter, &visibility), SHB_OK);
    return (double)visibility;
}

static double limited(double value) {
    return value < 0 ? 0 : value > 1 ? 1 : value;
}

/* Map depth is (4 - z) / 8 and the map 2 wide. An edge at z = 1 over a floor at z = 0, light 0.5
 * wide at distance one: the penumbra is 0.5 wide, and lit in proportion to the way through it. */
TEST(a_directional_light_gives_the_penumbra_of_its_angle) {
    const shb_filter filter = shb_filter_pcss(0.5f, 0, 0, SHB_TAPS_PLANE);
    for (int i = 0; i < 4; i++) {
        const bool upper = i & 1, reversed = i & 2;
        host_map host = open_map(probe_orthographic(reversed), SIZE, SIZE);
        fill_halves(&host, 0.375, 0.5, upper);
        for (double way = -0.35; way < 0.35; way += 0.0131) {
            const double lit = limited((way + 0.25) / 0.5);
            const double given =
                upper ? ask(&host, &filter, 0.003, -way, 0) : ask(&host, &filter, way, 0.003, 0);
            CHECK_NEAR(given, lit, 2e-5);
        }
        close_map(&host);
    }
}

/* A host's depths may lie before the near plane, z = 4: they block as if they lay on it, where the
 * light, 0.1 wide at distance one, gives a penumbra of 0.4. */
TEST(what_lies_before_the_near_plane_has_the_penumbra_of_that_plane) {
    const shb_taps taps[] = {SHB_TAPS_PLANE, SHB_TAPS_NAIVE};
    for (int i = 0; i < 4; i++) {
        const shb_filter filter = shb_filter_pcss(0.1f, 0, 0, taps[i / 2]);
        host_map host = open_map(probe_orthographic(i & 1), SIZE, SIZE);
        fill_halves(&host, -3, 0.5, false);
        for (double way = -0.3; way < 0.3; way += 0.0131)
            CHECK_NEAR(ask(&host, &filter, way, 0.003, 0), limited((way + 0.2) / 0.4), 2e-5);
        close_map(&host);
    }
}

/* The same where texels are four times as high as wide. */
TEST(a_penumbra_has_its_width_on_both_axes_of_a_map) {
    const shb_filter filter = shb_filter_pcss(0.5f, 0, 0, SHB_TAPS_PLANE);
    for (int upper = 0; upper < 2; upper++) {
        host_map host = open_map(probe_orthographic(false), SIZE, SIZE / 4);
        fill_halves(&host, 0.375, 0.5, upper);
        for (double way = -0.35; way < 0.35; way += 0.0131) {
            const double given =
                upper ? ask(&host, &filter, 0.003, -way, 0) : ask(&host, &filter, way, 0.003, 0);
            CHECK_NEAR(given, limited((way + 0.25) / 0.5), 2e-5);
        }
        close_map(&host);
    }
}

/* A light at (0, 0, 4) that looks down: depth is 1.5 - 1.5 / w with w = 4 - z. An edge at w = 1.5,
 * a floor at w = 2.5, light 0.4 wide: the penumbra on the floor is (2.5 - 1.5) / 1.5 * 0.4. */
TEST(a_point_light_gives_the_penumbra_of_similar_triangles) {
    const shb_filter filter = shb_filter_pcss(0.4f, 0, 0, SHB_TAPS_PLANE);
    const double penumbra = 0.4 / 1.5;
    for (int reversed = 0; reversed < 2; reversed++) {
        host_map host = open_map(probe_perspective(reversed), SIZE, SIZE);
        fill_halves(&host, 0.5, 0.9, false);
        for (double way = -0.2; way < 0.2; way += 0.0071)
            CHECK_NEAR(ask(&host, &filter, way, 0.01, 1.5), limited(way / penumbra + 0.5), 2e-5);
        close_map(&host);
    }
}

/* The same turned about (1, 2, 3) together with the light, whose axis is no axis of the world. */
TEST(a_turned_light_gives_the_same_penumbra) {
    const shb_filter filter = shb_filter_pcss(0.4f, 0, 0, SHB_TAPS_PLANE);
    const shb_mat4 turn = shb_mat4_rotation((shb_vec3){1, 2, 3}, 2);
    const shb_mat4 back = shb_mat4_rotation((shb_vec3){1, 2, 3}, -2);
    shb_view view = probe_perspective(false);
    view.clip_from_world = shb_mat4_multiply(view.clip_from_world, back);
    host_map host = open_map(view, SIZE, SIZE);
    fill_halves(&host, 0.5, 1, false);
    for (double way = -0.2; way < 0.2; way += 0.0071) {
        const shb_vec3 p = shb_mat4_transform_point(turn, (shb_vec3){way, 0.01, 1.5});
        CHECK_NEAR(ask(&host, &filter, p.x, p.y, p.z), limited(1.5 * way / 0.4 + 0.5), 2e-5);
    }
    close_map(&host);
}

/* The mean over many fragments of taps on a disk: a chord cuts its share off. The width is that of
 * the first test: radius 0.25. */
TEST(taps_on_a_disk_give_the_same_penumbra_on_average) {
    const shb_filter filter = shb_filter_pcss(0.5f, 25, 25, SHB_TAPS_PLANE);
    host_map host = open_map(probe_orthographic(false), SIZE, SIZE);
    fill_halves(&host, 0.375, 0.5, false);
    for (double way = -0.3; way < 0.31; way += 0.05) {
        const double t = way / 0.25;
        const double shadowed = t >= 1    ? 0
                                : t <= -1 ? 1
                                          : (acos(t) - t * sqrt(1 - t * t)) / acos(-1);
        double sum = 0;
        for (int i = 0; i < 400; i++)
            sum += ask(&host, &filter, way, -0.3 + i * 0.0015, 0);
        CHECK_NEAR(sum / 400, 1 - shadowed, 0.02);
    }
    CHECK(ask(&host, &filter, 0.3, 0, 0) == 1);
    CHECK(ask(&host, &filter, -0.3, 0, 0) == 0);
    close_map(&host);
}

static const shb_filter *both_kinds(int index) {
    static shb_filter filters[2];
    filters[0] = shb_filter_pcss(0.5f, 0, 0, SHB_TAPS_PLANE);
    filters[1] = shb_filter_pcss(0.5f, 16, 32, SHB_TAPS_OWN);
    return &filters[index];
}

TEST(without_a_blocker_a_fragment_is_lit) {
    for (int i = 0; i < 4; i++) {
        host_map host = open_map(probe_orthographic(i & 1), SIZE, SIZE);
        fill(&host, 1);
        CHECK(ask(&host, both_kinds(i / 2), 0.1, 0.2, 0) == 1);
        fill(&host, 0.5);
        CHECK(ask(&host, both_kinds(i / 2), 0.1, 0.2, 0) == 1);
        CHECK(ask(&host, both_kinds(i / 2), 0.1, 0.2, -100) < 0.9);
        fill(&host, 1);
        CHECK(ask(&host, both_kinds(i / 2), 0.1, 0.2, -100) == 1);
        close_map(&host);
    }
}

TEST(where_every_tap_is_blocked_a_fragment_is_dark) {
    for (int i = 0; i < 4; i++) {
        host_map host = open_map(probe_orthographic(i & 1), SIZE, SIZE);
        fill(&host, 0.375);
        CHECK(ask(&host, both_kinds(i / 2), 0.1, 0.2, 0) == 0);
        close_map(&host);
    }
}

/* The kernel is 0.5 wide; at x = 0.875 a quarter of it lies beyond the map. */
TEST(what_lies_beyond_the_edge_of_the_map_is_lit) {
    host_map host = open_map(probe_orthographic(false), SIZE, SIZE);
    fill(&host, 0.375);
    CHECK_NEAR(ask(&host, both_kinds(0), 0.875, 0, 0), 0.25, 1e-6);
    CHECK_NEAR(ask(&host, both_kinds(0), 0.1, -0.875, 0), 0.25, 1e-6);
    CHECK_NEAR(ask(&host, both_kinds(0), -0.875, 0.875, 0), 1 - 0.75 * 0.75, 1e-6);
    const double disk = ask(&host, both_kinds(1), 0.99, 0.1, 0);
    CHECK(disk > 0.25 && disk < 0.75);
    for (int i = 0; i < 2; i++) {
        CHECK(ask(&host, both_kinds(i), 1.01, 0, 0) == 1);
        CHECK(ask(&host, both_kinds(i), 0, -1.01, 0) == 1);
        CHECK(ask(&host, both_kinds(i), nan(""), 0, 0) == 1);
        CHECK(ask(&host, both_kinds(i), 0, HUGE_VAL, 0) == 1);
    }
    close_map(&host);
}

/* A light without width, or a blocker that touches: a square of one texel. The fragment lies a
 * quarter of a texel to the left of the edge between texels. */
TEST(the_narrowest_kernel_is_one_texel) {
    host_map host = open_map(probe_orthographic(false), SIZE, SIZE);
    const float sizes[] = {0, -1, NAN};
    fill_halves(&host, 0.375, 0.5, false);
    for (int i = 0; i < 3; i++) {
        const shb_filter filter = shb_filter_pcss(sizes[i], 0, 0, SHB_TAPS_PLANE);
        CHECK_NEAR(ask(&host, &filter, -0.25 / 32, 0.01, 0), 0.25, 1e-5);
        CHECK(ask(&host, &filter, -0.51 / 32, 0.01, 0) == 0);
        CHECK(ask(&host, &filter, 0.51 / 32, 0.01, 0) == 1);
    }
    fill_halves(&host, 0.4999999, 0.5, false);
    CHECK_NEAR(ask(&host, both_kinds(0), -0.25 / 32, 0.01, 0), 0.25, 1e-5);
    close_map(&host);
}

/* A light so wide that the search spans far more than the map. */
TEST(the_widest_kernels_stay_defined) {
    const float sizes[] = {1e3f, 1e9f, 3e38f, INFINITY};
    host_map host = open_map(probe_orthographic(false), SIZE, SIZE);
    fill(&host, 0.375);
    for (int i = 0; i < 4; i++)
        for (int taps = 0; taps < 300; taps += 75) {
            const shb_filter filter = shb_filter_pcss(sizes[i], taps, taps, SHB_TAPS_PLANE);
            const double lit = ask(&host, &filter, 0.1, 0.1, 0);
            CHECK(lit >= 0 && lit <= 1 && (i == 0 || lit > 0.98));
        }
    close_map(&host);
}

/* Squares of more than 126 texels: the same as 64 taps on the disk. */
static void check_wide_squares(shb_taps taps) {
    enum { WIDE = 512 };
    host_map host = open_map(probe_orthographic(false), WIDE, WIDE);
    test_random random = {5};
    for (uint32_t y = 0; y < WIDE; y++)
        for (uint32_t x = 0; x < WIDE; x++)
            put(&host, x, y, random_double(&random, 0.3, 0.6));
    const shb_filter squares = shb_filter_pcss(0.5f, 0, 0, taps);
    const shb_filter disks = shb_filter_pcss(0.5f, 64, 64, taps);
    const shb_filter search_disk = shb_filter_pcss(0.5f, 64, 0, taps);
    const shb_filter narrow = shb_filter_pcss(0.115f, 0, 0, taps);
    const shb_filter narrow_disks = shb_filter_pcss(0.115f, 64, 0, taps);
    bool differs = false; /* a search 118 texels wide */
    for (int i = 0; i < 20; i++) {
        const double x = random_double(&random, -0.3, 0.3), y = random_double(&random, -0.3, 0.3);
        /* Search 4 * 0.5 * 256 texels wide, penumbra about 0.4 * 0.5 * 256. */
        CHECK(ask(&host, &squares, x, y, 0) == ask(&host, &search_disk, x, y, 0));
        /* Seen from the far plane, both are wide. */
        CHECK(ask(&host, &squares, x, y, -28) == ask(&host, &disks, x, y, -28));
        differs |= ask(&host, &narrow, x, y, 0) != ask(&host, &narrow_disks, x, y, 0);
    }
    CHECK(differs);
    close_map(&host);
}

TEST(squares_that_are_too_wide_are_disks) {
    check_wide_squares(SHB_TAPS_PLANE);
    check_wide_squares(SHB_TAPS_NAIVE);
}

/* The view with the world's unit changed; powers of two change no bit. */
static shb_view scaled_view(shb_view view, double scale) {
    for (int i = 0; i < 12; i++)
        view.clip_from_world.m[i] /= scale;
    return view;
}

TEST(a_larger_world_gives_the_same_bits) {
    for (int i = 0; i < 4; i++) {
        const bool spot = i & 1, reversed = i & 2;
        const shb_view view = spot ? probe_perspective(reversed) : probe_orthographic(reversed);
        for (int power = -20; power <= 20; power += 10) {
            const double scale = ldexp(1, power);
            host_map one = open_map(view, SIZE, SIZE);
            host_map other = open_map(scaled_view(view, scale), SIZE, SIZE);
            test_random random = {9};
            for (uint32_t y = 0; y < SIZE; y++)
                for (uint32_t x = 0; x < SIZE; x++) {
                    const double depth = random_double(&random, 0.2, 1);
                    put(&one, x, y, depth);
                    put(&other, x, y, depth);
                }
            const double size = spot ? scale : 1;
            const shb_filter filter = shb_filter_pcss(0.25f, 0, 0, SHB_TAPS_PLANE);
            const shb_filter larger = shb_filter_pcss((float)(0.25 * size), 0, 0, SHB_TAPS_PLANE);
            for (int k = 0; k < 10; k++) {
                const double x = oracle_float(random_double(&random, -0.8, 0.8));
                const double y = oracle_float(random_double(&random, -0.8, 0.8)), z = 1.5;
                CHECK(ask(&one, &filter, x, y, z) ==
                      ask(&other, &larger, x * scale, y * scale, z * scale));
            }
            close_map(&one);
            close_map(&other);
        }
    }
}

/* What a filter is given, kept for the reference. */
static void keep_receivers(const shb_filter_args *args) {
    *(shb_receivers *)(uintptr_t)args->filter->user = *args->receivers;
    for (size_t i = 0; i < args->count; i++)
        args->visibility[i] = 1;
}

/* Distance along the light's axis, from the light or from any place. */
static double distance_of(bool spot, double depth) {
    return spot ? 1.5 / (1.5 - depth) : 8 * depth;
}

static double width_of_penumbra(bool spot, double light_size, double fragment, double blocker) {
    const double behind = distance_of(spot, fragment) - distance_of(spot, blocker);
    return spot ? behind / distance_of(spot, blocker) * light_size : behind * light_size;
}

typedef struct slow_stage {
    double blocked, penumbra, all;
} slow_stage;

/* Every texel, over the overlap of its square with the kernel's. Depths are standard ones. */
static slow_stage ask_slowly(const host_map *host, const shb_receivers *r, bool spot,
                             double light_size, double width) {
    const double own = host->reversed ? (double)r->depth[0] + 1 : (double)r->depth[0];
    const double texel = (spot ? 2 * distance_of(spot, own) : 2) / SIZE;
    const double half = fmax(width / texel / 2, 0.5);
    const double x = r->texel_x[0] + 0.5 - (double)r->to_center_x[0];
    const double y = r->texel_y[0] + 0.5 - (double)r->to_center_y[0];
    slow_stage stage = {0, 0, 4 * half * half};
    for (int row = 0; row < SIZE; row++)
        for (int column = 0; column < SIZE; column++) {
            const double w = fmin(column + 1, x + half) - fmax(column, x - half);
            const double h = fmin(row + 1, y + half) - fmax(row, y - half);
            const double stored = (double)host->texels[row * SIZE + column];
            const double canonical = host->reversed ? -stored : stored;
            const double plane = (double)r->ref[0] +
                                 (column - r->texel_x[0]) * (double)r->step_x[0] +
                                 (row - r->texel_y[0]) * (double)r->step_y[0];
            if (w <= 0 || h <= 0 || canonical >= plane || canonical >= (host->reversed ? 0 : 1))
                continue;
            const double depth = host->reversed ? canonical + 1 : canonical;
            stage.blocked += w * h;
            stage.penumbra += w * h * width_of_penumbra(spot, light_size, own, depth);
        }
    return stage;
}

static double slow_visibility(const host_map *host, const shb_receivers *r, bool spot,
                              double light_size) {
    const double own = host->reversed ? (double)r->depth[0] + 1 : (double)r->depth[0];
    const slow_stage search =
        ask_slowly(host, r, spot, light_size, width_of_penumbra(spot, light_size, own, 0));
    if (search.blocked == 0)
        return 1;
    const slow_stage filter =
        ask_slowly(host, r, spot, light_size, search.penumbra / search.blocked);
    return 1 - filter.blocked / filter.all;
}

TEST(every_texel_searched_equals_a_slow_search_in_double) {
    test_random random = {21};
    for (int i = 0; i < 4; i++) {
        const bool spot = i & 1, reversed = i & 2;
        host_map host =
            open_map(spot ? probe_perspective(reversed) : probe_orthographic(reversed), SIZE, SIZE);
        for (uint32_t y = 0; y < SIZE; y++)
            for (uint32_t x = 0; x < SIZE; x++)
                put(&host, x, y,
                    random_below(&random, 3) ? random_double(&random, 0.5, 1.1)
                                             : random_double(&random, 0.1, 0.5));
        const float light_size = spot ? 0.4f : 0.1f;
        const shb_filter filter = shb_filter_pcss(light_size, 0, 0, SHB_TAPS_PLANE);
        const shb_bias plane = shb_bias_receiver_plane(1e-4f);
        for (int k = 0; k < 100; k++) {
            const float position[3] = {
                (float)random_double(&random, -1, 1), (float)random_double(&random, -1, 1),
                (float)(spot ? random_double(&random, 1.2, 2.5) : random_double(&random, -1, 1))};
            const float normal[3] = {(float)random_double(&random, -0.5, 0.5),
                                     (float)random_double(&random, -0.5, 0.5), 1};
            const shb_points points = {.count = 1, .positions = position, .normals = normal};
            shb_receivers receivers;
            const shb_filter keep = {.filter = keep_receivers, .user = &receivers};
            float given = -1;
            CHECK_INT(shb_map_visibility(host.map, &points, &plane, &keep, &given), SHB_OK);
            CHECK_INT(shb_map_visibility(host.map, &points, &plane, &filter, &given), SHB_OK);
            CHECK_NEAR(given, slow_visibility(&host, &receivers, spot, (double)light_size), 2e-4);
        }
        close_map(&host);
    }
}

/* The plane of a tilted floor cut anew for every tap, against its steps from texel to texel; half
 * of the points lie in the first or the last row of the map. */
TEST(naive_taps_find_the_shadow_of_the_plane) {
    test_random random = {4};
    for (int i = 0; i < 4; i++) {
        const bool spot = i & 1;
        const int taps = i & 2 ? 25 : 0;
        host_map host =
            open_map(spot ? probe_perspective(true) : probe_orthographic(false), SIZE, SIZE);
        for (uint32_t y = 0; y < SIZE; y++)
            for (uint32_t x = 0; x < SIZE; x++)
                put(&host, x, y, random_double(&random, 0.1, 1));
        const shb_filter plane = shb_filter_pcss(0.2f, taps, taps, SHB_TAPS_PLANE);
        const shb_filter naive = shb_filter_pcss(0.2f, taps, taps, SHB_TAPS_NAIVE);
        const shb_bias bias = shb_bias_receiver_plane(1e-3f);
        for (int k = 0; k < 40; k++) {
            const double x = random_double(&random, -1.2, 1.2), y = random_double(&random, -1, 1);
            const double z = random_double(&random, 1.2, 2), w = spot ? 4 - z : 1;
            const double edge = (y < 0 ? -1 : 1) * (1 - 1.0 / SIZE);
            const float position[3] = {(float)(x * w), (float)((k % 2 ? edge : y) * w), (float)z};
            const float normal[3] = {0.36f, -0.48f, 0.8f};
            const shb_points points = {.count = 1, .positions = position, .normals = normal};
            float given = -1, expected = -2;
            CHECK_INT(shb_map_visibility(host.map, &points, &bias, &plane, &expected), SHB_OK);
            CHECK_INT(shb_map_visibility(host.map, &points, &bias, &naive, &given), SHB_OK);
            CHECK_NEAR(given, expected, 1e-5);
        }
        close_map(&host);
    }
}

TEST(pcss_has_a_text_form) {
    shb_filter filter;
    CHECK_INT(shb_filter_parse("pcss", &filter), SHB_OK);
    const shb_filter expected = shb_filter_pcss(0.05f, 25, 25, SHB_TAPS_PLANE);
    CHECK(memcmp(filter.params, expected.params, sizeof filter.params) == 0);
    CHECK_INT(shb_filter_parse("pcss:light=0.5,blockers=16,samples=0,taps=1", &filter), SHB_OK);
    const shb_filter other = shb_filter_pcss(0.5f, 16, 0, SHB_TAPS_OWN);
    CHECK(memcmp(filter.params, other.params, sizeof filter.params) == 0);
    CHECK(filter.filter == other.filter && filter.needs == other.needs);
    CHECK_INT(shb_filter_parse("pcss:taps=2", &filter), SHB_OK);
    CHECK_INT(filter.needs, SHB_NEEDS_NORMAL | SHB_NEEDS_SAMPLES);
    CHECK_INT(shb_filter_parse("pcss:taps=3", &filter), SHB_ERROR_ARGUMENT);
}
