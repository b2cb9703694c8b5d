/* Reproducible irregularity for scenes. */
#ifndef EXAMPLES_NOISE_H
#define EXAMPLES_NOISE_H

#include <stdint.h>

/* The same number for the same argument, in [-1, 1). */
double noise_random(uint32_t number);

/* Smooth noise in about -1 .. 1, with features of size 1, 1/2, 1/4 ... */
double noise_fractal(double x, double y, int octaves);

#endif
