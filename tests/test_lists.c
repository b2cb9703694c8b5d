/* Lists: the answers of the ray-cast truth for every point, at every size. */
#include "contexts.h"
#include "list_samples.h"

#include <math.h>
#include <string.h>

#include "oracle.h"
#include "scenes.h"
#include "test.h"

/* Every point of the scene gets the truth's answer, at all sizes, with exact points and ids; with
 * float points nothing lit is shadowed. */
static void check_against_truth(const shb_scene *scene, size_t count, const lists_light *l,
                                size_t least_shadowed) {
    static const uint32_t sizes[] = {8, 64, 256, 1024};
    shb_context *context = lists_context(2);
    shb_reference *reference = NULL;
    CHECK_INT(shb_reference_create(context, scene, &reference), SHB_OK);
    shb_box box;
    CHECK_INT(shb_scene_bounds(scene, &box), SHB_OK);
    list_samples exact = list_samples_create(scene, count, count),
                 rounded = list_samples_create(scene, count, count);
    list_samples_to_float(&rounded);
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        const shb_view view = lists_view(l, box, sizes[i], i % 2 == 0);
        shb_lists *lists = lists_of(context, &view, sizes[i], scene);
        list_samples_find_truth(reference, &view, &exact);
        CHECK(list_samples_occluded(&exact) >= least_shadowed);
        list_samples_ask(lists, &exact, true, 0);
        CHECK_INT(list_samples_false_shadow(&exact), 0);
        CHECK_INT(list_samples_false_light(&exact), 0);
        list_samples_ask(lists, &exact, false, 0);
        CHECK_INT(list_samples_false_shadow(&exact), 0);
        CHECK_INT(list_samples_false_light(&exact), 0);
        memcpy(rounded.occluded, exact.occluded, count);
        list_samples_ask(lists, &rounded, false, 0x1p-24);
        CHECK_INT(list_samples_false_shadow(&rounded), 0);
        shb_lists_destroy(lists);
    }
    list_samples_free(&exact);
    list_samples_free(&rounded);
    shb_reference_destroy(reference);
    shb_context_destroy(context);
}

TEST(lists_answer_as_rays_in_a_soup) {
    soup s = {0};
    test_random random = {1};
    for (int i = 0; i < 400; i++)
        soup_add_random(&s, &random, i % 7 == 0 ? 0.9 : 0.1);
    check_against_truth(soup_scene(&s), 6000, &lists_slanted, 1500);
    check_against_truth(soup_scene(&s), 6000, &lists_spot, 1500);
    soup_free(&s);
}

TEST(lists_answer_as_rays_among_needles) {
    soup s = {0};
    test_random random = {2};
    for (int i = 0; i < 300; i++) {
        float c[3][3];
        for (int k = 0; k < 2; k++)
            for (int j = 0; j < 3; j++)
                c[k][j] = (float)random_double(&random, -1, 1);
        for (int j = 0; j < 3; j++)
            c[2][j] = c[1][j] + (float)random_double(&random, -1e-3, 1e-3);
        soup_add(&s, c[0], c[1], c[2]);
    }
    const float lo[3] = {-1, -1, -1.5f}, hi[3] = {1, 1, -1.2f};
    soup_add_box(&s, lo, hi);
    check_against_truth(soup_scene(&s), 6000, &lists_slanted, 100);
    check_against_truth(soup_scene(&s), 6000, &lists_spot, 100);
    soup_free(&s);
}

TEST(lists_answer_as_rays_on_balls_and_boxes) {
    soup s = {0};
    const float centre[3] = {0, 0, 1.2f};
    soup_add_ball(&s, centre, 40, 40, NULL);
    const float ground_lo[3] = {-3, -3, -1}, ground_hi[3] = {3, 3, 0};
    soup_add_box(&s, ground_lo, ground_hi);
    for (int step = 0; step < 12; step++) { /* stairs that touch each other */
        const float x = 1.5f + 0.1f * (float)step;
        const float lo[3] = {x, -2, 0}, hi[3] = {x + 0.1f, 2, 0.1f * (float)(step + 1)};
        soup_add_box(&s, lo, hi);
    }
    check_against_truth(soup_scene(&s), 6000, &lists_slanted, 1500);
    check_against_truth(soup_scene(&s), 6000, &lists_grazing, 1500);
    check_against_truth(soup_scene(&s), 6000, &lists_spot, 1500);
    soup_free(&s);
}

