/* Walks over small meshes whose triangles are known by hand: ribbons with a profile in x and z that
 * are as wide as the view in y, under a light above them. Segment i of a ribbon is the triangles
 * 2 i, which has its first point at y = -0.9, and 2 i + 1. */
#include "../src/exact_sheet.h"
#include "contexts.h"
#include "probe.h"
#include "random.h"
#include "slow_walk.h"
#include "soup.h"
#include "test.h"

#include <math.h>

/* The longest ribbon has a triangle more than a walk. */
enum { SIZE = 16, POINTS_MAX = SHB_WALK_MAX / 2 + 2 };

/* A point of a profile; the light's view is -1 < x < 1. */
typedef struct profile_point {
    float x, z;
} profile_point;

typedef struct ribbon {
    soup s;
    profile_point points[POINTS_MAX];
    int count;
    shb_context *context;
    shb_map *map;
} ribbon;

static void add_segment(soup *s, profile_point a, profile_point b, bool is_turned) {
    const float corners[4][3] = {
        {a.x, -0.9f, a.z}, {b.x, -0.9f, b.z}, {b.x, 0.9f, b.z}, {a.x, 0.9f, a.z}};
    if (is_turned)
        soup_add_quad(s, corners[2], corners[1], corners[0], corners[3]);
    else
        soup_add_quad(s, corners[0], corners[1], corners[2], corners[3]);
}

static void draw(ribbon *r) {
    const shb_map_desc desc = {
        .view = probe_orthographic(false), .width = SIZE, .occluders = SHB_OCCLUDERS_TRIANGLES};
    r->context = test_context(0, SHB_ISA_BEST);
    CHECK_INT(shb_map_create(r->context, &desc, &r->map), SHB_OK);
    CHECK_INT(shb_map_draw(r->map, soup_scene(&r->s), NULL, NULL), SHB_OK);
}

/* windings: the segments whose bit is set are wound the other way. */
static ribbon ribbon_of(int count, const profile_point *points, uint32_t windings) {
    ribbon r = {.count = count};
    for (int i = 0; i < count; i++)
        r.points[i] = points[i];
    for (int i = 0; i + 1 < count; i++)
        add_segment(&r.s, points[i], points[i + 1], windings >> i & 1);
    draw(&r);
    return r;
}

static void ribbon_free(ribbon *r) {
    shb_map_destroy(r->map);
    shb_context_destroy(r->context);
    soup_free(&r->s);
}

/* Either winding has the diagonal from the first point at y = -0.9 to the second at y = 0.9. */
static uint32_t triangle_at(const ribbon *r, int segment, double x, double y) {
    const double from = (double)r->points[segment].x, to = (double)r->points[segment + 1].x;
    const bool below = (y + 0.9) / 1.8 < (x - from) / (to - from);
    return (uint32_t)(2 * segment + !below);
}

typedef struct line {
    double from[2], to[2];
} line;

static line line_of(double from_x, double to_x, double y) {
    const double row = (1 - y) * SIZE / 2;
    return (line){{(from_x + 1) * SIZE / 2, row}, {(to_x + 1) * SIZE / 2, row}};
}

static slow_walk walk_of(const ribbon *r, int segment, double from_x, double to_x, double y) {
    const line l = line_of(from_x, to_x, y);
    slow_walk walk;
    slow_walk_begin(&r->map->occluders.mesh, triangle_at(r, segment, from_x, y), l.from, l.to,
                    &walk);
    return walk;
}

/* The first triangle that a walk meets, its own first one included. */
static uint32_t first_of(slow_walk *walk) {
    const bool covers = shb_edges_before(&walk->mesh->triangles[walk->first], walk->to) == 0;
    return covers ? walk->first : slow_walk_next(walk);
}

/* The end of the way over the sheet. */
static uint32_t straight(const ribbon *r, int segment, double from_x, double to_x, double y) {
    const line l = line_of(from_x, to_x, y);
    return shb_sheet_end(&r->map->occluders.mesh, triangle_at(r, segment, from_x, y), l.from, l.to);
}

