/* Classification of frames. Shadows and their boundaries are known by hand: sheets float over or
 * stand on a ground plane z = 0 and cast shadows of straight outline. */
#include "shadowbias/reference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "allocator.h"
#include "random.h"
#include "soup.h"
#include "test.h"

enum { PIXELS = 256, PIXEL_COUNT = PIXELS * PIXELS };

/* A frame of PIXELS x PIXELS and a map, over one scene. */
typedef struct stage {
    shb_context *context;
    shb_view camera;
    const shb_scene *scene;
    shb_reference *reference;
    shb_map *map;
    uint32_t *ids;
    uint8_t *truth;
} stage;

static stage stage_with_map(const shb_scene *scene, shb_view camera, shb_view light, uint32_t width,
                            uint32_t height) {
    stage s = {.camera = camera, .scene = scene};
    CHECK_INT(shb_context_create(NULL, &s.context), SHB_OK);
    CHECK_INT(shb_reference_create(s.context, scene, &s.reference), SHB_OK);
    const shb_map_desc map = {.view = light, .width = width, .height = height};
    CHECK_INT(shb_map_create(s.context, &map, &s.map), SHB_OK);
    s.ids = malloc(PIXEL_COUNT * sizeof *s.ids);
    s.truth = malloc(PIXEL_COUNT);
    const shb_draw_desc draw = {
        .view = &s.camera, .scene = scene, .width = PIXELS, .height = PIXELS, .ids = s.ids};
    CHECK_INT(shb_draw(s.context, &draw, NULL), SHB_OK);
    return s;
}

static stage stage_for(const shb_scene *scene, shb_view camera, shb_view light, uint32_t texels) {
    return stage_with_map(scene, camera, light, texels, texels);
}

static shb_classify_desc desc_of(const stage *s) {
    return (shb_classify_desc){.frame = {.view = &s->camera,
                                         .scene = s->scene,
                                         .width = PIXELS,
                                         .height = PIXELS,
                                         .ids = s->ids},
                               .map = s->map};
}

static void classify(stage *s) {
    const shb_classify_desc desc = desc_of(s);
    memset(s->truth, 99, PIXEL_COUNT);
    CHECK_INT(shb_reference_classify(s->reference, &desc, s->truth), SHB_OK);
}

static void stage_end(stage *s) {
    free(s->ids);
    free(s->truth);
    shb_map_destroy(s->map);
    shb_reference_destroy(s->reference);
    shb_context_destroy(s->context);
}

/* Looks at target from the direction of from, 64 x 64 units wide. */
static shb_view wide_view(shb_vec3 from, shb_vec3 target) {
    shb_view view;
    const shb_vec3 eye = shb_vec3_add(target, shb_vec3_scale(shb_vec3_normalize(from), 60));
    CHECK_INT(shb_view_orthographic(eye, target, (shb_vec3){0, 1, 0}, 32, 32, 1, 200, false, &view),
              SHB_OK);
    return view;
}

/* Looks straight down on 64 x 64 units from a height; row 0 is y = 32. */
static shb_view view_from_height(double height) {
    shb_view view;
    CHECK_INT(shb_view_orthographic((shb_vec3){0, 0, height}, (shb_vec3){0, 0, 0},
                                    (shb_vec3){0, 1, 0}, 32, 32, 0.5, 200, false, &view),
              SHB_OK);
    return view;
}

/* The ground point under a pixel of view_from_height. */
static double ground_x(int pixel) {
    return (pixel % PIXELS + 0.5) * 64 / PIXELS - 32;
}

static double ground_y(int pixel) {
    return 32 - (pixel / PIXELS + 0.5) * 64 / PIXELS;
}

/* A horizontal sheet. */
static void add_sheet(soup *s, float x0, float y0, float x1, float y1, float z) {
    soup_add_quad(s, (float[3]){x0, y0, z}, (float[3]){x1, y0, z}, (float[3]){x1, y1, z},
                  (float[3]){x0, y1, z});
}

