/* Lists in views whose near plane cuts what is seen, or where arithmetic is at its limits. */
#include "contexts.h"
#include "list_samples.h"

#include <math.h>
#include <string.h>

#include "oracle.h"
#include "test.h"

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
