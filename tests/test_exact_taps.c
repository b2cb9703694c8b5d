/* The exact method in every tap: against the scalar test of mutual planes, on planes, and where it
 * is refused. */
#include "asked_map.h"
#include "isas.h"
#include "probe.h"
#include "random.h"
#include "slow_taps.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Turns the scene and what looks at it, so that no axis of the light is one of the world's, and
 * moves them away. */
static void place(soup *s, shb_view *view, shb_vec3 away) {
    static const double rows[3][3] = {{0.8, 0.36, -0.48}, {-0.6, 0.48, -0.64}, {0, 0.8, 0.6}};
    const double to[3] = {away.x, away.y, away.z};
    shb_mat4 back = shb_mat4_identity();
    for (int i = 0; i < 9; i++) {
        back.m[4 * (i / 3) + i % 3] = rows[i / 3][i % 3];
        back.m[12 + i % 3] -= rows[i / 3][i % 3] * to[i / 3];
    }
    view->clip_from_world = shb_mat4_multiply(view->clip_from_world, back);
    for (uint32_t i = 0; i < 3 * s->count; i++) {
        float *p = s->positions + 3 * i;
        const double old[3] = {(double)p[0], (double)p[1], (double)p[2]};
        for (int k = 0; k < 3; k++)
            p[k] =
                (float)((rows[k][0] * old[0] + rows[k][1] * old[1] + rows[k][2] * old[2]) + to[k]);
    }
}

/* Bounds that are taken for all taps at once may light a tap that the scalar test shadows by less
 * than rounding, never the other way round. */
