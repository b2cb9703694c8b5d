/* A drawing into arrays, again and again. */
#ifndef BENCH_DRAW_WORK_H
#define BENCH_DRAW_WORK_H

#include "timing.h"

#include "shadowbias/raster.h"

typedef enum draw_images {
    DRAW_DEPTH = 0,
    DRAW_DEPTH_IDS,
    DRAW_DEPTH_SECOND,
    DRAW_IDS
} draw_images;

typedef struct draw_work {
    shb_context *context;
    shb_view view;
    shb_draw_desc desc;
} draw_work;

/* Rows end on a cache line and one more, as those of maps do. On failure nothing is to be
 * destroyed. */
shb_result draw_work_create(shb_context *context, const shb_scene *scene, const shb_view *view,
                            uint32_t width, uint32_t height, draw_images images, draw_work *work);
void draw_work_destroy(draw_work *work);

/* Bytes that the images have a pixel. */
double draw_work_pixel_bytes(draw_images images);

/* The work lasts as long as what it is made of and must not move. */
bench_work draw_work_of(draw_work *work);

#endif
