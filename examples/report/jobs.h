/* What a survey has to do: which scenes, lights and map sizes. */
#ifndef REPORT_JOBS_H
#define REPORT_JOBS_H

#include "scene_list.h"
#include "stage.h"

/* How much work a survey does. */
typedef struct report_scale {
    uint32_t size[2];      /* of the picture, pixels */
    uint32_t samples;      /* rays of the truth of a square light */
    uint32_t runs[2];      /* hard, soft */
    uint32_t map_sizes[4]; /* texels; 0 ends them */
    double degrees[4];     /* of square lights; 0 ends them */
} report_scale;

const report_scale *report_scale_of(const report_options *options);

/* A group of rows that is to be measured. */
typedef struct report_job {
    const report_scene *scene;
    report_light light;
    uint32_t map_size;
} report_job;

typedef struct report_jobs {
    report_job *jobs;
    size_t count;
} report_jobs;

/* Scene by scene, and light by light. NULL jobs: out of memory. To be released with free. */
report_jobs report_list_jobs(const report_scene_list *scenes, const report_scale *scale);

#endif