static void check_against_scalar(bool spot, bool reversed, shb_occluders occluders) {
    soup s = {0};
    asked_scene_add(&s);
    for (uint32_t i = 0; i < 9 * s.count; i++)
        s.positions[i] *= 0.7f;
    if (spot)
        asked_scene_lift(&s);
    asked_points *given = malloc(sizeof *given);
    shb_view view = spot ? probe_perspective(reversed) : probe_orthographic(reversed);
    place(&s, &view, (shb_vec3){0, 0, 0});
    asked_points_fill(&s, 3, given);
    const shb_map_desc desc = {.view = view, .width = 100, .height = 70, .occluders = occluders};
    for (int n = 1; n <= 5; n += 2) {
        asked_map made = asked_map_draw(SHB_ISA_BEST, &desc, &s);
        const shb_filter box = shb_filter_pcf((float)n, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
        float seen[ASKED_POINTS];
        int darker = 0, lighter = 0, mixed = 0;
        asked_map_ask(&made, given, &box, seen);
        for (int i = 0; i < ASKED_POINTS; i++) {
            shb_exact_fragment fragment;
            const bool is_seen = asked_point_fragment(made.map, given, i, &fragment);
            const double part = is_seen ? slow_lit_in_box(made.map, &fragment, n, false) : 1;
            const int lit = (int)lround(part * n * n);
            const int found = (int)lround((double)seen[i] * n * n);
            darker += found < lit;
            lighter += found > lit;
            mixed += lit > 0 && lit < n * n;
        }
        CHECK_INT(darker, 0);
        CHECK(lighter <= ASKED_POINTS / 200);
        CHECK(n == 1 || mixed > 20);
        asked_map_close(&made);
    }
    free(given);
    soup_free(&s);
}

TEST(exact_taps_by_planes_agree_with_the_scalar_test) {
    check_against_scalar(false, false, SHB_OCCLUDERS_PLANES);
    check_against_scalar(true, true, SHB_OCCLUDERS_PLANES);
}

TEST(exact_taps_by_triangles_agree_with_the_scalar_test) {
    check_against_scalar(false, true, SHB_OCCLUDERS_TRIANGLES);
    check_against_scalar(true, false, SHB_OCCLUDERS_TRIANGLES);
}

/* A quad over x0 .. x1 and y0 .. y1 that rises from z0 to z1 along x, turned by quarters. */
static void add_turned(soup *s, int quarters, const float x[2], const float y[2],
                       const float z[2]) {
    float corners[4][3];
    for (int k = 0; k < 4; k++) {
        const int right = k == 1 || k == 2, up = k >= 2;
        const float along = x[right], across = y[up];
        const float places[4][2] = {
            {along, across}, {-across, along}, {-along, -across}, {across, -along}};
        corners[k][0] = places[quarters][0];
        corners[k][1] = places[quarters][1];
        corners[k][2] = z[right];
    }
    soup_add_quad(s, corners[0], corners[1], corners[2], corners[3]);
}

/* Ground at z = 0 with a ramp from x = 0.13 to 0.24 up to a plateau at 0.5, and the top of a post
 * at 0.2 that no sample sees. From the texel beside the middle the box reaches the plateau in one
 * of its five columns. The ground goes on to be the plateau, which does not shadow it; the post
 * stands before what its texel holds, and the plateau does. */
static void check_post(int quarters, bool reversed) {
    static const float ends[4] = {-1, 0.13f, 0.24f, 1}, heights[4] = {0, 0, 0.5f, 0.5f};
    static const float places[2] = {0.06f, 0.01f}, expected[2] = {1, 0.8f};
    const float wide[2] = {-1, 1}, post[2] = {0.005f, 0.03f}, top[2] = {0.2f, 0.2f};
    soup s = {0};
    for (int i = 0; i < 3; i++)
        add_turned(&s, quarters, &ends[i], wide, &heights[i]);
    add_turned(&s, quarters, post, wide, top);
    const shb_map_desc desc = {
        .view = probe_orthographic(reversed), .width = 16, .occluders = SHB_OCCLUDERS_PLANES};
    const shb_filter box = shb_filter_pcf(5, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
    const shb_filter grid = shb_filter_jittered(6, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
    const shb_bias exact = shb_bias_exact();
    asked_map made = asked_map_draw(SHB_ISA_BEST, &desc, &s);
    for (int i = 0; i < 2; i++) {
        const float x = places[i], y = 0.01f, normal[3] = {0, 0, 1}, z = i ? 0.2f : 0;
        const float positions[4][3] = {{x, y, z}, {-y, x, z}, {-x, -y, z}, {y, -x, z}};
        const shb_points asked = {.count = 1, .positions = positions[quarters], .normals = normal};
        float visibility;
        CHECK_INT(shb_map_visibility(made.map, &asked, &exact, &box, &visibility), SHB_OK);
        CHECK_NEAR(visibility, expected[i], 1e-6);
        CHECK_INT(shb_map_visibility(made.map, &asked, &exact, &grid, &visibility), SHB_OK);
        CHECK((visibility == 1) == (expected[i] == 1));
    }
    asked_map_close(&made);
    soup_free(&s);
}

TEST(what_stands_before_its_texel_is_not_on_the_sheet_there) {
    for (int quarters = 0; quarters < 4; quarters++)
        for (int reversed = 0; reversed < 2; reversed++)
            check_post(quarters, reversed != 0);
}

static void check_isas(bool spot, shb_occluders occluders) {
    const shb_filter filters[] = {shb_filter_pcf(5, SHB_UNIT_TEXEL, SHB_TAPS_PLANE),
                                  shb_filter_pcf(16, SHB_UNIT_TEXEL, SHB_TAPS_PLANE),
                                  shb_filter_pcf(19, SHB_UNIT_TEXEL, SHB_TAPS_PLANE),
                                  shb_filter_pcf(0.1f, SHB_UNIT_WORLD, SHB_TAPS_PLANE),
                                  shb_filter_pcf_smooth(4, SHB_UNIT_TEXEL, SHB_TAPS_PLANE),
                                  shb_filter_jittered(6, SHB_UNIT_TEXEL, SHB_TAPS_PLANE),
                                  shb_filter_jittered(0.4f, SHB_UNIT_WORLD, SHB_TAPS_PLANE),
                                  shb_filter_jittered(40, SHB_UNIT_TEXEL, SHB_TAPS_PLANE),
                                  shb_filter_poisson(9, 4, SHB_UNIT_TEXEL, SHB_TAPS_PLANE),
                                  shb_filter_poisson(100, 8, SHB_UNIT_TEXEL, SHB_TAPS_PLANE),
                                  shb_filter_pcss(0.2f, 25, 25, SHB_TAPS_PLANE),
                                  shb_filter_pcss(0.2f, 0, 0, SHB_TAPS_PLANE)};
    const int filter_count = sizeof filters / sizeof *filters;
    const shb_map_desc desc = {.view = spot ? probe_perspective(true) : probe_orthographic(false),
                               .width = 64,
                               .occluders = occluders};
    soup s = {0};
    asked_scene_add(&s);
    asked_scene_add_relief(&s);
    if (spot)
        asked_scene_lift(&s);
    asked_points *given = malloc(sizeof *given);
    asked_points_fill(&s, 4, given);
    asked_map scalar = asked_map_draw(SHB_ISA_SCALAR, &desc, &s);
    for (shb_isa isa = test_isa_after(SHB_ISA_SCALAR); isa < SHB_ISA_COUNT;
         isa = test_isa_after(isa)) {
        asked_map other = asked_map_draw(isa, &desc, &s);
        for (int f = 0; f < filter_count; f++) {
            float expected[ASKED_POINTS], actual[ASKED_POINTS];
            asked_map_ask(&scalar, given, &filters[f], expected);
            asked_map_ask(&other, given, &filters[f], actual);
            CHECK(memcmp(expected, actual, sizeof expected) == 0);
            double lit = 0;
            for (int i = 0; i < ASKED_POINTS; i++)
                lit += (double)expected[i] / ASKED_POINTS;
            CHECK(lit > 0.1 && lit < 0.9);
        }
        asked_map_close(&other);
    }
    asked_map_close(&scalar);
    free(given);
    soup_free(&s);
}

TEST(exact_taps_give_scalar_bits_on_every_isa) {
    check_isas(true, SHB_OCCLUDERS_PLANES);
    check_isas(false, SHB_OCCLUDERS_PLANES);
    check_isas(true, SHB_OCCLUDERS_TRIANGLES);
}

/* The plane is in the map unless it is seen edge on. */
static bool covers_middle(const shb_map *map) {
    const int32_t column = 63, row = 39;
    float depth;
    shb_map_fetch(map, 1, &column, &row, &depth);
    return depth < (map->info.view.reversed ? 0.0f : 1.0f);
}

/* False shadow of exact taps on planes at any slope, near the origin and far from it: none of count
 * points. */
static int false_shadows(const shb_filter *filter, int count, uint64_t seed) {
    test_random random = {seed};
    asked_points *given = malloc(sizeof *given);
    int wrong = 0, covered = 0;
    for (int asked = 0; asked < count; asked += ASKED_POINTS) {
        const double angle = 1.5707963 * (1 - pow(random_double(&random, 0, 1), 3));
        const double turn = random_double(&random, 0, 6.28);
        const double c = cos(angle), z = sin(angle), x = cos(turn), y = sin(turn);
        const float across[3] = {(float)(0.9 * x * c), (float)(0.9 * y * c), (float)(0.9 * z)};
        const float along[3] = {(float)(-0.9 * y), (float)(0.9 * x), 0};
        float corners[4][3];
        for (int k = 0; k < 4; k++)
            for (int axis = 0; axis < 3; axis++)
                corners[k][axis] = (k == 1 || k == 2 ? across[axis] : -across[axis]) +
                                   (k > 1 ? 1.0f : -1.0f) * along[axis];
        soup s = {0};
        soup_add_quad(&s, corners[0], corners[1], corners[2], corners[3]);
        const bool spot = asked / ASKED_POINTS % 2;
        if (spot)
            asked_scene_lift(&s);
        shb_view view = spot ? probe_perspective(true) : probe_orthographic(false);
        const double size = pow(10, random_double(&random, -1, 4));
        place(&s, &view,
              (shb_vec3){size * random_double(&random, -1, 1), size * random_double(&random, -1, 1),
                         size * random_double(&random, -1, 1)});
        asked_points_fill(&s, seed + (uint64_t)asked, given);
        const shb_map_desc desc = {.view = view,
                                   .width = 128,
                                   .height = 80,
                                   .occluders = asked / ASKED_POINTS % 3 ? SHB_OCCLUDERS_PLANES
                                                                         : SHB_OCCLUDERS_TRIANGLES};
        asked_map made = asked_map_draw(SHB_ISA_BEST, &desc, &s);
        float seen[ASKED_POINTS];
        asked_map_ask(&made, given, filter, seen);
        for (int i = 0; i < ASKED_POINTS; i++)
            wrong += seen[i] != 1;
        covered += covers_middle(made.map);
        asked_map_close(&made);
        soup_free(&s);
    }
    CHECK(covered > count / ASKED_POINTS / 2);
    free(given);
    return wrong;
}

/* SHB_TEST_FRAGMENTS: how many instead of a quick 100 000. */
TEST(exact_taps_shadow_no_plane_at_any_slope) {
    const char *count = getenv("SHB_TEST_FRAGMENTS");
    const shb_filter box = shb_filter_pcf(5, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
    const shb_filter soft = shb_filter_pcss(0.1f, 16, 16, SHB_TAPS_PLANE);
    CHECK_INT(false_shadows(&box, count ? atoi(count) : 100000, 21), 0);
    CHECK_INT(false_shadows(&soft, count ? atoi(count) : 30000, 22), 0);
}

TEST(exact_taps_are_refused_by_maps_that_keep_lists) {
    soup s = {0};
    asked_scene_add(&s);
    asked_points *given = malloc(sizeof *given);
    asked_points_fill(&s, 5, given);
    const shb_map_desc desc = {
        .view = probe_orthographic(false), .width = 16, .occluders = SHB_OCCLUDERS_LISTS};
    asked_map made = asked_map_draw(SHB_ISA_BEST, &desc, &s);
    const shb_points list = {
        .count = ASKED_POINTS, .positions = given->positions, .normals = given->normals};
    const shb_bias exact = shb_bias_exact(), none = shb_bias_none();
    const shb_filter filters[] = {shb_filter_pcf(5, SHB_UNIT_TEXEL, SHB_TAPS_PLANE),
                                  shb_filter_pcf_smooth(2, SHB_UNIT_TEXEL, SHB_TAPS_PLANE),
                                  shb_filter_jittered(4, SHB_UNIT_TEXEL, SHB_TAPS_PLANE),
                                  shb_filter_poisson(9, 4, SHB_UNIT_TEXEL, SHB_TAPS_PLANE),
                                  shb_filter_pcss(0.2f, 0, 0, SHB_TAPS_PLANE)};
    float seen[ASKED_POINTS];
    for (int f = 0; f < 5; f++) {
        seen[0] = 7;
        CHECK_INT(shb_map_visibility(made.map, &list, &exact, &filters[f], seen),
                  SHB_ERROR_UNSUPPORTED);
        CHECK(seen[0] == 7);
        CHECK_INT(shb_map_visibility(made.map, &list, &none, &filters[f], seen), SHB_OK);
    }
    asked_map_close(&made);
    free(given);
    soup_free(&s);
}
