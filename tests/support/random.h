/* Reproducible random numbers for tests (PCG32, O'Neill 2014). */
#ifndef TESTS_SUPPORT_RANDOM_H
#define TESTS_SUPPORT_RANDOM_H

#include <stdint.h>

#include "shadowbias/math.h"

typedef struct test_random {
    uint64_t state;
} test_random;

static inline uint32_t random_bits(test_random *random) {
    const uint64_t old = random->state;
    random->state = old * 6364136223846793005u + 1442695040888963407u;
    const uint32_t mixed = (uint32_t)(((old >> 18) ^ old) >> 27);
    const uint32_t turn = (uint32_t)(old >> 59);
    return (mixed >> turn) | (mixed << ((32 - turn) & 31));
}

/* Uniform in [lo, hi). */
static inline double random_double(test_random *random, double lo, double hi) {
    const uint64_t bits = ((uint64_t)random_bits(random) << 21) ^ random_bits(random);
    return lo + (hi - lo) * ((double)(bits & ((1ull << 53) - 1)) * 0x1p-53);
}

/* Uniform in 0 .. count - 1. */
static inline uint32_t random_below(test_random *random, uint32_t count) {
    return (uint32_t)(((uint64_t)random_bits(random) * count) >> 32);
}

/* A unit vector; those to the corners of a cube are more frequent. */
static inline shb_vec3 random_direction(test_random *random) {
    const shb_vec3 v = {random_double(random, -1, 1), random_double(random, -1, 1),
                        random_double(random, -1, 1)};
    return shb_vec3_normalize(v);
}

#endif
