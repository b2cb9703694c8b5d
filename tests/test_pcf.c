/* Filters of boxes of texels against a slow tap-by-tap reference, on maps and receivers that no
 * scene should have. */
#include "../src/poisson.h"

#include "contexts.h"
#include "isas.h"
#include "probe.h"
#include "random.h"
#include "shadowbias/shadowbias.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { POINTS = 300 };

typedef struct asked_map {
    shb_context *context;
    shb_map *map;
    float *texels;
} asked_map;

static shb_view view_of(bool spot, bool reversed) {
    return spot ? probe_perspective(reversed) : probe_orthographic(reversed);
}

static float random_depth(test_random *random) {
    static const float odd[] = {NAN, INFINITY, -INFINITY, 0, 1, -1, 2, 0.5f, -0.0f};
    const uint32_t choice = random_below(random, 40);
    return choice < 9 ? odd[choice] : (float)random_double(random, 0.3, 0.7);
}

static asked_map open_map(shb_isa isa, shb_view view, shb_format format, uint32_t width,
                          uint32_t height) {
    asked_map made;
    made.context = test_context(1, isa);
    const size_t texel = format == SHB_FORMAT_UNORM16 ? 2 : 4;
    made.texels = malloc(texel * width * height); /* no byte beyond the last row */
    test_random random = {width + 3 * height};
    for (uint32_t i = 0; i < width * height; i++) {
        const float depth = random_depth(&random);
        const double size = depth >= 0 && depth <= 1 ? (double)depth : 1;
        const uint32_t wide = (uint32_t)(size * 0xffffff);
        const uint16_t narrow = (uint16_t)(size * 0xffff);
        const void *bytes = format == SHB_FORMAT_FLOAT32   ? (const void *)&depth
                            : format == SHB_FORMAT_UNORM24 ? (const void *)&wide
                                                           : (const void *)&narrow;
        memcpy((char *)made.texels + texel * i, bytes, texel);
    }
    const shb_map_desc map = {.view = view, .width = width, .height = height, .format = format};
    CHECK_INT(shb_map_wrap(made.context, &map, made.texels, 0, NULL, &made.map), SHB_OK);
    return made;
}

static void close_map(asked_map *made) {
    shb_map_destroy(made->map);
    shb_context_destroy(made->context);
    free(made->texels);
}

/* Points in the map, around it, behind the light, and no points at all. */
static void random_points(float *positions, float *normals, uint64_t seed) {
    test_random random = {seed};
    for (int i = 0; i < 3 * POINTS; i++) {
        positions[i] = (float)random_double(&random, -1.2, 1.2);
        normals[i] = (float)random_double(&random, -1, 1);
    }
    positions[0] = NAN;
    positions[3] = INFINITY;
    positions[8] = 50;
    positions[9] = -3e38f;
    for (int i = 0; i < POINTS / 8; i++) { /* runs that touch each other's boxes */
        positions[24 * i + 3] = positions[24 * i] + 0.01f;
        positions[24 * i + 4] = positions[24 * i + 1];
    }
}

/* A method that writes planes of all kinds. */
static void write_wild_planes(const shb_bias_args *args) {
    static const float odd[] = {NAN, INFINITY, -INFINITY, 3e38f, -3e38f, 0, -0.0f, 1e-40f};
    shb_receivers *r = args->receivers;
    test_random random = {99};
    for (size_t i = 0; i < args->count; i++) {
        const uint32_t choice = random_below(&random, 30);
        r->ref[i] = choice < 8 ? odd[choice] : r->depth[i];
        r->step_x[i] = (float)random_double(&random, -0.1, 0.1);
        r->step_y[i] = choice >= 8 && choice < 16 ? odd[choice - 8] : r->step_x[i];
        if (choice == 20)
            r->step_x[i] = INFINITY;
    }
}

/* Where the n columns nearest to a fragment begin. */
static int first_of(int texel, float to_center, int n) {
    return n % 2 ? texel - (n - 1) / 2 : texel - n / 2 + (to_center < 0 ? 1 : 0);
}

static int rounded_size(float size, int least) {
    const double n = floor((double)size + 0.5);
    return n >= least ? n <= 63 ? (int)n : 63 : least;
}

static int size_of(const shb_filter_args *args, size_t i, int least) {
    const float *params = args->filter->params;
    const bool world = params[1] == SHB_UNIT_WORLD;
    return rounded_size(world ? params[0] / args->receivers->texel_size[i] : params[0], least);
}

