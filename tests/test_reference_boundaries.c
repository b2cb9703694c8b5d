/* Shadows and their boundaries in classified frames, known by hand: sheets float over or stand on a
 * ground plane z = 0 and cast shadows of straight outline. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "classify_stage.h"
#include "random.h"
#include "test.h"

/* The ground point under a pixel of view_from_height. */
static double ground_x(int pixel) {
    return (pixel % PIXELS + 0.5) * 64 / PIXELS - 32;
}

static double ground_y(int pixel) {
    return 32 - (pixel / PIXELS + 0.5) * 64 / PIXELS;
}

static uint8_t truth_of(bool shadowed, bool boundary) {
    const int truth = shadowed ? SHB_TRUTH_SHADOWED : SHB_TRUTH_LIT;
    return (uint8_t)(truth | (boundary ? SHB_TRUTH_BOUNDARY : 0));
}

/* Compares the truth of a frame with a function of the ground point. */
typedef uint8_t expected_fn(double x, double y);

static void check_ground(const stage *s, expected_fn *expected) {
    int wrong = 0;
    uint32_t counts[8] = {0};
    for (int pixel = 0; pixel < PIXEL_COUNT; pixel++) {
        const double x = ground_x(pixel), y = ground_y(pixel);
        const bool covered = fabs(x) < 30 && fabs(y) < 30;
        const uint8_t right = covered ? expected(x, y) : SHB_TRUTH_NONE;
        wrong += s->truth[pixel] != right;
        counts[right]++;
    }
    CHECK_INT(wrong, 0);
    CHECK(counts[SHB_TRUTH_LIT] > 1000 && counts[SHB_TRUTH_SHADOWED] > 1000);
    CHECK(counts[SHB_TRUTH_LIT | SHB_TRUTH_BOUNDARY] > 50);
    CHECK(counts[SHB_TRUTH_SHADOWED | SHB_TRUTH_BOUNDARY] > 50);
}

static void check_scene(soup *s, shb_view camera, shb_view light, uint32_t texels,
                        expected_fn *expected) {
    stage t = stage_for(soup_scene(s), camera, light, texels);
    stage_classify(&t);
    check_ground(&t, expected);
    stage_end(&t);
    soup_free(s);
}

/* ---- outlines ---- */

/* A rectangle's shadow with borders one unit (= one texel) to both sides. Pixel centres lie at odd
 * multiples of 1/8, so that the coordinates below, odd multiples of 1/16, are never met. */
static uint8_t rectangle_shadow(double x, double y, double x0, double x1, double y0, double y1) {
    const bool inside = x > x0 && x < x1 && y > y0 && y < y1;
    const bool deep = x > x0 + 1 && x < x1 - 1 && y > y0 + 1 && y < y1 - 1;
    const bool close = x > x0 - 1 && x < x1 + 1 && y > y0 - 1 && y < y1 + 1;
    return truth_of(inside, close && !deep);
}

static uint8_t under_floating_sheet(double x, double y) {
    return rectangle_shadow(x, y, -10.0625, 9.4375, -5.3125, 15.8125);
}

TEST(the_outline_of_a_floating_sheet_is_the_boundary) {
    /* The map looks straight down with texels of one unit; the camera is under the sheet. */
    soup s = {0};
    add_ground(&s);
    add_sheet(&s, -10.0625f, -5.3125f, 9.4375f, 15.8125f, 10);
    check_scene(&s, view_from_height(5), view_from_height(60), 64, under_floating_sheet);
}

