/* Truth by ray casting: own triangles, lights, what is not finite, shapes of the hierarchy,
 * threads, memory and arguments. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "allocator.h"
#include "random.h"
#include "ray_caster.h"
#include "soup.h"
#include "test.h"

/* ---- own triangles, lights, what is not finite ---- */

TEST(the_own_triangle_is_left_out_by_its_id) {
    soup s = {0};
    soup_add(&s, (float[3]){-1, -1, 1}, (float[3]){1, -1, 1}, (float[3]){0, 1, 1});
    ray_caster t = ray_caster_create(soup_scene(&s));
    const shb_light_source light = light_along(0, 0, 1);
    const shb_vec3 point = {0, 0, 0};
    uint8_t result = 99;
    CHECK_INT(shb_reference_occluded(t.reference, &light, 1, &point, NULL, &result), SHB_OK);
    CHECK_INT(result, 1);
    CHECK_INT(ray_caster_occluded(t.reference, light, point, SHB_ID_NONE), 1);
    CHECK_INT(ray_caster_occluded(t.reference, light, point, 1), 1);
    CHECK_INT(ray_caster_occluded(t.reference, light, point, 0), 0);
    ray_caster_destroy(&t);
    soup_free(&s);
}

TEST(only_what_lies_before_a_point_light_shadows) {
    soup s = {0};
    soup_add(&s, (float[3]){-1, -1, 1}, (float[3]){1, -1, 1}, (float[3]){0, 1, 1});
    ray_caster t = ray_caster_create(soup_scene(&s));
    const shb_vec3 point = {0, 0, 0};
    CHECK_INT(ray_caster_occluded(t.reference, light_at(0, 0, 1.5), point, SHB_ID_NONE), 1);
    CHECK_INT(ray_caster_occluded(t.reference, light_at(0, 0, 1.0001), point, SHB_ID_NONE), 1);
    CHECK_INT(ray_caster_occluded(t.reference, light_at(0, 0, 1), point, SHB_ID_NONE), 0);
    CHECK_INT(ray_caster_occluded(t.reference, light_at(0, 0, 0.9999), point, SHB_ID_NONE), 0);
    CHECK_INT(ray_caster_occluded(t.reference, light_at(0, 0, -1), point, SHB_ID_NONE), 0);
    CHECK_INT(ray_caster_occluded(t.reference, light_at(0, 0, 0), point, SHB_ID_NONE), 0);
    CHECK_INT(ray_caster_occluded(t.reference, light_along(0, 0, 1e-300), point, SHB_ID_NONE), 1);
    CHECK_INT(ray_caster_occluded(t.reference, light_along(0, 0, -1), point, SHB_ID_NONE), 0);
    ray_caster_destroy(&t);
    soup_free(&s);
}

TEST(triangles_that_are_not_finite_are_left_out_and_ids_stay) {
    soup s = {0};
    soup_add(&s, (float[3]){NAN, -1, 1}, (float[3]){1, -1, 1}, (float[3]){0, 1, 1});
    soup_add(&s, (float[3]){-1, -1, 1}, (float[3]){1, -1, INFINITY}, (float[3]){0, 1, 1});
    soup_add(&s, (float[3]){-1, -1, 2}, (float[3]){1, -1, 2}, (float[3]){0, 1, 2});
    ray_caster t = ray_caster_create(soup_scene(&s));
    const shb_light_source light = light_along(0, 0, 1);
    CHECK_INT(ray_caster_occluded(t.reference, light, (shb_vec3){0, 0, 0}, 0), 1);
    CHECK_INT(ray_caster_occluded(t.reference, light, (shb_vec3){0, 0, 0}, 2), 0);
    CHECK_INT(ray_caster_occluded(t.reference, light, (shb_vec3){(double)NAN, 0, 0}, SHB_ID_NONE),
              0);
    CHECK_INT(ray_caster_occluded(t.reference, light, (shb_vec3){0, 0, -HUGE_VAL}, SHB_ID_NONE), 0);
    ray_caster_destroy(&t);
    soup_free(&s);
}

TEST(coordinates_beyond_float_cast_shadows_and_extremes_do_no_harm) {
    soup s = {0};
    soup_add(&s, (float[3]){-1, -1, 1}, (float[3]){1, -1, 1}, (float[3]){0, 1, 1});
    s.transform = shb_mat4_scaling(1e50, 1e50, 1e50);
    ray_caster t = ray_caster_create(soup_scene(&s));
    CHECK_INT(
        ray_caster_occluded(t.reference, light_along(0, 0, 1), (shb_vec3){0, 0, 0}, SHB_ID_NONE),
        1);
    CHECK_INT(
        ray_caster_occluded(t.reference, light_along(0, 0, 1), (shb_vec3){3e50, 0, 0}, SHB_ID_NONE),
        0);
    ray_caster_destroy(&t);
    s.transform = shb_mat4_scaling(1e300, 1e300, 1e-300);
    t = ray_caster_create(soup_scene(&s));
    CHECK(ray_caster_occluded(t.reference, light_along(1, 1, 1), (shb_vec3){1e308, 0, 0},
                              SHB_ID_NONE) <= 1);
    CHECK(ray_caster_occluded(t.reference, light_at(-1e308, 1, 1), (shb_vec3){1e308, 0, 0},
                              SHB_ID_NONE) <= 1);
    ray_caster_destroy(&t);
    soup_free(&s);
}

