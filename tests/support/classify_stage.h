/* A camera's frame and a light's map over one scene, to be classified. */
#ifndef TESTS_SUPPORT_CLASSIFY_STAGE_H
#define TESTS_SUPPORT_CLASSIFY_STAGE_H

#include "soup.h"

#include "shadowbias/reference.h"

enum { PIXELS = 256, PIXEL_COUNT = PIXELS * PIXELS };

/* A frame of PIXELS x PIXELS and a map, over one scene. */
typedef struct stage {
    shb_context *context;
    shb_view camera;
    const shb_scene *scene;
    shb_reference *reference;
    shb_map *map;
    uint32_t *ids;
    uint8_t *truth;
} stage;

stage stage_with_map(const shb_scene *scene, shb_view camera, shb_view light, uint32_t width,
                     uint32_t height);
stage stage_for(const shb_scene *scene, shb_view camera, shb_view light, uint32_t texels);
void stage_end(stage *s);

shb_classify_desc stage_desc(const stage *s);

/* Fills in the truth. */
void stage_classify(stage *s);

/* Looks at target from the direction of from, 64 x 64 units wide. */
shb_view wide_view(shb_vec3 from, shb_vec3 target);

/* Looks straight down on 64 x 64 units from a height; row 0 is y = 32. */
shb_view view_from_height(double height);

/* A horizontal sheet. */
void add_sheet(soup *s, float x0, float y0, float x1, float y1, float z);

/* From -30 to 30 at z = 0, ids 0 and 1. */
void add_ground(soup *s);

#endif
