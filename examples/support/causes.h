/* Why a fragment is wrong: each cause is what an answer would have been right without.
 *
 * A method compares one sample with a receiver plane: the depth that the map holds at the texel
 * that it asks, with ref there. Each wrong fragment gets the first of these causes whose test it
 * passes; "would" means that the question is asked again with that one thing changed.
 *
 * False shadow (acne):
 *   kernel         the filter is wider than a texel, and its one tap at the fragment would be right
 *   quantisation   a map of float depths would light it, or rounding alone is between sample and
 * ref slope          the sample does not lie in front of the receiver's own plane at the texel's
 *                  centre: that plane would light it, and the method compared something deeper
 *   offset         the method moved the point to another texel; at the point's own one the
 *                  receiver's plane would light it
 *   crease         the sample is another triangle's that shares a corner with the receiver's or
 *                  whose plane, carried to the fragment's own light ray, does not lie in front of
 *                  the fragment: the same surface, bent within a texel
 *   sampling       the sample is of a true occluder that the fragment's own light ray misses
 *
 * False light (leak):
 *   kernel         as above
 *   quantisation   a map of float depths would darken it, or rounding alone is between the two
 *   bias           the offset exceeds the gap: even at the fragment's own light ray nothing stands
 *                  between the light and the receiver plane, but something does before the
 * fragment; or the map keeps depths of its own where the nearest would darken it offset         the
 * method moved the point to another texel; at the point's own one the same ref would darken it
 *   extrapolation  the sample lies in front of the receiver plane at the fragment's own place, but
 *                  not where the plane was carried to the texel's centre; or the exact method lit
 * it by the occluder's plane, carried from there sampling       the sample at the fragment's own
 * light ray would darken it: the occluder is missed at the texel's centre, or lies deeper there
 *
 * Unexplained: none of these, as with methods whose question is not known here. */
#ifndef EXAMPLES_CAUSES_H
#define EXAMPLES_CAUSES_H

#include "measure.h"

typedef enum cause {
    CAUSE_NONE = 0, /* right, or no fragment that counts */
    CAUSE_KERNEL,
    CAUSE_QUANTISATION,
    CAUSE_SLOPE,
    CAUSE_BIAS,
    CAUSE_OFFSET,
    CAUSE_CREASE,
    CAUSE_EXTRAPOLATION,
    CAUSE_SAMPLING,
    CAUSE_UNEXPLAINED,
    CAUSES
} cause;

const char *cause_name(cause kind);

typedef struct cause_question {
    measure_frame *frame;
    const measure_truth *truth;
    const shb_map *map; /* drawn for the method, and prepared for the filter */
    const shb_bias *bias;
    const shb_filter *filter; /* NULL: hard */
} cause_question;

/* The cause of every fragment of the frame; frame->visibility gets the answers. Errors as
 * shb_map_visibility and shb_map_draw. */
shb_result causes_find(const cause_question *question, uint8_t *causes);

typedef struct cause_counts {
    uint64_t acne[CAUSES], leak[CAUSES]; /* false shadow and false light by cause */
    uint64_t fragments, wrong;           /* that count */
} cause_counts;

cause_counts causes_count(const cause_question *question, const uint8_t *causes);

#endif