static bool is_lit(const shb_filter_args *args, float taps, size_t i, int32_t x, int32_t y) {
    const shb_receivers *r = args->receivers;
    const bool own = taps == SHB_TAPS_OWN;
    const float m = (float)(x - r->texel_x[i]), n = (float)(y - r->texel_y[i]);
    const float across = m * (own ? 0 : r->step_x[i]), down = n * (own ? 0 : r->step_y[i]);
    const float tap = (r->ref[i] + across) + down;
    float stored;
    shb_map_fetch(args->map, 1, &x, &y, &stored);
    return !(stored < tap && stored < (args->info->view.reversed ? 0 : 1));
}

static void slow_pcf(const shb_filter_args *args) {
    const shb_receivers *r = args->receivers;
    for (size_t i = 0; i < args->count; i++) {
        const int n = size_of(args, i, 1);
        const int left = first_of(r->texel_x[i], r->to_center_x[i], n);
        const int top = first_of(r->texel_y[i], r->to_center_y[i], n);
        int lit = 0;
        for (int k = 0; k < n * n; k++)
            lit += is_lit(args, args->filter->params[2], i, left + k % n, top + k / n);
        args->visibility[i] = (float)((double)lit / (n * n));
    }
}

/* What a box of n - 1 texels around place, 0 .. 1 in its own texel, covers of texel k. */
static double covered(double place, int n, int k) {
    const double half = (n - 1) / 2.0;
    return fmax(0, fmin(k + 1, place + half) - fmax(k, place - half));
}

static void slow_smooth(const shb_filter_args *args) {
    const shb_receivers *r = args->receivers;
    for (size_t i = 0; i < args->count; i++) {
        const int n = size_of(args, i, 2);
        const double x = 0.5 - (double)r->to_center_x[i], y = 0.5 - (double)r->to_center_y[i];
        double lit = 0;
        for (int row = -n; row <= n; row++)
            for (int column = -n; column <= n; column++) {
                const double weight = covered(x, n, column) * covered(y, n, row);
                if (weight > 0)
                    lit += weight * is_lit(args, args->filter->params[2], i, r->texel_x[i] + column,
                                           r->texel_y[i] + row);
            }
        args->visibility[i] = (float)(lit / ((n - 1) * (n - 1)));
    }
}

/* In floats, as the contract of reproducible taps has it: place, then whole texel. */
static bool is_lit_at(const shb_filter_args *args, float taps, size_t i, float dx, float dy) {
    const shb_receivers *r = args->receivers;
    const float x = floorf((0.5f - r->to_center_x[i]) + dx);
    const float y = floorf((0.5f - r->to_center_y[i]) + dy);
    return is_lit(args, taps, i, r->texel_x[i] + (int)x, r->texel_y[i] + (int)y);
}

static float reach_of(const shb_filter_args *args, size_t i, float reach, float unit) {
    const float wide = unit == SHB_UNIT_WORLD ? reach / args->receivers->texel_size[i] : reach;
    return fminf(wide, 16384);
}

static void slow_poisson(const shb_filter_args *args) {
    const shb_receivers *r = args->receivers;
    const float *p = args->filter->params;
    for (size_t i = 0; i < args->count; i++) {
        const uint32_t turn = shb_position_hash(r->x[i], r->y[i], r->z[i]) % 64;
        const float reach = reach_of(args, i, p[1], p[2]);
        const float cosine = reach * (shb_poisson_turns[turn][0] / 16384.0f);
        const float sine = reach * (shb_poisson_turns[turn][1] / 16384.0f);
        int lit = 0;
        for (int k = 0; k < (int)p[0]; k++) {
            const float x = shb_poisson_disk[k][0] / 16384.0f;
            const float y = shb_poisson_disk[k][1] / 16384.0f;
            const float xx = cosine * x, xy = sine * y, yx = sine * x, yy = cosine * y;
            lit += is_lit_at(args, p[3], i, xx - xy, yx + yy);
        }
        args->visibility[i] = (float)((double)lit / (double)p[0]);
    }
}

/* A linear congruential sequence from the hash on; its upper two bytes are the place in the cell.
 */
