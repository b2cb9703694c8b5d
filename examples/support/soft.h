/* Soft shadows of a frame: the truth of an area light, errors against it, pictures of both. */
#ifndef EXAMPLES_SOFT_H
#define EXAMPLES_SOFT_H

#include "measure.h"

#include "shadowbias/area.h"

/* A square light of this width, or a disk of this diameter, around the light of a view and parallel
 * to its picture; world units, or the width at the distance 1 for a direction. */
shb_area_light soft_light(const shb_view *view, double width, bool disk);

/* One value a pixel of a frame; 0 where there is no fragment. */
typedef struct soft_truth {
    float *visibility; /* the part of the light that reaches the fragment */
    float *seen;       /* the answers of a method, in the same places */
    uint8_t *mask;     /* 1: faces the middle of the light, and its map holds what is around */
} soft_truth;

/* By samples rays a fragment. Fragments outside the view of the light's map, or in the outer tenth
 * of it where kernels see beyond the map, are left out of the mask. On failure *truth is empty. */
shb_result soft_truth_create(const measure_frame *frame, const shb_view *view,
                             const shb_area_light *area, uint32_t samples, soft_truth *truth);
void soft_truth_destroy(soft_truth *truth);

/* The errors of frame->visibility, which go to truth->seen. */
shb_result soft_truth_compare(const measure_frame *frame, const soft_truth *truth,
                              shb_soft_errors *errors);

/* The scene as it looks with these values of all pixels; image has the frame's size. */
shb_result soft_paint(const measure_frame *frame, const shb_light_source *light,
                      const float light_color[3], const float *visibility, const shb_image *image);

/* Truth in dim grey; what truth->seen holds too little of in red, too much of in blue. */
void soft_paint_errors(const measure_frame *frame, const soft_truth *truth, const shb_image *image);

#endif
