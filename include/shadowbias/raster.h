/* Drawing: a scene as one view sees it, into the caller's arrays.
 *
 * Exactness. Vertices are transformed in double. Positions are snapped to 1/256 pixel, and coverage
 * is decided in integers at pixel centres with the top-left rule: triangles that share an edge
 * cover each sample between them exactly once. The depth at a sample is that of the plane through
 * the unsnapped triangle at the pixel centre: the true surface, not the snapped one. A stored float
 * depth z lies within 5 * 2^-24 * |z| of that plane or, for slivers, within the depth range of the
 * triangle's corners. Nothing depends on tiles, threads, instruction set or order: at equal depth
 * the lower triangle id wins. */
#ifndef SHADOWBIAS_RASTER_H
#define SHADOWBIAS_RASTER_H

#include "shadowbias/context.h"
#include "shadowbias/scene.h"
#include "shadowbias/view.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How a depth is stored. A unorm depth is rounded away from the viewer (up, or down when reversed),
 * so that quantisation may cause false light but never false shadow. */
typedef enum shb_format {
    SHB_FORMAT_FLOAT32 = 0, /* float */
    SHB_FORMAT_UNORM24,     /* uint32_t, value 0 .. 2^24 - 1 in the low bits, high bits 0: a stencil
                               there must be cleared, OpenGL's 24_8 shifted right by 8 */
    SHB_FORMAT_UNORM16      /* uint16_t */
} shb_format;

/* An array of depths. stride: bytes from one row to the next, a multiple of the texel's size;
 * 0: rows without gaps. Rows that are a large power of two apart take each other's place in caches:
 * 64 bytes more can make drawing a quarter faster. */
typedef struct shb_depth_image {
    void *texels;
    size_t stride;
    shb_format format;
} shb_depth_image;

typedef struct shb_draw_desc {
    const shb_view *view;
    const shb_scene *scene;
    uint32_t width, height; /* 1 .. SHB_SIZE_MAX */
    shb_depth_image depth;  /* the nearest surface; texels NULL: not wanted */
    shb_depth_image second; /* the second nearest: the next one in the order of (depth, id), so a
                               second triangle at equal depth counts; texels NULL: not wanted */
    uint32_t *ids;          /* triangle ids of the nearest surface; NULL: not wanted */
    size_t id_stride;       /* bytes, a multiple of 4; 0: rows without gaps */
    bool flip_culling;      /* cull front faces of instances that cull back faces, and vice versa */
    uint32_t tile_size;     /* a power of two, 16 .. 512; 0: chosen. Results do not depend on it */
    void *clear_marks;      /* see shb_clear_marks_size; NULL: every image is cleared altogether */
    size_t clear_marks_size; /* bytes */
} shb_draw_desc;

/* What became of the triangles. */
typedef struct shb_draw_stats {
    uint64_t triangles;  /* in the scene */
    uint64_t not_finite; /* left out: a clip coordinate of a vertex is NaN or beyond +-2^300 */
    uint64_t culled;     /* facing the wrong way, without area, or without a sample in the bounding
                            box of what clipping leaves of them */
    uint64_t clipped;    /* cut by the near plane or the guard band, then drawn */
    uint64_t drawn;      /* all others, clipped ones included */
} shb_draw_stats;

/* Draws the scene. Samples that nothing covers get the far depth (1, or 0 when reversed) and
 * SHB_ID_NONE; surfaces at or beyond the far depth are not seen. "Equal depth" means equal float32
 * depth, before a unorm format rounds it. All texels of the wanted images are written, the padding
 * between rows is not. Images must not overlap. stats may be NULL. Errors: SHB_ERROR_ARGUMENT,
 * SHB_ERROR_SIZE (of target, scene or clear_marks), SHB_ERROR_NUMBER (view or instance matrix not
 * finite), SHB_ERROR_MEMORY. One call at a time for a context. */
shb_result shb_draw(shb_context *context, const shb_draw_desc *desc, shb_draw_stats *stats);

/* The size of shb_draw_desc.clear_marks for a target of this size, in bytes; 0 for a size out of
 * range. Marks remember from one drawing to the next where the images are clear, a byte for each 16
 * by 16 samples, so that images drawn again and again are cleared only where the drawing before
 * drew in them. It pays where much of the images stays empty.
 *
 * The host zeroes the marks once, and again whenever anything but a drawing with these marks has
 * written to one of the images. A drawing whose images, strides, formats, size or view.reversed are
 * not those of the drawing before notices it by itself and clears everything. Marks are of no use,
 * and everything is cleared, if depth is not float32, the images' strides differ from each other,
 * the width is no multiple of 16, or several threads draw many small triangles into a target of at
 * most 2048 by 2048 samples. Marks need no alignment. */
size_t shb_clear_marks_size(uint32_t width, uint32_t height);

/* The bytes of a texel: 4 or 2; 0 for an unknown format. */
size_t shb_format_size(shb_format format);

#ifdef __cplusplus
}
#endif

#endif
