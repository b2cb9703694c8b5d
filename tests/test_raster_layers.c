#include "random.h"
#include "target.h"
#include "test.h"

#include <math.h>
#include <string.h>

#define WIDTH 70
#define HEIGHT 40
#define SAMPLES (WIDTH * HEIGHT)

/* Draws every triangle of the mesh alone and merges the depths by the definition: the two smallest
 * pairs of (depth, id). Depths are canonical within. */
static void merge_single_triangles(test_contexts *contexts, const shb_view *view,
                                   const shb_mesh *mesh, const test_target *merged) {
    const float empty = view->reversed ? 0 : 1, sign = view->reversed ? -1 : 1;
    test_target single = test_target_create(WIDTH, HEIGHT);
    for (int at = 0; at < SAMPLES; at++) {
        merged->depth[at] = merged->second[at] = empty;
        merged->ids[at] = SHB_ID_NONE;
    }
    for (uint32_t id = 0; id < mesh->triangle_count; id++) {
        shb_mesh part = *mesh;
        part.triangle_count = 1;
        part.indices = (const uint32_t *)mesh->indices + (size_t)3 * id;
        const shb_instance instance = {.mesh = &part};
        const shb_scene scene = {&instance, 1};
        test_target_draw(&single, contexts, view, &scene, 0);
        for (int at = 0; at < SAMPLES; at++) {
            if (single.ids[at] != 0)
                continue;
            CHECK(single.second[at] == empty);
            const float z = sign * single.depth[at];
            if (z < sign * merged->depth[at]) {
                merged->second[at] = merged->depth[at];
                merged->depth[at] = single.depth[at];
                merged->ids[at] = id;
            } else if (z < sign * merged->second[at]) {
                merged->second[at] = single.depth[at];
            }
        }
    }
    test_target_destroy(&single);
}

static void check_layers(const shb_view *view, const shb_mesh *mesh) {
    const shb_instance instance = {.mesh = mesh};
    const shb_scene scene = {&instance, 1};
    test_contexts *contexts = test_contexts_create(1);
    test_target target = test_target_create(WIDTH, HEIGHT);
    test_target merged = test_target_create(WIDTH, HEIGHT);
    merge_single_triangles(contexts, view, mesh, &merged);
    test_target_draw(&target, contexts, view, &scene, 16);
    CHECK(test_target_equal(&target, &merged));
    unsigned seconds = 0;
    for (int at = 0; at < SAMPLES; at++)
        seconds += target.second[at] != (view->reversed ? 0.0f : 1.0f);
    CHECK(seconds > SAMPLES / 4);
    test_target_destroy(&merged);
    test_target_destroy(&target);
    test_contexts_destroy(contexts);
}

/* Triangles over the vertices, some of them twice, some with their corners in another order. */
static void random_indices(test_random *random, uint32_t vertices, uint32_t triangles,
                           uint32_t *indices) {
    for (uint32_t i = 0; i < triangles; i++) {
        uint32_t *corners = &indices[3 * i];
        for (int k = 0; k < 3; k++)
            corners[k] = random_below(random, vertices);
        const uint32_t kind = random_below(random, 4);
        if (i > 0 && kind < 2)
            for (uint32_t k = 0; k < 3; k++)
                corners[k] = indices[3 * (i - 1) + (k + kind) % 3];
    }
}

TEST(layers_are_the_two_smallest_pairs_of_depth_and_id) {
    enum { VERTICES = 40, TRIANGLES = 60 };
    test_random random = {21};
    for (int round = 0; round < 6; round++) {
        float positions[3 * VERTICES];
        uint32_t indices[3 * TRIANGLES];
        for (int i = 0; i < VERTICES; i++) {
            positions[3 * i] = (float)random_double(&random, -20, WIDTH + 20);
            positions[3 * i + 1] = (float)random_double(&random, -20, HEIGHT + 20);
            /* Few depths, so that many are equal. */
            positions[3 * i + 2] = 0.25f * (float)(1 + random_below(&random, round < 3 ? 2 : 5));
        }
        random_indices(&random, VERTICES, TRIANGLES, indices);
        const shb_mesh mesh = {.positions = positions,
                               .vertex_count = VERTICES,
                               .indices = indices,
                               .triangle_count = TRIANGLES};
        shb_view view = test_pixel_view(WIDTH, HEIGHT);
        view.reversed = round % 2;
        check_layers(&view, &mesh);
    }
}

TEST(layers_of_clipped_triangles_are_distinct_triangles) {
    enum { VERTICES = 40, TRIANGLES = 80 };
    test_random random = {22};
    for (int round = 0; round < 6; round++) {
        float positions[3 * VERTICES];
        uint32_t indices[3 * TRIANGLES];
        for (int i = 0; i < 3 * VERTICES; i++)
            positions[i] = (float)random_double(&random, -3, 3);
        random_indices(&random, VERTICES, TRIANGLES, indices);
        const shb_mesh mesh = {.positions = positions,
                               .vertex_count = VERTICES,
                               .indices = indices,
                               .triangle_count = TRIANGLES};
        shb_view view;
        CHECK_INT(shb_view_perspective((shb_vec3){0, 0, 0}, (shb_vec3){1, 0.1, 0.2},
                                       (shb_vec3){0, 1, 0}, 1.3, 1.7, 0.1, round % 3 ? 9 : HUGE_VAL,
                                       round % 2, &view),
                  SHB_OK);
        check_layers(&view, &mesh);
    }
}

