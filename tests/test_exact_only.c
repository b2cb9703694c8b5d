/* Maps of lists without depths. */
#include "asked_map.h"
#include "probe.h"
#include "test.h"

#include <stdlib.h>
#include <string.h>

/* Frees what it draws. */
static asked_map draw(soup *s, bool reversed, bool classifies, bool exact_only) {
    const shb_map_desc desc = {.view = probe_orthographic(reversed),
                               .width = 60,
                               .height = 44,
                               .occluders = SHB_OCCLUDERS_LISTS,
                               .classifies = classifies,
                               .exact_only = exact_only};
    return asked_map_draw(SHB_ISA_BEST, &desc, s);
}

TEST(maps_without_depths_answer_as_those_with) {
    const shb_filter hard = shb_filter_hard();
    asked_points *given = malloc(sizeof *given);
    soup s = {0};
    asked_scene_add(&s);
    asked_points_fill(&s, 51, given);
    for (int k = 0; k < 4; k++) {
        asked_map with = draw(&s, k & 1, k & 2, false), without = draw(&s, k & 1, k & 2, true);
        float expected[ASKED_POINTS], actual[ASKED_POINTS];
        asked_map_ask(&with, given, &hard, expected);
        asked_map_ask(&without, given, &hard, actual);
        CHECK(memcmp(expected, actual, sizeof expected) == 0);
        int lit = 0;
        for (int i = 0; i < ASKED_POINTS; i++)
            lit += actual[i] == 1;
        CHECK(lit > ASKED_POINTS / 5 && lit < ASKED_POINTS * 4 / 5);
        const shb_points points = {.count = ASKED_POINTS, .positions = given->positions};
        uint8_t certain[ASKED_POINTS], found[ASKED_POINTS];
        if (k & 2) {
            CHECK_INT(shb_map_classify(with.map, &points, certain), SHB_OK);
            CHECK_INT(shb_map_classify(without.map, &points, found), SHB_OK);
            CHECK(memcmp(certain, found, sizeof certain) == 0);
        }
        asked_map_close(&with);
        asked_map_close(&without);
    }
    free(given);
    soup_free(&s);
}

TEST(maps_without_depths_keep_no_bytes_of_them) {
    soup s = {0};
    asked_scene_add(&s);
    asked_map with = draw(&s, false, false, false), without = draw(&s, false, false, true);
    const size_t depths = 44 * shb_map_get_depth(with.map).stride + shb_clear_marks_size(60, 44);
    CHECK_INT(shb_map_get_info(without.map)->memory_bytes,
              shb_map_get_info(with.map)->memory_bytes - depths);
    CHECK(shb_map_get_depth(without.map).texels == NULL);
    asked_map_close(&with);
    asked_map_close(&without);
    soup_free(&s);
}

TEST(maps_without_depths_have_the_far_depth_everywhere) {
    const int32_t column[2] = {30, -1}, row[2] = {22, 3};
    soup s = {0};
    asked_scene_add(&s);
    for (int reversed = 0; reversed < 2; reversed++) {
        float depth[2] = {7, 7};
        asked_map made = draw(&s, reversed != 0, false, true);
        shb_map_fetch(made.map, 2, column, row, depth);
        CHECK(depth[0] == (reversed ? 0 : 1) && depth[1] == depth[0]);
        asked_map_close(&made);
    }
    soup_free(&s);
}

TEST(stats_of_maps_without_depths_count_triangles_alone) {
    shb_draw_stats stats = {7, 7, 7, 7, 7};
    soup s = {0};
    asked_scene_add(&s);
    asked_map made = draw(&s, false, false, true);
    CHECK_INT(shb_map_draw(made.map, soup_scene(&s), NULL, &stats), SHB_OK);
    CHECK_INT(stats.triangles, s.count);
    CHECK_INT(stats.not_finite + stats.culled + stats.clipped + stats.drawn, 0);
    asked_map_close(&made);
    soup_free(&s);
}

/* Before it is drawn and after. */
static void check_refusals(shb_map *map) {
    const shb_bias none = shb_bias_none(), adaptive = shb_bias_adaptive(1e-4f, 0);
    const shb_bias exact = shb_bias_exact();
    const shb_filter box = shb_filter_pcf(3, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
    const shb_filter soft = shb_filter_pcss(0.1f, 0, 0, SHB_TAPS_PLANE);
    const float position[3] = {0, 0, -1}, normal[3] = {0, 0, 1};
    const shb_points point = {.count = 1, .positions = position, .normals = normal};
    float visibility = 7;
    CHECK_INT(shb_map_visibility(map, &point, &none, NULL, &visibility), SHB_ERROR_UNSUPPORTED);
    CHECK_INT(shb_map_visibility(map, &point, &adaptive, &box, &visibility), SHB_ERROR_UNSUPPORTED);
    CHECK_INT(shb_map_visibility(map, &point, &exact, &box, &visibility), SHB_ERROR_UNSUPPORTED);
    CHECK_INT(shb_map_prepare(map, &soft), SHB_ERROR_UNSUPPORTED);
    CHECK(visibility == 7);
    CHECK_INT(shb_map_visibility(map, &point, &exact, NULL, &visibility), SHB_OK);
}

TEST(maps_without_depths_refuse_what_needs_them) {
    const shb_bias constant = shb_bias_constant(0.1f, SHB_UNIT_DEPTH);
    shb_map_desc desc = {.view = probe_orthographic(false),
                         .width = 16,
                         .occluders = SHB_OCCLUDERS_LISTS,
                         .exact_only = true};
    shb_context *context = NULL;
    shb_map *map = NULL;
    soup s = {0};
    asked_scene_add(&s);
    CHECK_INT(shb_context_create(NULL, &context), SHB_OK);
    CHECK_INT(shb_map_create(context, &desc, &map), SHB_OK);
    check_refusals(map);
    CHECK_INT(shb_map_draw(map, soup_scene(&s), &constant, NULL), SHB_ERROR_UNSUPPORTED);
    CHECK_INT(shb_map_draw(map, soup_scene(&s), NULL, NULL), SHB_OK);
    check_refusals(map);
    shb_map_destroy(map);
    for (int i = SHB_OCCLUDERS_NONE; i < SHB_OCCLUDERS_LISTS; i++) {
        desc.occluders = (shb_occluders)i;
        CHECK_INT(shb_map_create(context, &desc, &map), SHB_ERROR_ARGUMENT);
    }
    shb_context_destroy(context);
    soup_free(&s);
}
