/* The exact method where every constant bias fails: wedges, narrow gaps, and worlds of any scale.
 */
#include "contexts.h"
#include "random.h"
#include "soup.h"
#include "test.h"

#include "shadowbias/map.h"

#include <math.h>
#include <string.h>

enum { POINTS = 2000, SIZE = 1024 };

/* What a map keeps, and whether it answers what is certain first. */
typedef struct exact_mode {
    shb_occluders occluders;
    bool classifies;
} exact_mode;

static const exact_mode modes[] = {
    {SHB_OCCLUDERS_PLANES, false}, {SHB_OCCLUDERS_TRIANGLES, false}, {SHB_OCCLUDERS_LISTS, false},
    {SHB_OCCLUDERS_PLANES, true},  {SHB_OCCLUDERS_TRIANGLES, true},  {SHB_OCCLUDERS_LISTS, true}};
enum { MODES = sizeof modes / sizeof *modes };

/* Visibility of points with one normal, from a map that is drawn for it. */
static void ask(const exact_mode *mode, const shb_view *view, uint32_t size, const shb_scene *scene,
                size_t count, const float *positions, shb_vec3 normal, float *visibility) {
    static float normals[3 * POINTS];
    for (size_t i = 0; i < count; i++) {
        normals[3 * i] = (float)normal.x;
        normals[3 * i + 1] = (float)normal.y;
        normals[3 * i + 2] = (float)normal.z;
    }
    shb_context *context = NULL;
    shb_map *map = NULL;
    const shb_map_desc desc = {
        .view = *view, .width = size, .occluders = mode->occluders, .classifies = mode->classifies};
    const shb_points points = {.count = count, .positions = positions, .normals = normals};
    const shb_bias exact = shb_bias_exact();
    context = test_context(0, SHB_ISA_BEST);
    CHECK_INT(shb_map_create(context, &desc, &map), SHB_OK);
    CHECK_INT(shb_map_draw(map, scene, NULL, NULL), SHB_OK);
    CHECK_INT(shb_map_visibility(map, &points, &exact, NULL, visibility), SHB_OK);
    shb_map_destroy(map);
    shb_context_destroy(context);
}

/* The world that the cases are built in, turned so that no rounding vanishes by chance. */
static shb_vec3 turned(double x, double y, double z) {
    return shb_mat4_transform_point(shb_mat4_rotation((shb_vec3){1, 2, 3}, 0.7),
                                    (shb_vec3){x, y, z});
}