/* A relief of squares whose neighbours have T-junctions, twice each, cut by a standing plane. */
TEST(lists_answer_as_rays_on_reliefs_duplicates_and_crossings) {
    soup s = {0};
    test_random random = {3};
    float height[25][25];
    for (int i = 0; i < 25; i++)
        for (int j = 0; j < 25; j++)
            height[i][j] = (float)random_double(&random, 0, 0.08);
    for (int i = 0; i < 24; i++)
        for (int j = 0; j < 24; j++) {
            const float x = (float)i / 12 - 1, y = (float)j / 12 - 1, d = 1.0f / 12;
            const float a[3] = {x, y, height[i][j]}, b[3] = {x + d, y, height[i + 1][j]};
            const float c[3] = {x + d, y + d, height[i + 1][j + 1]};
            const float e[3] = {x, y + d, height[i][j + 1]};
            soup_add_quad(&s, a, b, c, e);
            if ((i + j) % 3 == 0)
                soup_add_quad(&s, a, b, c, e);
        }
    const float a[3] = {-1, -0.3f, -0.2f}, b[3] = {1, 0.4f, -0.2f}, c[3] = {1, 0.4f, 0.5f};
    const float e[3] = {-1, -0.3f, 0.5f};
    soup_add_quad(&s, a, b, c, e);
    check_against_truth(soup_scene(&s), 6000, &lists_grazing, 1000);
    check_against_truth(soup_scene(&s), 6000, &lists_slanted, 500);
    check_against_truth(soup_scene(&s), 6000, &lists_spot, 500);
    soup_free(&s);
}

TEST(lists_answer_as_rays_on_known_meshes) {
    static const char *const paths[] = {"../shared/scenes/bunny_69k.obj",
                                        "../shared/scenes/dx_crypt.obj"};
    size_t found = 0;
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        example_scene *scene;
        char error[256];
        if (!scene_open(paths[i], &scene, error, sizeof error))
            continue;
        found++;
        shb_context *context = lists_context(2);
        shb_reference *reference = NULL;
        CHECK_INT(shb_reference_create(context, &scene->scene, &reference), SHB_OK);
        const shb_view view = lists_view(&lists_slanted, scene->bounds, 256, true);
        shb_lists *lists = lists_of(context, &view, 256, &scene->scene);
        list_samples s = list_samples_create(&scene->scene, 20000, 5);
        list_samples_find_truth(reference, &view, &s);
        list_samples_ask(lists, &s, true, 0);
        CHECK_INT(list_samples_false_shadow(&s), 0);
        CHECK_INT(list_samples_false_light(&s), 0);
        list_samples_to_float(&s);
        list_samples_ask(lists, &s, false, 0x1p-24);
        CHECK_INT(list_samples_false_shadow(&s), 0);
        list_samples_free(&s);
        shb_lists_destroy(lists);
        shb_reference_destroy(reference);
        shb_context_destroy(context);
        scene_close(scene);
    }
    if (!found)
        test_skip("no meshes in ../shared/scenes");
}

/* Two level plates a gap apart, turned so that nothing is exact; ids 0, 1 below and 2, 3 above. */
static void add_plates(soup *s, float gap) {
    for (int plate = 0; plate < 2; plate++) {
        const float z = plate ? gap : 0, half = plate ? 0.4f : 0.35f;
        const float a[3] = {-half, -half, z}, b[3] = {half, -half, z};
        const float c[3] = {half, half, z}, d[3] = {-half, half, z};
        soup_add_quad(s, a, b, c, d);
    }
    s->transform = shb_mat4_rotation((shb_vec3){1, 2, 3}, 1);
}

