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

/* The truth for a light whose rays begin at the near plane: 113 bits, no hierarchy, plane by plane.
 * True if the triangle meets the segment from the point to the light, behind the near plane. */
static bool blocks_behind_near(const shb_view *view, const shb_light_source *source,
                               const shb_vec3 corners[3], shb_vec3 point) {
    const oracle_real p[3] = {oracle_exact(point.x), oracle_exact(point.y), oracle_exact(point.z)};
    const oracle_real d[3] = {oracle_exact(source->position.x) - p[0],
                              oracle_exact(source->position.y) - p[1],
                              oracle_exact(source->position.z) - p[2]};
    oracle_real a[3][3];
    for (int k = 0; k < 3; k++) {
        a[k][0] = oracle_exact(corners[k].x) - p[0];
        a[k][1] = oracle_exact(corners[k].y) - p[1];
        a[k][2] = oracle_exact(corners[k].z) - p[2];
    }
    oracle_real volume[3], total = 0, at[3] = {0};
    for (int k = 0; k < 3; k++) {
        const oracle_real *u = a[(k + 1) % 3], *v = a[(k + 2) % 3];
        volume[k] = d[0] * (u[1] * v[2] - u[2] * v[1]) + d[1] * (u[2] * v[0] - u[0] * v[2]) +
                    d[2] * (u[0] * v[1] - u[1] * v[0]);
        total += volume[k];
    }
    for (int k = 0; k < 3; k++) {
        if (volume[k] * total < 0 || total == 0)
            return false;
        for (int i = 0; i < 3; i++)
            at[i] += a[k][i] * volume[k] / total;
    }
    const oracle_real along = at[0] * d[0] + at[1] * d[1] + at[2] * d[2];
    const oracle_real length = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    const double *m = view->clip_from_world.m;
    oracle_real z = oracle_exact(m[14]), w = oracle_exact(m[15]);
    for (int i = 0; i < 3; i++) {
        z += oracle_exact(m[4 * i + 2]) * (at[i] + p[i]);
        w += oracle_exact(m[4 * i + 3]) * (at[i] + p[i]);
    }
    const bool behind = view->reversed ? z <= w : z >= 0;
    return along > 0 && along < length && behind;
}

TEST(triangles_across_the_near_plane_block_behind_it) {
    for (int reversed = 0; reversed < 2; reversed++) {
        soup s = {0};
        test_random random = {4};
        for (int i = 0; i < 150; i++) /* all round the light, many across its plane */
            soup_add_random(&s, &random, i % 3 == 0 ? 1.5 : 0.3);
        const shb_scene *scene = soup_scene(&s);
        shb_view view;
        CHECK_INT(shb_view_perspective((shb_vec3){0.1, 0.2, 0.3}, (shb_vec3){0.3, -0.9, 0.1},
                                       (shb_vec3){0, 0, 1}, 2, 1, 0.25, 10, reversed, &view),
                  SHB_OK);
        shb_light_source source;
        CHECK_INT(shb_view_light_source(&view, &source), SHB_OK);
        shb_context *context = lists_context(1);
        shb_lists *lists = lists_of(context, &view, 64, scene);
        list_samples points = list_samples_create(scene, 4000, 6);
        size_t wrong = 0, shadowed = 0, crossing = 0;
        for (uint32_t i = 0; i < lists->id_count; i++)
            crossing += lists->triangles[i].margin == HUGE_VALF;
        CHECK(crossing > 20);
        list_samples_ask(lists, &points, true, 0);
        for (size_t i = 0; i < points.count; i++) {
            const double *m = view.clip_from_world.m;
            double clip[4];
            for (int r = 0; r < 4; r++)
                clip[r] = m[r] * points.x[i] + m[4 + r] * points.y[i] + m[8 + r] * points.z[i] +
                          m[12 + r];
            const bool seen = clip[3] > 0 && fabs(clip[0]) < clip[3] && fabs(clip[1]) < clip[3];
            bool blocked = false;
            for (uint32_t id = 0; seen && id < s.count && !blocked; id++) {
                shb_vec3 corners[3];
                shb_scene_triangle(scene, id, corners);
                blocked = id != points.own_ids[i] &&
                          blocks_behind_near(&view, &source, corners, points.points[i]);
            }
            shadowed += blocked;
            wrong += blocked != (points.visibility[i] < 0.5f);
        }
        CHECK(shadowed > 200);
        CHECK_INT(wrong, 0);
        list_samples_free(&points);
        shb_lists_destroy(lists);
        shb_context_destroy(context);
        soup_free(&s);
    }
}

