/* Tables 1 and 2 of Ehm, Ederer, Klein and Nischwitz 2015 on a scene of our own: their rows, and
 * what a row needs to be measured again, with a map of 2048 under the tree's spot light.
 *
 * Errors are those of a small picture of the same view, against rays to a light of the shape that
 * the taps have: a square for all texels of a box, a disk for Poisson taps. Table 1 has kernels of
 * fixed size; its light is the smallest of table 2. */
#ifndef EXAMPLES_EHM_TABLES_H
#define EXAMPLES_EHM_TABLES_H

#include "scenes.h"
#include "soft.h"
#include "soft_work.h"

enum { EHM_MAP_SIZE = 2048, EHM_LIGHTS = 3, EHM_TABLES = 2 };

/* A row: which bias and filter, and the overall time over the receiver plane's in the paper. */
typedef struct ehm_row {
    const char *name, *bias, *filter;
    int light;
    bool disk;
    double paper; /* 0: not in the paper; 1: the receiver plane, that the next rows stand beside */
} ehm_row;

/* Table 0 is PCF over boxes of texels, table 1 PCSS. */
const ehm_row *ehm_rows(int table, size_t *count);

typedef struct ehm_desc {
    shb_context *single, *several;   /* for what is timed, and for the truth */
    uint32_t size[2], truth_size[2]; /* of pictures: width and height */
    uint32_t samples;                /* rays a fragment */
} ehm_desc;

/* What all rows share. */
typedef struct ehm_subject {
    ehm_desc desc;
    example_scene *scene;
    measure_frame timed, judged;
    soft_truth truths[EHM_LIGHTS][2]; /* of squares and disks */
} ehm_subject;

/* The subject must not move, and be closed in any case. */
shb_result ehm_open(const ehm_desc *desc, ehm_subject *subject);
void ehm_close(ehm_subject *subject);

/* A row over the frame that is timed, with a map of a size. */
shb_result ehm_work(const ehm_subject *subject, const ehm_row *row, uint32_t map_size,
                    soft_work *work);

/* Its errors over the frame that is judged. */
shb_result ehm_judge(const ehm_subject *subject, const ehm_row *row, shb_soft_errors *errors);

#endif
