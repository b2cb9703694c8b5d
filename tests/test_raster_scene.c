#include "random.h"
#include "target.h"
#include "test.h"

#include <math.h>
#include <string.h>

#define WIDTH 32
#define HEIGHT 16
#define SAMPLES (WIDTH * HEIGHT)

/* In a target with y up, corners in units of it: counter-clockwise, so front. */
static const float front_corners[9] = {-1, -1, 0.5f, 3, -1, 0.5f, -1, 3, 0.5f};

static shb_view plain_view(bool reversed) {
    return (shb_view){shb_mat4_identity(), reversed};
}

/* True if the triangle over the whole target is drawn. */
static bool is_drawn(test_contexts *contexts, shb_cull cull, shb_mat4 transform, bool flip,
                     bool reversed) {
    const shb_mesh mesh = {.positions = front_corners, .vertex_count = 3, .triangle_count = 1};
    const shb_instance instance = {.mesh = &mesh, .world_from_mesh = transform, .cull = cull};
    const shb_scene scene = {&instance, 1};
    const shb_view view = plain_view(reversed);
    uint32_t ids[SAMPLES];
    shb_draw_desc desc = {.view = &view,
                          .scene = &scene,
                          .width = WIDTH,
                          .height = HEIGHT,
                          .ids = ids,
                          .flip_culling = flip};
    shb_draw_stats stats;
    CHECK_INT(shb_draw(contexts->best, &desc, &stats), SHB_OK);
    CHECK_INT(stats.drawn + stats.culled, 1);
    CHECK((ids[SAMPLES / 2 + 3] == 0) == (stats.drawn == 1));
    return stats.drawn == 1;
}

TEST(culling_follows_faces_mirrors_and_flips) {
    const shb_mat4 same = {{0}};
    /* Turned about the y axis, and moved back into the depth range: a back face. */
    shb_mat4 turned = shb_mat4_scaling(-1, 1, -1);
    turned.m[14] = 1;
    /* Mirrored left and right: winding turns round, the front stays in front. */
    const shb_mat4 mirrored = shb_mat4_scaling(-1, 1, 1);
    /* Mirrored front and back: the eye sees the back from inside. Winding as drawn stays. */
    shb_mat4 inverted = shb_mat4_scaling(1, 1, -1);
    inverted.m[14] = 1;
    const struct {
        const shb_mat4 *transform;
        bool is_front;
    } cases[] = {{&same, true}, {&turned, false}, {&mirrored, true}, {&inverted, false}};
    test_contexts *contexts = test_contexts_create(1);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (int reversed = 0; reversed < 2; reversed++) {
            const shb_mat4 m = *cases[i].transform;
            const bool front = cases[i].is_front;
            CHECK(is_drawn(contexts, SHB_CULL_NONE, m, false, reversed));
            CHECK(is_drawn(contexts, SHB_CULL_NONE, m, true, reversed));
            CHECK(is_drawn(contexts, SHB_CULL_BACK, m, false, reversed) == front);
            CHECK(is_drawn(contexts, SHB_CULL_BACK, m, true, reversed) == !front);
            CHECK(is_drawn(contexts, SHB_CULL_FRONT, m, false, reversed) == !front);
            CHECK(is_drawn(contexts, SHB_CULL_FRONT, m, true, reversed) == front);
        }
    test_contexts_destroy(contexts);
}

/* A box around the eye, wound outwards: culling back faces shows nothing, front faces everything.
 */
