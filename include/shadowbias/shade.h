/* Shading: from a visibility buffer to an image, in batches, through the user's callback. */
#ifndef SHADOWBIAS_SHADE_H
#define SHADOWBIAS_SHADE_H

#include "shadowbias/image.h"
#include "shadowbias/map.h"

#ifdef __cplusplus
extern "C" {
#endif

#define SHB_LIGHTS_MAX 16 /* lights of a frame */

/* What a camera saw: the view it was drawn with and the triangle ids that shb_draw wrote. */
typedef struct shb_frame {
    const shb_view *view;
    const shb_scene *scene;
    uint32_t width, height; /* pixels, 1 .. SHB_SIZE_MAX */
    const uint32_t *ids;    /* aligned to 4 bytes; SHB_ID_NONE: no fragment */
    size_t id_stride;       /* bytes, a multiple of 4; 0: rows without gaps */
} shb_frame;

/* A batch of fragments: covered pixels of a few rows, row by row and from left to right. The
 * position is the point of the triangle at the pixel's centre or, where snapping covered a centre
 * just outside the triangle, the triangle's point nearest to it on the screen. Normals are unit
 * vectors: the triangle's is turned towards the camera (a triangle without area gets the direction
 * to it), the shading normal to the same side of the triangle. From the count up to the next
 * multiple of 16 all arrays repeat the last fragment, those of shb_lighting too, so that loops may
 * run over whole vectors. */
typedef struct shb_fragments {
    SHB_ALIGN float x[SHB_BATCH]; /* world position */
    float y[SHB_BATCH];
    float z[SHB_BATCH];
    float normal_x[SHB_BATCH]; /* of the triangle */
    float normal_y[SHB_BATCH];
    float normal_z[SHB_BATCH];
    /* interpolated from the mesh's normals; the triangle's without any */
    float shading_x[SHB_BATCH];
    float shading_y[SHB_BATCH];
    float shading_z[SHB_BATCH];
    /* barycentric weights of the triangle's second and third corner: at least 0, and in sum, before
     * it is rounded, at most 1 */
    float weight_1[SHB_BATCH];
    float weight_2[SHB_BATCH];
    uint32_t id[SHB_BATCH];
    int32_t pixel_x[SHB_BATCH];
    int32_t pixel_y[SHB_BATCH];
} shb_fragments;

/* What one light does to the batch. A triangle faces the light if light and camera lie on the same
 * side of it. */
typedef struct shb_lighting {
    SHB_ALIGN float visibility[SHB_BATCH]; /* 0 shadowed .. 1 lit; 0 where the triangle faces away,
                                              unless the terminator is smooth */
    float cosine[SHB_BATCH]; /* between shading normal and light direction; 0 where the triangle or
                                the shading normal faces away */
} shb_lighting;

typedef struct shb_shade_light {
    const shb_map *map;
    const shb_bias *bias;
    const shb_filter *filter; /* NULL: hard */
    float color[3];           /* linear red, green and blue, finite; 1 is full */
} shb_shade_light;

typedef struct shb_shade_args {
    size_t count; /* 1 .. SHB_BATCH */
    const shb_fragments *fragments;
    size_t light_count;
    const shb_shade_light *lights;
    const shb_lighting *lighting; /* one a light */
    const void *user;             /* shb_shade_desc.user */
    /* out: linear colour, SHB_BATCH elements each, black before the call. The image gets the square
     * root (a display gamma of 2) clamped to 0 .. 1 and rounded to the nearest 1 / 255; NaN is 0 */
    float *red;
    float *green;
    float *blue;
    const struct shb_shade_kernels *kernels; /* the library's own; NULL when a host calls one */
} shb_shade_args;

/* Must be thread-safe: batches of one frame run at the same time. */
typedef void shb_shade_fn(const shb_shade_args *args);

typedef struct shb_shade_desc {
    shb_frame frame;
    const shb_shade_light *lights; /* may be NULL if there are none */
    size_t light_count;            /* 0 .. SHB_LIGHTS_MAX */
    shb_shade_fn *shade;
    const void *user;    /* for shade */
    float background[3]; /* linear colour of pixels without a fragment, finite */
    /* Triangles turn away from a light, and into each other's shadow, before the smooth surface
     * that the mesh's normals describe does: low-poly shapes show dark facets at the terminator.
     * True: visibility is asked at the point moved out to that surface (Hanika 2021, Hacking the
     * shadow terminator, Ray Tracing Gems II, chapter 4). Where the triangle faces away it is asked
     * as well, with the tangent plane of that surface; the shading normal alone decides what faces
     * a light. Meshes without normals are shaded as without the option. */
    bool smooth_terminator;
    shb_image image; /* pixels NULL: none is written, the callback may keep what it wants */
} shb_shade_desc;

/* Shades the frame. Allocates nothing, but needs up to 650 KB of stack on every thread. Ids that
 * the scene does not have, or whose triangle has a corner that is not finite, are background.
 * Errors: SHB_ERROR_ARGUMENT, SHB_ERROR_SIZE (also for an image that is not of the frame's size),
 * SHB_ERROR_NUMBER (background, colour, view), SHB_ERROR_UNSUPPORTED as shb_map_visibility. One
 * call at a time for a context. */
shb_result shb_shade(shb_context *context, const shb_shade_desc *desc);

/* White Lambert surfaces under all lights: the sum of color * visibility * cosine, and ambient
 * light from above (+y), 0.04 * (1 + shading_y). user: NULL, or a pointer to the three floats of a
 * surface colour. */
void shb_shade_lambert(const shb_shade_args *args);

/* The errors of the first light over surfaces in dim grey: false shadow red, false light blue, both
 * paler where the truth has the flag SHB_TRUTH_BOUNDARY. A visibility below 0.5 counts as shadowed.
 * user: a pointer to an shb_shade_error_params. */
typedef struct shb_shade_error_params {
    const uint8_t *truth; /* one a pixel, as shb_reference_classify writes it */
    size_t stride; /* bytes from one row to the next: the frame's width if there are no gaps */
} shb_shade_error_params;
void shb_shade_error(const shb_shade_args *args);

#ifdef __cplusplus
}
#endif

#endif
