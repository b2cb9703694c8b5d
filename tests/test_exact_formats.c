/* Taps of the exact method by planes in maps of every format, before steep planes and on rough
 * surfaces: against the scalar test and sheets that are followed slowly. */
#include "../src/occluders.h"
#include "../src/poisson.h"
#include "../src/slopes.h"

#include "asked_map.h"
#include "probe.h"
#include "slow_taps.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>

/* What a filter lets through at a point by the scalar test. */
typedef double slow_filter(const shb_map *map, const asked_points *given, int i,
                           const shb_filter *filter);

static double lit_in_box(const shb_map *map, const asked_points *given, int i,
                         const shb_filter *filter, bool smooth) {
    shb_exact_fragment fragment;
    if (!asked_point_fragment(map, given, i, &fragment))
        return 1;
    return slow_lit_in_box(map, &fragment, (int)filter->params[0], smooth);
}

static double slow_pcf(const shb_map *map, const asked_points *given, int i,
                       const shb_filter *filter) {
    return lit_in_box(map, given, i, filter, false);
}

static double slow_pcf_smooth(const shb_map *map, const asked_points *given, int i,
                              const shb_filter *filter) {
    return lit_in_box(map, given, i, filter, true);
}

/* Taps at these places from the fragment on, texels, as far as reach on an axis: sheets lie in a
 * square around its own texel, none in one of more than 63 texels on a side. */
static double lit_at_places(const shb_map *map, const asked_points *given, int i, double reach,
                            float (*places)[2], int count) {
    const int side = (int)floor(reach) + 1;
    slow_box square = {0};
    shb_exact_fragment fragment;
    int lit = 0;
    if (!asked_point_fragment(map, given, i, &fragment))
        return 1;
    if (side <= SLOW_BOX_MAX / 2)
        square = slow_box_of(map, &fragment, 2 * side + 1);
    for (int k = 0; k < count; k++) {
        const int column = (int)floor(fragment.point.x + (double)places[k][0]);
        const int row = (int)floor(fragment.point.y + (double)places[k][1]);
        lit += slow_is_on_sheet(&square, column, row) ||
               !slow_tap_is_shadowed(map, &fragment, column, row);
    }
    return (double)lit / count;
}

static uint32_t hash_of_point(const asked_points *given, int i) {
    const float *p = given->positions + 3 * i;
    return shb_position_hash(p[0], p[1], p[2]);
}

static double slow_jittered(const shb_map *map, const asked_points *given, int i,
                            const shb_filter *filter) {
    const float cell = filter->params[0] / 4;
    uint32_t hash = hash_of_point(given, i);
    float places[16][2];
    for (int k = 0; k < 16; k++) {
        hash = 1664525u * hash + 1013904223u;
        places[k][0] = cell * ((float)(k % 4 - 2) + (float)(hash >> 24) / 256);
        places[k][1] = cell * ((float)(k / 4 - 2) + (float)(hash >> 16 & 255) / 256);
    }
    return lit_at_places(map, given, i, (double)filter->params[0] / 2, places, 16);
}

static double slow_poisson(const shb_map *map, const asked_points *given, int i,
                           const shb_filter *filter) {
    const int count = (int)filter->params[0];
    const int16_t *turn = shb_poisson_turns[hash_of_point(given, i) % SHB_POISSON_TURNS];
    const float cosine = filter->params[1] * (turn[0] / 16384.0f);
    const float sine = filter->params[1] * (turn[1] / 16384.0f);
    float places[SHB_POISSON_MAX][2];
    for (int k = 0; k < count; k++) {
        const float x = shb_poisson_disk[k][0] / 16384.0f, y = shb_poisson_disk[k][1] / 16384.0f;
        places[k][0] = cosine * x - sine * y;
        places[k][1] = sine * x + cosine * y;
    }
    return lit_at_places(map, given, i, (double)filter->params[1], places, count);
}