TEST(a_clipped_box_around_the_eye_has_only_back_faces) {
    float corners[24];
    for (int i = 0; i < 24; i++)
        corners[i] = (i / 3) >> (i % 3) & 1 ? 2.0f : -2.0f;
    const uint16_t indices[36] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                  2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    const shb_mesh mesh = {.positions = corners,
                           .vertex_count = 8,
                           .indices = indices,
                           .index_size = 2,
                           .triangle_count = 12};
    shb_instance instance = {.mesh = &mesh, .cull = SHB_CULL_BACK};
    const shb_scene scene = {&instance, 1};
    test_contexts *contexts = test_contexts_create(1);
    test_target target = test_target_create(WIDTH, HEIGHT);
    for (int turn = 0; turn < 8; turn++) {
        shb_view view;
        CHECK_INT(shb_view_perspective((shb_vec3){0.1, 0.2, 0.3},
                                       (shb_vec3){cos(turn), 0.7 * sin(2 * turn), sin(turn)},
                                       (shb_vec3){0, 1, 0}, 1.5, 2, 0.1, 10, false, &view),
                  SHB_OK);
        instance.cull = SHB_CULL_BACK;
        CHECK_INT(test_target_draw(&target, contexts, &view, &scene, 0).drawn, 0);
        instance.cull = SHB_CULL_FRONT;
        CHECK(test_target_draw(&target, contexts, &view, &scene, 0).clipped > 0);
        for (int at = 0; at < SAMPLES; at++)
            CHECK(target.ids[at] != SHB_ID_NONE && target.second[at] == 1);
    }
    test_target_destroy(&target);
    test_contexts_destroy(contexts);
}

enum { VERTICES = 60, TRIANGLES = 90 };

/* One mesh in all its forms. */
typedef struct mesh_forms {
    float positions[3 * VERTICES];
    float strided[5 * VERTICES];
    float unindexed[9 * TRIANGLES];
    uint32_t indices32[3 * TRIANGLES];
    uint16_t indices16[3 * TRIANGLES];
} mesh_forms;

static void make_forms(mesh_forms *forms) {
    test_random random = {41};
    for (int i = 0; i < 3 * VERTICES; i++)
        forms->positions[i] =
            (float)(i % 3 == 2 ? random_double(&random, 0, 1) : random_double(&random, -1.2, 1.2));
    for (int i = 0; i < 5 * VERTICES; i++)
        forms->strided[i] = i % 5 < 3 ? forms->positions[i / 5 * 3 + i % 5] : NAN;
    for (int i = 0; i < 3 * TRIANGLES; i++) {
        const uint32_t vertex = random_below(&random, VERTICES);
        forms->indices32[i] = vertex;
        forms->indices16[i] = (uint16_t)vertex;
        memcpy(&forms->unindexed[3 * i], &forms->positions[3 * vertex], 3 * sizeof(float));
    }
}

static void draw_mesh(test_contexts *contexts, const shb_mesh *mesh, const test_target *target) {
    const shb_view view = plain_view(false);
    const shb_instance instance = {.mesh = mesh};
    const shb_scene scene = {&instance, 1};
    test_target_draw(target, contexts, &view, &scene, 16);
}

TEST(indices_and_strides_of_every_kind_draw_the_same) {
    mesh_forms forms;
    make_forms(&forms);
    const shb_mesh plain = {.positions = forms.positions,
                            .vertex_count = VERTICES,
                            .indices = forms.indices32,
                            .triangle_count = TRIANGLES};
    shb_mesh others[4] = {plain, plain, plain, plain};
    others[0].index_size = 4;
    others[0].position_stride = 12;
    others[1].indices = forms.indices16;
    others[1].index_size = 2;
    others[2].positions = forms.strided;
    others[2].position_stride = 5 * sizeof(float);
    others[3] = (shb_mesh){
        .positions = forms.unindexed, .vertex_count = 3 * TRIANGLES, .triangle_count = TRIANGLES};
    test_contexts *contexts = test_contexts_create(1);
    test_target expected = test_target_create(WIDTH, HEIGHT);
    draw_mesh(contexts, &plain, &expected);
    for (int i = 0; i < 4; i++) {
        test_target target = test_target_create(WIDTH, HEIGHT);
        draw_mesh(contexts, &others[i], &target);
        CHECK(test_target_equal(&target, &expected));
        test_target_destroy(&target);
    }
    test_target_destroy(&expected);
    test_contexts_destroy(contexts);
}