/* Two slopes, one below the other, from y = 5 down to y = -5 through the near plane at y = 0: their
 * parts behind it begin nearer to the light than any corner there. */
TEST(what_the_near_plane_cuts_blocks_before_all_corners_behind_it) {
    soup s = {0};
    for (int lower = 0; lower < 2; lower++) {
        const float y = lower ? -0.5f : 0;
        soup_add(&s, (float[]){-4, y + 5, 0}, (float[]){6, y - 5, 3}, (float[]){6, y - 5, -3});
    }
    const shb_vec3 eye = {0, 0, 0}, below = {0, -1, 0}, up = {0, 0, 1};
    shb_context *context = lists_context(1);
    for (int reversed = 0; reversed < 2; reversed++) {
        shb_view view;
        CHECK_INT(shb_view_orthographic(eye, below, up, 8, 8, 0, 20, reversed, &view), SHB_OK);
        shb_lists *lists = lists_of(context, &view, 16, soup_scene(&s));
        for (double x = 1.25; x < 6; x += 0.25) {
            float upper, lower;
            lists_ask_one(lists, x, 1 - x, 0, &upper);
            lists_ask_one(lists, x, 0.5 - x, 0, &lower);
            CHECK(upper == 1 && lower == 0);
        }
        shb_lists_destroy(lists);
    }
    shb_context_destroy(context);
    soup_free(&s);
}

/* Of two points the first one is lit and the second one not, however they are rounded. */
static void check_first_is_lit(const shb_lists *lists, const double x[2], const double y[2],
                               const double z[2]) {
    for (int rounded = 0; rounded < 2; rounded++) {
        const shb_list_points points = {
            .count = 2, .x = x, .y = y, .z = z, .rounding = rounded ? 0x1p-24 : 0};
        float visibility[2];
        shb_lists_query(lists, &points, visibility);
        CHECK(visibility[0] == 1 && visibility[1] == 0);
    }
}

/* A slope from y = 5 down to y = -5 through the near plane at y = 0, where x is 1. Texels are half
 * a unit wide. */
TEST(what_lies_before_the_near_plane_blocks_no_point_however_it_is_rounded) {
    soup s = {0};
    soup_add(&s, (float[]){-4, 5, 0}, (float[]){6, -5, 3}, (float[]){6, -5, -3});
    const shb_vec3 eye = {0, 0, 0}, below = {0, -1, 0}, up = {0, 0, 1};
    const double x[] = {0.875, 1.125}, y[] = {-5, -5}, z[] = {0, 0};
    shb_context *context = lists_context(1);
    for (int reversed = 0; reversed < 2; reversed++) {
        shb_view view;
        CHECK_INT(shb_view_orthographic(eye, below, up, 8, 8, 0, 20, reversed, &view), SHB_OK);
        shb_lists *lists = lists_of(context, &view, 16, soup_scene(&s));
        check_first_is_lit(lists, x, y, z);
        shb_lists_destroy(lists);
    }
    shb_context_destroy(context);
    soup_free(&s);
}

/* A plate z = 2 + slope x + y / 8 below a light at (0, 0, 4), from x = left to 3, in units. */
static void add_slanting_plate(soup *s, float left, float slope, float unit) {
    const float low = 2 + slope * left, high = 2 + slope * 3;
    float corners[4][3] = {{left, -1, low - 0.125f},
                           {3, -1, high - 0.125f},
                           {3, 1, high + 0.125f},
                           {left, 1, low + 0.125f}};
    for (int k = 0; k < 4; k++)
        for (int axis = 0; axis < 3; axis++)
            corners[k][axis] *= unit;
    soup_add_quad(s, corners[0], corners[1], corners[2], corners[3]);
}

/* Points on the plate are lit, those behind it shadowed, however they are rounded; the last ones
 * lie outside of the scene. */
