/* Matrices are homogeneous: a view is the same whatever its matrix is multiplied by. */
#include "asked_map.h"
#include "probe.h"
#include "test.h"

#include <math.h>
#include <string.h>

typedef struct factor_answers {
    float visibility[ASKED_POINTS];
    uint8_t certain[ASKED_POINTS];
} factor_answers;

/* Of a map with the view times 2^exponent. */
static void ask_view(shb_context *context, shb_view view, int exponent, shb_occluders occluders,
                     soup *s, const asked_points *given, factor_answers *out) {
    for (int i = 0; i < 16; i++)
        view.clip_from_world.m[i] = ldexp(view.clip_from_world.m[i], exponent);
    const shb_map_desc desc = {
        .view = view, .width = 96, .occluders = occluders, .classifies = true};
    const shb_points points = {
        .count = ASKED_POINTS, .positions = given->positions, .normals = given->normals};
    const shb_bias bias = occluders ? shb_bias_exact() : shb_bias_adaptive(1e-4f, 0);
    const shb_filter filter = occluders == SHB_OCCLUDERS_LISTS
                                  ? shb_filter_hard()
                                  : shb_filter_pcf(3, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
    shb_map *map = NULL;
    CHECK_INT(shb_map_create(context, &desc, &map), SHB_OK);
    CHECK_INT(shb_map_draw(map, soup_scene(s), NULL, NULL), SHB_OK);
    CHECK_INT(shb_map_visibility(map, &points, &bias, &filter, out->visibility), SHB_OK);
    CHECK_INT(shb_map_classify(map, &points, out->certain), SHB_OK);
    shb_map_destroy(map);
}

static void check_factors(shb_view view, soup *s, const asked_points *given) {
    static const int exponents[] = {-100, -20, -1, 1, 20, 100};
    shb_context *context = NULL;
    CHECK_INT(shb_context_create(NULL, &context), SHB_OK);
    for (int occluders = 0; occluders <= SHB_OCCLUDERS_LISTS; occluders++) {
        factor_answers expected, out;
        ask_view(context, view, 0, (shb_occluders)occluders, s, given, &expected);
        for (size_t i = 0; i < sizeof exponents / sizeof *exponents; i++) {
            ask_view(context, view, exponents[i], (shb_occluders)occluders, s, given, &out);
            test_check(memcmp(&out, &expected, sizeof out) == 0, __FILE__, __LINE__,
                       "occluders %d, factor 2^%d", occluders, exponents[i]);
        }
    }
    shb_context_destroy(context);
}

TEST(answers_are_the_same_whatever_the_view_is_multiplied_by) {
    static asked_points given;
    for (int reversed = 0; reversed < 2; reversed++) {
        soup s = {0};
        asked_scene_add(&s);
        asked_points_fill(&s, 5, &given);
        check_factors(probe_orthographic(reversed), &s, &given);
        asked_scene_lift(&s);
        asked_points_fill(&s, 5, &given);
        check_factors(probe_perspective(reversed), &s, &given);
        soup_free(&s);
    }
}
