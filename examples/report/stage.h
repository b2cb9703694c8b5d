/* A scene ready to be measured: what its camera sees, its lights, and rays for the truth. */
#ifndef REPORT_STAGE_H
#define REPORT_STAGE_H

#include "soft.h"

/* A light of a scene: a point, or a square around it that is parallel to the map. */
typedef struct report_light {
    scene_light_kind kind;
    double degrees; /* the angle under which a spot's target sees the square; 0: a point */
} report_light;

typedef struct report_stage {
    shb_context *context;
    char name[64];
    example_scene *scene;
    measure_frame frame;
    shb_reference *reference;
    shb_image image; /* of the frame's size, to draw into */
    soft_truth soft; /* of the latest square */
    report_light soft_light;
} report_stage;

/* text: as scene_open takes it; name: what rows and files call the scene. False, and a line on
 * stderr, if something fails; *stage is empty then. */
bool report_stage_open(shb_context *context, const char *text, const char *name,
                       const uint32_t size[2], report_stage *stage);
void report_stage_close(report_stage *stage);

/* "sun" and "spot". */
const char *report_light_name(scene_light_kind kind);

/* The same with the angle behind it: "sun-4deg". */
void report_name_light(report_light light, char *name, size_t size);

/* The width of a square in world units, or at the distance 1 for a directional light. */
double report_light_width(const example_scene *scene, report_light light);

/* Sees to it that stage->soft belongs to the light, whose view is given. Fragments near the border
 * of the view do not count, as maps know nothing of what lies behind it. */
shb_result report_stage_soften(report_stage *stage, const shb_view *view, report_light light,
                               uint32_t samples);

#endif
