/* The exact method in both stages of percentage-closer soft shadows. */
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

/* Every texel of a square of this half width, by the scalar test. Depths are canonical. */
static slow_stage ask_slowly(const shb_map *map, const shb_exact_fragment *fragment, double half) {
    const double x = fragment->point.x, y = fragment->point.y;
    slow_stage stage = {0, 0, 4 * half * half};
    for (int row = (int)floor(y - half); row < y + half; row++)
        for (int column = (int)floor(x - half); column < x + half; column++) {
            const double w = fmin(column + 1, x + half) - fmax(column, x - half);
            const double h = fmin(row + 1, y + half) - fmax(row, y - half);
            const int32_t texel_x = column, texel_y = row;
            float depth;
            if (!slow_tap_is_shadowed(map, fragment, column, row))
                continue;
            shb_map_fetch(map, 1, &texel_x, &texel_y, &depth);
            stage.blocked += w * h;
            stage.depth += w * h * (double)depth;
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

static double slow_soft(const shb_map *map, bool spot, double light, const asked_points *given,
                        int i) {
    shb_exact_fragment fragment;
    if (!asked_point_fragment(map, given, i, &fragment))
        return 1;
    const shb_light_point *p = &fragment.point;
    const double size = map->info.width, near_depth = map->info.view.reversed ? -1 : 0;
    if (!(p->x >= 0 && p->y >= 0 && p->x < size && p->y < size))
        return 1;
    const slow_stage search =
        ask_slowly(map, &fragment, half_width(map, spot, light, p->z, near_depth));
    if (search.blocked == 0)
        return 1;
    const slow_stage filter = ask_slowly(
        map, &fragment, half_width(map, spot, light, p->z, search.depth / search.blocked));
    return 1 - filter.blocked / filter.all;
}

static void check_soft_against_scalar(bool spot, bool reversed, shb_occluders occluders) {
    const double light = spot ? 0.1 : 0.05;
    const shb_filter filter = shb_filter_pcss((float)light, 0, 0, SHB_TAPS_PLANE);
    soup s = {0};
    asked_scene_add(&s);
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
    int different = 0, soft = 0;
    for (int i = 0; i < ASKED_POINTS / 2; i++) {
        const double expected = slow_soft(made.map, spot, light, given, i);
        different += !(fabs((double)seen[i] - expected) < 1e-3);
        soft += expected > 0.05 && expected < 0.95;
    }
    CHECK(different <= ASKED_POINTS / 400);
    CHECK(soft > ASKED_POINTS / 20);
    asked_map_close(&made);
    free(given);
    soup_free(&s);
}

TEST(exact_soft_shadows_agree_with_a_slow_search_by_the_scalar_test) {
    check_soft_against_scalar(false, false, SHB_OCCLUDERS_PLANES);
    check_soft_against_scalar(true, true, SHB_OCCLUDERS_PLANES);
    check_soft_against_scalar(false, true, SHB_OCCLUDERS_TRIANGLES);
    check_soft_against_scalar(true, false, SHB_OCCLUDERS_TRIANGLES);
}