/* Ids 0 and 1. */
static void add_ground(soup *s) {
    add_sheet(s, -30, -30, 30, 30, 0);
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
    classify(&t);
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
    classify(&t);
    check_ground(&t, under_floating_sheet);
    stage_end(&t);

    /* Three surfaces meet at the seam, two of them on different sides. The fin's lower edge is an
     * open edge under the seam. */
    const shb_scene with_fin = {instances, 5};
    t = stage_for(&with_fin, view_from_height(5), view_from_height(60), 64);
    classify(&t);
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

TEST(a_wall_is_lit_up_to_its_own_edges_and_its_foot) {
    soup s = {0};
    add_ground(&s);
    soup_add_quad(&s, (float[3]){0, -10.0625f, 0}, (float[3]){0, 10.0625f, 0},
                  (float[3]){0, 10.0625f, 15}, (float[3]){0, -10.0625f, 15});
    stage t = stage_for(soup_scene(&s), wide_view((shb_vec3){1, 0.2, 0.1}, (shb_vec3){0, 0, 0}),
                        wide_view((shb_vec3){0.6, 0, 0.8}, (shb_vec3){0, 0, 0}), 64);
    classify(&t);
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
    shb_classify_desc desc = desc_of(&t);
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
    classify(&t);
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

/* ---- what is not classified ---- */

static int count_truth(const stage *s, uint8_t truth) {
    int count = 0;
    for (int pixel = 0; pixel < PIXEL_COUNT; pixel++)
        count += s->truth[pixel] == truth;
    return count;
}

TEST(surfaces_turned_away_or_below_the_least_cosine_are_not_classified) {
    /* Light along (0.8, 0, 0.6) meets the ground at a cosine of 0.6. */
    soup s = {0};
    add_ground(&s);
    const shb_vec3 origin = {0, 0, 0};
    const int covered = 240 * 240; /* 60 of 64 units */
    for (int k = 0; k < 4; k++) {
        const shb_view light = wide_view((shb_vec3){0.8, 0, k == 3 ? -0.6 : 0.6}, origin);
        stage t = stage_for(soup_scene(&s), view_from_height(60), light, 64);
        shb_classify_desc desc = desc_of(&t);
        desc.min_cosine = k == 0 ? 0 : k == 1 ? 0.599 : k == 2 ? 0.601 : 0;
        CHECK_INT(shb_reference_classify(t.reference, &desc, t.truth), SHB_OK);
        CHECK_INT(count_truth(&t, SHB_TRUTH_LIT), k < 2 ? covered : 0);
        CHECK_INT(count_truth(&t, SHB_TRUTH_NONE), k < 2 ? PIXEL_COUNT - covered : PIXEL_COUNT);
        stage_end(&t);
    }
    soup_free(&s);
}

TEST(pixels_behind_a_spot_light_are_not_classified) {
    /* The light hangs over the ground and looks up: x / w of the ground lies within the map. */
    soup s = {0};
    add_ground(&s);
    shb_view light;
    CHECK_INT(shb_view_perspective((shb_vec3){0, 0, 20}, (shb_vec3){0, 0, 40}, (shb_vec3){0, 1, 0},
                                   2, 1, 1, 100, false, &light),
              SHB_OK);
    stage t = stage_for(soup_scene(&s), view_from_height(50), light, 64);
    classify(&t);
    CHECK_INT(count_truth(&t, SHB_TRUTH_NONE), PIXEL_COUNT);
    stage_end(&t);
    soup_free(&s);
}

TEST(pixels_outside_the_map_or_without_a_triangle_are_not_classified) {
    /* The map sees x and y from -16 to 16. */
    soup s = {0};
    add_ground(&s);
    shb_view light;
    CHECK_INT(shb_view_orthographic((shb_vec3){0, 0, 60}, (shb_vec3){0, 0, 0}, (shb_vec3){0, 1, 0},
                                    16, 16, 1, 100, true, &light),
              SHB_OK);
    stage t = stage_for(soup_scene(&s), view_from_height(50), light, 64);
    t.ids[128 * PIXELS + 128] = SHB_ID_NONE;
    t.ids[128 * PIXELS + 129] = 2;
    classify(&t);
    CHECK_INT(count_truth(&t, SHB_TRUTH_LIT), 128 * 128 - 2);
    CHECK_INT(count_truth(&t, SHB_TRUTH_NONE), PIXEL_COUNT - 128 * 128 + 2);
    CHECK_INT(t.truth[128 * PIXELS + 128], SHB_TRUTH_NONE);
    CHECK_INT(t.truth[128 * PIXELS + 129], SHB_TRUTH_NONE);
    CHECK_INT(t.truth[128 * PIXELS + 130], SHB_TRUTH_LIT);
    CHECK_INT(t.truth[63 * PIXELS + 64], SHB_TRUTH_NONE);
    CHECK_INT(t.truth[64 * PIXELS + 64], SHB_TRUTH_LIT);
    CHECK_INT(t.truth[191 * PIXELS + 191], SHB_TRUTH_LIT);
    CHECK_INT(t.truth[191 * PIXELS + 192], SHB_TRUTH_NONE);
    stage_end(&t);
    soup_free(&s);
}

/* ---- layout, threads, memory, arguments ---- */

TEST(rows_of_ids_may_have_gaps) {
    soup s = {0};
    add_ground(&s);
    add_sheet(&s, -10.0625f, -5.3125f, 9.4375f, 15.8125f, 10);
    stage t = stage_for(soup_scene(&s), view_from_height(5), view_from_height(60), 64);
    uint32_t *padded = malloc(PIXELS * (PIXELS + 3) * sizeof *padded);
    memset(padded, 0, PIXELS * (PIXELS + 3) * sizeof *padded);
    for (int row = 0; row < PIXELS; row++)
        memcpy(padded + row * (PIXELS + 3), t.ids + row * PIXELS, PIXELS * sizeof *padded);
    shb_classify_desc desc = desc_of(&t);
    desc.frame.ids = padded;
    desc.frame.id_stride = (PIXELS + 3) * sizeof *padded;
    CHECK_INT(shb_reference_classify(t.reference, &desc, t.truth), SHB_OK);
    check_ground(&t, under_floating_sheet);
    free(padded);
    stage_end(&t);
    soup_free(&s);
}

/* A few boxes on the ground. */
static void add_boxes(soup *s) {
    test_random random = {2};
    add_ground(s);
    for (int i = 0; i < 40; i++) {
        const float x = (float)random_double(&random, -25, 22);
        const float y = (float)random_double(&random, -25, 22);
        const float size = (float)random_double(&random, 0.5, 4);
        soup_add_box(s, (float[3]){x, y, 0}, (float[3]){x + size, y + size, 2 * size});
    }
}

TEST(classification_does_not_depend_on_threads) {
    soup s = {0};
    add_boxes(&s);
    stage t = stage_for(soup_scene(&s), wide_view((shb_vec3){-1, -1, 2}, (shb_vec3){0, 0, 0}),
                        wide_view((shb_vec3){1, -0.4, 1}, (shb_vec3){0, 0, 0}), 128);
    classify(&t);
    const shb_context_desc one_thread = {.threads = 1};
    shb_context *context;
    shb_reference *reference;
    CHECK_INT(shb_context_create(&one_thread, &context), SHB_OK);
    CHECK_INT(shb_reference_create(context, t.scene, &reference), SHB_OK);
    const shb_classify_desc desc = desc_of(&t);
    uint8_t *truth = malloc(PIXEL_COUNT);
    CHECK_INT(shb_reference_classify(reference, &desc, truth), SHB_OK);
    CHECK(memcmp(truth, t.truth, PIXEL_COUNT) == 0);
    CHECK(count_truth(&t, SHB_TRUTH_SHADOWED) > 1000);
    CHECK(count_truth(&t, SHB_TRUTH_LIT | SHB_TRUTH_BOUNDARY) > 1000);
    free(truth);
    shb_reference_destroy(reference);
    shb_context_destroy(context);
    stage_end(&t);
    soup_free(&s);
}

TEST(a_classification_without_memory_fails_and_writes_nothing) {
    soup s = {0};
    add_boxes(&s);
    stage t = stage_for(soup_scene(&s), view_from_height(60), view_from_height(60), 64);
    test_allocator state = {0};
    const shb_context_desc hooks = {.allocator = test_allocator_hooks(&state), .threads = 1};
    shb_context *context;
    shb_reference *reference;
    CHECK_INT(shb_context_create(&hooks, &context), SHB_OK);
    CHECK_INT(shb_reference_create(context, t.scene, &reference), SHB_OK);
    const size_t live = state.live;
    const shb_classify_desc desc = desc_of(&t);
    memset(t.truth, 99, PIXEL_COUNT);
    shb_result result = SHB_ERROR_MEMORY;
    for (size_t fail_at = 1; result && fail_at < 20; fail_at++) {
        state.calls = 0;
        state.fail_at = fail_at;
        result = shb_reference_classify(reference, &desc, t.truth);
        CHECK_INT(state.live, live);
        CHECK_INT(result, fail_at <= state.calls ? SHB_ERROR_MEMORY : SHB_OK);
        CHECK_INT(count_truth(&t, 99), result ? PIXEL_COUNT : 0);
        CHECK(result || fail_at > 3);
    }
    CHECK_INT(result, SHB_OK);
    shb_reference_destroy(reference);
    shb_context_destroy(context);
    stage_end(&t);
    soup_free(&s);
}

TEST(classification_refuses_bad_arguments) {
    soup s = {0}, other = {0};
    add_ground(&s);
    add_sheet(&other, 0, 0, 1, 1, 1);
    soup_add(&other, (float[3]){0, 0, 0}, (float[3]){0, 1, 0}, (float[3]){1, 0, 0});
    stage t = stage_for(soup_scene(&s), view_from_height(60), view_from_height(60), 64);
    memset(t.truth, 99, PIXEL_COUNT);
    const shb_classify_desc good = desc_of(&t);
    const shb_view singular = {{{0}}, false};
    shb_classify_desc bad[13];
    for (int i = 0; i < 13; i++)
        bad[i] = good;
    bad[0].map = NULL;
    bad[1].frame.view = NULL;
    bad[2].frame.scene = NULL;
    bad[3].frame.ids = NULL;
    bad[4].frame.id_stride = 4 * PIXELS - 4;
    bad[5].frame.id_stride = 4 * PIXELS + 2;
    bad[6].min_cosine = -0.1;
    bad[7].min_cosine = (double)NAN;
    bad[8].frame.scene = soup_scene(&other);
    bad[9].frame.width = 0;
    bad[10].frame.height = 0;
    bad[11].frame.height = SHB_SIZE_MAX + 1;
    bad[12].frame.view = &singular;
    for (int i = 0; i < 13; i++)
        CHECK_INT(shb_reference_classify(t.reference, &bad[i], t.truth), i < 9 ? SHB_ERROR_ARGUMENT
                                                                         : i < 12
                                                                             ? SHB_ERROR_SIZE
                                                                             : SHB_ERROR_NUMBER);
    CHECK_INT(shb_reference_classify(NULL, &good, t.truth), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_reference_classify(t.reference, NULL, t.truth), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_reference_classify(t.reference, &good, NULL), SHB_ERROR_ARGUMENT);
    CHECK_INT(count_truth(&t, 99), PIXEL_COUNT);
    stage_end(&t);
    soup_free(&s);
    soup_free(&other);
}
