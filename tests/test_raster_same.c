/* The same bits for every tile size, thread count and scheduler. */
#include "random.h"
#include "target.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>

#define WIDTH 330
#define HEIGHT 203
#define TRIANGLES 1500

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

static void check_same(const shb_view *view, const shb_scene *scene) {
    shb_context *context = test_context(1);
    test_target expected = test_target_create(WIDTH, HEIGHT);
    const shb_draw_stats stats = test_target_draw(&expected, context, view, scene, 0);
    CHECK(stats.clipped > 20 && stats.drawn > 200 && stats.culled > 100);
    shb_context_destroy(context);
    for (uint32_t threads = 1; threads <= 5; threads++) {
        shb_context_desc desc = {.threads = threads};
        if (threads == 5)
            desc.parallel_for = run_backwards;
        CHECK_INT(shb_context_create(&desc, &context), SHB_OK);
        for (uint32_t tile_size = 16; tile_size <= 512; tile_size *= 2) {
            test_target target = test_target_create(WIDTH, HEIGHT);
            const shb_draw_stats same = test_target_draw(&target, context, view, scene, tile_size);
            CHECK(test_target_equal(&target, &expected));
            CHECK(same.drawn == stats.drawn && same.clipped == stats.clipped &&
                  same.culled == stats.culled && same.triangles == stats.triangles);
            test_target_destroy(&target);
        }
        shb_context_destroy(context);
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
        check_same(&view, &scene);
    }
    free(corners);
}
