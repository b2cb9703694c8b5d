#include "stage.h"

#include "tool.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static shb_result create(report_stage *stage, const uint32_t size[2]) {
    stage->image = (shb_image){malloc(3 * (size_t)size[0] * size[1]), size[0], size[1], 0};
    if (!stage->image.pixels)
        return SHB_ERROR_MEMORY;
    const shb_result result =
        shb_reference_create(stage->context, &stage->scene->scene, &stage->reference);
    return result ? result
                  : measure_frame_create(stage->context, stage->scene, size[0], size[1],
                                         &stage->frame);
}

bool report_stage_open(shb_context *context, const char *text, const char *name,
                       const uint32_t size[2], report_stage *stage) {
    *stage = (report_stage){.context = context, .scene = tool_open_scene("report", text)};
    if (!stage->scene)
        return false;
    snprintf(stage->name, sizeof stage->name, "%s", name);
    const bool done = tool_succeeds("report", name, create(stage, size));
    if (!done)
        report_stage_close(stage);
    return done;
}

void report_stage_close(report_stage *stage) {
    soft_truth_destroy(&stage->soft);
    measure_frame_destroy(&stage->frame);
    shb_reference_destroy(stage->reference);
    free(stage->image.pixels);
    scene_close(stage->scene);
    *stage = (report_stage){0};
}

const char *report_light_name(scene_light_kind kind) {
    return kind == SCENE_DIRECTIONAL ? "sun" : "spot";
}

void report_name_light(report_light light, char *name, size_t size) {
    const char *kind = report_light_name(light.kind);
    if (light.degrees > 0)
        snprintf(name, size, "%s-%gdeg", kind, light.degrees);
    else
        snprintf(name, size, "%s", kind);
}

double report_light_width(const example_scene *scene, report_light light) {
    const scene_light *place = &scene->lights[light.kind];
    const double distance = light.kind == SCENE_SPOT
                                ? shb_vec3_length(shb_vec3_subtract(place->source, place->target))
                                : 1;
    return 2 * distance * tan(light.degrees * atan(1) / 90);
}

shb_result report_stage_soften(report_stage *stage, const shb_view *view, report_light light,
                               uint32_t samples) {
    const report_light *latest = &stage->soft_light;
    if (stage->soft.visibility && latest->kind == light.kind && latest->degrees == light.degrees)
        return SHB_OK;
    const shb_area_light area = soft_light(view, report_light_width(stage->scene, light), false);
    soft_truth_destroy(&stage->soft);
    stage->soft_light = light;
    return soft_truth_create(&stage->frame, view, &area, samples, &stage->soft);
}
