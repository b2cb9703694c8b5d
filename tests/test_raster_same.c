/* The same bits for every tile size, thread count and scheduler. */
#include "random.h"
#include "target.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH 210
#define HEIGHT 133
#define TRIANGLES 1500
#define THREADS 8 /* and a host's scheduler */

/* Triangles of all sizes around the eye: whole, cut, flat, steep, thin. */
static float *random_triangles(void) {
    test_random random = {51};
    float *corners = malloc(sizeof(float) * 9 * TRIANGLES);
    for (int i = 0; i < TRIANGLES; i++) {
        const double distance = exp(random_double(&random, log(0.2), log(40)));
        const double size = distance * exp(random_double(&random, log(0.01), log(2)));
        double center[3];
        for (int axis = 0; axis < 3; axis++)
            center[axis] = random_double(&random, -distance, distance);
        for (int k = 0; k < 9; k++)
            corners[9 * i + k] = (float)(center[k % 3] + random_double(&random, -size, size));
    }
    return corners;
}

static void run_backwards(void *user, shb_task_fn *task, void *arg, size_t count) {
    (void)user;
    for (size_t i = count; i > 0; i--)
        task(arg, i - 1);
}

static shb_draw_stats draw(const shb_context_desc *desc, const test_target *target,
                           const shb_view *view, const shb_scene *scene, uint32_t tile_size) {
    shb_context *context = NULL;
    shb_draw_stats stats = {0};
    shb_draw_desc drawing = test_target_desc(target, view, scene);
    drawing.tile_size = tile_size;
    CHECK_INT(shb_context_create(desc, &context), SHB_OK);
    CHECK_INT(shb_draw(context, &drawing, &stats), SHB_OK);
    shb_context_destroy(context);
    return stats;
}

static void check_same(const shb_view *view, const shb_scene *scene, shb_isa isa) {
    test_target expected = test_target_create(WIDTH, HEIGHT);
    shb_context_desc desc = {.threads = 1, .max_isa = isa};
    const shb_draw_stats stats = draw(&desc, &expected, view, scene, 0);
    CHECK(stats.clipped > 20 && stats.drawn > 200 && stats.culled > 100);
    for (desc.threads = 1; desc.threads <= THREADS + 1; desc.threads++) {
        desc.parallel_for = desc.threads > THREADS ? run_backwards : NULL;
        for (uint32_t tile_size = 16; tile_size <= 512; tile_size *= 2) {
            test_target target = test_target_create(WIDTH, HEIGHT);
            const shb_draw_stats same = draw(&desc, &target, view, scene, tile_size);
            CHECK(test_target_equal(&target, &expected));
            CHECK(memcmp(&same, &stats, sizeof same) == 0);
            test_target_destroy(&target);
        }
    }
    test_target_destroy(&expected);
}

TEST(drawing_is_the_same_for_all_tiles_and_threads) {
    float *corners = random_triangles();
    const shb_mesh mesh = {
        .positions = corners, .vertex_count = 3 * TRIANGLES, .triangle_count = TRIANGLES};
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene scene = {&instance, 1};
    for (int reversed = 0; reversed < 2; reversed++) {
        shb_view view;
        CHECK_INT(shb_view_perspective((shb_vec3){0, 0, 0}, (shb_vec3){1, 0.3, 0.2},
                                       (shb_vec3){0, 1, 0}, 1, 1.8, 0.1, reversed ? HUGE_VAL : 50,
                                       reversed, &view),
                  SHB_OK);
        check_same(&view, &scene, SHB_ISA_SCALAR);
        check_same(&view, &scene, SHB_ISA_BEST);
    }
    free(corners);
}

/* 257 columns by 17 rows of 16 x 16 pixels. */
TEST(more_small_tiles_than_a_target_is_cut_into_draw_the_same) {
    enum { WIDE = 257 * 16, HIGH = 17 * 16 };
    const float corners[18] = {4090, 0,  0.25f, 4112, 0,   0.5f, 4101, 272, 0.75f,
                               0,    90, 0.5f,  4112, 100, 0.5f, 9,    120, 0.125f};
    const shb_mesh mesh = {.positions = corners, .vertex_count = 6, .triangle_count = 2};
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene scene = {&instance, 1};
    const shb_view view = test_pixel_view(WIDE, HIGH);
    test_target expected = test_target_create(WIDE, HIGH), target = test_target_create(WIDE, HIGH);
    const shb_context_desc scalar = {.threads = 1, .max_isa = SHB_ISA_SCALAR},
                           best = {.threads = 2};
    const shb_draw_stats stats = draw(&scalar, &expected, &view, &scene, 512);
    CHECK_INT(stats.drawn, 2);
    draw(&best, &target, &view, &scene, 16);
    CHECK(test_target_equal(&target, &expected));
    test_target_destroy(&target);
    test_target_destroy(&expected);
}
