/* Points that ask lists at the same time, and what they ask. */
#ifndef SRC_KERNELS_LIST_POINTS_H
#define SRC_KERNELS_LIST_POINTS_H

#include "list_types.h"

/* Points of a group that are asked about one triangle at the same time: this many from the first
 * on, one bit each. */
#define SHB_LIST_RUN 8

/* Points that ask at the same time: what each step of asking reads is on its way for all of them
 * while the step before is at work. */
#define SHB_LIST_POINTS 256

/* These, as the light sees them; the last one fills up SHB_LIST_LANES. */
typedef struct shb_list_group {
    size_t count;
    const double *world[3];
    SHB_ALIGN double x[SHB_LIST_POINTS];
    double y[SHB_LIST_POINTS], depth[SHB_LIST_POINTS];
    double inverse_w[SHB_LIST_POINTS];
    double scale[SHB_LIST_POINTS]; /* of the triangles' bounds: above 1 outside the scene */
    bool has_outside;              /* there is such a one */
    double least_size; /* of the points' largest coordinates by w, where that is positive */
    /* x, y and depth rounded, and what vectors may read */
    float about_x[SHB_LIST_POINTS + SHB_LIST_LANES];
    float about_y[SHB_LIST_POINTS + SHB_LIST_LANES];
    float about_depth[SHB_LIST_POINTS + SHB_LIST_LANES];
    int32_t texel[SHB_LIST_POINTS];                 /* row * 2^16 + column; -1: not in the view */
    int32_t cell[SHB_LIST_POINTS + SHB_LIST_LANES]; /* -1: none, nothing is near */
    bool has_own; /* it is known on which triangles the points lie */
    uint32_t own[SHB_LIST_POINTS + SHB_LIST_LANES]; /* these, and what vectors may read */
} shb_list_group;

/* Points of a group that follow each other in one cell, up to where the next ones begin. */
typedef struct shb_list_span {
    const shb_list_cell *cell;
    const shb_list_entry *entries; /* of the cell's tile */
    size_t first;
} shb_list_span;

/* As many of them as are asked at the same time. */
typedef struct shb_list_run {
    const shb_list_entry *entry, *end; /* that are left to ask */
    float depth;                       /* no open point's is greater but for rounding */
    uint8_t first;                     /* at most SHB_LIST_POINTS - SHB_LIST_RUN */
    uint8_t open; /* points from the first on that are not in shadow so far, one bit each */
} shb_list_run;

/* What a run asks about a triangle. Its bytes, from the lowest: which run; the first of its points;
 * which points ask, then those that the triangle blocks; then those that it may block: the ray has
 * to decide. They are one number because single bytes took a thirtieth of the time of asking. */
typedef struct shb_list_question {
    uint32_t triangle;
    uint32_t bytes;
} shb_list_question;

enum { SHB_LIST_ASKER = 0, SHB_LIST_FIRST = 8, SHB_LIST_ASKED = 16, SHB_LIST_DOUBT = 24 };

static inline uint32_t shb_list_byte(const shb_list_question *question, int shift) {
    return question->bytes >> shift & 0xff;
}

#endif
