/* The truth that every method is judged by, and the measures of error.
 *
 * Rays in double precision through a bounding-volume hierarchy. The receiver's own triangle is left
 * out by its id, never by an offset along the ray, so the truth has no bias of its own. A hit
 * counts unless rounding cannot tell it from the ray's origin (by a forward bound of the distance's
 * error). Nothing of the shadow-map path depends on it.
 *
 * Functions that take a reference work on the threads of its context: one call at a time for a
 * context. */
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

/* What the truth says of a pixel: one of the first three values, to the last two of which the flag
 * may be added. */
enum {
    SHB_TRUTH_NONE = 0,     /* no fragment, faces away from the light, or outside the map */
    SHB_TRUTH_LIT = 1,      /* nothing stands between fragment and light */
    SHB_TRUTH_SHADOWED = 2, /* something does */
    SHB_TRUTH_BOUNDARY = 4  /* the flag: within one map texel of a true shadow boundary */
};

typedef struct shb_classify_desc {
    shb_frame frame;
    const shb_map *map; /* the light and the texel grid; its depths are not read */
    double min_cosine;  /* 0 .. 1: SHB_TRUTH_NONE where the cosine between the triangle's normal and
                           the light is smaller; 0: only where the triangle faces away */
} shb_classify_desc;

/* Classifies every pixel of a frame: truth[row * width + column]. A fragment faces the light if
 * light and camera lie on the same side of its triangle.
 *
 * A true shadow boundary is a silhouette edge projected from the light onto a receiver behind it.
 * Silhouette edges are open edges and those whose two triangles lie on the same side of them as the
 * light sees them, vertices being welded where their positions are equal. The flag is set if such
 * an edge is nearer to the light than the fragment's plane and passes within one texel of the
 * fragment in the map, on both axes. Contact lines and creases, where the edge touches the plane,
 * are no boundaries: errors there are the bias's own. An edge touches if it lies no higher above
 * the plane than 2^-20 of the largest coordinate of both.
 *
 * The frame's scene must be the one of the reference; SHB_ERROR_ARGUMENT if their numbers of
 * triangles differ. Other errors: SHB_ERROR_ARGUMENT, SHB_ERROR_SIZE, SHB_ERROR_NUMBER,
 * SHB_ERROR_MEMORY. */
shb_result shb_reference_classify(const shb_reference *reference, const shb_classify_desc *desc,
                                  uint8_t *truth);

/* Errors over a frame. A visibility below 0.5 counts as shadowed. */
typedef struct shb_errors {
    uint64_t lit, shadowed;             /* fragments by truth */
    uint64_t false_shadow, false_light; /* away from boundaries: the bias is at fault */
    uint64_t boundary_shadow;           /* false shadow within a texel of a boundary: sampling */
    uint64_t boundary_light;            /* false light there */
    double false_shadow_ppm; /* false_shadow per million lit fragments; 0 if none is lit */
    double false_light_ppm;  /* false_light per million shadowed fragments; 0 if none is */
    double boundary_ppm;     /* both boundary errors per million of all fragments */
    uint64_t wrong;          /* the sum of all four errors */
    double wrong_ppm;        /* wrong per million of all fragments */
} shb_errors;

/* truth and visibility hold count elements in the same order; those whose truth is SHB_TRUTH_NONE
 * are skipped. SHB_ERROR_ARGUMENT for NULL. */
shb_result shb_errors_measure(size_t count, const uint8_t *truth, const float *visibility,
                              shb_errors *errors);

/* How far soft shadows are from the truth, over the pixels that count. */
typedef struct shb_soft_errors {
    uint64_t fragments; /* pixels that count */
    double rms;         /* square root of the mean squared difference */
    double mean;        /* mean absolute difference */
    double largest;     /* largest absolute difference */
    double similarity;  /* structural similarity, -1 .. 1; 1: the same */
} shb_soft_errors;

/* truth and visibility hold width * height values from 0 to 1, row by row without gaps. mask is 0
 * where a pixel does not count, whose truth and visibility are not read; NULL: all count. The
 * similarity (Wang, Bovik, Sheikh and Simoncelli 2004) is the mean over all windows of 8 x 8
 * pixels, or of the frame's size where that is smaller, of
 *     (2 m n + c) (2 s_mn + d) / ((m^2 + n^2 + c) (s_m^2 + s_n^2 + d)),  c = 0.01^2, d = 0.03^2,
 * with the means m and n and the (co)variances s of the window's pixels; pixels that do not count
 * are left out of their windows, and a window's weight is the number of those that do. If none
 * counts: no errors, similarity 1. SHB_ERROR_ARGUMENT for NULL, SHB_ERROR_SIZE for a width or
 * height of 0, SHB_ERROR_NUMBER if a value that counts is not finite. */
shb_result shb_soft_errors_measure(uint32_t width, uint32_t height, const float *truth,
                                   const float *visibility, const uint8_t *mask,
                                   shb_soft_errors *errors);

/* How far a shadow is detached from its contact line: the receiver is probed from contact along
 * direction. Samples that truly are lit are skipped. */
typedef struct shb_detachment_desc {
    const shb_map *map;
    const shb_bias *bias;
    const shb_filter *filter; /* NULL: hard */
    shb_vec3 contact;         /* on the contact line, world units */
    shb_vec3 direction;       /* unit vector in the receiver's plane */
    shb_vec3 normal;          /* of the receiver */
    double length;            /* of the probe, world units */
    uint32_t samples;         /* 1 .. 2^20; sample k lies at length * (k + 0.5) / samples */
    uint32_t receiver_id;     /* triangle left out of the truth, or SHB_ID_NONE */
} shb_detachment_desc;

typedef struct shb_detachment {
    double world;    /* distance from the contact to the last falsely lit sample; 0: attached */
    double texels;   /* the same in widths of a map texel at the contact */
    uint32_t probed; /* samples that truly are in shadow */
} shb_detachment;

/* SHB_ERROR_ARGUMENT if a pointer is NULL, direction is not a unit vector, or contact lies behind
 * the light; SHB_ERROR_NUMBER, SHB_ERROR_SIZE; others as shb_map_visibility. */
shb_result shb_detachment_measure(const shb_reference *reference, const shb_detachment_desc *desc,
                                  shb_detachment *detachment);

#ifdef __cplusplus
}
#endif

#endif