/* ---- shapes of the hierarchy ---- */

TEST(equal_and_lopsided_triangles_build_a_hierarchy) {
    soup s = {0};
    for (int i = 0; i < 1000; i++) /* all in one place */
        soup_add(&s, (float[3]){-1, -1, 1}, (float[3]){1, -1, 1}, (float[3]){0, 1, 1});
    for (int i = -120; i < 120; i++) { /* each far smaller than the next */
        const float size = ldexpf(1, i), at = 3 * size;
        soup_add(&s, (float[3]){at, 0, size}, (float[3]){at + size, 0, size},
                 (float[3]){at, size, size});
    }
    ray_caster t = ray_caster_create(soup_scene(&s));
    const shb_light_source light = light_along(0, 0, 1);
    CHECK_INT(ray_caster_occluded(t.reference, light, (shb_vec3){0, -0.5, 0}, 3), 1);
    CHECK_INT(ray_caster_occluded(t.reference, light, (shb_vec3){0, -0.5, 1}, 3), 0);
    for (int i = -120; i < 120; i++) {
        const double size = ldexp(1, i);
        const shb_vec3 under = {3.25 * size, 0.25 * size, 0};
        const uint32_t id = (uint32_t)(1000 + 120 + i);
        CHECK_INT(ray_caster_occluded(t.reference, light_at(under.x, under.y, 2 * size), under,
                                      SHB_ID_NONE),
                  1);
        CHECK_INT(
            ray_caster_occluded(t.reference, light_at(under.x, under.y, 1.01 * size), under, id),
            0);
    }
    ray_caster_destroy(&t);
    soup_free(&s);
}

TEST(a_hierarchy_is_never_too_deep_for_its_traversal) {
    /* Triangles of sizes 16^k with their middles at 16^k on each axis: bins tell only the largest
     * apart, so that the heuristic alone would peel off one at a time, 190 levels deep. All boxes
     * hold the origin. In its own axes a triangle of size 1 lies in the plane 3.8 x + 3.8 y + 8 z =
     * 0.4: a ray along (1, 1, 1) meets it at 1 / 39 of the way, one along (-1, -1, -1) never does.
     */
    soup s = {0};
    const float shape[3][3] = {{-1, -1, 1}, {3, -1, -0.9f}, {1, 1, -0.9f}};
    for (int power = -36; power < 28; power++)
        for (int axis = 0; axis < 3; axis++) {
            float p[3][3];
            for (int k = 0; k < 3; k++)
                for (int i = 0; i < 3; i++)
                    p[k][(axis + i) % 3] = ldexpf(shape[k][i], 4 * power);
            soup_add(&s, p[0], p[1], p[2]);
        }
    ray_caster t = ray_caster_create(soup_scene(&s));
    const shb_vec3 origin = {0, 0, 0};
    CHECK_INT(ray_caster_occluded(t.reference, light_along(-1, -1, -1), origin, SHB_ID_NONE), 0);
    CHECK_INT(ray_caster_occluded(t.reference, light_along(1, 1, 1), origin, SHB_ID_NONE), 1);
    CHECK_INT(ray_caster_occluded(t.reference, light_at(1e-50, 1e-50, 1e-50), origin, SHB_ID_NONE),
              0);
    ray_caster_destroy(&t);
    soup_free(&s);
}

TEST(an_empty_scene_shadows_nothing) {
    const shb_scene scene = {NULL, 0};
    ray_caster t = ray_caster_create(&scene);
    CHECK_INT(ray_caster_occluded(t.reference, light_along(0, 0, 1), (shb_vec3){0, 0, 0}, 0), 0);
    const shb_light_source light = light_along(0, 0, 1);
    CHECK_INT(shb_reference_occluded(t.reference, &light, 0, NULL, NULL, NULL), SHB_OK);
    ray_caster_destroy(&t);
}

/* ---- threads, memory, arguments ---- */

