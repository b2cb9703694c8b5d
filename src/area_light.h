/* Samples of area lights, shared by rays and by maps. */
#ifndef SRC_AREA_LIGHT_H
#define SRC_AREA_LIGHT_H

#include "context.h"
#include "shadowbias/area.h"

/* A place in the unit square, both in 0 .. 1. */
typedef struct shb_area_place {
    double s, t;
} shb_area_place;

/* Place number index of count: Hammersley's pattern, whose middle is that of the square. */
shb_area_place shb_area_pattern(uint32_t index, uint32_t count);

/* The place moved by another one, round the square. */
shb_area_place shb_area_shift(shb_area_place place, shb_area_place by);

/* The point of the light at a place; equal areas of the square are equal areas of the light. */
shb_light_source shb_area_sample(const shb_area_light *area, shb_area_place place);

/* Corner k, 0 .. 3 around it, of the parallelogram -1 .. 1, which holds the disk as well. */
shb_light_source shb_area_corner(const shb_area_light *area, int k);

/* Checks the light and the number of samples in the name of caller. */
shb_result shb_area_check(const shb_context *context, const char *caller,
                          const shb_area_light *area, uint32_t samples);

#endif
