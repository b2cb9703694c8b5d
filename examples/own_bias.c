/* A bias method of one's own, used like the built-in ones. This one takes away the depth by which
 * the receiver's plane can rise within a texel, and half a texel's width in depth on top. */
#include "measure.h"
#include "scenes.h"
#include "tool.h"

#include <math.h>
#include <stdio.h>

/* The depth stage: from the batch's slopes and scales to its receiver planes. */
static void texel_rise(const shb_bias_args *args) {
    shb_receivers *r = args->receivers;
    const float share = args->bias->params[0];
    for (size_t i = 0; i < args->count; i++) {
        const float rise = fabsf(r->slope_x[i]) + fabsf(r->slope_y[i]);
        const float width = r->texel_size[i] * r->depth_per_world[i];
        r->ref[i] = r->depth[i] - 0.5f * rise - share * width;
        r->step_x[i] = r->slope_x[i];
        r->step_y[i] = r->slope_y[i];
    }
}

static bool succeeds(shb_result result) {
    return tool_succeeds("own_bias", "columns", result);
}

static bool measure_and_print(measure_frame *frame, const measure_truth *truth, shb_map *map,
                              const shb_bias *bias) {
    measure_result measured;
    const shb_result result = measure_method(frame, truth, map, bias, NULL, NULL, 1, &measured);
    if (!result)
        printf("%-16s false shadow %8.0f ppm, false light %8.0f ppm\n", bias->name,
               measured.errors.false_shadow_ppm, measured.errors.false_light_ppm);
    return succeeds(result);
}

static bool compare(measure_frame *frame, const measure_truth *truth, shb_map *map) {
    const shb_bias own = {.name = "texel-rise",
                          .depth = texel_rise,
                          .needs = SHB_NEEDS_SLOPE | SHB_NEEDS_SCALE,
                          .params = {0.5f}};
    const shb_bias slope = shb_bias_slope(1.1f, 4, 0), adaptive = shb_bias_adaptive(1e-4f, 0);
    return measure_and_print(frame, truth, map, &own) &&
           measure_and_print(frame, truth, map, &slope) &&
           measure_and_print(frame, truth, map, &adaptive);
}

int main(void) {
    char error[256];
    example_scene *scene = NULL;
    if (!scene_open("columns", &scene, error, sizeof error)) {
        fprintf(stderr, "own_bias: %s\n", error);
        return TOOL_FAILED;
    }
    shb_map *map = NULL;
    shb_map_desc desc = {.width = 512};
    measure_frame frame = {0};
    measure_truth truth = {0};
    shb_context *context = tool_create_context("own_bias", 0, SHB_ISA_BEST);
    const bool done =
        context &&
        succeeds(scene_light_view(scene, SCENE_DIRECTIONAL, desc.width, false, &desc.view)) &&
        succeeds(shb_map_create(context, &desc, &map)) &&
        succeeds(measure_frame_create(context, scene, 480, 300, &frame)) &&
        succeeds(measure_truth_create(&frame, map, &truth)) && compare(&frame, &truth, map);
    measure_truth_destroy(&truth);
    measure_frame_destroy(&frame);
    shb_map_destroy(map);
    shb_context_destroy(context);
    scene_close(scene);
    return done ? TOOL_OK : TOOL_FAILED;
}
