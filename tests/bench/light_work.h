/* One light over one camera's view, asked by one method, again and again. */
#ifndef BENCH_LIGHT_WORK_H
#define BENCH_LIGHT_WORK_H

#include "draw_work.h"
#include "measure.h"

typedef struct light_work {
    shb_context *context;
    const measure_frame *frame;
    shb_bias bias;
    const char *name;        /* of the method in tables */
    shb_occluders occluders; /* that the map keeps for the exact method */
    bool names_triangles;    /* points are asked with all that is known of them */
    shb_map *map;
    draw_work camera; /* of the whole frame */
    shb_image image;
} light_work;

/* A map of the scene's directional light, drawn for the method; the camera sees what it saw in
 * frame. On failure nothing is to be destroyed. */
shb_result light_work_create(shb_context *context, const measure_frame *frame, uint32_t map_size,
                             const shb_bias *bias, light_work *work);

/* What the exact method asks with besides planes: what a map keeps for it, and points that name
 * their triangles and their places on them or not. */
typedef struct light_exact {
    const char *name; /* in tables */
    shb_occluders occluders;
    bool names_triangles;
} light_exact;

#define LIGHT_EXACT_KINDS 4
extern const light_exact light_exact_kinds[LIGHT_EXACT_KINDS];

/* On failure nothing is to be destroyed. */
shb_result light_work_create_exact(shb_context *context, const measure_frame *frame,
                                   uint32_t map_size, const light_exact *exact, light_work *work);

/* The same for another context around the same depths; it cannot draw them, so it has no frame. It
 * lasts as long as the original keeps its method. For the exact method, a map of its own. */
shb_result light_work_share(shb_context *context, const light_work *original, light_work *work);

void light_work_destroy(light_work *work);

/* Changes the method; the map is drawn anew if either method asks for depths of its own. */
shb_result light_work_set_bias(light_work *work, const shb_bias *bias);

/* Visibility of all fragments of the frame. */
bench_work light_work_visibility(light_work *work);

/* Lambert shading of the frame. */
bench_work light_work_shade(light_work *work);

/* Map, camera and shading. */
bench_work light_work_frame(light_work *work);

#endif
