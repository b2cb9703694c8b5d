/* A scene ready to be measured: what its camera sees, and rays for the truth. */
#ifndef REPORT_STAGE_H
#define REPORT_STAGE_H

#include "measure.h"

typedef struct report_stage {
    shb_context *context;
    char name[64];
    example_scene *scene;
    measure_frame frame;
    shb_reference *reference;
    shb_image image; /* of the frame's size, to draw into */
} report_stage;

/* text: as scene_open takes it; name: what rows and files call the scene. False, and a line on
 * stderr, if something fails; *stage is empty then. */
bool report_stage_open(shb_context *context, const char *text, const char *name,
                       const uint32_t size[2], report_stage *stage);
void report_stage_close(report_stage *stage);

const char *report_light_name(scene_light_kind light);

#endif