static void write(float out[3], shb_vec3 v) {
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

static void add_turned_quad(soup *s, const double corners[4][3]) {
    float c[4][3];
    for (int k = 0; k < 4; k++)
        write(c[k], turned(corners[k][0], corners[k][1], corners[k][2]));
    soup_add_quad(s, c[0], c[1], c[2], c[3]);
}

/* A plate that rises from the line x = 0 of a ground y = 0, at an angle above its side x < 0. */
static soup wedge_of(double degrees) {
    const double angle = degrees * 3.14159265358979323846 / 180;
    const double x = -0.8 * cos(angle), y = 0.8 * sin(angle);
    soup s = {0};
    add_turned_quad(&s, (const double[4][3]){{-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}});
    add_turned_quad(&s, (const double[4][3]){{0, 0, 0.7}, {0, 0, -0.7}, {x, y, -0.7}, {x, y, 0.7}});
    return s;
}

/* The sun's rays come from x > 0, 40 degrees off the ground's normal: behind the line the ground
 * lies in the shadow of the plate, right from it on. Points at a distance of so many texels as
 * the plate may be detached by are dark; those in front of the line lie in the light. */
static int count_wrong_behind_wedge(const exact_mode *mode, double degrees, double texels) {
    static float positions[3 * POINTS], visibility[POINTS];
    soup s = wedge_of(degrees);
    const shb_scene *scene = soup_scene(&s);
    const double angle = 40 * 3.14159265358979323846 / 180;
    shb_box box;
    shb_view view;
    CHECK_INT(shb_scene_bounds(scene, &box), SHB_OK);
    CHECK_INT(shb_view_fit_directional(turned(sin(angle), cos(angle), 0), box, SIZE, false, &view),
              SHB_OK);
    const shb_vec3 extent = shb_vec3_subtract(box.hi, box.lo);
    /* A texel covers more of the ground, which spans more than half of the map. */
    const double texel = 0.5 * shb_vec3_length(extent) / SIZE;
    test_random random = {51};
    for (int i = 0; i < POINTS; i++) {
        const double side = i % 2 ? 1 : -1, distance = texel * texels;
        write(positions + 3 * i, turned(side * distance, 0, random_double(&random, -0.6, 0.6)));
    }
    ask(mode, &view, SIZE, scene, POINTS, positions, turned(0, 1, 0), visibility);
    int wrong = 0;
    for (int i = 0; i < POINTS; i++)
        wrong += visibility[i] != (i % 2 ? 1.0f : 0.0f);
    soup_free(&s);
    return wrong;
}

TEST(shadows_of_wedges_begin_at_the_hinge) {
    static const double detached[3][2] = {{1, 0.1}, {20, 0.01}, {90, 0.002}};
    for (int i = 0; i < MODES; i++)
        for (int k = 0; k < 3 && modes[i].occluders != SHB_OCCLUDERS_PLANES; k++)
            CHECK_INT(count_wrong_behind_wedge(&modes[i], detached[k][0], detached[k][1]), 0);
}

/* Two level squares, 1e-7 of their diagonal apart; the light comes from above. The large
 * one lies at 0, so that the gap is a float. */
TEST(gaps_of_a_ten_millionth_of_the_scene_are_kept) {
    static float positions[3 * POINTS], visibility[POINTS];
    const float gap = 2.828427e-7f;
    soup s = {0};
    soup_add_quad(&s, (float[]){-1, -1, 0}, (float[]){1, -1, 0}, (float[]){1, 1, 0},
                  (float[]){-1, 1, 0});
    soup_add_quad(&s, (float[]){-0.5f, -0.5f, gap}, (float[]){0.5f, -0.5f, gap},
                  (float[]){0.5f, 0.5f, gap}, (float[]){-0.5f, 0.5f, gap});
    const shb_scene *scene = soup_scene(&s);
    shb_box box;
    shb_view view;
    CHECK_INT(shb_scene_bounds(scene, &box), SHB_OK);
    CHECK_INT(shb_view_fit_directional((shb_vec3){0.5, 0.25, 1}, box, SIZE, false, &view), SHB_OK);
    test_random random = {52};
    for (int i = 0; i < POINTS; i++) {
        positions[3 * i] = (float)random_double(&random, -0.95, 0.95);
        positions[3 * i + 1] = (float)random_double(&random, -0.95, 0.95);
        positions[3 * i + 2] = 0;
    }
    for (int i = 0; i < MODES; i++) {
        /* planes are those at the centres of texels, which are less than 0.0025 wide */
        const double border = modes[i].occluders == SHB_OCCLUDERS_PLANES ? 0.005 : 1e-6;
        ask(&modes[i], &view, SIZE, scene, POINTS, positions, (shb_vec3){0, 0, 1}, visibility);
        for (int k = 0; k < POINTS; k++) {
            const double x = fabs((double)positions[3 * k]), y = fabs((double)positions[3 * k + 1]);
            if (fabs(x - 0.5) > border && fabs(y - 0.5) > border)
                CHECK(visibility[k] == (x < 0.5 && y < 0.5 ? 0.0f : 1.0f));
        }
    }
    soup_free(&s);
}

/* A ball and small triangles over a ground, scaled by a power of two. */
static soup scaled_scene(double scale) {
    soup s = {0};
    const float f = (float)scale;
    test_random random = {53};
    soup_add_ball(&s, (float[]){0, 0, 0}, 24, 12, NULL);
    for (uint32_t i = 0; i < 9 * s.count; i++)
        s.positions[i] = (0.4f * s.positions[i] + (i % 3 == 2 ? 0.5f : 0)) * f;
    soup_add_quad(&s, (float[]){-f, -f, 0}, (float[]){f, -f, 0}, (float[]){f, f, 0},
                  (float[]){-f, f, 0});
    for (int i = 0; i < 60; i++) {
        float c[3][3];
        double middle[3];
        for (int j = 0; j < 3; j++)
            middle[j] = random_double(&random, -0.8, 0.8);
        for (int k = 0; k < 3; k++)
            for (int j = 0; j < 3; j++)
                c[k][j] = (float)(middle[j] + random_double(&random, -0.15, 0.15) + (j == 2)) * f;
        soup_add(&s, c[0], c[1], c[2]);
    }
    return s;
}

/* A spot above the scene: only the numbers that are lengths change with the scale. */
static shb_view scaled_spot(double scale) {
    shb_view view;
    CHECK_INT(shb_view_perspective((shb_vec3){0, 0, 4 * scale}, (shb_vec3){0, 0, 0},
                                   (shb_vec3){0, 1, 0}, 0.7, 1, scale, 8 * scale, true, &view),
              SHB_OK);
    return view;
}

static void ask_scaled(const exact_mode *mode, double scale, float visibility[POINTS]) {
    static float positions[3 * POINTS];
    test_random random = {54};
    soup s = scaled_scene(scale);
    const shb_view view = scaled_spot(scale);
    for (int i = 0; i < POINTS; i++) {
        positions[3 * i] = (float)random_double(&random, -0.9, 0.9) * (float)scale;
        positions[3 * i + 1] = (float)random_double(&random, -0.9, 0.9) * (float)scale;
        positions[3 * i + 2] = 0;
    }
    ask(mode, &view, 64, soup_scene(&s), POINTS, positions, (shb_vec3){0, 0, 1}, visibility);
    soup_free(&s);
}

TEST(scaling_the_world_by_powers_of_two_changes_no_answer) {
    static float expected[POINTS], visibility[POINTS];
    for (int i = 0; i < MODES; i++) {
        int dark = 0;
        ask_scaled(&modes[i], 1, expected);
        for (int k = 0; k < POINTS; k++)
            dark += expected[k] == 0;
        CHECK(dark > POINTS / 10 && dark < POINTS * 9 / 10);
        for (int exponent = -12; exponent <= 20; exponent += 8) {
            ask_scaled(&modes[i], ldexp(1, exponent), visibility);
            CHECK(memcmp(visibility, expected, sizeof expected) == 0);
        }
    }
}
