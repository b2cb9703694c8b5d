/* The exact method in both stages of percentage-closer soft shadows. */
#include "../src/poisson.h"

#include "asked_map.h"
#include "probe.h"
#include "slow_taps.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What a kernel holds: taps by the parts of texels that it covers. */
typedef struct slow_stage {
    double blocked, depth, all;
} slow_stage;

/* A fragment, what its search and filter ask about it, and the sheet that it stands on. */
typedef struct slow_soft {
    const shb_map *map;
    shb_exact_fragment fragment;
    int taps; /* on the disk; 0: every texel */
    double cosine, sine;
    slow_box sheet;
} slow_soft;

/* By the scalar test; depths are canonical. */
static void ask_texel(const slow_soft *soft, int column, int row, double weight,
                      slow_stage *stage) {
    const int32_t texel_x = column, texel_y = row;
    float depth;
    stage->all += weight;
    if (slow_is_on_sheet(&soft->sheet, column, row) ||
        !slow_tap_is_shadowed(soft->map, &soft->fragment, column, row))
        return;
    shb_map_fetch(soft->map, 1, &texel_x, &texel_y, &depth);
    stage->blocked += weight;
    stage->depth += weight * (double)depth;
}

/* Every texel of a square of this half width, or points of a disk with this radius. */
static slow_stage ask_slowly(const slow_soft *soft, double half) {
    const double x = soft->fragment.point.x, y = soft->fragment.point.y;
    slow_stage stage = {0, 0, 0};
    for (int k = 0; k < soft->taps; k++) {
        const double px = shb_poisson_disk[k][0] / 16384.0, py = shb_poisson_disk[k][1] / 16384.0;
        ask_texel(soft, (int)floor(x + half * (soft->cosine * px - soft->sine * py)),
                  (int)floor(y + half * (soft->sine * px + soft->cosine * py)), 1, &stage);
    }
    for (int row = (int)floor(y - half); !soft->taps && row < y + half; row++)
        for (int column = (int)floor(x - half); column < x + half; column++) {
            const double w = fmin(column + 1, x + half) - fmax(column, x - half);
            const double h = fmin(row + 1, y + half) - fmax(row, y - half);
            ask_texel(soft, column, row, w * h, &stage);
        }
    return stage;
}

/* By the penumbra in the world, for the probe's lights: parallel rays of 1 / 8 depth per unit, or a
 * spot with depth 1.5 - 1.5 / w; 2 units or 2 w are a map's width. */
static double half_width(const shb_map *map, bool spot, double light, double own, double blocker) {
    const double shift = map->info.view.reversed ? 1 : 0, size = map->info.width;
    const double w = 1.5 / (1.5 - own - shift), near_w = 1.5 / (1.5 - blocker - shift);
    const double width = spot ? (w - near_w) / near_w * light * size / (2 * w)
                              : 8 * (own - blocker) * light * size / 2;
    return fmax(width / 2, 0.5);
}

/* Sheets go through a square that holds the search's kernel, of 31 texels on a side at most. */
static slow_box sheet_of(const slow_soft *soft, double half) {
    return slow_box_of(soft->map, &soft->fragment, 2 * (int)fmin(floor(half + 1), 15) + 1);
}

static double slow_visibility(const asked_map *made, bool spot, const shb_filter *filter,
                              const asked_points *given, int i, bool sheets) {
    const float *p = given->positions + 3 * i;
    const int16_t *turn = shb_poisson_turns[shb_poisson_turn(p[0], p[1], p[2])];
    slow_soft soft = {.map = made->map,
                      .taps = (int)filter->params[1],
                      .cosine = turn[0] / 16384.0,
                      .sine = turn[1] / 16384.0};
    if (!asked_point_fragment(soft.map, given, i, &soft.fragment))
        return 1;
    const double light = (double)filter->params[0], size = soft.map->info.width;
    const double near_depth = soft.map->info.view.reversed ? -1 : 0;
    const shb_light_point *at = &soft.fragment.point;
    if (!(at->x >= 0 && at->y >= 0 && at->x < size && at->y < size))
        return 1;
    const double half = half_width(soft.map, spot, light, at->z, near_depth);
    if (sheets)
        soft.sheet = sheet_of(&soft, half);
    const slow_stage search = ask_slowly(&soft, half);
    if (search.blocked == 0)
        return 1;
    const slow_stage last =
        ask_slowly(&soft, half_width(soft.map, spot, light, at->z, search.depth / search.blocked));
    return 1 - last.blocked / last.all;
}