TEST(sheets_that_share_welded_corners_have_no_boundary_between_them) {
    /* The same sheet as two instances that meet at x = 2.1875, one of them moved into place, and a
     * fin that hangs from the seam. The fourth copies the first: doubles change nothing. */
    soup ground = {0}, left = {0}, right = {0}, fin = {0};
    add_ground(&ground);
    add_sheet(&left, -10.0625f, -5.3125f, 2.1875f, 15.8125f, 10);
    add_sheet(&right, -97.8125f, -5.3125f, -90.5625f, 15.8125f, 9);
    soup_add_quad(&fin, (float[3]){2.1875f, -5.3125f, 10}, (float[3]){2.1875f, 15.8125f, 10},
                  (float[3]){2.1875f, 15.8125f, 8}, (float[3]){2.1875f, -5.3125f, 8});
    soup *parts[4] = {&ground, &left, &right, &fin};
    for (int i = 0; i < 4; i++)
        soup_scene(parts[i]);
    const shb_instance instances[5] = {
        {.mesh = &ground.mesh},
        {.mesh = &left.mesh},
        {.mesh = &right.mesh, .world_from_mesh = shb_mat4_translation(100, 0, 1)},
        {.mesh = &left.mesh},
        {.mesh = &fin.mesh}};
    const shb_scene without_fin = {instances, 4};
    stage t = stage_for(&without_fin, view_from_height(5), view_from_height(60), 64);
    stage_classify(&t);
    check_ground(&t, under_floating_sheet);
    stage_end(&t);

    /* Three surfaces meet at the seam, two of them on different sides. The fin's lower edge is an
     * open edge under the seam. */
    const shb_scene with_fin = {instances, 5};
    t = stage_for(&with_fin, view_from_height(5), view_from_height(60), 64);
    stage_classify(&t);
    int wrong = 0, flagged = 0;
    for (int pixel = 0; pixel < PIXEL_COUNT; pixel++) {
        const double x = ground_x(pixel), y = ground_y(pixel);
        if (fabs(x) > 30 || fabs(y) > 30)
            continue;
        const bool under_fin = fabs(x - 2.1875) < 1 && y > -6.3125 && y < 16.8125;
        const uint8_t right_truth =
            under_floating_sheet(x, y) | (under_fin ? SHB_TRUTH_BOUNDARY : 0);
        wrong += t.truth[pixel] != right_truth;
        flagged += under_fin;
    }
    CHECK_INT(wrong, 0);
    CHECK(flagged > 500);
    stage_end(&t);
    for (int i = 0; i < 4; i++)
        soup_free(parts[i]);
}

TEST(a_fold_is_a_boundary_and_a_ridge_is_none) {
    /* The ridge at x = 0 (and -0, which is the same place) has its slopes on both sides. The fold
     * at x = 9.4375 has both sheets on its left: the lower one runs back under the roof and joins
     * it at x = -10.0625. */
    soup s = {0};
    add_ground(&s);
    const float y0 = -5.3125f, y1 = 15.8125f;
    soup_add_quad(&s, (float[3]){-10.0625f, y0, 8}, (float[3]){0, y0, 12}, (float[3]){0, y1, 12},
                  (float[3]){-10.0625f, y1, 8});
    soup_add_quad(&s, (float[3]){-0.0f, y0, 12}, (float[3]){9.4375f, y0, 8},
                  (float[3]){9.4375f, y1, 8}, (float[3]){-0.0f, y1, 12});
    soup_add_quad(&s, (float[3]){9.4375f, y0, 8}, (float[3]){9.4375f, y1, 8},
                  (float[3]){-10.0625f, y1, 8}, (float[3]){-10.0625f, y0, 8});
    check_scene(&s, view_from_height(5), view_from_height(60), 64, under_floating_sheet);
}

TEST(triangles_without_area_make_no_boundary) {
    soup s = {0};
    add_ground(&s);
    add_sheet(&s, -10.0625f, -5.3125f, 9.4375f, 15.8125f, 10);
    soup_add(&s, (float[3]){0, 0, 8}, (float[3]){0, 0, 8}, (float[3]){0, 0, 8});
    soup_add(&s, (float[3]){1, 5, 8}, (float[3]){1, 5, 8}, (float[3]){5, 6, 9});
    soup_add(&s, (float[3]){-2, 2, 8}, (float[3]){-4, 4, 8}, (float[3]){-8, 8, 8});
    check_scene(&s, view_from_height(5), view_from_height(60), 64, under_floating_sheet);
}

/* The view of a scene that is moved by a rigid or similar transform, moved with it. */
static shb_view moved_view(shb_view view, shb_mat4 place) {
    shb_mat4 back;
    CHECK_INT(shb_mat4_inverse(place, &back), SHB_OK);
    view.clip_from_world = shb_mat4_multiply(view.clip_from_world, back);
    return view;
}