static void check_slanting_plate(const shb_view *view, soup *s, double slope, double unit) {
    enum { SIDE = 20, POINTS = SIDE * SIDE };
    static const double distances[] = {1, 1.25, 8};
    static double place[3][POINTS];
    static float visibility[POINTS];
    shb_context *context = lists_context(1);
    shb_lists *lists = lists_of(context, view, 16, soup_scene(s));
    for (int k = 0; k < 3; k++)
        for (int rounded = 0; rounded < 2; rounded++) {
            size_t shadowed = 0;
            for (int i = 0; i < POINTS; i++) {
                const double x = 0.06 + 0.03 * (i % SIDE), y = -0.5 + 0.05 * (i / SIDE);
                const double ray[3] = {x, y, slope * x + y / 8 - 2};
                for (int axis = 0; axis < 3; axis++) {
                    const double at = (ray[axis] * distances[k] + (axis == 2 ? 4 : 0)) * unit;
                    place[axis][i] = rounded ? oracle_float(at) : at;
                }
            }
            const shb_list_points points = {.count = POINTS,
                                            .x = place[0],
                                            .y = place[1],
                                            .z = place[2],
                                            .rounding = rounded ? 0x1p-24 : 0};
            shb_lists_query(lists, &points, visibility);
            for (int i = 0; i < POINTS; i++)
                shadowed += visibility[i] == 0;
            CHECK_INT(shadowed, k ? POINTS : 0);
        }
    shb_lists_destroy(lists);
    shb_context_destroy(context);
}

static const shb_vec3 above_plate = {0, 0, 4}, below_plate = {0, 0, 0}, plate_up = {0, 1, 0};

TEST(points_in_floats_are_shadowed_in_the_widest_views) {
    soup s = {0};
    add_slanting_plate(&s, -1, 0.25f, 1);
    for (int reversed = 0; reversed < 2; reversed++)
        for (double left = 1e-2; left > 1e-10; left *= 0.1) {
            shb_view view;
            CHECK_INT(shb_view_perspective(above_plate, below_plate, plate_up, acos(-1) - left, 1,
                                           0.25, 10, reversed, &view),
                      SHB_OK);
            check_slanting_plate(&view, &s, 0.25, 1);
        }
    soup_free(&s);
}

TEST(points_in_floats_are_shadowed_beside_a_mesh_that_is_far_larger) {
    shb_view view;
    CHECK_INT(
        shb_view_perspective(above_plate, below_plate, plate_up, 2, 1, 0.25, 10, false, &view),
        SHB_OK);
    for (float size = 1e6f; size < 1e14f; size *= 10) {
        soup s = {0};
        add_slanting_plate(&s, -1, 0.25f, 1);
        soup_add(&s, (float[]){size, size, -size}, (float[]){2 * size, size, -size},
                 (float[]){size, 2 * size, -size});
        check_slanting_plate(&view, &s, 0.25, 1);
        soup_free(&s);
    }
}

/* From the least floats of full precision to those that are a few of their steps large. */
TEST(points_in_floats_are_rounded_by_their_steps_in_the_smallest_scenes) {
    for (double unit = 0x1p-120; unit > 0x1p-144; unit *= 0.25) {
        soup s = {0};
        add_slanting_plate(&s, -1, 0.25f, (float)unit);
        shb_view view;
        CHECK_INT(shb_view_perspective((shb_vec3){0, 0, 4 * unit}, below_plate, plate_up, 2, 1,
                                       0.25 * unit, 10 * unit, false, &view),
                  SHB_OK);
        check_slanting_plate(&view, &s, 0.25, unit);
        soup_free(&s);
    }
}

/* What lies behind its near plane: z < 4 + 41 x, but for a hundredth. */
static shb_view steep_view(void) {
    shb_view view;
    CHECK_INT(
        shb_view_perspective(above_plate, below_plate, plate_up, 2, 1, 0.01, 10, false, &view),
        SHB_OK);
    for (int column = 0; column < 4; column++)
        view.clip_from_world.m[4 * column + 2] += 64 * view.clip_from_world.m[4 * column];
    return view;
}

/* The plate passes beside the light, and the near plane does not cut it there. */
TEST(points_in_floats_are_shadowed_by_what_reaches_past_the_light) {
    soup s = {0};
    add_slanting_plate(&s, 0, 2, 1);
    const shb_view view = steep_view();
    check_slanting_plate(&view, &s, 2, 1);
    soup_free(&s);
}

/* Which cuts the plate at x = -0.05. */
TEST(points_before_a_steep_near_plane_are_lit) {
    soup s = {0};
    add_slanting_plate(&s, -1, 0.25f, 1);
    const shb_view view = steep_view();
    shb_context *context = lists_context(1);
    shb_lists *lists = lists_of(context, &view, 16, soup_scene(&s));
    const double x[] = {-0.5, 0.5}, y[] = {-0.25, -0.25}, z[] = {-1, -1};
    check_first_is_lit(lists, x, y, z);
    shb_lists_destroy(lists);
    shb_context_destroy(context);
    soup_free(&s);
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
