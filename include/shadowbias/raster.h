/* Drawing: a scene as one view sees it, into the caller's arrays.
 *
 * Exactness. Vertices are transformed in double. Positions are snapped to 1/256 pixel and coverage
 * is decided in integers at pixel centres with the top-left rule: neighbours that share an edge
 * cover each sample exactly once. Depth at a sample is the plane through the unsnapped triangle,
 * evaluated at the pixel centre, so that it is the depth of the true surface and not of the snapped
 * one; a stored float depth z lies within 5 * 2^-24 * |z| of that plane, and within the depth range
 * of the triangle's corners where the triangle is a sliver. Nothing depends on tiles, threads,
 * instruction set or order: at equal depth the lower triangle id wins. */
#ifndef SHADOWBIAS_RASTER_H
#define SHADOWBIAS_RASTER_H

#include "shadowbias/context.h"
#include "shadowbias/scene.h"
#include "shadowbias/view.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How a depth is stored. A unorm depth is rounded away from the viewer (up; down when reversed), so
 * that quantisation can cause false light but never false shadow. */
typedef enum shb_format {
    SHB_FORMAT_FLOAT32 = 0, /* float */
    SHB_FORMAT_UNORM24,     /* uint32_t, value 0 .. 2^24 - 1 in the low bits, high bits 0 */
    SHB_FORMAT_UNORM16      /* uint16_t */
} shb_format;

/* An array of depths. stride: bytes from one row to the next, a multiple of the texel's size;
 * 0: rows without gaps. */
typedef struct shb_depth_image {
    void *texels;
    size_t stride;
    shb_format format;
} shb_depth_image;

typedef struct shb_draw_desc {
    const shb_view *view;
    const shb_scene *scene;
    uint32_t width, height; /* 1 .. SHB_SIZE_MAX */
    shb_depth_image depth;  /* the closest surface; texels NULL: not wanted */
    shb_depth_image second; /* the second closest surface: the next in the order of (depth, id), so
                               a second triangle at equal depth counts; texels NULL: not wanted */
    uint32_t *ids;          /* triangle ids of the closest surface, or NULL; SHB_ID_NONE: nothing */
    size_t id_stride;       /* bytes, a multiple of 4; 0: rows without gaps */
    bool flip_culling;      /* draw back faces of instances that cull back faces, and so on */
    uint32_t tile_size;     /* a power of two, 16 .. 512; 0: chosen. Results do not depend on it */
    void *clear_marks; /* where the images are clear, see shb_clear_marks_size; NULL: unknown */
    size_t clear_marks_size; /* its bytes */
} shb_draw_desc;

/* What became of the triangles. */
typedef struct shb_draw_stats {
    uint64_t triangles;  /* in the scene */
    uint64_t not_finite; /* left out: a clip coordinate of a vertex is NaN or beyond +-2^300 */
    uint64_t culled;     /* facing the wrong way, without area, or no sample of the view lies in the
                            box around what is left after clipping */
    uint64_t clipped;    /* cut by the near plane or the guard band, then drawn */
    uint64_t drawn;      /* all others, clipped ones included */
} shb_draw_stats;

/* Draws the scene. Samples that nothing covers get the far depth (1, or 0 when reversed) and
 * SHB_ID_NONE; surfaces at or beyond the far depth are not seen. "Equal depth" means equal float32
 * depth, before a unorm format rounds it. Every texel of every wanted image is written; padding
 * between rows is not. Images may not overlap. stats may be NULL.
 * Errors: SHB_ERROR_ARGUMENT, SHB_ERROR_SIZE (of target, scene or clear_marks), SHB_ERROR_NUMBER
 * (view or instance matrix not finite), SHB_ERROR_MEMORY; images are untouched then. One call at a
 * time for a context. */
shb_result shb_draw(shb_context *context, const shb_draw_desc *desc, shb_draw_stats *stats);

/* Bytes of the marks of a target, or 0 for a size that is no target's. With marks, images that are
 * drawn again and again are cleared only where the drawing before drew in them: a byte for each 16
 * by 16 samples, and what they were drawn with. They need no alignment. The host sets them to 0
 * once, and again after anything but a drawing with these marks has written to one of the images; a
 * drawing with other images, strides, formats, another size or a view that is reversed where the
 * one before was not takes notice by itself and clears all. It pays where much of the images stays
 * empty. All is cleared, as without marks, where a depth is not float32, strides differ, the
 * width is no multiple of 16, or threads share a target of 2048 by 2048 samples or less between
 * many small triangles. */
size_t shb_clear_marks_size(uint32_t width, uint32_t height);

/* Bytes of one texel of a format: 4 or 2; 0 for an unknown one. */
size_t shb_format_size(shb_format format);

#ifdef __cplusplus
}
#endif

#endif
