/* The exact method on maps that keep triangles: equal to the truth, shadow boundaries included. */
#include "contexts.h"
#include "measure.h"
#include "probe.h"
#include "random.h"
#include "scenes.h"
#include "soup.h"
#include "starved.h"
#include "test.h"

#include <math.h>

/* The errors of a built-in scene or of a file, every one of them away from a boundary and near one.
 */
static shb_errors errors_of(const char *name, scene_light_kind light, uint32_t size,
                            shb_occluders occluders, shb_format format, bool reversed) {
    example_scene *scene = NULL;
    shb_context *context = NULL;
    shb_map *map = NULL;
    shb_map_desc desc = {.width = size, .format = format, .occluders = occluders};
    measure_frame frame;
    measure_truth truth;
    char error[512];
    const shb_bias exact = shb_bias_exact();
    measure_result measured = {0};
    CHECK(scene_open(name, &scene, error, sizeof error));
    context = test_context(0, SHB_ISA_BEST);
    CHECK(!scene_light_view(scene, light, size, reversed, &desc.view));
    CHECK(!shb_map_create(context, &desc, &map));
    CHECK(!measure_frame_create(context, scene, 200, 150, &frame));
    CHECK(!measure_truth_create(&frame, map, &truth));
    CHECK(!measure_method(&frame, &truth, map, &exact, NULL, NULL, 1, &measured));
    measure_truth_destroy(&truth);
    measure_frame_destroy(&frame);
    shb_map_destroy(map);
    shb_context_destroy(context);
    scene_close(scene);
    return measured.errors;
}

static uint64_t wrong(const shb_errors *errors) {
    return errors->false_shadow + errors->false_light + errors->boundary_shadow +
           errors->boundary_light;
}

TEST(planes_leave_no_false_shadow_on_creases_and_contacts) {
    static const char *const names[] = {"box", "l-shape", "staircase", "gap"};
    for (int i = 0; i < 4; i++)
        for (int light = 0; light < 2; light++) {
            const shb_errors errors = errors_of(names[i], (scene_light_kind)light, 512,
                                                SHB_OCCLUDERS_PLANES, SHB_FORMAT_FLOAT32, false);
            test_check(errors.false_shadow == 0 && errors.lit > 5000, __FILE__, __LINE__,
                       "%s, light %d: %d in false shadow", names[i], light,
                       (int)errors.false_shadow);
        }
}

TEST(planes_leave_no_false_shadow_in_any_format) {
    for (int format = 0; format < 3; format++)
        for (int reversed = 0; reversed < 2; reversed++) {
            const shb_errors errors = errors_of("box", SCENE_SPOT, 256, SHB_OCCLUDERS_PLANES,
                                                (shb_format)format, reversed);
            CHECK_INT(errors.false_shadow, 0);
        }
}

TEST(triangles_are_right_inside_a_texel) {
    static const char *const names[] = {"box", "l-shape",      "staircase",
                                        "gap", "tilted-plane", "wedge:15"};
    for (int i = 0; i < 6; i++)
        for (int light = 0; light < 2; light++) {
            const shb_errors errors = errors_of(names[i], (scene_light_kind)light, 256,
                                                SHB_OCCLUDERS_TRIANGLES, SHB_FORMAT_UNORM16, false);
            test_check(errors.false_shadow + errors.false_light == 0, __FILE__, __LINE__,
                       "%s, light %d: %d and %d", names[i], light, (int)errors.false_shadow,
                       (int)errors.false_light);
            test_check(wrong(&errors) * 2000 <= errors.lit + errors.shadowed, __FILE__, __LINE__,
                       "%s, light %d: %d wrong in all", names[i], light, (int)wrong(&errors));
        }
}

TEST(a_closed_mesh_of_many_triangles_gets_no_false_shadow) {
    example_scene *bunny = NULL;
    char error[512];
    if (!scene_open("../shared/scenes/bunny_69k.obj", &bunny, error, sizeof error)) {
        test_skip("no mesh of a bunny");
        return;
    }
    scene_close(bunny);
    const shb_errors errors = errors_of("../shared/scenes/bunny_69k.obj", SCENE_DIRECTIONAL, 1024,
                                        SHB_OCCLUDERS_TRIANGLES, SHB_FORMAT_FLOAT32, false);
    CHECK_INT(errors.false_shadow, 0);
    CHECK(wrong(&errors) * 1000 <= errors.lit + errors.shadowed);
}

typedef struct asked {
    shb_context *context;
    shb_map *map;
} asked;