static size_t shadowed_below(float gap, double rounding, size_t *shadowed_above) {
    soup s = {0};
    add_plates(&s, gap);
    const shb_scene *scene = soup_scene(&s);
    shb_context *context = lists_context(1);
    shb_box box;
    CHECK_INT(shb_scene_bounds(scene, &box), SHB_OK);
    const shb_mat4 turn = s.transform;
    const lists_light above = {false, {turn.m[8] + 0.2, turn.m[9], turn.m[10]}};
    const shb_view view = lists_view(&above, box, 64, true);
    shb_lists *lists = lists_of(context, &view, 64, scene);
    list_samples points = list_samples_create(scene, 2000, 7);
    if (rounding > 0)
        list_samples_to_float(&points);
    list_samples_ask(lists, &points, false, rounding);
    size_t below = 0;
    *shadowed_above = 0;
    for (size_t i = 0; i < points.count; i++) {
        const bool is_below = points.own_ids[i] < 2;
        below += is_below;
        if (points.visibility[i] > 0.5f)
            continue;
        below -= is_below;
        *shadowed_above += !is_below;
    }
    list_samples_free(&points);
    shb_lists_destroy(lists);
    shb_context_destroy(context);
    soup_free(&s);
    return below; /* those that are lit */
}

TEST(a_gap_of_rounding_size_casts_a_shadow) {
    size_t above;
    CHECK_INT(shadowed_below(1e-7f, 0, &above), 0);
    CHECK_INT(above, 0);
    CHECK_INT(shadowed_below(1e-12f, 0, &above), 0);
    CHECK_INT(above, 0);
    CHECK_INT(shadowed_below(5e-7f, 0x1p-24, &above), 0);
    CHECK_INT(above, 0);
}

TEST(coincident_triangles_do_not_shadow_each_other) {
    size_t above;
    CHECK(shadowed_below(0, 0, &above) > 0);
    CHECK_INT(above, 0);
}

/* Points moved away from the light, behind the plate that they are said to lie on. */
static void ask_behind_own_plate(shb_isa isa) {
    soup s = {0};
    const float a[3] = {-0.4f, -0.4f, 0}, b[3] = {0.4f, -0.4f, 0};
    const float c[3] = {0.4f, 0.4f, 0}, d[3] = {-0.4f, 0.4f, 0};
    soup_add_quad(&s, a, b, c, d);
    const shb_scene *scene = soup_scene(&s);
    shb_context *context = test_context(1, isa);
    const shb_box box = {{-1, -1, -1}, {1, 1, 1}};
    const lists_light above = {false, {0, 0, 1}};
    const shb_view view = lists_view(&above, box, 16, false);
    shb_lists *lists = lists_of(context, &view, 16, scene);
    list_samples points = list_samples_create(scene, 1000, 11);
    for (size_t i = 0; i < points.count; i++)
        points.z[i] -= 0.125;
    list_samples_ask(lists, &points, false, 0x1p-24);
    for (size_t i = 0; i < points.count; i++)
        CHECK(points.visibility[i] == 0);
    list_samples_ask(lists, &points, true, 0x1p-24);
    for (size_t i = 0; i < points.count; i++)
        CHECK(points.visibility[i] == 1);
    for (size_t i = 0; i < points.count; i++)
        points.own_ids[i] ^= (uint32_t)i & 1;
    list_samples_ask(lists, &points, true, 0x1p-24);
    for (size_t i = 0; i < points.count; i++)
        CHECK(points.visibility[i] == (i & 1 ? 0 : 1));
    list_samples_free(&points);
    shb_lists_destroy(lists);
    shb_context_destroy(context);
    soup_free(&s);
}

TEST(a_points_own_triangle_does_not_shadow_it_however_far_it_lies_behind) {
    for (shb_isa isa = SHB_ISA_SCALAR; isa < SHB_ISA_COUNT; isa++)
        ask_behind_own_plate(isa);
}