static bool has_unbounded_slopes(const shb_map *map) {
    bool found = false;
    for (int row = 0; row < (int)map->info.height; row++)
        for (uint32_t column = 0; column < map->info.width; column++)
            found |= shb_occluder_row(map, row)[column] == SHB_SLOPES_NONE;
    return found;
}

/* The first count points. Bounds that are taken for all taps at once may light one of a few. */
static void check_every_format(const shb_filter *filter, slow_filter *slow, int count) {
    soup s = {0};
    asked_scene_add(&s);
    asked_scene_add_relief(&s);
    asked_points *given = malloc(sizeof *given);
    asked_points_fill(&s, (uint64_t)filter->params[0], given);
    asked_scene_add_steep(&s);
    for (int format = SHB_FORMAT_FLOAT32; format <= SHB_FORMAT_UNORM16; format++)
        for (int reversed = 0; reversed < 2; reversed++) {
            const shb_map_desc desc = {.view = probe_orthographic(reversed != 0),
                                       .width = 90,
                                       .format = (shb_format)format,
                                       .occluders = SHB_OCCLUDERS_PLANES};
            asked_map made = asked_map_draw(SHB_ISA_BEST, &desc, &s);
            float seen[ASKED_POINTS];
            int darker = 0, lighter = 0;
            asked_map_ask(&made, given, filter, seen);
            for (int i = 0; i < count; i++) {
                const double lit = slow(made.map, given, i, filter);
                darker += (double)seen[i] < lit - 1e-5;
                lighter += (double)seen[i] > lit + 1e-5;
            }
            CHECK_INT(darker, 0);
            CHECK(lighter <= ASKED_POINTS / 100);
            CHECK(has_unbounded_slopes(made.map));
            asked_map_close(&made);
        }
    free(given);
    soup_free(&s);
}

static void check_box(int n, int count) {
    const shb_filter box = shb_filter_pcf((float)n, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
    check_every_format(&box, slow_pcf, count);
}

TEST(exact_boxes_agree_with_the_scalar_test_in_every_format) {
    check_box(4, ASKED_POINTS);
    check_box(5, ASKED_POINTS);
    check_box(11, ASKED_POINTS);
    check_box(16, ASKED_POINTS);
    check_box(19, ASKED_POINTS);
    check_box(48, 200);
    check_box(63, 200);
}

static void check_smooth(int n, int count) {
    const shb_filter smooth = shb_filter_pcf_smooth((float)n, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
    check_every_format(&smooth, slow_pcf_smooth, count);
}

TEST(smooth_exact_boxes_agree_with_the_scalar_test_in_every_format) {
    check_smooth(3, ASKED_POINTS);
    check_smooth(8, ASKED_POINTS);
    check_smooth(11, ASKED_POINTS);
    check_smooth(20, 200);
}

static void check_jittered(float size, int count) {
    const shb_filter grid = shb_filter_jittered(size, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
    check_every_format(&grid, slow_jittered, count);
}

TEST(exact_jittered_taps_agree_with_the_scalar_test_in_every_format) {
    check_jittered(5, ASKED_POINTS);
    check_jittered(13, ASKED_POINTS);
    check_jittered(14, ASKED_POINTS);
    check_jittered(61, 200);
    check_jittered(62, 200);
}

static void check_poisson(int taps, float radius, int count) {
    const shb_filter disk = shb_filter_poisson((float)taps, radius, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
    check_every_format(&disk, slow_poisson, count);
}

TEST(exact_taps_on_disks_agree_with_the_scalar_test_in_every_format) {
    check_poisson(16, 2.5f, ASKED_POINTS);
    check_poisson(1, 0, ASKED_POINTS);
    check_poisson(70, 6, ASKED_POINTS);
    check_poisson(64, 9, ASKED_POINTS);
    check_poisson(SHB_POISSON_MAX, 30.5f, 200);
}
