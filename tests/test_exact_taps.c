/* The exact method in every tap: against the scalar test of mutual planes, on planes, and where it
 * is refused. */
#include "../src/exact.h"
#include "../src/half.h"
#include "../src/occluders.h"
#include "../src/poisson.h"

#include "isas.h"
#include "probe.h"
#include "random.h"
#include "shadowbias/shadowbias.h"
#include "slow_taps.h"
#include "soup.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct asked_map {
    shb_context *context;
    shb_map *map;
} asked_map;

static asked_map draw(shb_isa isa, const shb_map_desc *map, soup *s) {
    asked_map made;
    const shb_context_desc desc = {.max_isa = isa, .threads = 1};
    const shb_bias exact = shb_bias_exact();
    CHECK_INT(shb_context_create(&desc, &made.context), SHB_OK);
    CHECK_INT(shb_map_create(made.context, map, &made.map), SHB_OK);
    CHECK_INT(shb_map_draw(made.map, soup_scene(s), &exact, NULL), SHB_OK);
    return made;
}

static void close_map(asked_map *made) {
    shb_map_destroy(made->map);
    shb_context_destroy(made->context);
}

/* The probe's spot sees heights of 1 to 3. */
static void lift_into_spot(soup *s) {
    for (uint32_t i = 2; i < 9 * s->count; i += 3)
        s->positions[i] += 2;
}

enum { POINTS = 1200 };

typedef struct points {
    float positions[3 * POINTS], normals[3 * POINTS];
} points;

static shb_vec3 corner_of(const soup *s, uint32_t triangle, int k) {
    const float *p = s->positions + 9 * triangle + 3 * k;
    return (shb_vec3){(double)p[0], (double)p[1], (double)p[2]};
}

/* A point of a random triangle, half the time of one of the first two, with its unit normal. */
static void random_point(const soup *s, test_random *random, float *position, float *normal) {
    const uint32_t triangle = random_below(random, random_below(random, 2) ? s->count : 2);
    const shb_vec3 a = corner_of(s, triangle, 0), b = corner_of(s, triangle, 1);
    const shb_vec3 c = corner_of(s, triangle, 2);
    double u = random_double(random, 0, 1), v = random_double(random, 0, 1);
    if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
    }
    const shb_vec3 ab = shb_vec3_subtract(b, a), ac = shb_vec3_subtract(c, a);
    const shb_vec3 n = shb_vec3_normalize(shb_vec3_cross(ab, ac));
    position[0] = (float)(a.x + u * ab.x + v * ac.x);
    position[1] = (float)(a.y + u * ab.y + v * ac.y);
    position[2] = (float)(a.z + u * ab.z + v * ac.z);
    normal[0] = (float)n.x;
    normal[1] = (float)n.y;
    normal[2] = (float)n.z;
}

static void fill_points(const soup *s, uint64_t seed, points *made) {
    test_random random = {seed};
    for (int i = 0; i < POINTS; i++)
        random_point(s, &random, made->positions + 3 * i, made->normals + 3 * i);
    made->positions[5] = NAN;
    made->positions[9] = 3e38f;
    memset(made->normals + 12, 0, 3 * sizeof(float));
}

static shb_result ask_unchecked(const asked_map *made, const points *given,
                                const shb_filter *filter, float *visibility) {
    const shb_points list = {
        .count = POINTS, .positions = given->positions, .normals = given->normals};
    const shb_bias exact = shb_bias_exact();
    return shb_map_visibility(made->map, &list, &exact, filter, visibility);
}

static void ask(const asked_map *made, const points *given, const shb_filter *filter,
                float *visibility) {
    CHECK_INT(ask_unchecked(made, given, filter, visibility), SHB_OK);
}

/* False: nothing of the map's shadows it. */
static bool fragment_of_point(const shb_map *map, const points *given, int i,
                              shb_exact_fragment *fragment) {
    double position[3], normal[3];
    for (int k = 0; k < 3; k++) {
        position[k] = (double)given->positions[3 * i + k];
        normal[k] = (double)given->normals[3 * i + k];
    }
    *fragment = shb_exact_fragment_of(&map->rows, position, normal);
    return fragment->point.w > 0 && fabs(fragment->point.x) < 1e6 && fabs(fragment->point.y) < 1e6;
}

