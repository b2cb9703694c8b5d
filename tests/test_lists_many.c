/* Lists over many exact points: not one may differ from the ray-cast truth, at no size. */
#include "list_samples.h"

#include <stdlib.h>

#include "test.h"

enum { SIZES = 3, CHUNK = 4000 };

static const uint32_t sizes[SIZES] = {16, 200, 1024};

/* Small and large triangles that cross each other, two balls that nearly touch, stairs. */
static void make_mixture(soup *s) {
    test_random random = {21};
    for (int i = 0; i < 1500; i++)
        soup_add_random(s, &random, i % 40 == 0 ? 0.7 : i % 4 == 0 ? 0.003 : 0.05);
    const float left[3] = {-1.0005f, 0, 0}, right[3] = {1, 0.1f, 0};
    soup_add_ball(s, left, 60, 60, NULL);
    soup_add_ball(s, right, 25, 25, NULL);
    for (int step = 0; step < 12; step++) {
        const float y = -1.5f + 0.1f * (float)step;
        const float lo[3] = {-1, y, -1.2f}, hi[3] = {1, y + 0.1f, -1.1f + 0.05f * (float)step};
        soup_add_box(s, lo, hi);
    }
}

typedef struct counts {
    size_t asked, shadowed, wrong;
} counts;

static void ask_chunk(shb_lists *const lists[SIZES], const shb_reference *reference,
                      const shb_view *view, const shb_scene *scene, uint64_t seed, counts *c) {
    list_samples s = list_samples_create(scene, CHUNK, seed);
    list_samples_find_truth(reference, view, &s);
    for (int i = 0; i < SIZES; i++) {
        list_samples_ask(lists[i], &s, true, 0);
        c->wrong += list_samples_false_shadow(&s) + list_samples_false_light(&s);
    }
    c->asked += CHUNK;
    c->shadowed += list_samples_occluded(&s);
    list_samples_free(&s);
}

/* Ten million points with SHB_LIST_POINTS=10000000. */
TEST(no_exact_point_of_many_differs_from_the_rays) {
    static const lists_light *const lights[] = {&lists_slanted, &lists_grazing, &lists_spot};
    const size_t light_count = sizeof lights / sizeof *lights;
    const char *wanted = getenv("SHB_LIST_POINTS");
    const size_t points = wanted ? (size_t)strtoull(wanted, NULL, 10) : 24000;
    soup s = {0};
    make_mixture(&s);
    const shb_scene *scene = soup_scene(&s);
    shb_context *context = lists_context(1);
    shb_reference *reference = NULL;
    shb_box box;
    CHECK_INT(shb_reference_create(context, scene, &reference), SHB_OK);
    CHECK_INT(shb_scene_bounds(scene, &box), SHB_OK);
    counts c = {0};
    for (size_t light = 0; light < light_count; light++) {
        const shb_view view = lists_view(lights[light], box, 1024, true);
        shb_lists *lists[SIZES];
        for (int i = 0; i < SIZES; i++)
            lists[i] = lists_of(context, &view, sizes[i], scene);
        for (uint64_t seed = 100; c.asked < points * (light + 1) / light_count; seed++)
            ask_chunk(lists, reference, &view, scene, seed, &c);
        for (int i = 0; i < SIZES; i++)
            shb_lists_destroy(lists[i]);
    }
    CHECK(c.asked >= points && c.shadowed > c.asked / 10);
    CHECK_INT(c.wrong, 0);
    shb_reference_destroy(reference);
    shb_context_destroy(context);
    soup_free(&s);
}

/* So far away that rounding moves points across edges by more than weights in float would tell. */
TEST(lists_answer_as_rays_for_points_far_outside_the_scene) {
    soup s = {0};
    test_random random = {7};
    for (int i = 0; i < 200; i++)
        soup_add_random(&s, &random, 0.03);
    const shb_scene *scene = soup_scene(&s);
    shb_context *context = lists_context(1);
    shb_reference *reference = NULL;
    CHECK_INT(shb_reference_create(context, scene, &reference), SHB_OK);
    const shb_view view = lists_view(&lists_slanted, (shb_box){{-2, -2, -2}, {2, 2, 2}}, 64, false);
    shb_lists *lists = lists_of(context, &view, 64, scene);
    shb_light_source light;
    CHECK_INT(shb_view_light_source(&view, &light), SHB_OK);
    list_samples samples = list_samples_create(scene, 3000, 8);
    for (size_t i = 0; i < samples.count; i++) {
        shb_vec3 *p = &samples.points[i];
        *p = shb_vec3_subtract(*p, shb_vec3_scale(light.position, 0x1p44));
        samples.x[i] = p->x;
        samples.y[i] = p->y;
        samples.z[i] = p->z;
        samples.own_ids[i] = SHB_ID_NONE;
    }
    list_samples_find_truth(reference, &view, &samples);
    CHECK(list_samples_occluded(&samples) > 2000 && list_samples_occluded(&samples) < 2990);
    list_samples_ask(lists, &samples, false, 0);
    CHECK_INT(list_samples_false_shadow(&samples), 0);
    CHECK_INT(list_samples_false_light(&samples), 0);
    list_samples_free(&samples);
    shb_lists_destroy(lists);
    shb_reference_destroy(reference);
    shb_context_destroy(context);
    soup_free(&s);
}