TEST(ids_count_through_the_instances) {
    /* Quads of two triangles, side by side: instance k covers columns 8 k .. 8 k + 7. Instances
     * without triangles take no ids. */
    const float corners[] = {0, -1, 0.5f, 0.5f, -1, 0.5f, 0, 1, 0.5f, 0.5f, 1, 0.5f};
    const uint16_t indices[] = {0, 1, 2, 2, 1, 3};
    const shb_mesh quad = {.positions = corners,
                           .vertex_count = 4,
                           .indices = indices,
                           .index_size = 2,
                           .triangle_count = 2};
    const shb_mesh empty = {0}, vertices_only = {.positions = corners, .vertex_count = 4};
    shb_instance instances[8];
    size_t count = 0;
    for (int k = 0; k < 4; k++) {
        const shb_mat4 place = shb_mat4_translation(-1 + 0.5 * k, 0, 0);
        instances[count++] = (shb_instance){.mesh = &quad, .world_from_mesh = place};
        instances[count++] = (shb_instance){.mesh = k % 2 ? &empty : &vertices_only};
    }
    const shb_scene scene = {instances, count};
    const shb_view view = plain_view(false);
    test_contexts *contexts = test_contexts_create(1);
    test_target target = test_target_create(WIDTH, HEIGHT);
    const shb_draw_stats stats = test_target_draw(&target, contexts, &view, &scene, 16);
    CHECK_INT(stats.triangles, 8);
    CHECK_INT(stats.drawn, 8);
    for (int at = 0; at < SAMPLES; at++)
        CHECK_INT(target.ids[at] / 2, at % WIDTH / 8);
    test_target_destroy(&target);
    test_contexts_destroy(contexts);
}

/* More vertices and triangles than one task takes, in many instances. */
TEST(a_large_scene_keeps_its_ids_across_tasks) {
    enum { CELLS = 5000, INSTANCES = 3 };
    static float positions[9 * CELLS];
    for (int i = 0; i < CELLS; i++) {
        /* Triangle i covers the sample i % SAMPLES alone: a corner before its centre, two behind.
         */
        const float x = (float)(i % SAMPLES % WIDTH), y = (float)(i % SAMPLES / WIDTH);
        const float z = 1 - (float)(i + 1) / (2 * CELLS);
        const float corners[9] = {x + 0.25f, y + 0.25f, z,        x + 1.2f, y + 0.25f,
                                  z,         x + 0.25f, y + 1.2f, z};
        memcpy(&positions[9 * i], corners, sizeof corners);
    }
    const shb_mesh mesh = {
        .positions = positions, .vertex_count = 3 * CELLS, .triangle_count = CELLS};
    shb_instance instances[INSTANCES];
    for (int k = 0; k < INSTANCES; k++)
        instances[k] = (shb_instance){
            .mesh = &mesh, .world_from_mesh = shb_mat4_translation(0, 0, k == 1 ? -0.1 : 0)};
    const shb_scene scene = {instances, INSTANCES};
    const shb_view view = test_pixel_view(WIDTH, HEIGHT);
    test_contexts *contexts = test_contexts_create(2);
    test_target target = test_target_create(WIDTH, HEIGHT);
    CHECK_INT(test_target_draw(&target, contexts, &view, &scene, 16).drawn, INSTANCES * CELLS);
    for (int at = 0; at < SAMPLES; at++) {
        /* Later ones are nearer; instance 1 is nearest. */
        const int last = at + (CELLS - 1 - at) / SAMPLES * SAMPLES;
        CHECK_INT(target.ids[at], CELLS + last);
    }
    test_target_destroy(&target);
    test_contexts_destroy(contexts);
}

static shb_draw_stats stats_of(const float *corners, uint32_t count, const shb_view *view) {
    const shb_mesh mesh = {
        .positions = corners, .vertex_count = 3 * count, .triangle_count = count};
    const shb_instance instance = {.mesh = &mesh, .cull = SHB_CULL_BACK};
    const shb_scene scene = {&instance, 1};
    test_contexts *contexts = test_contexts_create(1);
    test_target target = test_target_create(WIDTH, HEIGHT);
    const shb_draw_stats stats = test_target_draw(&target, contexts, view, &scene, 0);
    test_target_destroy(&target);
    test_contexts_destroy(contexts);
    return stats;
}

static void check_stats(const float *corners, const shb_view *view, uint64_t not_finite,
                        uint64_t culled, uint64_t clipped, uint64_t drawn) {
    const shb_draw_stats stats = stats_of(corners, 1, view);
    CHECK_INT(stats.triangles, 1);
    CHECK_INT(stats.not_finite, not_finite);
    CHECK_INT(stats.culled, culled);
    CHECK_INT(stats.clipped, clipped);
    CHECK_INT(stats.drawn, drawn);
}

