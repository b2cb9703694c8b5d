#include "noise.h"

#include <math.h>

/* A 32-bit mix whose every output bit depends on every input bit. */
static uint32_t mix(uint32_t x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    x ^= x >> 16;
    return x;
}

double noise_random(uint32_t number) {
    return mix(number + 0x9e3779b9u) * 0x1p-31 - 1;
}

static double lattice_value(double x, double y) {
    const uint32_t column = (uint32_t)(int32_t)x, row = (uint32_t)(int32_t)y;
    return noise_random(column * 0x27d4eb2du + mix(row));
}

static double fade(double t) {
    return t * t * t * (t * (6 * t - 15) + 10);
}

/* Random values at whole coordinates, smooth between them. */
static double value_noise(double x, double y) {
    const double column = floor(x), row = floor(y);
    const double u = fade(x - column), v = fade(y - row);
    const double low = lattice_value(column, row) * (1 - u) + lattice_value(column + 1, row) * u;
    const double high =
        lattice_value(column, row + 1) * (1 - u) + lattice_value(column + 1, row + 1) * u;
    return low * (1 - v) + high * v;
}

double noise_fractal(double x, double y, int octaves) {
    double sum = 0, weight = 0.5;
    for (int i = 0; i < octaves; i++) {
        sum += weight * value_noise(x, y);
        x = 2 * x + 17.3;
        y = 2 * y - 5.7;
        weight /= 2;
    }
    return sum;
}