static void slow_jittered(const shb_filter_args *args) {
    const shb_receivers *r = args->receivers;
    const float *p = args->filter->params;
    for (size_t i = 0; i < args->count; i++) {
        uint32_t hash = shb_position_hash(r->x[i], r->y[i], r->z[i]);
        const float cell = reach_of(args, i, p[0] / 2, p[1]) / 2;
        int lit = 0;
        for (int k = 0; k < 16; k++) {
            hash = 1664525u * hash + 1013904223u;
            const float x = (float)(k % 4 - 2) + (float)(hash >> 24) / 256;
            const float y = (float)(k / 4 - 2) + (float)(hash >> 16 & 255) / 256;
            lit += is_lit_at(args, p[2], i, cell * x, cell * y);
        }
        args->visibility[i] = (float)lit / 16;
    }
}

static void ask(const asked_map *made, const float *positions, const float *normals, size_t count,
                const shb_bias *bias, const shb_filter *filter, float *visibility) {
    const shb_points points = {.count = count, .positions = positions, .normals = normals};
    CHECK_INT(shb_map_visibility(made->map, &points, bias, filter, visibility), SHB_OK);
}

/* Infinite if there is one that is no number. */
static double largest_difference(const float *a, const float *b, size_t count) {
    double largest = 0;
    for (size_t i = 0; i < count; i++) {
        const double difference = fabs((double)a[i] - (double)b[i]);
        if (isnan(difference))
            return HUGE_VAL;
        largest = difference > largest ? difference : largest;
    }
    return largest;
}

/* All maps hold the same; they have to give the same bits, and what the slow way gives. Two batches
 * of the first methods, so that none finds what it needs where the one before left it. */
static void check_filter(const asked_map *maps, int map_count, const shb_filter *filter,
                         shb_filter_fn *slow, double tolerance) {
    static float positions[3 * POINTS], normals[3 * POINTS];
    const shb_bias biases[] = {shb_bias_constant(0.001f, SHB_UNIT_DEPTH),
                               shb_bias_receiver_plane(1e-4f),
                               {.name = "wild", .depth = write_wild_planes}};
    shb_filter slowly = *filter;
    slowly.filter = slow;
    random_points(positions, normals, 5);
    for (int b = 0; b < 3; b++) {
        float expected[POINTS], first[POINTS], actual[POINTS];
        const size_t count = b < 2 ? POINTS : POINTS / 2 + 3;
        ask(&maps[0], positions, normals, count, &biases[b], &slowly, expected);
        ask(&maps[0], positions, normals, count, &biases[b], filter, first);
        const double worst = largest_difference(first, expected, count);
        test_check(worst <= tolerance, __FILE__, __LINE__, "%s %g %g %g by bias %d: off by %g",
                   filter->name, (double)filter->params[0], (double)filter->params[1],
                   (double)filter->params[2], b, worst);
        for (int k = 1; k < map_count; k++) {
            ask(&maps[k], positions, normals, count, &biases[b], filter, actual);
            CHECK(memcmp(first, actual, count * sizeof *first) == 0);
        }
    }
}

/* The same map for every instruction set. */
typedef struct isa_maps {
    asked_map maps[SHB_ISA_COUNT];
    int count;
} isa_maps;

static isa_maps open_maps(bool spot, bool reversed, shb_format format, uint32_t width,
                          uint32_t height) {
    isa_maps made = {.count = 0};
    for (shb_isa isa = SHB_ISA_SCALAR; isa < SHB_ISA_COUNT; isa = test_isa_after(isa))
        made.maps[made.count++] = open_map(isa, view_of(spot, reversed), format, width, height);
    return made;
}

static void close_maps(isa_maps *made) {
    for (int i = 0; i < made->count; i++)
        close_map(&made->maps[i]);
}

static void check_isas(bool spot, bool reversed, shb_format format, uint32_t width, uint32_t height,
                       const float *sizes, int size_count) {
    isa_maps made = open_maps(spot, reversed, format, width, height);
    for (int k = 0; k < size_count; k++) {
        const shb_unit unit = sizes[k] < 0 ? SHB_UNIT_WORLD : SHB_UNIT_TEXEL;
        const shb_taps taps = k % 3 == 2 ? SHB_TAPS_OWN : SHB_TAPS_PLANE;
        const shb_filter box = shb_filter_pcf(fabsf(sizes[k]), unit, taps);
        const shb_filter smooth = shb_filter_pcf_smooth(fabsf(sizes[k]), unit, taps);
        check_filter(made.maps, made.count, &box, slow_pcf, 0);
        check_filter(made.maps, made.count, &smooth, slow_smooth, 2e-6);
    }
    close_maps(&made);
}

