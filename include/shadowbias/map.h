/* Shadow maps: what a light sees, and the question that every renderer asks of it. */
#ifndef SHADOWBIAS_MAP_H
#define SHADOWBIAS_MAP_H

#include "shadowbias/filter.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct shb_map_desc {
    shb_view view;   /* the light */
    uint32_t width;  /* texels, 1 .. SHB_SIZE_MAX */
    uint32_t height; /* 0: the width */
    shb_format format;
    double scene_scale; /* world units; 0: the diagonal of the box of what is drawn (a pass over its
                           vertices at each draw), or of the box of the light's frustum for a map
                           that is wrapped (up to depth 0.5 when far is infinite) */
    shb_occluders occluders; /* kept when the map is drawn, for the exact method */
    size_t occluder_memory;  /* the most bytes that lists may keep; 0: as many as they need. Lists
                                that would keep more are made for texels twice as large, or four
                                times, and so on: the answers are the same, only slower. Drawing
                                fails with SHB_ERROR_MEMORY where one texel's would keep more */
    bool classifies; /* drawing finds what shb_map_classify answers from: 4 bytes a texel, and some
                        40 a triangle to know them again when the same scene is drawn next. The
                        exact method asks it first, by the filter hard, so that its occluders
                        are asked for few fragments: the answers become faster, and where planes
                        or triangles are not right by themselves better */
} shb_map_desc;

/* An empty map: every fragment is lit, by any method. To be destroyed before its context. Both ways
 * to make a map fail with SHB_ERROR_NUMBER if the view cannot be inverted, view.reversed
 * contradicts the matrix of a point light (depth must grow, or fall when reversed, away from it),
 * or scene_scale is negative or not finite; SHB_ERROR_ARGUMENT, SHB_ERROR_SIZE, SHB_ERROR_MEMORY.
 */
shb_result shb_map_create(shb_context *context, const shb_map_desc *desc, shb_map **map);

/* A map around depths that the host made (rasterized, or read back from a GPU) with the same view,
 * size and format. texels is borrowed and read at every question; stride in bytes, 0: no gaps.
 * holds names the method whose combine stage or culling the host applied; NULL: the nearest depth.
 * SHB_ERROR_ARGUMENT if texels or stride is not aligned to the texel's size or the stride is below
 * a row, SHB_ERROR_SIZE if it overflows, SHB_ERROR_UNSUPPORTED if desc.occluders or desc.classifies
 * is set: depths alone tell nothing of either. */
shb_result shb_map_wrap(shb_context *context, const shb_map_desc *desc, const void *texels,
                        size_t stride, const shb_bias *holds, shb_map **map);

/* Draws the scene into a map that shb_map_create made, in place of what it held. bias decides what
 * the map keeps (its combine stage, SHB_NEEDS_FLIPPED); NULL or any method without these: the
 * nearest depth, which serves all such methods alike. desc.occluders are kept if bias is NULL or
 * needs them, in copies: the scene may go when the call is done. What a combine stage writes is
 * rounded to the format as drawn depths are; NaN becomes the far depth. stats may be NULL. Errors
 * as shb_draw, SHB_ERROR_UNSUPPORTED for a wrapped map, SHB_ERROR_MEMORY for 2^29 triangles or more
 * where the map keeps triangles or classifies without lists, and SHB_ERROR_ARGUMENT where the pass
 * over the vertices for the scene's scale meets an index that is out of range; the map keeps what
 * it held then. One call at a time for a context, and none while others ask the map. */
shb_result shb_map_draw(shb_map *map, const shb_scene *scene, const shb_bias *bias,
                        shb_draw_stats *stats);

/* Lets the filter make what it reads beside the depths (shb_filter.prepare), and keeps it until the
 * map is drawn again or destroyed, the filter is prepared with other parameters, or another filter
 * takes its place where more than SHB_PREPARED_MAX are kept; a filter that prepares nothing is
 * SHB_OK. Drawing outdates it but leaves its memory to the next preparation of the same filter,
 * until another one is prepared anew or the map is drawn once more. To be called again when a host
 * changes the texels of a wrapped map. What is kept is used by filters with the same prepare,
 * release, params and user. One call at a time for a context, and none while others ask the map.
 * SHB_ERROR_ARGUMENT for NULL, else as the filter says; the map keeps what it held then. */
shb_result shb_map_prepare(shb_map *map, const shb_filter *filter);

/* What different filters made of a map, kept at the same time. */
#define SHB_PREPARED_MAX 4

/* NULL is ignored. */
void shb_map_destroy(shb_map *map);

/* Valid until the map is destroyed, and written when it is drawn or prepared; NULL for NULL. */
const shb_map_info *shb_map_get_info(const shb_map *map);

/* The stored depths, top row first, to be read; valid until the map is drawn again or destroyed. No
 * texels for NULL. */
shb_depth_image shb_map_get_depth(const shb_map *map);

/* Points of a host: any count, any layout. Arrays are aligned to 4 bytes; strides in bytes,
 * multiples of 4; 0: 12. */
typedef struct shb_points {
    size_t count;
    const float *positions; /* x, y, z in world units */
    size_t position_stride;
    const float *normals; /* unit geometric normals of either side, not shading normals; NULL if the
                             method does not need them */
    size_t normal_stride;
    shb_own_triangles own; /* the triangles that the points lie on, or all NULL */
} shb_points;

/* Visibility of the light from count points: 0 shadowed .. 1 lit. filter NULL: hard. Allocates
 * nothing; any thread, any number at a time. SHB_ERROR_UNSUPPORTED if method or filter need normals
 * that are missing, a map drawn or prepared for them, or do not go together; SHB_ERROR_ARGUMENT for
 * NULL pointers, bad alignments and strides, weights without ids or one without the other, and,
 * where they are read, ids that the map's scene does not have (SHB_ID_NONE: unknown, may stand for
 * some of them where there are no weights); SHB_ERROR_SIZE where count times a stride overflows. */
shb_result shb_map_visibility(const shb_map *map, const shb_points *points, const shb_bias *bias,
                              const shb_filter *filter, float *visibility);

/* What is known for certain of the light at a point. */
enum {
    SHB_LIGHT_UNSURE = 0,
    SHB_LIGHT_LIT = 1,     /* nothing stands between point and light */
    SHB_LIGHT_SHADOWED = 2 /* something does */
};

/* answers[i]: SHB_LIGHT_* of point i, for hosts that cast rays: only points that are unsure need
 * one. What is said for certain is never wrong: if the point lies on the surface of the scene that
 * was drawn, within half a unit in the last place of each coordinate, it is what a ray to the light
 * finds in exact arithmetic, triangles culled or not. (SHB_LIGHT_SHADOWED holds for any point; one
 * that floats just behind a surface may be called lit.) What lies in front of the near plane casts
 * no shadow. Unsure are points near an edge, seen from the light, of what is nearest to it: an open
 * edge, a silhouette, a line of contact; and those outside the view or with coordinates so large
 * that rounding moves them by 1/32 texel (1/256 where the map keeps lists). The map must have been
 * drawn with desc.classifies: SHB_ERROR_UNSUPPORTED, unless it is empty, when all is unsure.
 * Normals are not read. Maps with lists know edges by names of 64 bits, sums of which agree by
 * accident once in 2^64. Other errors as shb_map_visibility. Allocates nothing; any thread, any
 * number at a time. */
shb_result shb_map_classify(const shb_map *map, const shb_points *points, uint8_t *answers);

#ifdef __cplusplus
}
#endif

#endif