static asked open_map(const shb_view *view, uint32_t size, const shb_scene *scene) {
    asked made;
    const shb_map_desc desc = {.view = *view, .width = size, .occluders = SHB_OCCLUDERS_TRIANGLES};
    made.context = test_context(0, SHB_ISA_BEST);
    CHECK(!shb_map_create(made.context, &desc, &made.map));
    CHECK(!shb_map_draw(made.map, scene, NULL, NULL));
    return made;
}

static void close_map(asked *made) {
    shb_map_destroy(made->map);
    shb_context_destroy(made->context);
}

enum { POINTS = 2000 };

static void ask(const asked *made, const float *points, float *visibility) {
    static float normals[3 * POINTS];
    for (int i = 0; i < POINTS; i++)
        normals[3 * i + 2] = 1;
    const shb_points all = {.count = POINTS, .positions = points, .normals = normals};
    const shb_bias exact = shb_bias_exact();
    CHECK(!shb_map_visibility(made->map, &all, &exact, NULL, visibility));
}

/* A zigzag roof over a floor, its risers and treads wound at random; texels are as wide as a tread.
 */
static void add_roof(soup *s, test_random *random, float scale) {
    const float f = scale;
    soup_add_quad(s, (float[]){-f, -f, 0}, (float[]){f, -f, 0}, (float[]){f, f, 0},
                  (float[]){-f, f, 0});
    for (int i = 0; i < 16; i++) {
        const float x = (-0.5f + 0.0625f * (float)i) * f, next = x + 0.0625f * f;
        const float z = (i % 2 ? 0.5f : 0.25f) * f, next_z = (i % 2 ? 0.25f : 0.5f) * f;
        const float a[3] = {x, -0.5f * f, z}, b[3] = {next, -0.5f * f, next_z};
        const float c[3] = {next, 0.5f * f, next_z}, d[3] = {x, 0.5f * f, z};
        if (random_below(random, 2))
            soup_add_quad(s, a, b, c, d);
        else
            soup_add_quad(s, d, c, b, a);
    }
}

/* Seen from above the roof covers |x|, |y| < 0.5, which the points tell by their own coordinates:
 * 8 texels of a map of 16 are exactly under it. */
TEST(winding_does_not_matter_to_the_walk) {
    test_random random = {21};
    soup s = {0};
    add_roof(&s, &random, 1);
    const shb_view view = probe_orthographic(false);
    asked made = open_map(&view, 16, soup_scene(&s));
    static float points[3 * POINTS], visibility[POINTS];
    for (int i = 0; i < POINTS; i++) {
        points[3 * i] = (float)random_double(&random, -0.9, 0.9);
        points[3 * i + 1] = (float)random_double(&random, -0.9, 0.9);
    }
    ask(&made, points, visibility);
    for (int i = 0; i < POINTS; i++) {
        const bool under = fabsf(points[3 * i]) < 0.5f && fabsf(points[3 * i + 1]) < 0.5f;
        CHECK(visibility[i] == (under ? 0.0f : 1.0f));
    }
    close_map(&made);
    soup_free(&s);
}

/* An edge 0.3 texels into a texel: the map's samples say nothing of it, the triangle does. */
TEST(an_edge_inside_a_texel_is_straight) {
    soup s = {0};
    soup_add_quad(&s, (float[]){-1, -1, 0}, (float[]){1, -1, 0}, (float[]){1, 1, 0},
                  (float[]){-1, 1, 0});
    const float edge = 0.5375f;
    soup_add_quad(&s, (float[]){-1, -1, 1}, (float[]){edge, -1, 1}, (float[]){edge, 1, 1},
                  (float[]){-1, 1, 1});
    const shb_view view = probe_orthographic(false);
    asked made = open_map(&view, 16, soup_scene(&s));
    test_random random = {22};
    static float points[3 * POINTS], visibility[POINTS];
    for (int i = 0; i < POINTS; i++) {
        points[3 * i] = (float)random_double(&random, 0.4375, 0.625);
        points[3 * i + 1] = (float)random_double(&random, -0.9, 0.9);
    }
    ask(&made, points, visibility);
    for (int i = 0; i < POINTS; i++)
        CHECK(visibility[i] == (points[3 * i] < edge ? 0.0f : 1.0f));
    close_map(&made);
    soup_free(&s);
}

TEST(no_memory_is_an_error_at_every_allocation) {
    test_random random = {25};
    soup s = {0};
    add_roof(&s, &random, 1);
    for (int kind = SHB_OCCLUDERS_PLANES; kind <= SHB_OCCLUDERS_TRIANGLES; kind++) {
        const shb_map_desc desc = {
            .view = probe_orthographic(false), .width = 16, .occluders = (shb_occluders)kind};
        CHECK(test_starve_map(&desc, soup_scene(&s)) > 5);
    }
    soup_free(&s);
}
