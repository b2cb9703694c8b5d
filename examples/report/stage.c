#include "stage.h"

#include "scenes.h"
#include "tool.h"

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
    char error[256];
    *stage = (report_stage){.context = context};
    if (!scene_open(text, &stage->scene, error, sizeof error)) {
        fprintf(stderr, "report: %s\n", error);
        return false;
    }
    snprintf(stage->name, sizeof stage->name, "%s", name);
    const bool done = tool_succeeds("report", name, create(stage, size));
    if (!done)
        report_stage_close(stage);
    return done;
}

void report_stage_close(report_stage *stage) {
    measure_frame_destroy(&stage->frame);
    shb_reference_destroy(stage->reference);
    free(stage->image.pixels);
    scene_close(stage->scene);
    *stage = (report_stage){0};
}

const char *report_light_name(scene_light_kind light) {
    return light == SCENE_DIRECTIONAL ? "sun" : "spot";
}