static void check_soft_against_scalar(bool spot, bool reversed, shb_occluders occluders,
                                      double light, int taps) {
    const shb_filter filter = shb_filter_pcss((float)light, taps, taps, SHB_TAPS_PLANE);
    soup s = {0};
    asked_scene_add(&s);
    if (occluders == SHB_OCCLUDERS_PLANES)
        asked_scene_add_relief(&s);
    if (spot)
        asked_scene_lift(&s);
    asked_points *given = malloc(sizeof *given);
    asked_points_fill(&s, 6, given);
    const shb_map_desc desc = {.view = spot ? probe_perspective(reversed)
                                            : probe_orthographic(reversed),
                               .width = 64,
                               .occluders = occluders};
    asked_map made = asked_map_draw(SHB_ISA_BEST, &desc, &s);
    float seen[ASKED_POINTS], prepared[ASKED_POINTS];
    asked_map_ask(&made, given, &filter, seen);
    CHECK_INT(shb_map_prepare(made.map, &filter), SHB_OK);
    asked_map_ask(&made, given, &filter, prepared);
    CHECK(memcmp(seen, prepared, sizeof seen) == 0);
    int different = 0, soft = 0, by_sheets = 0;
    for (int i = 0; i < ASKED_POINTS / 2; i++) {
        const double expected = slow_visibility(&made, spot, &filter, given, i, true);
        different += !(fabs((double)seen[i] - expected) < 1e-3);
        soft += expected > 0.05 && expected < 0.95;
        by_sheets += expected != slow_visibility(&made, spot, &filter, given, i, false);
    }
    CHECK(different <= ASKED_POINTS / 400);
    CHECK(soft > ASKED_POINTS / 30);
    CHECK(occluders != SHB_OCCLUDERS_PLANES || by_sheets > ASKED_POINTS / 100);
    asked_map_close(&made);
    free(given);
    soup_free(&s);
}

TEST(exact_soft_shadows_agree_with_a_slow_search_by_the_scalar_test) {
    check_soft_against_scalar(false, false, SHB_OCCLUDERS_PLANES, 0.1, 0);
    check_soft_against_scalar(true, true, SHB_OCCLUDERS_PLANES, 0.2, 0);
    check_soft_against_scalar(false, true, SHB_OCCLUDERS_TRIANGLES, 0.05, 0);
    check_soft_against_scalar(true, false, SHB_OCCLUDERS_TRIANGLES, 0.1, 0);
}

/* Sheets lie in squares of 17 to 31 texels on a side, and no more for a larger light. */
TEST(exact_soft_shadows_of_large_lights_agree_with_a_slow_search) {
    check_soft_against_scalar(false, true, SHB_OCCLUDERS_PLANES, 0.2, 0);
    check_soft_against_scalar(false, false, SHB_OCCLUDERS_PLANES, 0.5, 0);
}

TEST(exact_soft_shadows_by_points_of_a_disk_agree_with_a_slow_search) {
    check_soft_against_scalar(false, false, SHB_OCCLUDERS_PLANES, 0.15, 25);
    check_soft_against_scalar(true, true, SHB_OCCLUDERS_PLANES, 0.4, 40);
    check_soft_against_scalar(false, true, SHB_OCCLUDERS_PLANES, 0.5, 25);
}

/* Rows of points on triangles of the relief, several in a texel; searches reach up to as many
 * texels as depth says, and so one texel farther at some points of a texel than at others. */
static void fill_rows(const soup *s, asked_points *made) {
    enum { ROW = 12 };
    for (int i = 0; i < ASKED_POINTS; i++) {
        const float *a = s->positions + 9 * (s->count - 1 - (uint32_t)(i / ROW));
        const float *b = a + 3, *c = a + 6;
        const float along = ((float)(i % ROW) + 0.5f) / ROW;
        float first[3], second[3];
        for (int k = 0; k < 3; k++) {
            first[k] = b[k] - a[k];
            second[k] = c[k] - a[k];
            made->positions[3 * i + k] = a[k] + along * (0.7f * first[k] + 0.3f * second[k]);
        }
        for (int k = 0; k < 3; k++)
            made->normals[3 * i + k] =
                first[(k + 1) % 3] * second[(k + 2) % 3] - first[(k + 2) % 3] * second[(k + 1) % 3];
    }
}

static void check_points_alone(double light, int taps) {
    const shb_filter filter = shb_filter_pcss((float)light, taps, taps, SHB_TAPS_PLANE);
    const shb_bias exact = shb_bias_exact();
    soup s = {0};
    asked_scene_add(&s);
    asked_scene_add_relief(&s);
    asked_points *given = malloc(sizeof *given);
    fill_rows(&s, given);
    const shb_map_desc desc = {
        .view = probe_orthographic(true), .width = 64, .occluders = SHB_OCCLUDERS_PLANES};
    asked_map made = asked_map_draw(SHB_ISA_BEST, &desc, &s);
    float together[ASKED_POINTS], alone;
    asked_map_ask(&made, given, &filter, together);
    int different = 0;
    for (int i = 0; i < ASKED_POINTS; i++) {
        const shb_points point = {
            .count = 1, .positions = given->positions + 3 * i, .normals = given->normals + 3 * i};
        CHECK_INT(shb_map_visibility(made.map, &point, &exact, &filter, &alone), SHB_OK);
        different += alone != together[i];
    }
    CHECK_INT(different, 0);
    asked_map_close(&made);
    free(given);
    soup_free(&s);
}

TEST(exact_soft_shadows_of_a_point_do_not_depend_on_others_in_its_texel) {
    check_points_alone(0.15, 0);
    check_points_alone(0.164, 0);
    check_points_alone(0.164, 40);
}