/* Over 20 triangles to the one that covers the place, whatever the winding of each. */
TEST(walks_arrive_at_the_triangle_that_covers_the_place) {
    profile_point points[11];
    for (int i = 0; i < 11; i++)
        points[i] = (profile_point){-0.8f + 0.16f * (float)i, i % 2 ? 0.2f : 0.1f};
    test_random random = {31};
    for (int n = 0; n < 8; n++) {
        const uint32_t windings = n ? random_below(&random, 1u << 10) : 0;
        ribbon r = ribbon_of(11, points, windings);
        for (int i = 0; i < 200; i++) {
            const double from = random_double(&random, -0.79, 0.79);
            const double to = random_double(&random, -0.79, 0.79);
            const double y = random_double(&random, -0.85, 0.85);
            const int first = (int)((from + 0.8) / 0.16), last = (int)((to + 0.8) / 0.16);
            const uint32_t expected = triangle_at(&r, last, to, y);
            CHECK_INT(straight(&r, first, from, to, y), expected);
            slow_walk walk = walk_of(&r, first, from, to, y);
            CHECK_INT(first_of(&walk), expected);
        }
        ribbon_free(&r);
    }
}

/* The roof ends at x = 0.5, where the mesh turns round and goes back under it. */
static const profile_point folded[] = {{-0.6f, 0.5f}, {0.5f, 0.6f}, {-0.6f, 0.2f}};

TEST(walks_go_on_below_a_fold) {
    ribbon r = ribbon_of(3, folded, 0);
    slow_walk walk = walk_of(&r, 0, 0.3, 0.45, 0.1);
    CHECK_INT(first_of(&walk), triangle_at(&r, 0, 0.45, 0.1));
    CHECK_INT(slow_walk_next(&walk), triangle_at(&r, 1, 0.45, 0.1));
    ribbon_free(&r);
}

/* Beyond the fold there is nothing; the line is lost sight of below the roof, two texels before the
 * start, where the mesh still goes on. */
TEST(a_sheet_ends_where_it_turns_round) {
    for (uint32_t windings = 0; windings < 4; windings++) {
        ribbon r = ribbon_of(3, folded, windings);
        CHECK_INT(straight(&r, 0, 0.3, 0.7, 0.1), SHB_ID_NONE);
        slow_walk walk = walk_of(&r, 0, 0.3, 0.7, 0.1);
        CHECK_INT(slow_walk_next(&walk), SHB_ID_NONE);
        CHECK(!walk.cut);
        ribbon_free(&r);
    }
}

/* A fold that folds again reaches places that the sheet itself does not. */
TEST(walks_go_on_over_two_folds) {
    static const profile_point points[] = {{-0.6f, 0.6f}, {0.5f, 0.7f}, {0.3f, 0.4f}, {0.9f, 0.3f}};
    for (uint32_t windings = 0; windings < 8; windings++) {
        ribbon r = ribbon_of(4, points, windings);
        CHECK_INT(straight(&r, 0, 0.4, 0.55, 0.2), SHB_ID_NONE);
        slow_walk walk = walk_of(&r, 0, 0.4, 0.55, 0.2);
        CHECK_INT(slow_walk_next(&walk), triangle_at(&r, 2, 0.55, 0.2));
        ribbon_free(&r);
    }
}

/* A riser that the light sees edge-on covers nothing, and nobody can tell whether it is a fold: the
 * sheet ends. */
TEST(walks_pass_what_is_seen_edge_on) {
    static const profile_point points[] = {
        {-0.6f, 0.6f}, {0.125f, 0.6f}, {0.125f, 0.3f}, {0.9f, 0.3f}};
    ribbon r = ribbon_of(4, points, 0);
    slow_walk walk = walk_of(&r, 0, 0.05, 0.2, 0.3);
    CHECK_INT(slow_walk_next(&walk), triangle_at(&r, 2, 0.2, 0.3));
    CHECK_INT(straight(&r, 0, 0.05, 0.2, 0.3), SHB_ID_NONE);
    ribbon_free(&r);
}

/* Through a box of half a texel, which no end of the reach cuts: each of the two triangles that
 * cover the place is met once. */
TEST(walks_come_round_once) {
    ribbon r = {0};
    const float lo[3] = {0.01f, -0.02f, 0.2f}, hi[3] = {0.07f, 0.04f, 0.3f};
    soup_add_box(&r.s, lo, hi);
    draw(&r);
    const line l = line_of(0.0625, 0.03, 0.0123);
    const shb_light_mesh *mesh = &r.map->occluders.mesh;
    for (uint32_t first = 0; first < 12; first++) {
        slow_walk walk;
        slow_walk_begin(mesh, first, l.from, l.to, &walk);
        const bool covers = shb_edges_before(&mesh->triangles[first], l.to) == 0;
        int met = covers;
        for (uint32_t id; (id = slow_walk_next(&walk)) != SHB_ID_NONE; met++)
            CHECK_INT(shb_edges_before(&mesh->triangles[id], l.to), 0);
        CHECK(!walk.cut);
        CHECK(covers ? met == 2 : met <= 2);
    }
    ribbon_free(&r);
}