TEST(pcf_agrees_with_tap_by_tap_reading_for_every_size_and_isa) {
    const float sizes[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 16, 19};
    check_isas(false, false, SHB_FORMAT_FLOAT32, 64, 41, sizes, 12);
    check_isas(true, true, SHB_FORMAT_FLOAT32, 64, 41, sizes, 12);
}

TEST(pcf_agrees_with_tap_by_tap_reading_in_world_units) {
    const float sizes[] = {-0.1f, -0.3f, -1e-9f, -1e9f, -0.5f};
    check_isas(false, true, SHB_FORMAT_FLOAT32, 90, 60, sizes, 4);
    check_isas(true, false, SHB_FORMAT_FLOAT32, 90, 60, sizes, 5);
}

TEST(pcf_agrees_with_tap_by_tap_reading_in_every_format) {
    const float sizes[] = {5, 2, 11, 20};
    check_isas(false, false, SHB_FORMAT_UNORM24, 50, 50, sizes, 4);
    check_isas(true, true, SHB_FORMAT_UNORM24, 50, 50, sizes, 4);
    check_isas(true, false, SHB_FORMAT_UNORM16, 50, 50, sizes, 4);
    check_isas(false, true, SHB_FORMAT_UNORM16, 50, 50, sizes, 4);
}

TEST(pcf_agrees_with_tap_by_tap_reading_in_small_maps) {
    const float sizes[] = {1, 5, 4, 33, 62, 2};
    check_isas(false, false, SHB_FORMAT_FLOAT32, 1, 1, sizes, 6);
    check_isas(false, true, SHB_FORMAT_FLOAT32, 7, 1, sizes, 6);
    check_isas(true, false, SHB_FORMAT_UNORM16, 1, 9, sizes, 6);
    check_isas(true, false, SHB_FORMAT_FLOAT32, 17, 17, sizes, 6);
}