TEST(a_box_lit_along_its_sides_has_their_outline_as_boundary) {
    /* Seen from the light the sides are lines, and rounding decides what side of each other their
     * edges are on. The ground shows its back to light and camera. */
    test_random random = {3};
    for (int round = 0; round < 24; round++) {
        soup s = {0};
        add_sheet(&s, 30, -30, -30, 30, 0);
        soup_add_box(&s, (float[3]){-10.0625f, -5.3125f, 8}, (float[3]){9.4375f, 15.8125f, 12});
        shb_mat4 place = shb_mat4_identity();
        if (round) {
            const double scale = pow(10, random_double(&random, -4, 6));
            const shb_vec3 axis = {random_double(&random, -1, 1), 1, random_double(&random, -1, 1)};
            place = shb_mat4_multiply(
                shb_mat4_translation(scale * 100 * (round % 3), -scale * 7, scale),
                shb_mat4_multiply(shb_mat4_scaling(scale, scale, scale),
                                  shb_mat4_rotation(axis, random_double(&random, 0, 6))));
        }
        s.transform = place;
        check_scene(&s, moved_view(view_from_height(5), place),
                    moved_view(view_from_height(60), place), 64, under_floating_sheet);
    }
}

static uint8_t under_point_light(double x, double y) {
    /* Texels are 64 units / 128 wide on the ground: borders of half a unit. */
    const bool inside = x > -8.0625 && x < 16.0625 && y > -4.0625 && y < 12.0625;
    const bool deep = x > -7.5625 && x < 15.5625 && y > -3.5625 && y < 11.5625;
    const bool close = x > -8.5625 && x < 16.5625 && y > -4.5625 && y < 12.5625;
    return truth_of(inside, close && !deep);
}

TEST(the_outline_under_a_point_light_is_the_boundary) {
    /* From 32 units above, through an opening of 90 degrees, the map sees 64 units of ground; a
     * sheet at half the height casts a shadow of twice its size. A sheet above the light casts
     * none. */
    soup s = {0};
    add_ground(&s);
    add_sheet(&s, -4.03125f, -2.03125f, 8.03125f, 6.03125f, 16);
    add_sheet(&s, -20, -20, 20, 20, 40);
    shb_view light;
    CHECK_INT(shb_view_perspective((shb_vec3){0, 0, 32}, (shb_vec3){0, 0, 0}, (shb_vec3){0, 1, 0},
                                   1.5707963267948966, 1, 1, HUGE_VAL, true, &light),
              SHB_OK);
    check_scene(&s, view_from_height(5), light, 128, under_point_light);
}

/* ---- contacts and curved surfaces ---- */

/* Across the map the ground point (x, y) lies at u = x * 0.8 (see below). */
static uint8_t beside_wall(double x, double y) {
    const double u = 0.8 * x, far = -0.6 * 15;
    const bool inside = x > -0.75 * 15 && x < 0 && fabs(y) < 10.0625;
    const bool near_top = fabs(u - far) < 1 && fabs(y) < 11.0625;
    const bool near_side = fabs(fabs(y) - 10.0625) < 1 && u > far - 1 && u < 1;
    return truth_of(inside, near_top || near_side);
}

TEST(a_contact_line_is_no_boundary) {
    /* A wall stands on x = 0, 15 high. The light comes along (0.6, 0, 0.8): a point of the wall at
     * height z casts its shadow to x = -0.75 z. In the map, whose columns run along (0.8, 0, -0.6)
     * in texels of one unit, the wall takes u = -9 .. 0. Its foot touches the ground: no boundary
     * there, but the ends of the foot are near the upright edges. */
    soup s = {0};
    add_ground(&s);
    soup_add_quad(&s, (float[3]){0, -10.0625f, 0}, (float[3]){0, 10.0625f, 0},
                  (float[3]){0, 10.0625f, 15}, (float[3]){0, -10.0625f, 15});
    check_scene(&s, view_from_height(60), wide_view((shb_vec3){0.6, 0, 0.8}, (shb_vec3){0, 0, 0}),
                64, beside_wall);
}

static uint8_t beside_floating_wall(double x, double y) {
    const bool near_foot = fabs(0.8 * x) < 1 && fabs(y) < 11.0625;
    return (uint8_t)(beside_wall(x, y) | (near_foot ? SHB_TRUTH_BOUNDARY : 0));
}

/* The ground reaches to 30, so that a foot touches it up to 30 * 2^-20: more than 2^-16 and less
 * than 2^-15. */
