/* Of two numbers the second where they are equal or one is NaN, as the vector instructions have it.
 */
#ifndef SRC_KERNELS_MIN_MAX_H
#define SRC_KERNELS_MIN_MAX_H

static inline double double_min(double a, double b) {
    return a < b ? a : b;
}

static inline double double_max(double a, double b) {
    return a > b ? a : b;
}

static inline float float_min(float a, float b) {
    return a < b ? a : b;
}

static inline float float_max(float a, float b) {
    return a > b ? a : b;
}

#endif
