/* Views, maps and frames for tests of shading, and a callback that writes down what it saw. */
#ifndef TESTS_SUPPORT_SHADING_H
#define TESTS_SUPPORT_SHADING_H

#include "shadowbias/shadowbias.h"

/* World x and y are pixel columns and rows; depth is z / 16, away from camera or light. */
shb_view pixel_space(uint32_t width, uint32_t height);

/* Looks along -z from the origin with an opening of 90 degrees both ways. */
shb_view pinhole(void);

shb_context *shading_context(uint32_t threads);

/* A map around a host's depths, or an empty one. */
shb_map *shading_map(shb_context *context, const shb_view *view, uint32_t width, uint32_t height,
                     const float *depths);

/* What a callback saw of one pixel. */
typedef struct seen_pixel {
    unsigned times;
    float position[3], normal[3], shading[3], weight_1, weight_2;
    uint32_t id;
    float visibility[2], cosine[2];
} seen_pixel;

/* Shades with a recorder in place of the description's callback, which also checks that batches
 * keep their rules. One element a pixel; to be freed. */
seen_pixel *shade_and_record(shb_context *context, shb_shade_desc desc);

/* A rectangle of 8 x 4 pixels in the plane z = depth + slope * y, as two triangles that meet in the
 * diagonal from (0, 0) to (8, 4). */
typedef struct quad {
    float positions[12], normals[12];
    uint16_t indices[6];
    shb_mesh mesh;
    shb_instance instance;
    shb_scene scene;
    uint32_t ids[32];
    shb_view view;
    shb_frame frame;
} quad;

void quad_init(quad *q, float depth, float slope);

#endif