/* Below the edge that two triangles share, which leaves both to the ray. */
TEST(an_own_triangle_that_is_not_finite_takes_no_shadow_away) {
    soup s = {0};
    soup_add_quad(&s, (float[]){-1, -1, 0}, (float[]){1, -1, 0}, (float[]){1, 1, 0},
                  (float[]){-1, 1, 0});
    for (int corner = 0; corner < 3; corner++) {
        float own[9] = {0, 0, -0.5f, 1, 0, -0.5f, 0, 1, -0.5f};
        own[3 * corner + 2] = corner == 1 ? INFINITY : NAN;
        soup_add(&s, own, own + 3, own + 6);
    }
    shb_context *context = lists_context(1);
    const shb_box box = {{-1, -1, -1}, {1, 1, 1}};
    const shb_view view = lists_view(&(lists_light){false, {0, 0, 1}}, box, 16, false);
    shb_lists *lists = lists_of(context, &view, 16, soup_scene(&s));
    const double x[] = {0, 0, 0}, z[] = {-0.5, -0.5, -0.5};
    const uint32_t own_ids[] = {2, 3, 4};
    float visibility[3];
    shb_lists_query(lists,
                    &(shb_list_points){.count = 3, .x = x, .y = x, .z = z, .own_ids = own_ids},
                    visibility);
    for (int i = 0; i < 3; i++)
        CHECK(visibility[i] == 0);
    shb_lists_destroy(lists);
    shb_context_destroy(context);
    soup_free(&s);
}

/* A plate hinged on the ground at y = 0 and one degree (slope 0.0175): its shadow begins there. */
TEST(a_shadow_begins_at_its_hinge) {
    soup s = {0};
    const float ground[4][3] = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    soup_add_quad(&s, ground[0], ground[1], ground[2], ground[3]);
    const float plate[4][3] = {{-1, 0, 0}, {1, 0, 0}, {1, 1, 0.0175f}, {-1, 1, 0.0175f}};
    soup_add_quad(&s, plate[0], plate[1], plate[2], plate[3]);
    shb_context *context = lists_context(1);
    const shb_view view = lists_view(&(lists_light){false, {0.1, 0.05, 1}},
                                     (shb_box){{-1, -1, 0}, {1, 1, 0.1}}, 64, true);
    shb_lists *lists = lists_of(context, &view, 64, soup_scene(&s));
    for (double distance = 0.5; distance > 1e-12; distance *= 0.5) {
        const double x = 0.123, z = 0, behind = distance, before = -distance;
        float visibility[2];
        lists_ask_one(lists, x, behind, z, &visibility[0]);
        lists_ask_one(lists, x, before, z, &visibility[1]);
        CHECK(visibility[0] == 0 && visibility[1] == 1);
    }
    shb_lists_destroy(lists);
    shb_context_destroy(context);
    soup_free(&s);
}

TEST(what_the_light_does_not_see_is_lit) {
    soup s = {0};
    const float corners[3][3] = {{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}};
    soup_add(&s, corners[0], corners[1], corners[2]);
    shb_view view;
    CHECK_INT(shb_view_perspective((shb_vec3){0, 0, 4}, (shb_vec3){0, 0, 0}, (shb_vec3){0, 1, 0}, 1,
                                   1, 1, 8, false, &view),
              SHB_OK);
    shb_context *context = lists_context(1);
    shb_lists *lists = lists_of(context, &view, 16, soup_scene(&s));
    /* behind the triangle, also beyond the far plane; before it; outside; behind the light; none */
    const double x[] = {0, 0, 0, 3, 0, (double)NAN, 0}, y[7] = {0};
    const double z[] = {-1, -90, 1, -1, 9, -1, -HUGE_VAL};
    const float expected[] = {0, 0, 1, 1, 1, 1, 1};
    float visibility[7];
    shb_lists_query(lists, &(shb_list_points){.count = 7, .x = x, .y = y, .z = z}, visibility);
    for (int i = 0; i < 7; i++)
        CHECK(visibility[i] == expected[i]);
    shb_lists_destroy(lists);
    shb_context_destroy(context);
    soup_free(&s);
}

TEST(lists_of_nothing_light_everything) {
    const shb_scene scene = {0};
    const shb_view view = lists_view(&lists_slanted, (shb_box){{-1, -1, -1}, {1, 1, 1}}, 8, false);
    shb_context *context = lists_context(1);
    shb_lists *lists = lists_of(context, &view, 8, &scene);
    const double x = 0, y = 0, z = 0;
    float visibility = 0;
    lists_ask_one(lists, x, y, z, &visibility);
    CHECK(visibility == 1);
    shb_lists_destroy(lists);
    shb_context_destroy(context);
}