/* Stacked copies of one triangle over the whole target. */
static void draw_stack(const float *depths, uint32_t count, bool reversed, float *nearest,
                       float *second, uint32_t *id) {
    float positions[9 * 8];
    for (uint32_t i = 0; i < count; i++) {
        const float corners[9] = {-1,        -1, depths[i], 3 * WIDTH, -1,
                                  depths[i], -1, 3 * WIDTH, depths[i]};
        memcpy(&positions[9 * i], corners, sizeof corners);
    }
    const shb_mesh mesh = {
        .positions = positions, .vertex_count = 3 * count, .triangle_count = count};
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene scene = {&instance, 1};
    shb_view view = test_pixel_view(WIDTH, HEIGHT);
    view.reversed = reversed;
    test_contexts *contexts = test_contexts_create(1);
    test_target target = test_target_create(WIDTH, HEIGHT);
    test_target_draw(&target, contexts, &view, &scene, 0);
    *nearest = target.depth[SAMPLES / 2];
    *second = target.second[SAMPLES / 2];
    *id = target.ids[SAMPLES / 2];
    test_target_destroy(&target);
    test_contexts_destroy(contexts);
}

static void check_stack(const float *depths, uint32_t count, bool reversed, float nearest,
                        float second, uint32_t id) {
    float drawn_nearest, drawn_second;
    uint32_t drawn_id;
    draw_stack(depths, count, reversed, &drawn_nearest, &drawn_second, &drawn_id);
    CHECK(drawn_nearest == nearest);
    CHECK(drawn_second == second);
    CHECK_INT(drawn_id, id);
}

TEST(equal_depth_keeps_the_lower_id_and_counts_as_second) {
    check_stack((float[]){0.5f, 0.5f}, 2, false, 0.5f, 0.5f, 0);
    check_stack((float[]){0.75f, 0.5f, 0.5f, 0.25f}, 4, false, 0.25f, 0.5f, 3);
    check_stack((float[]){0.75f, 0.25f, 0.5f, 0.25f}, 4, false, 0.25f, 0.25f, 1);
    check_stack((float[]){0.5f}, 1, false, 0.5f, 1, 0);
    check_stack((float[]){0.5f, 1, 1.5f}, 3, false, 0.5f, 1, 0);
    check_stack((float[]){0.75f, 0.5f, 0.5f, 0.25f}, 4, true, 0.75f, 0.5f, 0);
    check_stack((float[]){0.25f, 0.75f, 0.75f}, 3, true, 0.75f, 0.75f, 1);
    check_stack((float[]){0.5f, 0}, 2, true, 0.5f, 0, 0);
}

/* A flat triangle that the guard band cuts and one that it does not, at equal depth. */
TEST(equal_depth_keeps_the_lower_id_of_cut_and_whole_triangles) {
    const float cut[9] = {-1, -1, 0.5f, 1e6f, -1, 0.5f, -1, 1e6f, 0.5f};
    const float whole[9] = {-1, -1, 0.5f, 200, -1, 0.5f, -1, 200, 0.5f};
    const shb_view view = test_pixel_view(WIDTH, HEIGHT);
    test_contexts *contexts = test_contexts_create(1);
    test_target target = test_target_create(WIDTH, HEIGHT);
    for (int order = 0; order < 2; order++) {
        float corners[18];
        memcpy(corners, order ? whole : cut, sizeof cut);
        memcpy(corners + 9, order ? cut : whole, sizeof whole);
        const shb_mesh mesh = {.positions = corners, .vertex_count = 6, .triangle_count = 2};
        const shb_instance instance = {.mesh = &mesh};
        const shb_scene scene = {&instance, 1};
        CHECK_INT(test_target_draw(&target, contexts, &view, &scene, 0).clipped, 1);
        for (int at = 0; at < SAMPLES; at++)
            CHECK(target.ids[at] == 0 && target.depth[at] == 0.5f && target.second[at] == 0.5f);
    }
    test_target_destroy(&target);
    test_contexts_destroy(contexts);
}

TEST(an_empty_scene_is_far_and_without_ids) {
    const shb_scene scene = {NULL, 0};
    test_contexts *contexts = test_contexts_create(2);
    test_target target = test_target_create(WIDTH, HEIGHT);
    for (int reversed = 0; reversed < 2; reversed++) {
        shb_view view = test_pixel_view(WIDTH, HEIGHT);
        view.reversed = reversed;
        const shb_draw_stats stats = test_target_draw(&target, contexts, &view, &scene, 16);
        CHECK(stats.triangles == 0 && stats.culled == 0 && stats.drawn == 0);
        for (int at = 0; at < SAMPLES; at++) {
            CHECK(target.depth[at] == (reversed ? 0.0f : 1.0f) && !signbit(target.depth[at]));
            CHECK(target.second[at] == target.depth[at]);
            CHECK(target.ids[at] == SHB_ID_NONE);
        }
    }
    test_target_destroy(&target);
    test_contexts_destroy(contexts);
}