TEST(a_foot_above_the_rounding_of_positions_is_a_boundary) {
    for (int floats = 0; floats < 2; floats++) {
        const float foot = floats ? 0x1p-15f : 0x1p-16f;
        soup s = {0};
        add_ground(&s);
        soup_add_quad(&s, (float[3]){0, -10.0625f, foot}, (float[3]){0, 10.0625f, foot},
                      (float[3]){0, 10.0625f, 15}, (float[3]){0, -10.0625f, 15});
        check_scene(&s, view_from_height(60),
                    wide_view((shb_vec3){0.6, 0, 0.8}, (shb_vec3){0, 0, 0}), 64,
                    floats ? beside_floating_wall : beside_wall);
    }
}

TEST(a_wall_is_lit_up_to_its_own_edges_and_its_foot) {
    soup s = {0};
    add_ground(&s);
    soup_add_quad(&s, (float[3]){0, -10.0625f, 0}, (float[3]){0, 10.0625f, 0},
                  (float[3]){0, 10.0625f, 15}, (float[3]){0, -10.0625f, 15});
    stage t = stage_for(soup_scene(&s), wide_view((shb_vec3){1, 0.2, 0.1}, (shb_vec3){0, 0, 0}),
                        wide_view((shb_vec3){0.6, 0, 0.8}, (shb_vec3){0, 0, 0}), 64);
    stage_classify(&t);
    int wall = 0, wrong = 0;
    for (int pixel = 0; pixel < PIXEL_COUNT; pixel++) {
        const bool is_wall = t.ids[pixel] == 2 || t.ids[pixel] == 3;
        wall += is_wall;
        wrong += is_wall && t.truth[pixel] != SHB_TRUTH_LIT;
    }
    CHECK(wall > 1000);
    CHECK_INT(wrong, 0);
    stage_end(&t);
    soup_free(&s);
}

TEST(a_convex_ball_has_no_shadow_and_no_boundary_on_itself) {
    soup s = {0};
    soup_add_ball(&s, (float[3]){1, 2, 3}, 48, 24, NULL);
    s.transform = shb_mat4_multiply(shb_mat4_scaling(12, 12, 12),
                                    shb_mat4_rotation((shb_vec3){1, 1, 0}, 0.7));
    const shb_vec3 center = shb_mat4_transform_point(s.transform, (shb_vec3){1, 2, 3});
    const shb_vec3 to_light = shb_vec3_normalize((shb_vec3){1, 0.3, 0.4});
    stage t = stage_for(soup_scene(&s), wide_view((shb_vec3){0, 0.2, 1}, center),
                        wide_view(to_light, center), 64);
    shb_classify_desc desc = stage_desc(&t);
    desc.min_cosine = 0.01;
    CHECK_INT(shb_reference_classify(t.reference, &desc, t.truth), SHB_OK);
    int lit = 0, dark = 0, wrong = 0;
    for (int pixel = 0; pixel < PIXEL_COUNT; pixel++) {
        shb_vec3 c[3];
        if (t.ids[pixel] == SHB_ID_NONE || shb_scene_triangle(t.scene, t.ids[pixel], c))
            continue;
        const shb_vec3 normal = shb_vec3_normalize(
            shb_vec3_cross(shb_vec3_subtract(c[1], c[0]), shb_vec3_subtract(c[2], c[0])));
        const bool is_lit = shb_vec3_dot(normal, to_light) >= 0.01;
        wrong += t.truth[pixel] != (is_lit ? SHB_TRUTH_LIT : SHB_TRUTH_NONE);
        lit += is_lit;
        dark += !is_lit;
    }
    CHECK(lit > 1000 && dark > 1000);
    CHECK_INT(wrong, 0);
    stage_end(&t);
    soup_free(&s);
}

/* ---- every edge of a soup, the slow way ---- */

/* True if the segment a b, in texels, comes within a texel of (x, y) along both axes: it does
 * unless an axis of the box or the segment's own normal separates them. */
static bool passes_near(const double a[2], const double b[2], double x, double y) {
    for (int i = 0; i < 2; i++) {
        const double c = i ? y : x;
        if ((a[i] < c - 1 && b[i] < c - 1) || (a[i] > c + 1 && b[i] > c + 1))
            return false;
    }
    const double nx = b[1] - a[1], ny = a[0] - b[0];
    const double distance = nx * (x - a[0]) + ny * (y - a[1]);
    return fabs(distance) <= fabs(nx) + fabs(ny);
}