TEST(statistics_say_what_became_of_each_triangle) {
    const shb_view view = plain_view(false);
    check_stats(front_corners, &view, 0, 0, 0, 1);
    check_stats((float[]){-1, -1, NAN, 3, -1, 0, -1, 3, 0}, &view, 1, 0, 0, 0);
    check_stats((float[]){-1, -1, 0, 3, INFINITY, 0, -1, 3, 0}, &view, 1, 0, 0, 0);
    check_stats((float[]){-1, -1, 0, 3, 0, 0, -INFINITY, 3, 0}, &view, 1, 0, 0, 0);
    /* Back face, without area, left of the view, before the near plane, between the samples. */
    check_stats((float[]){-1, -1, 0, -1, 3, 0, 3, -1, 0}, &view, 0, 1, 0, 0);
    check_stats((float[]){0, 0, 0, 0.5f, 0.5f, 0, 1, 1, 0}, &view, 0, 1, 0, 0);
    check_stats((float[]){-3, -1, 0, -2, -1, 0, -2, 3, 0}, &view, 0, 1, 0, 0);
    check_stats((float[]){-1, -1, -1, 3, -1, -1, -1, 3, -1}, &view, 0, 1, 0, 0);
    check_stats((float[]){0, 0, 0, 0.02f, 0, 0, 0, 0.02f, 0}, &view, 0, 1, 0, 0);
    /* Cut by the near plane, by the guard band, and by the near plane but off the view. */
    check_stats((float[]){-1, -1, -1, 3, -1, 1, -1, 3, 1}, &view, 0, 0, 1, 1);
    check_stats((float[]){-1e5f, -1, 0, 3, -1, 0, -1, 3, 0}, &view, 0, 0, 1, 1);
    check_stats((float[]){-1, -5, -1, 9, -5, 0.1f, 9, 5, -1}, &view, 0, 1, 0, 0);
    /* Behind far: drawn, though no sample is seen. */
    check_stats((float[]){-1, -1, 2, 3, -1, 2, -1, 3, 2}, &view, 0, 0, 0, 1);
}

TEST(a_matrix_that_overflows_leaves_triangles_out) {
    shb_view view = plain_view(false);
    view.clip_from_world.m[0] = 0x1p1000;
    check_stats(front_corners, &view, 1, 0, 0, 0);
    view.clip_from_world.m[0] = 0x1p290;
    check_stats(front_corners, &view, 0, 0, 1, 1);
    /* Nothing can be projected with a w of 0. */
    view = (shb_view){.reversed = false};
    check_stats(front_corners, &view, 0, 1, 0, 0);
}

/* Vertices far apart in magnitude, not finite or degenerate: any result, but a defined one. */
TEST(nasty_vertices_draw_without_undefined_behaviour) {
    static const float nasty[] = {0,       -0.0f,    1,         -1,     1e-45f, 1e-38f,
                                  3.4e38f, -3.4e38f, 1e30f,     -1e30f, 16384,  -16384,
                                  NAN,     INFINITY, -INFINITY, 0.5f,   1e-7f,  65536};
    enum { COUNT = 400 };
    float corners[9 * COUNT];
    test_random random = {42};
    for (int i = 0; i < 9 * COUNT; i++)
        corners[i] = nasty[random_below(&random, i % 2 ? 12 : sizeof nasty / sizeof *nasty)];
    for (int reversed = 0; reversed < 2; reversed++) {
        shb_view view;
        CHECK_INT(shb_view_perspective((shb_vec3){0, 0, 0}, (shb_vec3){1, 1, 1},
                                       (shb_vec3){0, 1, 0}, 1, 1, 1e-3, HUGE_VAL, reversed, &view),
                  SHB_OK);
        const shb_draw_stats stats = stats_of(corners, COUNT, &view);
        CHECK_INT(stats.not_finite + stats.culled + stats.drawn, COUNT);
        CHECK(stats.not_finite > 0 && stats.clipped > 0);
    }
}
