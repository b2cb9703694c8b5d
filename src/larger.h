/* The larger of two numbers; the second one if there is a NaN. */
#ifndef SRC_LARGER_H
#define SRC_LARGER_H

static inline double larger(double a, double b) {
    return a > b ? a : b;
}

#endif
