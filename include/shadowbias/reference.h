/* The truth that every method is judged by, and the measures of error.
 *
 * Hard-shadow visibility by ray casting in double precision through a bounding-volume hierarchy.
 * The receiver's own triangle is left out by its id, never by an offset along the ray, so the truth
 * has no bias of its own. A hit counts unless the rounding of double arithmetic cannot tell it from
 * the ray's origin (the forward error bound of the distance computation). Slow on purpose: not a
 * part of the shadow-map path.
 *
 * What takes a reference works on the threads of its context: one call at a time for a context. */
#ifndef SHADOWBIAS_REFERENCE_H
#define SHADOWBIAS_REFERENCE_H

#include "shadowbias/shade.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct shb_reference shb_reference;

/* Copies the scene's triangles in world units (double) and builds the hierarchy. Culling does not
 * matter: every triangle casts a shadow. Errors: those of shb_scene_validate, SHB_ERROR_SIZE above
 * 2^30 triangles, SHB_ERROR_MEMORY. One call at a time for a context. */
shb_result shb_reference_create(shb_context *context, const shb_scene *scene,
                                shb_reference **reference);

/* Before its context is destroyed; NULL is ignored. */
void shb_reference_destroy(shb_reference *reference);

/* occluded[i] = 1 if a triangle other than own_ids[i] lies between points[i] and the light, else 0.
 * own_ids may be NULL or hold SHB_ID_NONE: nothing is left out. Watertight: a ray through a shared
 * edge or corner hits. A point that is not finite gives 0. SHB_ERROR_ARGUMENT for NULL,
 * SHB_ERROR_NUMBER if the light is not finite, a zero direction, or its w is neither 0 nor 1. */
shb_result shb_reference_occluded(const shb_reference *reference, const shb_light_source *light,
                                  size_t count, const shb_vec3 *points, const uint32_t *own_ids,
                                  uint8_t *occluded);

/* What the truth says of a pixel: one of the first three, and the flag. */
enum {
    SHB_TRUTH_NONE = 0,     /* no fragment, faces away from the light, or outside the map */
    SHB_TRUTH_LIT = 1,      /* nothing stands between fragment and light */
    SHB_TRUTH_SHADOWED = 2, /* something does */
    SHB_TRUTH_BOUNDARY = 4  /* within one map texel of a true shadow boundary */
};

typedef struct shb_classify_desc {
    shb_frame frame;
    const shb_map *map; /* the light and the texel grid; its depths are not read */
    double min_cosine;  /* 0 .. 1; fragments whose triangle meets the light at a smaller cosine are
                           SHB_TRUTH_NONE; 0: only those that face away from it */
} shb_classify_desc;

/* Classifies every pixel of a frame: truth[row * width + column]. A fragment faces the light if
 * light and camera lie on the same side of its triangle. A true shadow boundary is the projection
 * from the light of a silhouette edge (an open edge, or one whose two triangles fall on the same
 * side of it as the light sees them; vertices are welded where their positions are equal) onto a
 * receiver behind it: the flag is set if such an edge, nearer to the light than the fragment's
 * plane, passes within one texel (larger of both axes) of the fragment in the map. Contact lines
 * and creases, where the edge touches the receiver, are no boundaries: errors there are the bias's
 * own. An edge touches if it lies no higher above the plane than 2^-20 of the largest coordinate of
 * both. The frame's scene must be the reference's, or SHB_ERROR_ARGUMENT where the numbers of
 * triangles tell. The other errors: SHB_ERROR_ARGUMENT, SHB_ERROR_SIZE, SHB_ERROR_NUMBER,
 * SHB_ERROR_MEMORY; truth is untouched then. */
shb_result shb_reference_classify(const shb_reference *reference, const shb_classify_desc *desc,
                                  uint8_t *truth);

/* Errors over a frame. A visibility below 0.5 counts as shadowed. */
typedef struct shb_errors {
    uint64_t lit, shadowed;             /* fragments by truth */
    uint64_t false_shadow, false_light; /* away from boundaries: the bias is at fault */
    uint64_t boundary_shadow;           /* false shadow within a texel of a boundary: sampling */
    uint64_t boundary_light;            /* false light there */
    double false_shadow_ppm; /* false_shadow per million lit fragments; 0 if none is lit */
    double false_light_ppm;  /* false_light per million shadowed fragments */
    double boundary_ppm;     /* both boundary errors per million of all fragments */
    uint64_t wrong;          /* all four errors */
    double wrong_ppm;        /* the same per million of all fragments */
} shb_errors;

/* truth and visibility hold count elements in the same order; those whose truth is SHB_TRUTH_NONE
 * are skipped. SHB_ERROR_ARGUMENT for NULL. */
shb_result shb_errors_measure(size_t count, const uint8_t *truth, const float *visibility,
                              shb_errors *errors);

/* How far soft shadows are from the truth. */
typedef struct shb_soft_errors {
    uint64_t fragments; /* that count */
    double rms;         /* square root of the mean squared difference */
    double mean;        /* of absolute differences */
    double largest;     /* absolute difference */
    double similarity;  /* structural similarity, 1: the same, -1 .. 1 */
} shb_soft_errors;

/* truth and visibility hold width * height values from 0 to 1, row by row without gaps; mask is 0
 * where a pixel does not count (what truth and visibility hold there is not read), or NULL: all
 * count. The similarity is the mean of (2 m n + c) (2 s_mn + d) / ((m^2 + n^2 + c) (s_m^2 + s_n^2 +
 * d)) over all windows of 8 x 8 pixels, or of the frame's size where it is smaller, with the means
 * m and n, the (co)variances s of a window's pixels and c = 0.01^2, d = 0.03^2 (Wang, Bovik, Sheikh
 * and Simoncelli 2004); pixels that do not count are left out of their windows, and the weight of a
 * window is the number of those that do. If none counts: no errors, similarity 1.
 * SHB_ERROR_ARGUMENT for NULL, SHB_ERROR_SIZE for a width or height of 0, SHB_ERROR_NUMBER if a
 * value that counts is not finite. */
shb_result shb_soft_errors_measure(uint32_t width, uint32_t height, const float *truth,
                                   const float *visibility, const uint8_t *mask,
                                   shb_soft_errors *errors);

/* How far a shadow is detached from its contact line. The probe runs from contact along direction
 * (a unit vector in the receiver's plane) over length world units, in samples steps; every probe
 * point must truly be in shadow, or it is skipped. */
typedef struct shb_detachment_desc {
    const shb_map *map;
    const shb_bias *bias;
    const shb_filter *filter;            /* NULL: hard */
    shb_vec3 contact, direction, normal; /* normal: of the receiver */
    double length;
    uint32_t samples;     /* 1 .. 1 << 20; sample k lies at length * (k + 0.5) / samples */
    uint32_t receiver_id; /* triangle left out of the truth, or SHB_ID_NONE */
} shb_detachment_desc;

typedef struct shb_detachment {
    double world;    /* distance from the contact to the last falsely lit sample; 0: attached */
    double texels;   /* the same in widths of a map texel at the contact */
    uint32_t probed; /* samples that truly are in shadow */
} shb_detachment;

/* SHB_ERROR_ARGUMENT if a pointer is NULL, direction is no unit vector, or contact lies behind the
 * light; SHB_ERROR_NUMBER, SHB_ERROR_SIZE; else as shb_map_visibility. */
shb_result shb_detachment_measure(const shb_reference *reference, const shb_detachment_desc *desc,
                                  shb_detachment *detachment);

#ifdef __cplusplus
}
#endif

#endif
