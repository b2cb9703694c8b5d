/* Vertices as lists see them: every instruction set does what is done one by one here. */
#include "list_samples.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "isas.h"
#include "test.h"

enum { GROUP = SHB_LIST_GROUP };

/* Usable ones, some beside the view or behind the light, and some that are too large or no numbers.
 */
static void make_places(test_random *random, bool all_usable, shb_list_places *places) {
    static const float odd[] = {NAN, INFINITY, -INFINITY, FLT_MAX, -FLT_MAX, 0, -0.0f, FLT_MIN};
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < GROUP; i++) {
            const bool is_odd = !all_usable && random_below(random, 8) == 0;
            places->mesh[k][i] =
                is_odd ? odd[random_below(random, 8)] : (float)random_double(random, -9, 9);
        }
}

static double product(const double row[4], const double p[3]) {
    return ((row[0] * p[0] + row[1] * p[1]) + row[2] * p[2]) + row[3];
}

/* The vertex at a place of the world, by the meaning of shb_list_vertex: drawing leaves out what
 * reaches beyond 2^300. */
static shb_list_vertex vertex_at(const shb_list_frame *frame, const double p[3]) {
    double clip[4];
    for (int r = 0; r < 4; r++)
        clip[r] = product(frame->rows[r], p);
    for (int r = 0; r < 4; r++)
        if (!(fabs(clip[r]) <= 0x1p300))
            return (shb_list_vertex){.inverse_w = (double)NAN};
    if (clip[2] < frame->near_depth * clip[3] || clip[3] < DBL_MIN)
        return (shb_list_vertex){0};
    const double inverse = 1 / clip[3];
    return (shb_list_vertex){clip[0] * inverse, clip[1] * inverse, clip[2] * inverse, inverse};
}

static void check_places(const shb_mat4 *transform, const shb_list_places *places) {
    const double *m = transform->m;
    for (int i = 0; i < GROUP; i++)
        for (int k = 0; k < 3; k++) {
            const double expected = m[k] * (double)places->mesh[0][i] +
                                    m[4 + k] * (double)places->mesh[1][i] +
                                    m[8 + k] * (double)places->mesh[2][i] + m[12 + k];
            CHECK(places->world[k][i] == expected ||
                  (isnan(expected) && isnan(places->world[k][i])));
        }
}

/* Adds up the extent on the way. Returns how many of each kind there were: seen, in front of the
 * near plane, left out. */
static void check_vertices(const shb_list_frame *frame, const shb_list_places *places,
                           const shb_list_vertex *seen, shb_list_extent *extent, size_t kinds[3]) {
    for (int i = 0; i < GROUP; i++) {
        const double p[3] = {places->world[0][i], places->world[1][i], places->world[2][i]};
        const shb_list_vertex expected = vertex_at(frame, p);
        CHECK(memcmp(&seen[i], &expected, offsetof(shb_list_vertex, inverse_w)) == 0);
        kinds[isnan(expected.inverse_w) ? 2 : expected.inverse_w == 0]++;
        if (isnan(expected.inverse_w)) {
            CHECK(isnan(seen[i].inverse_w));
            continue;
        }
        CHECK(seen[i].inverse_w == expected.inverse_w);
        shb_list_extent_add(extent, p, expected.z, expected.inverse_w > 0);
    }
}

static void check_isa(shb_isa isa, const shb_view *view, size_t kinds[3]) {
    const shb_mat4 transform = {
        {0.9, 0.1, -0.2, 0, 0.3, 1.1, 0.05, 0, -0.4, 0.2, 0.8, 0, 0.5, -0.3, 2, 1}};
    test_random random = {41};
    shb_list_frame frame;
    CHECK_INT(shb_list_frame_init(view, 300, 200, &frame), SHB_OK);
    shb_list_extent expected = shb_list_extent_none(), extent = shb_list_extent_none();
    for (int group = 0; group < 40; group++) {
        shb_list_places places;
        shb_list_vertex seen[GROUP];
        make_places(&random, group % 2 == 0, &places);
        shb_list_kernels_of(isa)->see(&frame, &transform, &places, seen, &extent);
        check_places(&transform, &places);
        check_vertices(&frame, &places, seen, &expected, kinds);
        CHECK(extent.reach == expected.reach && extent.nearest == expected.nearest &&
              extent.farthest == expected.farthest);
    }
}

TEST(vertices_are_seen_in_groups_as_one_by_one) {
    const shb_box box = {{-2, -2, -2}, {2, 2, 2}};
    for (int i = 0; i < 4; i++) {
        const shb_view view = lists_view(i < 2 ? &lists_spot : &lists_slanted, box, 256, i % 2);
        for (shb_isa isa = SHB_ISA_SCALAR; isa < SHB_ISA_COUNT; isa = test_isa_after(isa)) {
            size_t kinds[3] = {0};
            check_isa(isa, &view, kinds);
            CHECK(kinds[0] > 300 && kinds[1] > 100 && kinds[2] > 100);
        }
    }
}
