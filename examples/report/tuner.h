/* For engines that have only knobs: the smallest constants that keep false shadow below a limit. */
#ifndef REPORT_TUNER_H
#define REPORT_TUNER_H

#include "stage.h"
#include "tuning.h"

#define TUNER_METHODS 9

/* What a length along the light's rays is in other units, at the middle one of the fragments that
 * the camera sees lit; of a directional light everywhere. */
typedef struct tuner_units {
    double scene_scale;     /* world units */
    double texel_size;      /* world units */
    double depth_per_world; /* map depth of a world unit */
} tuner_units;

/* A method and its smallest constants. Lengths are NaN where the knob is none, a slope factor where
 * it is no such. */
typedef struct tuner_row {
    const char *method;
    char setting[96]; /* as shb_bias_parse takes it */
    bool has_knob;    /* false: nothing to tune; this is what the method does */
    tuned_smallest found;
    double depth, texels, world;
    double slope_factor;
    shb_detachment detachment; /* NaN: the scene has no place to measure it */
} tuner_row;

typedef struct tuner_result {
    tuner_row rows[TUNER_METHODS];
    tuner_units units;
    uint64_t fragments; /* that face the light */
} tuner_result;

/* Tunes every method that has a constant for one light of the stage and a map of a size. */
shb_result tuner_run(report_stage *stage, scene_light_kind light, uint32_t map_size,
                     double limit_ppm, tuner_result *result);

/* A depth as the integer of a format of so many bits, rounded up: what such maps can hold. */
double tuner_integer_depth(double depth, int bits);

#endif
