/* Searches for the value of a method's parameters that serves one frame under one light best. */
#ifndef EXAMPLES_TUNING_H
#define EXAMPLES_TUNING_H

#include "measure.h"

/* What is asked again and again with other values. */
typedef struct tuning_subject {
    measure_frame *frame;
    shb_points points;    /* the frame's fragments, with what the method may know of them */
    const uint8_t *truth; /* one a fragment */
    shb_map *map;         /* of the light, drawn for the method that is tuned */
} tuning_subject;

/* A method and what it does to the subject. */
typedef struct tuned {
    shb_bias bias;
    shb_errors errors;
} tuned;

/* The errors of tried->bias; the map is drawn anew before if the method combines its layers. */
shb_result tuning_ask(const tuning_subject *subject, tuned *tried);

/* The first parameter for the fewest wrong fragments, starting from *best: eight values by powers
 * of eight about it, then between the best and its neighbours. Never worse than it started. */
shb_result tuning_fewest_wrong(const tuning_subject *subject, tuned *best);

/* By which part of itself the smallest value may be too large. */
#define TUNING_TOLERANCE 0.01

/* What the smallest value is sought of, and for. */
typedef struct tuning_goal {
    size_t count;     /* the method's first parameters are multiplied by one factor */
    double largest;   /* factor */
    double limit_ppm; /* of false shadow away from boundaries, per million lit fragments */
} tuning_goal;

typedef struct tuned_smallest {
    tuned tuned;
    double factor; /* 0, or above 2^-20 of the largest */
    bool met;      /* false: none that was tried meets the limit; this is the nearest to it */
} tuned_smallest;

/* The smallest factor that meets the goal; some smaller one within the tolerance does not. Steps of
 * four are tried from below, then what lies between the first that meets the limit and the one
 * before: where a method's false shadow does not always fall as its parameter grows, there may be
 * yet smaller ones between two steps that miss it. */
shb_result tuning_smallest(const tuning_subject *subject, const shb_bias *start,
                           const tuning_goal *goal, tuned_smallest *smallest);

#endif