TEST(walks_are_cut_at_borders) {
    static const profile_point points[] = {{-0.6f, 0.6f}, {0.1f, 0.6f}, {0.5f, 0.5f}};
    ribbon r = ribbon_of(3, points, 0);
    slow_walk walk = walk_of(&r, 0, 0, 0.7, 0.3);
    CHECK_INT(slow_walk_next(&walk), SHB_ID_NONE);
    CHECK(walk.cut);
    CHECK_INT(slow_walk_next(&walk), SHB_ID_NONE);
    ribbon_free(&r);
}

/* From the first triangle of a ribbon on there are two for each segment, the first one where the
 * line has not yet crossed the diagonal, at 5/9 of the segment for y = 0.1. */
TEST(walks_are_cut_where_they_get_too_long) {
    const int last = SHB_WALK_MAX / 2;
    const double start = -0.9, width = 1.8 / (last + 1);
    ribbon r = {.count = last + 2};
    for (int i = 0; i <= last + 1; i++)
        r.points[i] = (profile_point){(float)(start + width * i), i % 2 ? 0.2f : 0.1f};
    for (int i = 0; i <= last; i++)
        add_segment(&r.s, r.points[i], r.points[i + 1], false);
    draw(&r);
    for (int too_long = 0; too_long < 2; too_long++) {
        const int segment = too_long ? last : last - 1;
        const double to = start + width * (segment + (too_long ? 0.25 : 0.75));
        slow_walk walk = walk_of(&r, 0, start + 0.25 * width, to, 0.1);
        CHECK_INT(slow_walk_next(&walk),
                  too_long ? SHB_ID_NONE : triangle_at(&r, segment, to, 0.1));
        CHECK(!too_long || walk.cut);
        CHECK_INT(slow_walk_next(&walk), SHB_ID_NONE);
    }
    ribbon_free(&r);
}

/* The second segment rises through the light's near plane, z = 4, or has no height there: its
 * triangles are not followed, whether a way comes to them or begins there. */
TEST(walks_are_cut_at_the_near_plane) {
    const float heights[] = {5, NAN};
    for (int i = 0; i < 2; i++) {
        const profile_point points[] = {
            {-0.6f, 0.5f}, {0.1f, 0.6f}, {0.5f, heights[i]}, {0.9f, 0.5f}};
        ribbon r = ribbon_of(4, points, 0);
        for (int segment = 0; segment < 2; segment++) {
            const double from = segment ? 0.2 : 0;
            CHECK_INT(straight(&r, segment, from, 0.3, 0.1), SHB_ID_NONE);
            slow_walk walk = walk_of(&r, segment, from, 0.3, 0.1);
            CHECK_INT(slow_walk_next(&walk), SHB_ID_NONE);
            CHECK(walk.cut);
        }
        ribbon_free(&r);
    }
}

/* A roof that folds back beyond the place and, below, forth again before the start: walks look as
 * far as two texels, 0.25, beyond both. */
TEST(walks_follow_folds_as_far_as_their_reach) {
    const double from = 0, to = 0.25;
    for (int i = 0; i < 4; i++) {
        const bool is_back_near = i & 1, is_forth_near = i & 2;
        const float back = is_back_near ? 0.4375f : 0.5625f;
        const float forth = is_forth_near ? -0.1875f : -0.3125f;
        const profile_point points[] = {{-0.9f, 0.6f}, {back, 0.5f}, {forth, 0.3f}, {0.9f, 0.2f}};
        ribbon r = ribbon_of(4, points, 0);
        slow_walk walk = walk_of(&r, 0, from, to, 0.1);
        if (is_back_near)
            CHECK_INT(slow_walk_next(&walk), triangle_at(&r, 1, to, 0.1));
        if (is_back_near && is_forth_near)
            CHECK_INT(slow_walk_next(&walk), triangle_at(&r, 2, to, 0.1));
        CHECK_INT(slow_walk_next(&walk), SHB_ID_NONE);
        CHECK(!walk.cut || (is_back_near && is_forth_near));
        ribbon_free(&r);
    }
}

/* Three segments meet at x = 0.125: which of two the line follows is anyone's guess. */
TEST(walks_are_cut_where_three_triangles_meet) {
    ribbon r = {.count = 4, .points = {{-0.6f, 0.6f}, {0.125f, 0.6f}, {0.8f, 0.5f}, {0.8f, 0.2f}}};
    add_segment(&r.s, r.points[0], r.points[1], false);
    add_segment(&r.s, r.points[1], r.points[2], false);
    add_segment(&r.s, r.points[1], r.points[3], false);
    draw(&r);
    slow_walk walk = walk_of(&r, 0, 0, 0.3, 0.3);
    CHECK_INT(slow_walk_next(&walk), SHB_ID_NONE);
    CHECK(walk.cut);
    ribbon_free(&r);
}

