/* Measurements of bias methods over one camera frame, shared by demo, viewer and other tools. */
#ifndef EXAMPLES_MEASURE_H
#define EXAMPLES_MEASURE_H

#include "scene.h"
#include "timing.h"

#include "shadowbias/reference.h"

/* What the camera of a scene sees, and every fragment of it as a host's renderer would have it. */
typedef struct measure_frame {
    shb_context *context;
    const example_scene *scene;
    shb_view view;
    shb_frame frame; /* as shading and classification take it */
    uint32_t *ids;
    size_t fragment_count;
    float *positions, *normals; /* x, y, z of each fragment; normals are geometric */
    uint32_t *own_ids;          /* triangle of each fragment, and its place there */
    float *weights_1, *weights_2;
    uint32_t *pixels;  /* of each fragment: row * width + column */
    float *visibility; /* of each fragment: what the latest method said */
} measure_frame;

/* Draws the camera's view. On failure *frame is empty. */
shb_result measure_frame_create(shb_context *context, const example_scene *scene, uint32_t width,
                                uint32_t height, measure_frame *frame);
void measure_frame_destroy(measure_frame *frame);

/* All fragments by position and normal, and with all that is known of them; valid as long as the
 * frame. */
shb_points measure_positions(const measure_frame *frame);
shb_points measure_points(const measure_frame *frame);

/* What is true of a frame under one light; depends on the map's view and size, not on its depths,
 * so that all methods share it. */
typedef struct measure_truth {
    shb_reference *reference;
    uint8_t *pixels;    /* of every pixel, as shb_reference_classify writes it */
    uint8_t *fragments; /* the same, of the frame's fragments */
} measure_truth;

/* On failure *truth is empty. */
shb_result measure_truth_create(const measure_frame *frame, const shb_map *map,
                                measure_truth *truth);
void measure_truth_destroy(measure_truth *truth);

typedef struct measure_result {
    shb_errors errors;
    shb_detachment detachment; /* as measure_detachment tells it */
    double map_seconds;        /* median of the runs, as all times */
    double visibility_seconds;
    double ns_per_fragment; /* of visibility, on one thread */
} measure_result;

/* How far a map's shadow, drawn as it is now, has come loose at a contact. NaN where there is none:
 * contact is NULL or has no length. filter NULL: hard. */
shb_result measure_detachment(const shb_reference *reference, const shb_map *map,
                              const shb_bias *bias, const shb_filter *filter,
                              const scene_contact *contact, shb_detachment *detachment);

/* Prepares the filter (NULL: hard) and times the map's answers for all fragments by the thread's
 * processor time: at least so many runs. */
shb_result measure_visibility(const measure_frame *frame, shb_map *map, const shb_bias *bias,
                              const shb_filter *filter, uint32_t runs, bench_times *times);

/* Draws the map for a method, timed by the clock on the wall, and asks it as measure_visibility
 * does. */
shb_result measure_method(measure_frame *frame, const measure_truth *truth, shb_map *map,
                          const shb_bias *bias, const shb_filter *filter,
                          const scene_contact *contact, uint32_t runs, measure_result *result);

/* A filter that finds the same visibility everywhere. */
shb_filter measure_even_filter(float visibility);

/* The picture of the scene with a map as it is now, and the same in grey with false shadow in red
 * and false light in blue. image has the frame's size. */
shb_result measure_paint(const measure_frame *frame, const shb_map *map, const shb_bias *bias,
                         const shb_filter *filter, const float light_color[3],
                         const shb_image *image);
shb_result measure_paint_errors(const measure_frame *frame, const measure_truth *truth,
                                const shb_map *map, const shb_bias *bias, const shb_filter *filter,
                                const shb_image *image);

#endif
