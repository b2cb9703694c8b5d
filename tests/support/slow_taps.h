/* Taps of the exact method texel by texel, in doubles. */
#ifndef TESTS_SUPPORT_SLOW_TAPS_H
#define TESTS_SUPPORT_SLOW_TAPS_H

#include "../../src/exact.h"
#include "../../src/map.h"

/* What a texel of a map that keeps planes says of its occluder: slopes are mantissas of 14 bits by
 * four to a common exponent, within half of that; infinite where they are all ones. */
shb_exact_sample slow_sample_of(const shb_map *map, int x, int y);

/* By the test of mutual planes alone, with nothing allowed for snapping; texels outside the map
 * shadow nothing. */
bool slow_tap_is_shadowed(const shb_map *map, const shb_exact_fragment *fragment, int x, int y);

/* The texel seems to hold the fragment's own surface, finer than texels, whatever its plane says of
 * the fragment: it is turned against it by less than half of a right angle, passes in front of it
 * by less than four texels, and misses three of the texels next to it, beyond what rounding is
 * allowed, by more than half of that. */
bool slow_is_fine_sheet(const shb_map *map, const shb_exact_fragment *fragment, int x, int y);

/* Of the occluders' planes of two neighbouring texels of the map. */
typedef enum slow_joint { SLOW_JOINT_APART, SLOW_JOINT_MEET, SLOW_JOINT_UNSURE } slow_joint;

/* Unsure: by half of what rounding is allowed they do not, by twice that they do. */
slow_joint slow_joint_of(const shb_map *map, int ax, int ay, int bx, int by);

enum { SLOW_BOX_MAX = 63 };

/* A box of n x n texels, and which of them hold the sheet that the fragment stands on. */
typedef struct slow_box {
    int left, top, n;
    bool sheet[SLOW_BOX_MAX][SLOW_BOX_MAX]; /* by row and column */
} slow_box;

/* The n x n texels nearest to the fragment. Those of its sheet are those that are joined to its own
 * one, and that to its plane; none where that shadows the fragment, or the map does not keep
 * planes. */
slow_box slow_box_of(const shb_map *map, const shb_exact_fragment *fragment, int n);

/* Of any texel; of a box without texels, none is. */
bool slow_is_on_sheet(const slow_box *box, int x, int y);

/* The part of its taps that a box of n x n texels lets through, as the filters pcf and, if it is
 * smooth, pcf-smooth weigh them. */
double slow_lit_in_box(const shb_map *map, const shb_exact_fragment *fragment, int n, bool smooth);

#endif
