/* Taps on a disk: a sequence of points whose beginnings are well spread, and a turn for each
 * fragment. All of it is integers, so that nothing depends on a library's sine. */
#ifndef SRC_POISSON_H
#define SRC_POISSON_H

#include "shadowbias/filter.h"

#include <string.h>

/* The tables hold numbers times 2^14. */
#define SHB_POISSON_UNIT 0x1p-14f

/* Best candidates (Mitchell 1991) on the unit disk. Point 0 is the centre; point k is the best of
 * 64 k candidates, the first of them where equal: the one with the largest distance from the points
 * before it or, if that is less, three times its distance from the rim (in whole units, rounded
 * up). Candidates are pairs of the numbers (s >> 16) % 2^15 - 2^14, x before y, of the generator
 * s = 1664525 s + 1013904223 modulo 2^32 that starts from 1; those not inside the disk do not
 * count. */
extern const int16_t shb_poisson_disk[SHB_POISSON_MAX][2];

/* Unit vectors (cosine, sine) at equal angles. */
#define SHB_POISSON_TURNS 64
extern const int16_t shb_poisson_turns[SHB_POISSON_TURNS][2];

/* All bits of a position, well mixed: the finalizer of MurmurHash3 over a sum of odd multiples. */
static inline uint32_t shb_position_hash(float x, float y, float z) {
    uint32_t bits[3];
    memcpy(&bits[0], &x, 4);
    memcpy(&bits[1], &y, 4);
    memcpy(&bits[2], &z, 4);
    uint32_t hash = bits[0] * 0x9e3779b1u + bits[1] * 0x85ebca77u + bits[2] * 0xc2b2ae3du;
    hash = (hash ^ hash >> 16) * 0x85ebca6bu;
    hash = (hash ^ hash >> 13) * 0xc2b2ae35u;
    return hash ^ hash >> 16;
}

/* Which turn a fragment takes. */
static inline uint32_t shb_poisson_turn(float x, float y, float z) {
    return shb_position_hash(x, y, z) % SHB_POISSON_TURNS;
}

#endif
