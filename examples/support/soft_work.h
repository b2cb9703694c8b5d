/* One soft shadow over one camera's view, asked by one method and one filter, again and again. */
#ifndef EXAMPLES_SOFT_WORK_H
#define EXAMPLES_SOFT_WORK_H

#include "measure.h"
#include "timing.h"

typedef struct soft_work_desc {
    scene_light_kind light; /* of the frame's scene */
    uint32_t map_size;
    const char *bias, *filter; /* text forms */
    bool unprepared;           /* the filter has to do with the depths alone */
} soft_work_desc;

typedef struct soft_work {
    shb_context *context;
    const measure_frame *frame;
    shb_map *map;
    shb_bias bias;
    shb_filter filter;
    bool unprepared;
    shb_image image;
} soft_work;

/* On failure nothing is to be destroyed. */
shb_result soft_work_create(shb_context *context, const measure_frame *frame,
                            const soft_work_desc *desc, soft_work *work);
void soft_work_destroy(soft_work *work);

/* True if the filter serves the method. */
bool soft_work_is_served(const char *bias, const char *filter);

/* The camera's view; visibility of all fragments; Lambert shading of the frame; drawing and
 * preparing the map, then shading. */
bench_work soft_work_camera(soft_work *work);
bench_work soft_work_visibility(soft_work *work);
bench_work soft_work_shade(soft_work *work);
bench_work soft_work_overall(soft_work *work);

/* Medians, in seconds of the calling thread. */
typedef struct soft_work_times {
    double map, shade;
} soft_work_times;

/* Times of map and shading of two pieces of work by turns. */
shb_result soft_work_compare(soft_work *first, soft_work *second, bench_plan plan,
                             soft_work_times times[2]);

#endif