TEST(pcf_limits_sizes_that_make_no_sense) {
    const float sizes[] = {0, -0.0f, 0.4f, 1.5f, 63.4f, 1e30f, NAN, INFINITY};
    asked_map made = open_map(SHB_ISA_BEST, view_of(false, false), SHB_FORMAT_FLOAT32, 30, 30);
    for (int i = 0; i < 8; i++) {
        const shb_filter box = shb_filter_pcf(sizes[i], SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
        const shb_filter smooth = shb_filter_pcf_smooth(sizes[i], SHB_UNIT_DEPTH, SHB_TAPS_PLANE);
        check_filter(&made, 1, &box, slow_pcf, 0);
        check_filter(&made, 1, &smooth, slow_smooth, 2e-6);
    }
    close_map(&made);
}

/* A box of a single texel is the hard filter. */
TEST(pcf_of_one_texel_is_hard) {
    static float positions[3 * POINTS], normals[3 * POINTS];
    random_points(positions, normals, 6);
    asked_map made = open_map(SHB_ISA_BEST, view_of(true, false), SHB_FORMAT_FLOAT32, 40, 40);
    const shb_bias bias = shb_bias_receiver_plane(1e-5f);
    const shb_filter hard = shb_filter_hard();
    const shb_filter box = shb_filter_pcf(1, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
    float expected[POINTS], actual[POINTS];
    ask(&made, positions, normals, POINTS, &bias, &hard, expected);
    ask(&made, positions, normals, POINTS, &bias, &box, actual);
    CHECK(memcmp(expected, actual, sizeof expected) == 0);
    close_map(&made);
}

static void move_by_place(const shb_bias_args *args) {
    shb_receivers *r = args->receivers;
    for (size_t i = 0; i < args->count; i++) {
        r->x[i] += r->to_center_x[i];
        r->y[i] += r->to_center_y[i];
    }
}

static void deepen_by_place(const shb_bias_args *args) {
    shb_receivers *r = args->receivers;
    for (size_t i = 0; i < args->count; i++) {
        r->ref[i] = r->depth[i] + 0.1f * r->to_center_x[i];
        r->step_x[i] = r->step_y[i] = 0;
    }
}

/* Boxes of odd numbers of texels lie the same wherever in its texel a point does, but what a host's
 * own method makes of that counts. */
TEST(pcf_goes_by_what_methods_make_of_places_in_texels) {
    static float positions[3 * POINTS], normals[3 * POINTS];
    random_points(positions, normals, 7);
    asked_map made = open_map(SHB_ISA_BEST, view_of(false, false), SHB_FORMAT_FLOAT32, 40, 40);
    const shb_bias biases[] = {{.offset = move_by_place}, {.depth = deepen_by_place}};
    const shb_filter box = shb_filter_pcf(5, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
    shb_filter slowly = box;
    slowly.filter = slow_pcf;
    float expected[POINTS], actual[POINTS];
    for (int b = 0; b < 2; b++) {
        ask(&made, positions, normals, POINTS, &biases[b], &slowly, expected);
        ask(&made, positions, normals, POINTS, &biases[b], &box, actual);
        CHECK(memcmp(expected, actual, sizeof expected) == 0);
    }
    close_map(&made);
}

static void fill(const asked_map *made, float depth) {
    const shb_map_info *info = shb_map_get_info(made->map);
    for (uint32_t i = 0; i < info->width * info->height; i++)
        made->texels[i] = depth;
}

/* Depths of 0 shadow every tap, far depths none; so do no sizes round to anything else. */
TEST(pcf_of_all_taps_is_exactly_lit_or_dark) {
    asked_map made = open_map(SHB_ISA_BEST, view_of(false, false), SHB_FORMAT_FLOAT32, 100, 100);
    const shb_bias none = shb_bias_none();
    for (int n = 1; n <= 63; n++) {
        const shb_filter filters[] = {
            shb_filter_pcf((float)n, SHB_UNIT_TEXEL, SHB_TAPS_PLANE),
            shb_filter_pcf_smooth((float)n, SHB_UNIT_TEXEL, SHB_TAPS_OWN)};
        const float position[3] = {0.123f, 0.0456f, 0};
        for (int k = 0; k < 2; k++) {
            float lit, dark;
            fill(&made, 1);
            ask(&made, position, NULL, 1, &none, &filters[k], &lit);
            fill(&made, 0);
            ask(&made, position, NULL, 1, &none, &filters[k], &dark);
            CHECK(lit == 1 && dark == 0);
        }
    }
    close_map(&made);
}

/* Every stored value of 16 bits, and values of 24 bits around those where rounding could differ,
 * against a fragment at the very depth that shb_map_fetch gives, which is lit, and at the next one,
 * which is not. */
TEST(pcf_decodes_unorm_depths_to_the_bits_of_fetch) {
    const shb_format formats[] = {SHB_FORMAT_UNORM16, SHB_FORMAT_UNORM24};
    for (int f = 0; f < 2; f++) {
        asked_map made = open_map(SHB_ISA_BEST, view_of(false, false), formats[f], 1, 1);
        const uint32_t end = f ? 0xffffff : 0xffff;
        const uint32_t step = f ? 4099 : 13;
        int wrong = 0;
        for (uint32_t value = 0; value < end; value += step) {
            const uint16_t narrow = (uint16_t)value;
            memcpy(made.texels, f ? (const void *)&value : (const void *)&narrow, f ? 4 : 2);
            const int32_t at = 0;
            float depth, visibility[2];
            shb_map_fetch(made.map, 1, &at, &at, &depth);
            shb_receivers r = {.ref = {depth, nextafterf(depth, 2)}};
            const shb_filter box = shb_filter_pcf(1, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
            SHB_ALIGN float seen[SHB_BATCH];
            const shb_filter_args args = {.count = 2,
                                          .filter = &box,
                                          .map = made.map,
                                          .info = shb_map_get_info(made.map),
                                          .receivers = &r,
                                          .visibility = seen};
            box.filter(&args);
            visibility[0] = seen[0], visibility[1] = seen[1];
            wrong += visibility[0] != 1 || visibility[1] != 0;
        }
        CHECK_INT(wrong, 0);
        close_map(&made);
    }
}

static void check_scattered(bool spot, bool reversed, shb_format format, uint32_t size) {
    const shb_filter disks[] = {shb_filter_poisson(1, 5, SHB_UNIT_TEXEL, SHB_TAPS_PLANE),
                                shb_filter_poisson(16, 3, SHB_UNIT_TEXEL, SHB_TAPS_PLANE),
                                shb_filter_poisson(25, 0.2f, SHB_UNIT_WORLD, SHB_TAPS_OWN),
                                shb_filter_poisson(256, 40, SHB_UNIT_DEPTH, SHB_TAPS_PLANE),
                                shb_filter_poisson(7, 1e30f, SHB_UNIT_TEXEL, SHB_TAPS_PLANE)};
    const shb_filter grids[] = {shb_filter_jittered(4, SHB_UNIT_TEXEL, SHB_TAPS_PLANE),
                                shb_filter_jittered(11.5f, SHB_UNIT_TEXEL, SHB_TAPS_OWN),
                                shb_filter_jittered(0.4f, SHB_UNIT_WORLD, SHB_TAPS_PLANE),
                                shb_filter_jittered(1e30f, SHB_UNIT_WORLD, SHB_TAPS_PLANE)};
    isa_maps made = open_maps(spot, reversed, format, size, size);
    for (size_t i = 0; i < sizeof disks / sizeof *disks; i++)
        check_filter(made.maps, made.count, &disks[i], slow_poisson, 0);
    for (size_t i = 0; i < sizeof grids / sizeof *grids; i++)
        check_filter(made.maps, made.count, &grids[i], slow_jittered, 0);
    close_maps(&made);
}

TEST(scattered_taps_agree_with_tap_by_tap_reading) {
    check_scattered(false, false, SHB_FORMAT_FLOAT32, 64);
    check_scattered(true, true, SHB_FORMAT_FLOAT32, 64);
    check_scattered(true, false, SHB_FORMAT_UNORM16, 33);
    check_scattered(false, true, SHB_FORMAT_UNORM24, 1);
}

TEST(scattered_taps_without_reach_are_hard) {
    static float positions[3 * POINTS], normals[3 * POINTS];
    random_points(positions, normals, 8);
    asked_map made = open_map(SHB_ISA_BEST, view_of(true, false), SHB_FORMAT_FLOAT32, 40, 40);
    const shb_bias bias = shb_bias_receiver_plane(1e-5f);
    const shb_filter hard = shb_filter_hard();
    const shb_filter filters[] = {shb_filter_poisson(0, 9, SHB_UNIT_TEXEL, SHB_TAPS_PLANE),
                                  shb_filter_poisson(16, 0, SHB_UNIT_TEXEL, SHB_TAPS_PLANE),
                                  shb_filter_poisson(NAN, NAN, SHB_UNIT_WORLD, SHB_TAPS_PLANE),
                                  shb_filter_poisson(9, -1, SHB_UNIT_WORLD, SHB_TAPS_PLANE),
                                  shb_filter_jittered(0, SHB_UNIT_TEXEL, SHB_TAPS_PLANE),
                                  shb_filter_jittered(NAN, SHB_UNIT_TEXEL, SHB_TAPS_PLANE)};
    float expected[POINTS], actual[POINTS];
    ask(&made, positions, normals, POINTS, &bias, &hard, expected);
    for (int i = 0; i < 6; i++) {
        ask(&made, positions, normals, POINTS, &bias, &filters[i], actual);
        CHECK(memcmp(expected, actual, sizeof expected) == 0);
    }
    close_map(&made);
}

/* A map lit on the left of column 32 and dark on its right. A disk in its middle is half lit; a box
 * of 20 texels whose middle is 2.5 texels to the right of the edge, which runs through the cells
 * there, is lit by 7.5 / 20. Neighbours take other turns and places. */
TEST(scattered_taps_share_an_edge) {
    asked_map made = open_map(SHB_ISA_BEST, view_of(false, false), SHB_FORMAT_FLOAT32, 64, 64);
    for (int i = 0; i < 64 * 64; i++)
        made.texels[i] = i % 64 < 32 ? 1 : 0;
    const shb_bias none = shb_bias_none();
    const shb_filter filters[] = {shb_filter_poisson(64, 10, SHB_UNIT_TEXEL, SHB_TAPS_PLANE),
                                  shb_filter_jittered(20, SHB_UNIT_TEXEL, SHB_TAPS_PLANE)};
    const double shares[] = {0.5, 0.375};
    for (int k = 0; k < 2; k++) {
        float positions[3 * 64] = {0}, seen[64];
        double sum = 0;
        int changes = 0;
        for (int i = 0; i < 64; i++) {
            positions[3 * i] = k ? 2.5f / 32 : 0;
            positions[3 * i + 1] = (float)(i - 32) / 100;
        }
        ask(&made, positions, NULL, 64, &none, &filters[k], seen);
        for (int i = 0; i < 64; i++) {
            CHECK_NEAR(seen[i], shares[k], 0.26);
            sum += (double)seen[i] / 64;
            changes += i && seen[i] != seen[i - 1];
        }
        CHECK_NEAR(sum, shares[k], 0.03);
        CHECK(changes > 20);
    }
    close_map(&made);
}
