#include "list_samples.h"

#include "test.h"

#include <stdlib.h>

shb_context *lists_context(uint32_t threads) {
    shb_context *context = NULL;
    CHECK_INT(shb_context_create(&(shb_context_desc){.threads = threads}, &context), SHB_OK);
    return context;
}

list_samples list_samples_create(const shb_scene *scene, size_t count, uint64_t seed) {
    list_samples s = {.count = count,
                      .x = malloc(count * sizeof *s.x),
                      .y = malloc(count * sizeof *s.y),
                      .z = malloc(count * sizeof *s.z),
                      .points = malloc(count * sizeof *s.points),
                      .own_ids = malloc(count * sizeof *s.own_ids),
                      .occluded = malloc(count),
                      .visibility = malloc(count * sizeof *s.visibility)};
    test_random random = {seed};
    for (size_t i = 0; i < count; i++) {
        shb_vec3 corners[3];
        const uint32_t id = random_below(&random, (uint32_t)shb_scene_triangle_count(scene));
        shb_scene_triangle(scene, id, corners);
        double u = random_double(&random, 0, 1), v = random_double(&random, 0, 1);
        if (u + v > 1) {
            u = 1 - u;
            v = 1 - v;
        }
        const shb_vec3 e = shb_vec3_subtract(corners[1], corners[0]);
        const shb_vec3 f = shb_vec3_subtract(corners[2], corners[0]);
        const shb_vec3 way = shb_vec3_add(shb_vec3_scale(e, u), shb_vec3_scale(f, v));
        const shb_vec3 point = shb_vec3_add(corners[0], way);
        s.points[i] = point;
        s.x[i] = point.x;
        s.y[i] = point.y;
        s.z[i] = point.z;
        s.own_ids[i] = id;
    }
    return s;
}

void list_samples_free(list_samples *s) {
    free(s->x);
    free(s->y);
    free(s->z);
    free(s->points);
    free(s->own_ids);
    free(s->occluded);
    free(s->visibility);
}

void list_samples_to_float(list_samples *s) {
    for (size_t i = 0; i < s->count; i++) {
        s->x[i] = oracle_float(s->x[i]);
        s->y[i] = oracle_float(s->y[i]);
        s->z[i] = oracle_float(s->z[i]);
    }
}

void list_samples_ask(const shb_lists *lists, list_samples *s, bool with_ids, double rounding) {
    const shb_list_points points = {.count = s->count,
                                    .x = s->x,
                                    .y = s->y,
                                    .z = s->z,
                                    .own_ids = with_ids ? s->own_ids : NULL,
                                    .rounding = rounding};
    shb_lists_query(lists, &points, s->visibility);
}

void lists_ask_one(const shb_lists *lists, double x, double y, double z, float *visibility) {
    const shb_list_points point = {.count = 1, .x = &x, .y = &y, .z = &z};
    shb_lists_query(lists, &point, visibility);
}

shb_lists_desc lists_desc(const shb_view *view, uint32_t size, const shb_scene *scene) {
    return (shb_lists_desc){
        .caller = "test", .scene = scene, .view = view, .width = size, .height = size};
}

shb_lists *lists_of(shb_context *context, const shb_view *view, uint32_t size,
                    const shb_scene *scene) {
    shb_lists *lists = NULL;
    const shb_lists_desc desc = lists_desc(view, size, scene);
    CHECK_INT(shb_lists_build(context, &desc, &lists), SHB_OK);
    return lists;
}

void list_samples_find_truth(const shb_reference *reference, const shb_view *view,
                             list_samples *s) {
    shb_light_source light;
    CHECK_INT(shb_view_light_source(view, &light), SHB_OK);
    CHECK_INT(
        shb_reference_occluded(reference, &light, s->count, s->points, s->own_ids, s->occluded),
        SHB_OK);
}

size_t list_samples_false_shadow(const list_samples *s) {
    size_t count = 0;
    for (size_t i = 0; i < s->count; i++)
        count += s->visibility[i] < 0.5f && !s->occluded[i];
    return count;
}

size_t list_samples_false_light(const list_samples *s) {
    size_t count = 0;
    for (size_t i = 0; i < s->count; i++)
        count += s->visibility[i] > 0.5f && s->occluded[i];
    return count;
}

size_t list_samples_occluded(const list_samples *s) {
    size_t count = 0;
    for (size_t i = 0; i < s->count; i++)
        count += s->occluded[i];
    return count;
}

shb_view lists_view(const lists_light *l, shb_box box, uint32_t size, bool reversed) {
    shb_view view = {0};
    const shb_vec3 centre = shb_vec3_scale(shb_vec3_add(box.lo, box.hi), 0.5);
    const double scale = shb_vec3_length(shb_vec3_subtract(box.hi, box.lo));
    const shb_vec3 position = shb_vec3_add(centre, shb_vec3_scale(l->source, scale));
    const shb_result result = l->is_spot
                                  ? shb_view_fit_spot(position, box, size, reversed, &view)
                                  : shb_view_fit_directional(l->source, box, size, reversed, &view);
    CHECK_INT(result, SHB_OK);
    return view;
}
const lists_light lists_slanted = {false, {0.3, 0.5, 0.9}};
const lists_light lists_grazing = {false, {0.95, 0.3, 0.02}};
const lists_light lists_spot = {true, {0.4, -0.3, 0.8}};

void soup_add_random(soup *s, test_random *random, double size) {
    float c[3][3];
    double centre[3];
    for (int i = 0; i < 3; i++)
        centre[i] = random_double(random, -1, 1);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            c[k][i] = (float)(centre[i] + random_double(random, -size, size));
    soup_add(s, c[0], c[1], c[2]);
}