/* The second segment begins 2^-20 above where the first one ends: another vertex. */
TEST(walks_are_cut_where_positions_differ) {
    ribbon r = {.count = 3, .points = {{-0.6f, 0.6f}, {0.125f, 0.6f}, {0.8f, 0.5f}}};
    profile_point above = r.points[1];
    above.z += 0x1p-20f;
    add_segment(&r.s, r.points[0], r.points[1], false);
    add_segment(&r.s, above, r.points[2], false);
    draw(&r);
    CHECK_INT(straight(&r, 0, 0, 0.3, 0.3), SHB_ID_NONE);
    ribbon_free(&r);
}

/* A triangle whose corners fall together lies on an edge of two others and parts them not. */
TEST(triangles_without_corners_are_no_obstacle) {
    static const profile_point points[] = {{-0.6f, 0.6f}, {0.125f, 0.6f}, {0.8f, 0.5f}};
    ribbon r = {.count = 3, .points = {points[0], points[1], points[2]}};
    add_segment(&r.s, points[0], points[1], false);
    add_segment(&r.s, points[1], points[2], false);
    const float a[3] = {0.125f, -0.9f, 0.6f}, b[3] = {0.125f, 0.9f, 0.6f};
    soup_add(&r.s, a, b, b);
    soup_add(&r.s, a, a, b);
    draw(&r);
    CHECK_INT(straight(&r, 0, 0, 0.3, 0.3), triangle_at(&r, 1, 0.3, 0.3));
    ribbon_free(&r);
}

static float visibility_of(const ribbon *r, const float position[3], const float normal[3]) {
    const shb_points points = {.count = 1, .positions = position, .normals = normal};
    const shb_bias exact = shb_bias_exact();
    float visibility = -1;
    CHECK_INT(shb_map_visibility(r->map, &points, &exact, NULL, &visibility), SHB_OK);
    return visibility;
}

/* Visibility at a place of the map, from a point at that height. */
static float visibility_at(const ribbon *r, double x, double y, double z) {
    return visibility_of(r, (float[]){(float)x, (float)y, (float)z}, (float[]){0, 0, 1});
}

/* A ground whose end is bent back over itself by half a texel, between two rows of samples: those
 * at -0.0625 see the ground, those at 0.0625 nothing. Under the lip, -0.03 < x < 0.05, is shadow.
 */
TEST(what_hangs_on_the_far_side_of_a_fragment_shadows_it) {
    static const profile_point points[] = {{-0.9f, 0}, {0.05f, 0}, {-0.03f, 0.25f}};
    ribbon r = ribbon_of(3, points, 0);
    for (int i = 0; i < 50; i++) {
        const double x = -0.06 + 0.1 * i / 49, y = -0.8125 + 0.125 * (i % 13) + 0.01;
        CHECK(visibility_at(&r, x, y, 0) == (x < -0.03 ? 1.0f : 0.0f));
    }
    ribbon_free(&r);
}

/* The top of a post that no sample sees, beside a box whose edge at 0.08 lies between samples: the
 * one at 0.0625 sees the box, the next one the ground. Both are on the post's texels, and its
 * plane lies behind the box's, but the box ends before it. */
TEST(a_sheet_that_turns_round_before_the_fragment_does_not_shadow_it) {
    ribbon r = {0};
    const float ground_lo[3] = {-1, -1, -0.5f}, ground_hi[3] = {1, 1, 0};
    const float box_lo[3] = {-0.5f, -0.9f, 0}, box_hi[3] = {0.08f, 0.9f, 0.6f};
    const float post_lo[3] = {0.09f, -0.9f, 0}, post_hi[3] = {0.11f, 0.9f, 0.3f};
    soup_add_box(&r.s, ground_lo, ground_hi);
    soup_add_box(&r.s, box_lo, box_hi);
    soup_add_box(&r.s, post_lo, post_hi);
    draw(&r);
    for (int i = 0; i < 50; i++)
        CHECK(visibility_at(&r, 0.0905 + 0.019 * i / 49, -0.8 + 0.03 * i, 0.3) == 1);
    ribbon_free(&r);
}

/* A roof that goes over into a ramp and a floor, above which a point hovers. Of the 7 x 7 texels
 * around it one column is on the roof; the ramp's plane passes behind the point. The roof's sheet
 * leads to the floor below the point, which is not its own. */
