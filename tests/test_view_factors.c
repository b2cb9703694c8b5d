/* Matrices are homogeneous: a view is the same whatever its matrix is multiplied by. And how deep
 * it is matters only where depths are too small for floats. */
#include "asked_map.h"
#include "probe.h"
#include "test.h"

#include <math.h>
#include <string.h>

/* What a map says of points, and what it says for certain. */
typedef struct factor_answers {
    float visibility[ASKED_POINTS];
    uint8_t certain[ASKED_POINTS];
} factor_answers;

/* Certain answers are left as they are where the map does not give any. */
static void ask_view(shb_context *context, const shb_map_desc *desc, const shb_filter *filter,
                     soup *s, const asked_points *given, factor_answers *out) {
    const shb_points points = {
        .count = ASKED_POINTS, .positions = given->positions, .normals = given->normals};
    const shb_bias bias = desc->occluders ? shb_bias_exact() : shb_bias_adaptive(1e-4f, 0);
    shb_map *map = NULL;
    CHECK_INT(shb_map_create(context, desc, &map), SHB_OK);
    CHECK_INT(shb_map_draw(map, soup_scene(s), NULL, NULL), SHB_OK);
    CHECK_INT(shb_map_visibility(map, &points, &bias, filter, out->visibility), SHB_OK);
    if (desc->classifies)
        CHECK_INT(shb_map_classify(map, &points, out->certain), SHB_OK);
    shb_map_destroy(map);
}

static shb_view times_power(shb_view view, int exponent) {
    for (int i = 0; i < 16; i++)
        view.clip_from_world.m[i] = ldexp(view.clip_from_world.m[i], exponent);
    return view;
}

static void check_factors(shb_view view, soup *s, const asked_points *given) {
    static const int exponents[] = {-100, -20, -1, 1, 20, 100};
    shb_context *context = NULL;
    CHECK_INT(shb_context_create(NULL, &context), SHB_OK);
    for (int occluders = 0; occluders <= SHB_OCCLUDERS_LISTS; occluders++) {
        const shb_filter filter = occluders == SHB_OCCLUDERS_LISTS
                                      ? shb_filter_hard()
                                      : shb_filter_pcf(3, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
        shb_map_desc desc = {
            .view = view, .width = 96, .occluders = (shb_occluders)occluders, .classifies = true};
        factor_answers expected, out;
        ask_view(context, &desc, &filter, s, given, &expected);
        for (size_t i = 0; i < sizeof exponents / sizeof *exponents; i++) {
            desc.view = times_power(view, exponents[i]);
            ask_view(context, &desc, &filter, s, given, &out);
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

/* Down to depths that are nothing in floats. What that leaves open is lit. */
TEST(planes_shadow_nothing_more_the_deeper_the_view_is) {
    static asked_points given;
    static factor_answers expected, deep;
    soup s = {0};
    asked_scene_add(&s);
    asked_scene_add_relief(&s);
    asked_points_fill(&s, 6, &given);
    shb_context *context = NULL;
    CHECK_INT(shb_context_create(NULL, &context), SHB_OK);
    for (int reversed = 0; reversed < 2; reversed++) {
        shb_map_desc desc = {
            .view = probe_orthographic(reversed), .width = 96, .occluders = SHB_OCCLUDERS_PLANES};
        ask_view(context, &desc, NULL, &s, &given, &expected);
        for (int exponent = 8; exponent < 300; exponent += 8) {
            for (int column = 0; column < 4; column++)
                desc.view.clip_from_world.m[4 * column + 2] *= 0x1p-8;
            ask_view(context, &desc, NULL, &s, &given, &deep);
            size_t darker = 0;
            for (int i = 0; i < ASKED_POINTS; i++)
                darker += deep.visibility[i] < expected.visibility[i];
            CHECK_INT(darker, 0);
        }
    }
    shb_context_destroy(context);
    soup_free(&s);
}

/* Down to depths that are nothing in floats. */
TEST(lists_answer_the_same_however_deep_the_view_is) {
    static asked_points given;
    static factor_answers expected, deep;
    shb_context *context = NULL;
    CHECK_INT(shb_context_create(NULL, &context), SHB_OK);
    for (int kind = 0; kind < 4; kind++) {
        soup s = {0};
        asked_scene_add(&s);
        if (kind / 2)
            asked_scene_lift(&s);
        asked_points_fill(&s, 3, &given);
        const bool reversed = kind % 2;
        const shb_view near = kind / 2 ? probe_perspective(reversed) : probe_orthographic(reversed);
        shb_map_desc desc = {.view = near,
                             .width = 128,
                             .occluders = SHB_OCCLUDERS_LISTS,
                             .classifies = true,
                             .exact_only = true};
        ask_view(context, &desc, NULL, &s, &given, &expected);
        for (int exponent = -100; exponent > -1000; exponent -= exponent > -170 ? 6 : 200) {
            desc.view = near;
            for (int column = 0; column < 4; column++)
                desc.view.clip_from_world.m[4 * column + 2] *= ldexp(1, exponent);
            ask_view(context, &desc, NULL, &s, &given, &deep);
            size_t others = 0, against = 0;
            for (int i = 0; i < ASKED_POINTS; i++) {
                const int certain = deep.certain[i];
                others += deep.visibility[i] != expected.visibility[i];
                against +=
                    certain != SHB_LIGHT_UNSURE &&
                    certain != (expected.visibility[i] > 0 ? SHB_LIGHT_LIT : SHB_LIGHT_SHADOWED);
            }
            CHECK_INT(others, 0);
            CHECK_INT(against, 0);
        }
        soup_free(&s);
    }
    shb_context_destroy(context);
}