TEST(occlusion_does_not_depend_on_threads) {
    enum { POINTS = 20000 };
    test_random random = {9};
    soup s = {0};
    soup_add_needles(&s, &random, 20000, 0.03);
    shb_vec3 *points = malloc(POINTS * sizeof *points);
    uint32_t *ids = malloc(POINTS * sizeof *ids);
    uint8_t *results[2] = {malloc(POINTS), malloc(POINTS)};
    for (int i = 0; i < POINTS; i++) {
        points[i] = random_point(&random, 1);
        ids[i] = random_below(&random, s.count);
    }
    for (uint32_t k = 0; k < 2; k++) {
        const shb_context_desc desc = {.threads = k ? 5 : 1};
        const shb_light_source light = light_at(0.5, 1, 3);
        ray_caster t;
        CHECK_INT(shb_context_create(&desc, &t.context), SHB_OK);
        CHECK_INT(shb_reference_create(t.context, soup_scene(&s), &t.reference), SHB_OK);
        CHECK_INT(shb_reference_occluded(t.reference, &light, POINTS, points, ids, results[k]),
                  SHB_OK);
        ray_caster_destroy(&t);
    }
    CHECK(memcmp(results[0], results[1], POINTS) == 0);
    size_t shadowed = 0;
    for (int i = 0; i < POINTS; i++)
        shadowed += results[0][i];
    CHECK(shadowed > POINTS / 20 && shadowed < POINTS * 19 / 20);
    free(points);
    free(ids);
    free(results[0]);
    free(results[1]);
    soup_free(&s);
}

TEST(a_reference_without_memory_fails_and_leaks_nothing) {
    soup s = {0};
    test_random random = {10};
    soup_add_needles(&s, &random, 100, 0.3);
    test_allocator state = {0};
    const shb_context_desc desc = {.allocator = test_allocator_hooks(&state), .threads = 1};
    shb_context *context = NULL;
    CHECK_INT(shb_context_create(&desc, &context), SHB_OK);
    const size_t live = state.live;
    shb_reference *const untouched = (shb_reference *)(void *)&state;
    shb_result result = SHB_ERROR_MEMORY;
    for (size_t fail_at = 1; result == SHB_ERROR_MEMORY && fail_at < 100; fail_at++) {
        state.calls = 0;
        state.fail_at = fail_at;
        shb_reference *reference = untouched;
        result = shb_reference_create(context, soup_scene(&s), &reference);
        if (result) {
            CHECK_INT(result, SHB_ERROR_MEMORY);
            CHECK(reference == untouched);
            CHECK_INT(state.live, live);
        } else {
            CHECK(fail_at > 5);
            shb_reference_destroy(reference);
        }
    }
    CHECK_INT(result, SHB_OK);
    CHECK_INT(state.live, live);
    shb_context_destroy(context);
    soup_free(&s);
}

TEST(occlusion_refuses_bad_arguments) {
    soup s = {0};
    soup_add_quad(&s, (float[3]){-1, -1, 0}, (float[3]){1, -1, 0}, (float[3]){1, 1, 0},
                  (float[3]){-1, 1, 0});
    ray_caster t = ray_caster_create(soup_scene(&s));
    shb_reference *other = t.reference;
    CHECK_INT(shb_reference_create(NULL, soup_scene(&s), &other), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_reference_create(t.context, NULL, &other), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_reference_create(t.context, soup_scene(&s), NULL), SHB_ERROR_ARGUMENT);
    const uint32_t bad_index[3] = {0, 1, 6};
    const shb_mesh mesh = {
        .positions = s.positions, .vertex_count = 6, .indices = bad_index, .triangle_count = 1};
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene bad_scene = {&instance, 1};
    CHECK_INT(shb_reference_create(t.context, &bad_scene, &other), SHB_ERROR_ARGUMENT);
    CHECK(other == t.reference);

    const shb_light_source good = light_along(0, 0, 1);
    const shb_vec3 point = {0, 0, -1};
    uint8_t result = 99;
    CHECK_INT(shb_reference_occluded(NULL, &good, 1, &point, NULL, &result), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_reference_occluded(t.reference, NULL, 1, &point, NULL, &result),
              SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_reference_occluded(t.reference, &good, 1, NULL, NULL, &result),
              SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_reference_occluded(t.reference, &good, 1, &point, NULL, NULL),
              SHB_ERROR_ARGUMENT);
    const shb_light_source bad[4] = {light_along(0, 0, 0),
                                     light_along((double)NAN, 0, 1),
                                     light_at(0, HUGE_VAL, 0),
                                     {{1, 1, 1}, 0.5}};
    for (int i = 0; i < 4; i++)
        CHECK_INT(shb_reference_occluded(t.reference, &bad[i], 1, &point, NULL, &result),
                  SHB_ERROR_NUMBER);
    CHECK_INT(result, 99);
    ray_caster_destroy(&t);
    shb_reference_destroy(NULL);
    soup_free(&s);
}