/* Loose triangles between light and ground: all their edges are open and lie above it. */
static void check_soup(uint32_t width, uint32_t height) {
    const double texels[2] = {width, height};
    test_random random = {1};
    soup s = {0};
    add_ground(&s);
    for (int i = 0; i < 60; i++) {
        float p[3][3];
        for (int k = 0; k < 3; k++)
            for (int j = 0; j < 3; j++)
                p[k][j] = (float)(j < 2 ? random_double(&random, -25, 25)
                                        : random_double(&random, 6, 30));
        soup_add(&s, p[0], p[1], p[2]);
    }
    shb_view light;
    CHECK_INT(shb_view_perspective((shb_vec3){3, 5, 40}, (shb_vec3){0, 0, 0}, (shb_vec3){0, 1, 0},
                                   1.2, 1, 1, 100, false, &light),
              SHB_OK);
    stage t = stage_with_map(soup_scene(&s), view_from_height(5), light, width, height);
    stage_classify(&t);
    const double *m = light.clip_from_world.m;
    int wrong = 0, near = 0, in_map = 0;
    for (int pixel = 0; pixel < PIXEL_COUNT; pixel += 7) {
        if (t.ids[pixel] == SHB_ID_NONE)
            continue;
        double at[2];
        bool outside = false;
        for (int i = 0; i < 2; i++) {
            const double w = m[3] * ground_x(pixel) + m[7] * ground_y(pixel) + m[15];
            const double c = m[i] * ground_x(pixel) + m[4 + i] * ground_y(pixel) + m[12 + i];
            at[i] = (1 + (i ? -c : c) / w) / 2 * texels[i];
            outside |= at[i] < 0 || at[i] > texels[i];
        }
        bool expected = false;
        for (uint32_t k = 3 * 2; k < 3 * s.count && !expected; k++) {
            double ends[2][2];
            for (uint32_t e = 0; e < 2; e++) {
                const float *p = s.positions + 3 * (k / 3 * 3 + (k + e) % 3);
                const double x = (double)p[0], y = (double)p[1], z = (double)p[2];
                const double w = m[3] * x + m[7] * y + m[11] * z + m[15];
                for (int i = 0; i < 2; i++) {
                    const double c = m[i] * x + m[4 + i] * y + m[8 + i] * z + m[12 + i];
                    ends[e][i] = (1 + (i ? -c : c) / w) / 2 * texels[i];
                }
            }
            expected = passes_near(ends[0], ends[1], at[0], at[1]);
        }
        const bool actual = t.truth[pixel] & SHB_TRUTH_BOUNDARY;
        wrong += outside ? t.truth[pixel] != SHB_TRUTH_NONE : actual != expected;
        near += expected && !outside;
        in_map += !outside;
    }
    CHECK_INT(wrong, 0);
    CHECK(near > 500 && near < in_map - 500);
    stage_end(&t);
    soup_free(&s);
}

TEST(boundaries_of_a_soup_equal_a_search_through_all_edges) {
    check_soup(300, 300);
    check_soup(130, 700);
    check_soup(5000, 180);
}

/* ---- layout ---- */

TEST(rows_of_ids_may_have_gaps) {
    soup s = {0};
    add_ground(&s);
    add_sheet(&s, -10.0625f, -5.3125f, 9.4375f, 15.8125f, 10);
    stage t = stage_for(soup_scene(&s), view_from_height(5), view_from_height(60), 64);
    uint32_t *padded = malloc(PIXELS * (PIXELS + 3) * sizeof *padded);
    memset(padded, 0, PIXELS * (PIXELS + 3) * sizeof *padded);
    for (int row = 0; row < PIXELS; row++)
        memcpy(padded + row * (PIXELS + 3), t.ids + row * PIXELS, PIXELS * sizeof *padded);
    shb_classify_desc desc = stage_desc(&t);
    desc.frame.ids = padded;
    desc.frame.id_stride = (PIXELS + 3) * sizeof *padded;
    CHECK_INT(shb_reference_classify(t.reference, &desc, t.truth), SHB_OK);
    check_ground(&t, under_floating_sheet);
    free(padded);
    stage_end(&t);
    soup_free(&s);
}

/* A few boxes on the ground. */
