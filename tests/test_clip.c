#include "../src/clip.h"

#include "random.h"
#include "test.h"

#include <math.h>
#include <string.h>

#define WIDTH 64
#define HEIGHT 32

static bool is_same(const shb_clip_position *a, const shb_clip_position *b) {
    return memcmp(a->v, b->v, sizeof a->v) == 0;
}

/* The corners of the polygon that are none of the triangle. */
static size_t find_cuts(const shb_polygon *polygon, const shb_clip_position corners[3],
                        shb_clip_position cuts[SHB_POLYGON_MAX]) {
    size_t count = 0;
    for (size_t i = 0; i < polygon->count; i++) {
        const shb_clip_position *p = &polygon->corners[i];
        if (!is_same(p, &corners[0]) && !is_same(p, &corners[1]) && !is_same(p, &corners[2]))
            cuts[count++] = *p;
    }
    return count;
}

TEST(both_sides_of_an_edge_are_cut_at_the_same_point) {
    /* The second triangle has the edge a b the other way round, and its third corner c inside, so
     * that its cuts are on the edge a b alone or on the other side's edges. Where a is inside and
     * b outside one plane, both have the one cut of a b. */
    const shb_clip_volume volume = shb_clip_volume_of(WIDTH, HEIGHT, false);
    test_random random = {61};
    unsigned compared = 0;
    for (int round = 0; round < 20000; round++) {
        const shb_clip_position a = {{random_double(&random, -1, 1), random_double(&random, -1, 1),
                                      random_double(&random, 0, 1), 1}};
        shb_clip_position b = a, c = a, d = a;
        const int axis = (int)random_below(&random, 3);
        for (int i = 0; i < 3; i++) {
            b.v[i] = random_double(&random, 0, 1);
            c.v[i] = random_double(&random, 0, 1);
            d.v[i] = random_double(&random, 0, 1);
        }
        b.v[axis] = -random_double(&random, 1, 2000);
        if (axis < 2 && b.v[axis] > -1100)
            continue;
        const shb_clip_position one[3] = {a, b, c}, other[3] = {b, a, d};
        shb_polygon p, q;
        CHECK_INT(shb_clip_triangle(&volume, one, &p), SHB_CLIP_CUT);
        CHECK_INT(shb_clip_triangle(&volume, other, &q), SHB_CLIP_CUT);
        shb_clip_position p_cuts[SHB_POLYGON_MAX], q_cuts[SHB_POLYGON_MAX];
        const size_t p_count = find_cuts(&p, one, p_cuts), q_count = find_cuts(&q, other, q_cuts);
        CHECK(p_count == 2 && q_count == 2);
        unsigned shared = 0;
        for (size_t i = 0; i < p_count; i++)
            for (size_t k = 0; k < q_count; k++)
                shared += is_same(&p_cuts[i], &q_cuts[k]);
        CHECK_INT(shared, 1);
        compared++;
    }
    CHECK(compared > 5000);
}

TEST(cuts_lie_exactly_on_the_near_plane) {
    for (int reversed = 0; reversed < 2; reversed++) {
        const shb_clip_volume volume = shb_clip_volume_of(WIDTH, HEIGHT, reversed);
        /* Canonical z of standard depth -1 and 0.3; reversed, 2 and 0.3 of w = 1. */
        const double before = reversed ? -2 : -1, behind = reversed ? -0.3 : 0.3;
        const shb_clip_position corners[3] = {
            {{0, 0, before, 1}}, {{0.5, 0.1, behind, 1.7}}, {{0.1, 0.7, behind, 1.3}}};
        shb_polygon polygon;
        CHECK_INT(shb_clip_triangle(&volume, corners, &polygon), SHB_CLIP_CUT);
        CHECK_INT(polygon.count, 4);
        shb_clip_position cuts[SHB_POLYGON_MAX];
        CHECK_INT(find_cuts(&polygon, corners, cuts), 2);
        for (int i = 0; i < 2; i++) {
            CHECK(cuts[i].v[2] == (reversed ? -cuts[i].v[3] : 0));
            CHECK(reversed || !signbit(cuts[i].v[2]));
        }
    }
}

/* z = 0 is the near plane, y = 1 the border. */
TEST(corners_on_a_plane_are_inside) {
    const shb_clip_volume volume = shb_clip_volume_of(WIDTH, HEIGHT, false);
    const shb_clip_position on[3] = {{{0, 0, 0, 1}}, {{0.5, 0, 0, 1}}, {{0, 0.5, 0, 1}}};
    const shb_clip_position across[3] = {{{0, 0, 0.5, 1}}, {{0.5, 0, 0, 1}}, {{0, 0.5, -1, 1}}};
    const shb_clip_position aside[3] = {{{0, 2, 0.5, 1}}, {{0.5, 2, 0.5, 1}}, {{0, 3, 0.5, 1}}};
    shb_polygon polygon;
    CHECK_INT(shb_clip_triangle(&volume, on, &polygon), SHB_CLIP_WHOLE);
    CHECK_INT(shb_clip_triangle(&volume, across, &polygon), SHB_CLIP_CUT);
    CHECK_INT(polygon.count, 4); /* the edge that leaves at a corner is cut there */
    CHECK_INT(shb_clip_triangle(&volume, aside, &polygon), SHB_CLIP_OUTSIDE);
}

TEST(what_cannot_be_projected_is_outside) {
    const shb_clip_volume volume = shb_clip_volume_of(WIDTH, HEIGHT, false);
    shb_polygon polygon;
    const shb_clip_position nothing[3] = {{{0}}, {{0}}, {{0}}};
    CHECK_INT(shb_clip_triangle(&volume, nothing, &polygon), SHB_CLIP_OUTSIDE);
    const shb_clip_position tiny[3] = {
        {{0, 0, 0, 0x1p-1030}}, {{0, 0x1p-1040, 0, 0x1p-1030}}, {{0x1p-1040, 0, 0, 0x1p-1030}}};
    CHECK_INT(shb_clip_triangle(&volume, tiny, &polygon), SHB_CLIP_OUTSIDE);
    const shb_clip_position behind[3] = {{{0, 0, 1, -1}}, {{1, 0, 1, -1}}, {{0, 1, 1, -1}}};
    CHECK_INT(shb_clip_triangle(&volume, behind, &polygon), SHB_CLIP_OUTSIDE);
}

TEST(coordinates_beyond_the_limit_are_not_finite) {
    const double values[] = {0x1p300, -0x1p300, 0x1.1p300, -0x1.1p300, HUGE_VAL, (double)NAN};
    for (int axis = 0; axis < 4; axis++)
        for (int i = 0; i < 6; i++) {
            shb_clip_position p = {{1, 1, 1, 1}};
            p.v[axis] = values[i];
            CHECK(shb_clip_is_finite(&p) == (i < 2));
        }
}