TEST(a_sheet_that_goes_on_behind_a_point_shadows_it) {
    static const profile_point points[] = {{-0.9f, 1}, {0, 1}, {0.2f, -1}, {0.9f, -1}};
    ribbon r = ribbon_of(4, points, 0);
    const float position[] = {0.26f, 0.1f, 0}, normal[] = {0, 0, 1};
    const shb_points asked = {.count = 1, .positions = position, .normals = normal};
    const shb_bias exact = shb_bias_exact();
    const shb_filter box = shb_filter_pcf(7, SHB_UNIT_DEPTH, SHB_TAPS_PLANE);
    float visibility = -1;
    CHECK_INT(shb_map_visibility(r.map, &asked, &exact, &box, &visibility), SHB_OK);
    CHECK_NEAR(visibility, 6.0 / 7, 1e-6);
    ribbon_free(&r);
}

/* A slit between two boxes on the ground, seen by no sample: all of them are on the boxes. */
TEST(a_slit_between_boxes_lets_the_light_through) {
    ribbon r = {0};
    const float ground_lo[3] = {-1, -1, -0.5f}, ground_hi[3] = {1, 1, 0};
    const float left_lo[3] = {-0.5f, -0.9f, 0}, left_hi[3] = {0.08f, 0.9f, 0.6f};
    const float right_lo[3] = {0.11f, -0.9f, 0}, right_hi[3] = {0.5f, 0.9f, 0.6f};
    soup_add_box(&r.s, ground_lo, ground_hi);
    soup_add_box(&r.s, left_lo, left_hi);
    soup_add_box(&r.s, right_lo, right_hi);
    draw(&r);
    for (int i = 0; i < 50; i++) {
        const double x = 0.065 + 0.06 * i / 49;
        CHECK(visibility_at(&r, x, -0.8 + 0.03 * i, 0) == (x > 0.08 && x < 0.11 ? 1.0f : 0.0f));
    }
    ribbon_free(&r);
}

/* Squares of a third of a texel, each at a height of its own: nothing is welded. All walks are cut,
 * and the samples' planes are what is left: below them all is dark. */
TEST(below_what_is_not_welded_planes_answer) {
    ribbon r = {0};
    const float low[4][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}};
    soup_add_quad(&r.s, low[0], low[1], low[2], low[3]);
    for (int i = 0; i < 24; i++)
        for (int k = 0; k < 24; k++) {
            const float side = 0.125f / 3, x = -0.5f + side * (float)i, y = -0.5f + side * (float)k;
            const float z = 0.5f + 0x1p-12f * (float)(i * 24 + k);
            soup_add_quad(&r.s, (float[]){x, y, z}, (float[]){x + side, y, z},
                          (float[]){x + side, y + side, z}, (float[]){x, y + side, z});
        }
    draw(&r);
    test_random random = {32};
    for (int i = 0; i < 400; i++) {
        const double x = random_double(&random, -0.43, 0.43),
                     y = random_double(&random, -0.43, 0.43);
        CHECK(visibility_at(&r, x, y, -1) == 0);
        CHECK(visibility_at(&r, 0.7, y, -1) == 1);
    }
    ribbon_free(&r);
}

/* Such squares, 2^-20 apart and so hardly beside the plane z = x - y / 2: points at 0.05 below it
 * are dark and those above it lit, whichever way they lie from the sample that is asked. */
TEST(below_slanted_pieces_that_are_not_welded_planes_answer) {
    static const float normal[] = {-1, 0.5f, 1};
    ribbon r = {0};
    for (int i = 0; i < 24; i++)
        for (int k = 0; k < 24; k++) {
            const float side = 0.125f / 3, raised = 0x1p-20f * (float)(i * 24 + k);
            float corners[4][3];
            for (int n = 0; n < 4; n++) {
                corners[n][0] = -0.5f + side * (float)(i + (n == 1 || n == 2));
                corners[n][1] = -0.5f + side * (float)(k + (n >= 2));
                corners[n][2] = corners[n][0] - 0.5f * corners[n][1] + raised;
            }
            soup_add_quad(&r.s, corners[0], corners[1], corners[2], corners[3]);
        }
    draw(&r);
    test_random random = {33};
    for (int i = 0; i < 400; i++) {
        const float x = (float)random_double(&random, -0.43, 0.43);
        const float y = (float)random_double(&random, -0.43, 0.43);
        const float z = x - 0.5f * y;
        CHECK(visibility_of(&r, (float[]){x, y, z - 0.05f}, normal) == 0);
        CHECK(visibility_of(&r, (float[]){x, y, z + 0.05f}, normal) == 1);
    }
    ribbon_free(&r);
}
