/* From clip space to a shape on the pixel grid: projection, snapping, facing and the box of
 * samples.
 *
 * Window coordinates in pixels, x right, y down, all in double with one division a corner:
 *     i = 1 / w,  X = (x * i) * (width / 2) + width / 2,  Y = (y * i) * (-height / 2) + height / 2,
 *     Z = z * i
 * Snapped coordinates are X * 256 and Y * 256, rounded to nearest even. The guard band keeps X and
 * Y within +-16384 (rounding may exceed that: they are clamped before they are snapped), so snapped
 * coordinates within +-2^22, differences within +-2^23, areas and edge functions within +-2^48.
 *
 * Sample (i, j) lies at the pixel's centre, (256 i + 128, 256 j + 128) in snapped coordinates. */
#ifndef SRC_SETUP_H
#define SRC_SETUP_H

#include "clip.h"

#define SHB_SUBPIXELS 256

/* A rectangle of samples, both ends included; empty if a last one is before its first. */
typedef struct shb_samples {
    int32_t first_column, first_row, last_column, last_row;
} shb_samples;

struct shb_plane_finder;
struct shb_bias;

typedef struct shb_target {
    shb_clip_volume volume;
    double half_width, half_height;
    shb_samples samples;                   /* all of the target's */
    const struct shb_plane_finder *planes; /* slopes are drawn in place of ids; NULL: ids are */
    const struct shb_bias *combines;       /* what makes the depth of two layers, or NULL */
    uint8_t *marks; /* where the images are clear (marks.h); NULL: not known */
} shb_target;

/* A triangle, or what clipping left of it. */
typedef struct shb_shape {
    size_t count; /* corners; 3 unless it was cut */
    bool is_cut;
    shb_clip_position corners[3];                                      /* of the whole triangle */
    double X[SHB_POLYGON_MAX], Y[SHB_POLYGON_MAX], Z[SHB_POLYGON_MAX]; /* window, in mesh order */
    int32_t snapped_x[SHB_POLYGON_MAX], snapped_y[SHB_POLYGON_MAX];    /* in positive order */
    shb_samples samples; /* box of those that can be covered, not clipped to the target */
} shb_shape;

typedef enum shb_outcome {
    SHB_OUTCOME_NOT_FINITE,
    SHB_OUTCOME_CULLED,
    SHB_OUTCOME_DRAWN
} shb_outcome;

shb_target shb_target_of(uint32_t width, uint32_t height, bool reversed);

/* The samples of both rectangles. */
shb_samples shb_samples_intersect(shb_samples a, shb_samples b);
bool shb_samples_are_empty(shb_samples samples);

/* Fills the shape of a triangle that is drawn. */
shb_outcome shb_shape_prepare(const shb_target *target, const shb_draw_instance *instance,
                              const shb_clip_position corners[3], shb_shape *shape);

#endif