/* Lit taps of a box of n x n texels, n odd, by the scalar test. */
static int lit_taps(const shb_map *map, const points *given, int i, int n) {
    shb_exact_fragment fragment;
    if (!fragment_of_point(map, given, i, &fragment))
        return n * n;
    const slow_box box = slow_box_of(map, &fragment, n);
    int lit = n * n;
    for (int k = 0; k < n * n; k++)
        lit -= !box.sheet[k / n][k % n] &&
               slow_tap_is_shadowed(map, &fragment, box.left + k % n, box.top + k / n);
    return lit;
}

/* A ball over a tilted floor, and a wall that stands on it. */
static void add_scene(soup *s) {
    double radii[24 * 11 + 2];
    for (size_t i = 0; i < sizeof radii / sizeof *radii; i++)
        radii[i] = 0.4;
    soup_add_quad(s, (float[]){-1, -1, -0.7f}, (float[]){1, -1, -0.5f}, (float[]){1, 1, -0.4f},
                  (float[]){-1, 1, -0.6f});
    soup_add_ball(s, (float[]){-0.3f, 0, 0.3f}, 24, 12, radii);
    soup_add_box(s, (float[]){0.3f, -0.9f, -0.8f}, (float[]){0.5f, 0.9f, 0.9f});
}

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
    add_scene(&s);
    for (uint32_t i = 0; i < 9 * s.count; i++)
        s.positions[i] *= 0.7f;
    if (spot)
        lift_into_spot(&s);
    points *given = malloc(sizeof *given);
    shb_view view = spot ? probe_perspective(reversed) : probe_orthographic(reversed);
    place(&s, &view, (shb_vec3){0, 0, 0});
    fill_points(&s, 3, given);
    const shb_map_desc desc = {.view = view, .width = 100, .height = 70, .occluders = occluders};
    for (int n = 1; n <= 5; n += 2) {
        asked_map made = draw(SHB_ISA_BEST, &desc, &s);
        const shb_filter box = shb_filter_pcf((float)n, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
        float seen[POINTS];
        int darker = 0, lighter = 0, mixed = 0;
        ask(&made, given, &box, seen);
        for (int i = 0; i < POINTS; i++) {
            const int lit = lit_taps(made.map, given, i, n);
            const int found = (int)lround((double)seen[i] * n * n);
            darker += found < lit;
            lighter += found > lit;
            mixed += lit > 0 && lit < n * n;
        }
        CHECK_INT(darker, 0);
        CHECK(lighter <= POINTS / 200);
        CHECK(n == 1 || mixed > 20);
        close_map(&made);
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
    asked_map made = draw(SHB_ISA_BEST, &desc, &s);
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
    close_map(&made);
    soup_free(&s);
}

TEST(what_stands_before_its_texel_is_not_on_the_sheet_there) {
    for (int quarters = 0; quarters < 4; quarters++)
        for (int reversed = 0; reversed < 2; reversed++)
            check_post(quarters, reversed != 0);
}

/* ---- in every format, before steep planes ---- */

static asked_map draw_as(shb_format format, shb_view view, uint32_t size, soup *s) {
    asked_map made;
    const shb_context_desc desc = {.threads = 1};
    const shb_map_desc map = {
        .view = view, .width = size, .format = format, .occluders = SHB_OCCLUDERS_PLANES};
    const shb_bias exact = shb_bias_exact();
    CHECK_INT(shb_context_create(&desc, &made.context), SHB_OK);
    CHECK_INT(shb_map_create(made.context, &map, &made.map), SHB_OK);
    CHECK_INT(shb_map_draw(made.map, soup_scene(s), &exact, NULL), SHB_OK);
    return made;
}

/* A plane of 88.5 degrees, and many of so much that halves do not hold their slopes. */
static void add_steep(soup *s) {
    soup_add_quad(s, (float[]){-0.9f, -0.9f, -0.8f}, (float[]){-0.86f, -0.9f, 0.8f},
                  (float[]){-0.86f, 0.9f, 0.8f}, (float[]){-0.9f, 0.9f, -0.8f});
    for (int i = 0; i < 60; i++) {
        const float x = -0.8f + 0.0151f * (float)i, wide = x + 0.0001f;
        soup_add_quad(s, (float[]){x, -0.7f, -0.9f}, (float[]){wide, -0.7f, 0.9f},
                      (float[]){wide + 0.6f, 0.9f, 0.9f}, (float[]){x + 0.6f, 0.9f, -0.9f});
    }
}

/* A rough sheet, up to the edge of the map. */
static void add_relief(soup *s) {
    enum { CELLS = 14 };
    float corners[CELLS + 1][CELLS + 1][3];
    test_random random = {10};
    for (int row = 0; row <= CELLS; row++)
        for (int column = 0; column <= CELLS; column++) {
            float *corner = corners[row][column];
            corner[0] = -0.4f + 0.1f * (float)column;
            corner[1] = 0.1f + 0.065f * (float)row;
            corner[2] = (float)random_double(&random, -0.25, -0.1);
        }
    for (int row = 0; row < CELLS; row++)
        for (int column = 0; column < CELLS; column++)
            soup_add_quad(s, corners[row][column], corners[row][column + 1],
                          corners[row + 1][column + 1], corners[row + 1][column]);
}

/* How much of the texel at this place a side of length n - 1 around the middle covers. */
static double covered_side(double middle, int texel, int n) {
    const double half = (n - 1) / 2.0;
    return fmax(fmin(middle + half, texel + 1.0) - fmax(middle - half, texel), 0);
}

/* What a filter lets through at a point by the scalar test. */
typedef double slow_filter(const shb_map *map, const points *given, int i,
                           const shb_filter *filter);

static double lit_in_box(const shb_map *map, const points *given, int i, int n, bool smooth) {
    double lit = 0, all = 0;
    shb_exact_fragment fragment;
    if (!fragment_of_point(map, given, i, &fragment))
        return 1;
    const double x = fragment.point.x, y = fragment.point.y;
    const slow_box box = slow_box_of(map, &fragment, n);
    for (int k = 0; k < n; k++)
        for (int j = 0; j < n; j++) {
            const int column = box.left + j, row = box.top + k;
            const double part = smooth ? covered_side(x, column, n) * covered_side(y, row, n) : 1;
            lit += part * (box.sheet[k][j] || !slow_tap_is_shadowed(map, &fragment, column, row));
            all += part;
        }
    return lit / all;
}

static double slow_pcf(const shb_map *map, const points *given, int i, const shb_filter *filter) {
    return lit_in_box(map, given, i, (int)filter->params[0], false);
}

static double slow_pcf_smooth(const shb_map *map, const points *given, int i,
                              const shb_filter *filter) {
    return lit_in_box(map, given, i, (int)filter->params[0], true);
}

/* Taps at these places from the fragment on, texels, as far as reach on an axis: sheets lie in a
 * square around its own texel, none in one of more than 63 texels on a side. */
static double lit_at_places(const shb_map *map, const points *given, int i, double reach,
                            float (*places)[2], int count) {
    const int side = (int)floor(reach) + 1;
    slow_box square = {0};
    shb_exact_fragment fragment;
    int lit = 0;
    if (!fragment_of_point(map, given, i, &fragment))
        return 1;
    if (side <= SLOW_BOX_MAX / 2)
        square = slow_box_of(map, &fragment, 2 * side + 1);
    for (int k = 0; k < count; k++) {
        const int column = (int)floor(fragment.point.x + (double)places[k][0]);
        const int row = (int)floor(fragment.point.y + (double)places[k][1]);
        lit += (square.n && square.sheet[row - square.top][column - square.left]) ||
               !slow_tap_is_shadowed(map, &fragment, column, row);
    }
    return (double)lit / count;
}

static uint32_t hash_of_point(const points *given, int i) {
    const float *p = given->positions + 3 * i;
    return shb_position_hash(p[0], p[1], p[2]);
}

static double slow_jittered(const shb_map *map, const points *given, int i,
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

static double slow_poisson(const shb_map *map, const points *given, int i,
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
            found |= shb_occluder_row(map, row)[column] << 17 == SHB_HALF_INFINITY << 17;
    return found;
}

/* The first count points, whose answers may be off by so much; few have a tap that is shadowed by
 * what snapping moves, which only the scalar test knows. */
static void check_every_format(const shb_filter *filter, slow_filter *slow, int count, double off) {
    soup s = {0};
    add_scene(&s);
    add_relief(&s);
    points *given = malloc(sizeof *given);
    fill_points(&s, (uint64_t)filter->params[0], given);
    add_steep(&s);
    for (int format = SHB_FORMAT_FLOAT32; format <= SHB_FORMAT_UNORM16; format++)
        for (int reversed = 0; reversed < 2; reversed++) {
            asked_map made = draw_as((shb_format)format, probe_orthographic(reversed != 0), 90, &s);
            float seen[POINTS];
            int darker = 0, lighter = 0;
            ask(&made, given, filter, seen);
            for (int i = 0; i < count; i++) {
                const double lit = slow(made.map, given, i, filter);
                darker += (double)seen[i] < lit - off;
                lighter += (double)seen[i] > lit + off;
            }
            CHECK(darker <= POINTS / 500);
            CHECK(lighter <= POINTS / 100);
            CHECK(has_unbounded_slopes(made.map));
            close_map(&made);
        }
    free(given);
    soup_free(&s);
}

/* Of the many taps of a wide box one often is such. */
static void check_box(int n, int count) {
    const shb_filter box = shb_filter_pcf((float)n, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
    check_every_format(&box, slow_pcf, count, n > 20 ? 1.5 / (n * n) : 1e-5);
}

TEST(exact_boxes_agree_with_the_scalar_test_in_every_format) {
    check_box(4, POINTS);
    check_box(5, POINTS);
    check_box(11, POINTS);
    check_box(16, POINTS);
    check_box(19, POINTS);
    check_box(48, 200);
    check_box(63, 200);
}

static void check_smooth(int n, int count) {
    const shb_filter smooth = shb_filter_pcf_smooth((float)n, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
    check_every_format(&smooth, slow_pcf_smooth, count, 1e-5);
}

TEST(smooth_exact_boxes_agree_with_the_scalar_test_in_every_format) {
    check_smooth(3, POINTS);
    check_smooth(8, POINTS);
    check_smooth(11, POINTS);
    check_smooth(20, 200);
}

static void check_jittered(float size, int count) {
    const shb_filter grid = shb_filter_jittered(size, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
    check_every_format(&grid, slow_jittered, count, 1e-5);
}

TEST(exact_jittered_taps_agree_with_the_scalar_test_in_every_format) {
    check_jittered(5, POINTS);
    check_jittered(13, POINTS);
    check_jittered(14, POINTS);
    check_jittered(61, 200);
    check_jittered(62, 200);
}

static void check_poisson(int taps, float radius, int count) {
    const shb_filter disk = shb_filter_poisson((float)taps, radius, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
    check_every_format(&disk, slow_poisson, count, 1e-5);
}

TEST(exact_taps_on_disks_agree_with_the_scalar_test_in_every_format) {
    check_poisson(16, 2.5f, POINTS);
    check_poisson(1, 0, POINTS);
    check_poisson(70, 6, POINTS);
    check_poisson(64, 9, POINTS);
    check_poisson(SHB_POISSON_MAX, 30.5f, 200);
}

/* ---- what is found of a map when it is asked ---- */

TEST(exact_boxes_in_a_map_that_is_drawn_again_are_those_of_a_new_one) {
    const shb_filter box = shb_filter_pcf(7, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
    const shb_bias exact = shb_bias_exact();
    const shb_map_desc desc = {
        .view = probe_orthographic(false), .width = 90, .occluders = SHB_OCCLUDERS_PLANES};
    soup first = {0}, second = {0};
    add_scene(&first);
    soup_add_quad(&second, (float[]){-1, -1, 0.3f}, (float[]){1, -1, 0.1f}, (float[]){1, 1, 0.9f},
                  (float[]){-1, 1, -0.9f});
    add_steep(&second);
    points *given = malloc(sizeof *given);
    fill_points(&second, 8, given);
    asked_map drawn_again = draw(SHB_ISA_BEST, &desc, &first);
    asked_map fresh = draw(SHB_ISA_BEST, &desc, &second);
    float before[POINTS], after[POINTS], expected[POINTS];
    ask(&drawn_again, given, &box, before);
    CHECK_INT(shb_map_draw(drawn_again.map, soup_scene(&second), &exact, NULL), SHB_OK);
    ask(&drawn_again, given, &box, after);
    ask(&fresh, given, &box, expected);
    CHECK(memcmp(after, expected, sizeof expected) == 0);
    CHECK(memcmp(before, expected, sizeof expected) != 0);
    close_map(&fresh);
    close_map(&drawn_again);
    free(given);
    soup_free(&first);
    soup_free(&second);
}

enum { ASKERS = 4 };

typedef struct asked_at_once {
    const asked_map *made;
    const points *given;
    shb_result results[ASKERS + 1];
    float seen[ASKERS + 1][POINTS];
} asked_at_once;

/* Checks are for one thread. */
static void ask_as_one_of_many(void *arg, size_t index) {
    asked_at_once *all = arg;
    const shb_filter box = shb_filter_pcf(5, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
    all->results[index] = ask_unchecked(all->made, all->given, &box, all->seen[index]);
}

TEST(threads_that_ask_a_new_map_at_once_get_the_answers_of_one) {
    const shb_context_desc many = {.threads = ASKERS};
    const shb_map_desc desc = {
        .view = probe_orthographic(false), .width = 200, .occluders = SHB_OCCLUDERS_PLANES};
    shb_context *threads = NULL;
    soup s = {0};
    add_scene(&s);
    asked_at_once *all = malloc(sizeof *all);
    points *given = malloc(sizeof *given);
    fill_points(&s, 9, given);
    CHECK_INT(shb_context_create(&many, &threads), SHB_OK);
    for (int i = 0; i < 20; i++) {
        asked_map made = draw(SHB_ISA_BEST, &desc, &s);
        all->made = &made;
        all->given = given;
        shb_parallel_for(threads, ask_as_one_of_many, all, ASKERS);
        ask_as_one_of_many(all, ASKERS);
        for (int k = 0; k <= ASKERS; k++) {
            CHECK_INT(all->results[k], SHB_OK);
            CHECK(memcmp(all->seen[k], all->seen[ASKERS], sizeof *all->seen) == 0);
        }
        close_map(&made);
    }
    shb_context_destroy(threads);
    free(given);
    free(all);
    soup_free(&s);
}

/* ---- soft shadows ---- */

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

static double slow_soft(const shb_map *map, bool spot, double light, const points *given, int i) {
    double position[3], normal[3];
    for (int k = 0; k < 3; k++) {
        position[k] = (double)given->positions[3 * i + k];
        normal[k] = (double)given->normals[3 * i + k];
    }
    const shb_exact_fragment fragment = shb_exact_fragment_of(&map->rows, position, normal);
    const shb_light_point *p = &fragment.point;
    const double size = map->info.width, near_depth = map->info.view.reversed ? -1 : 0;
    if (!(p->w > 0 && p->x >= 0 && p->y >= 0 && p->x < size && p->y < size))
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
    add_scene(&s);
    if (spot)
        lift_into_spot(&s);
    points *given = malloc(sizeof *given);
    fill_points(&s, 6, given);
    const shb_map_desc desc = {.view = spot ? probe_perspective(reversed)
                                            : probe_orthographic(reversed),
                               .width = 64,
                               .occluders = occluders};
    asked_map made = draw(SHB_ISA_BEST, &desc, &s);
    float seen[POINTS], prepared[POINTS];
    ask(&made, given, &filter, seen);
    CHECK_INT(shb_map_prepare(made.map, &filter), SHB_OK);
    ask(&made, given, &filter, prepared);
    CHECK(memcmp(seen, prepared, sizeof seen) == 0);
    int different = 0, soft = 0;
    for (int i = 0; i < POINTS / 2; i++) {
        const double expected = slow_soft(made.map, spot, light, given, i);
        different += !(fabs((double)seen[i] - expected) < 1e-3);
        soft += expected > 0.05 && expected < 0.95;
    }
    CHECK(different <= POINTS / 400);
    CHECK(soft > POINTS / 20);
    close_map(&made);
    free(given);
    soup_free(&s);
}

TEST(exact_soft_shadows_agree_with_a_slow_search_by_the_scalar_test) {
    check_soft_against_scalar(false, false, SHB_OCCLUDERS_PLANES);
    check_soft_against_scalar(true, true, SHB_OCCLUDERS_PLANES);
    check_soft_against_scalar(false, true, SHB_OCCLUDERS_TRIANGLES);
    check_soft_against_scalar(true, false, SHB_OCCLUDERS_TRIANGLES);
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
    add_scene(&s);
    if (spot)
        lift_into_spot(&s);
    points *given = malloc(sizeof *given);
    fill_points(&s, 4, given);
    asked_map scalar = draw(SHB_ISA_SCALAR, &desc, &s);
    for (shb_isa isa = test_isa_after(SHB_ISA_SCALAR); isa < SHB_ISA_COUNT;
         isa = test_isa_after(isa)) {
        asked_map other = draw(isa, &desc, &s);
        for (int f = 0; f < filter_count; f++) {
            float expected[POINTS], actual[POINTS];
            ask(&scalar, given, &filters[f], expected);
            ask(&other, given, &filters[f], actual);
            CHECK(memcmp(expected, actual, sizeof expected) == 0);
            double lit = 0;
            for (int i = 0; i < POINTS; i++)
                lit += (double)expected[i] / POINTS;
            CHECK(lit > 0.1 && lit < 0.9);
        }
        close_map(&other);
    }
    close_map(&scalar);
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
    points *given = malloc(sizeof *given);
    int wrong = 0, covered = 0;
    for (int asked = 0; asked < count; asked += POINTS) {
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
        const bool spot = asked / POINTS % 2;
        if (spot)
            lift_into_spot(&s);
        shb_view view = spot ? probe_perspective(true) : probe_orthographic(false);
        const double size = pow(10, random_double(&random, -1, 4));
        place(&s, &view,
              (shb_vec3){size * random_double(&random, -1, 1), size * random_double(&random, -1, 1),
                         size * random_double(&random, -1, 1)});
        fill_points(&s, seed + (uint64_t)asked, given);
        const shb_map_desc desc = {.view = view,
                                   .width = 128,
                                   .height = 80,
                                   .occluders = asked / POINTS % 3 ? SHB_OCCLUDERS_PLANES
                                                                   : SHB_OCCLUDERS_TRIANGLES};
        asked_map made = draw(SHB_ISA_BEST, &desc, &s);
        float seen[POINTS];
        ask(&made, given, filter, seen);
        for (int i = 0; i < POINTS; i++)
            wrong += seen[i] != 1;
        covered += covers_middle(made.map);
        close_map(&made);
        soup_free(&s);
    }
    CHECK(covered > count / POINTS / 2);
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
    add_scene(&s);
    points *given = malloc(sizeof *given);
    fill_points(&s, 5, given);
    const shb_map_desc desc = {
        .view = probe_orthographic(false), .width = 16, .occluders = SHB_OCCLUDERS_LISTS};
    asked_map made = draw(SHB_ISA_BEST, &desc, &s);
    const shb_points list = {
        .count = POINTS, .positions = given->positions, .normals = given->normals};
    const shb_bias exact = shb_bias_exact(), none = shb_bias_none();
    const shb_filter filters[] = {shb_filter_pcf(5, SHB_UNIT_TEXEL, SHB_TAPS_PLANE),
                                  shb_filter_pcf_smooth(2, SHB_UNIT_TEXEL, SHB_TAPS_PLANE),
                                  shb_filter_jittered(4, SHB_UNIT_TEXEL, SHB_TAPS_PLANE),
                                  shb_filter_poisson(9, 4, SHB_UNIT_TEXEL, SHB_TAPS_PLANE),
                                  shb_filter_pcss(0.2f, 0, 0, SHB_TAPS_PLANE)};
    float seen[POINTS];
    for (int f = 0; f < 5; f++) {
        seen[0] = 7;
        CHECK_INT(shb_map_visibility(made.map, &list, &exact, &filters[f], seen),
                  SHB_ERROR_UNSUPPORTED);
        CHECK(seen[0] == 7);
        CHECK_INT(shb_map_visibility(made.map, &list, &none, &filters[f], seen), SHB_OK);
    }
    close_map(&made);
    free(given);
    soup_free(&s);
}
