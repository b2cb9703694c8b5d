/* A case ready to be asked: its scene, what the camera sees of it, and the truth. */
#ifndef STABILITY_STAGE_H
#define STABILITY_STAGE_H

#include "cases.h"
#include "measure.h"
#include "method_list.h"
#include "rows.h"

/* Fragments that meet the light at a smaller cosine do not count, in all cases. */
#define STABILITY_MIN_COSINE 0.02

typedef struct stability_stage {
    shb_context *context;
    example_scene *scene;
    measure_frame frame;
    shb_points points; /* the fragments, as methods are asked about them */
    shb_map_desc map;  /* the light; occluders are up to the method */
    uint8_t *truth;    /* one a fragment */
} stability_stage;

/* False if the case has no file here; the result tells of other failures. On failure *stage is
 * empty. map_size: of cases that do not name one, 0: STABILITY_MAP_SIZE. reach: texels of the map
 * within which a true shadow boundary is near, 1 for a single tap. */
bool stability_case_exists(const stability_case *c);
shb_result stability_stage_open(shb_context *context, const stability_case *c, uint32_t width,
                                uint32_t height, uint32_t map_size, uint32_t reach,
                                stability_stage *stage);
void stability_stage_close(stability_stage *stage);

/* Names every fragment by its triangle and weights instead of its position alone, and finds the
 * truth of these very points: what is left of a method's errors is its own, not that of rounded
 * positions. On failure the stage is as before. */
shb_result stability_name_points(stability_stage *stage);

/* A map of the stage's light, drawn for a method with these parameters; the caller destroys it. */
shb_result stability_draw_map(const stability_stage *stage, const listed_method *method,
                              const shb_bias *bias, shb_map **map);

/* What a map says for certain, drawn for it. */
shb_result stability_ask_certain(const stability_stage *stage, stability_certain *certain);

#endif
