/* A bias method of one's own beside built-in ones: a wall on the ground in a slanting sun, a map of
 * few texels, and what each method says of many points on the ground. */
#include "shadowbias/shadowbias.h"

#include <math.h>
#include <stdio.h>

/* The depth stage of the method. It takes off what the receiver's plane rises by from the middle of
 * a texel to its corner, and a share of a texel's width in depth on top. */
static void texel_rise(const shb_bias_args *args) {
    shb_receivers *r = args->receivers;
    const float share = args->bias->params[0];
    for (size_t i = 0; i < args->count; i++) {
        const float rise = 0.5f * (fabsf(r->slope_x[i]) + fabsf(r->slope_y[i]));
        const float width = r->texel_size[i] * r->depth_per_world[i];
        r->ref[i] = r->depth[i] - rise - share * width;
        r->step_x[i] = r->slope_x[i];
        r->step_y[i] = r->slope_y[i];
    }
}

/* The method is a value: its name, its stages, what they read, and their parameters. */
static const shb_bias own_method = {.name = "texel-rise",
                                    .depth = texel_rise,
                                    .needs = SHB_NEEDS_SLOPE | SHB_NEEDS_SCALE,
                                    .params = {0.5f}};

/* Triangles 0 and 1 are the ground, 2 and 3 the wall. */
static const float corners[8][3] = {{-4, 0, 4},  {4, 0, 4},  {4, 0, -4}, {-4, 0, -4},
                                    {-2, 0, -1}, {2, 0, -1}, {2, 2, -1}, {-2, 2, -1}};
static const uint16_t indices[4][3] = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};

enum { side = 400, count = side * side };
static float positions[count][3], normals[count][3], visibility[count];
static uint8_t truth[count];

static void place_points(void) {
    for (int i = 0; i < count; i++) {
        positions[i][0] = (float)(8 * (i % side + 0.5) / side - 4);
        positions[i][2] = (float)(8 * (i / side + 0.5) / side - 4);
        normals[i][1] = 1;
    }
}

/* A ray for each point; the triangle that the point lies on is left out. */
static shb_result find_truth(shb_context *context, const shb_scene *scene, const shb_view *light) {
    static shb_vec3 points[count];
    static uint32_t own_ids[count];
    for (int i = 0; i < count; i++) {
        points[i] = (shb_vec3){(double)positions[i][0], 0, (double)positions[i][2]};
        own_ids[i] = points[i].x + points[i].z > 0 ? 0 : 1;
    }
    shb_light_source source;
    shb_reference *reference;
    shb_result result = shb_view_light_source(light, &source);
    if (result == SHB_OK)
        result = shb_reference_create(context, scene, &reference);
    if (result != SHB_OK)
        return result;
    result = shb_reference_occluded(reference, &source, count, points, own_ids, truth);
    for (int i = 0; i < count; i++)
        truth[i] = truth[i] ? SHB_TRUTH_SHADOWED : SHB_TRUTH_LIT;
    shb_reference_destroy(reference);
    return result;
}

static shb_result compare(const shb_map *map) {
    const shb_bias methods[] = {shb_bias_none(), own_method, shb_bias_slope(1.1f, 4, 0),
                                shb_bias_adaptive(1e-4f, 0)};
    const shb_points points = {.count = count, .positions = positions[0], .normals = normals[0]};
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
        shb_errors errors;
        const shb_result result = shb_map_visibility(map, &points, &methods[i], NULL, visibility);
        if (result != SHB_OK)
            return result;
        shb_errors_measure(count, truth, visibility, &errors);
        printf("%-12s false shadow %6.0f ppm, false light %6.0f ppm\n", methods[i].name,
               errors.false_shadow_ppm, errors.false_light_ppm);
    }
    return SHB_OK;
}

int main(void) {
    const shb_mesh mesh = {.positions = corners[0],
                           .vertex_count = 8,
                           .indices = indices,
                           .index_size = sizeof indices[0][0],
                           .triangle_count = 4};
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene scene = {&instance, 1};
    const shb_vec3 to_light = {0.3, 1, -0.8};
    shb_map_desc desc = {.width = 128};
    shb_box bounds;
    shb_context *context = NULL;
    shb_map *map = NULL;
    place_points();
    const bool done = !shb_scene_bounds(&scene, &bounds) &&
                      !shb_view_fit_directional(to_light, bounds, desc.width, false, &desc.view) &&
                      !shb_context_create(NULL, &context) &&
                      !shb_map_create(context, &desc, &map) &&
                      !shb_map_draw(map, &scene, NULL, NULL) &&
                      !find_truth(context, &scene, &desc.view) && !compare(map);
    shb_map_destroy(map);
    shb_context_destroy(context);
    if (!done)
        fprintf(stderr, "own_bias failed\n");
    return done ? 0 : 1;
}
