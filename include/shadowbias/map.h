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
    double scene_scale; /* the size of the scene, world units, at least 0. 0: the diagonal of the
                           box of what is drawn, for which each drawing passes over its vertices;
                           of a wrapped map, that of the box of the light's frustum, which counts up
                           to twice the near distance if it has no end: give the scale then */
    shb_occluders occluders; /* kept when the map is drawn, for the exact method */
    size_t occluder_memory;  /* the most bytes that lists may take; 0: as many as they need. Lists
                                that would take more are made for texels twice as wide, or four
                                times, and so on: the answers are the same, only slower. Drawing
                                fails with SHB_ERROR_MEMORY if one list for all would take more */
    bool classifies; /* drawing finds what shb_map_classify answers from: 4 bytes a texel, and about
                        40 a triangle to recognise the scene when it is drawn again. The exact
                        method with the filter hard asks this first and its occluders only where it
                        is unsure: faster, and also better where planes or triangles err */
    bool exact_only; /* with lists: no depths are kept or drawn, which spares their bytes and the
                        depth pass. Only the exact method with the filter hard, and
                        shb_map_classify, may ask the map then */
} shb_map_desc;

/* Makes a map to draw into; until then it is empty: every fragment is lit, by any method. Destroy
 * it before its context. Both ways to make a map fail with SHB_ERROR_NUMBER if the view cannot be
 * inverted, if view.reversed contradicts the matrix of a point light (depth must grow, or fall when
 * reversed, away from it), or if scene_scale is negative or not finite; other errors are
 * SHB_ERROR_ARGUMENT (among them exact_only without lists), SHB_ERROR_SIZE and SHB_ERROR_MEMORY. */
shb_result shb_map_create(shb_context *context, const shb_map_desc *desc, shb_map **map);

/* Makes a map around depths that the host made (rasterized, or read back from a GPU) with the same
 * view, size and format, top row first. texels is borrowed, and read whenever the map is asked;
 * stride in bytes, 0: rows without gaps. Depths from the bottom row up, as OpenGL reads them back,
 * fit a view whose matrix has its row y negated; view.h tells what else the matrices of other
 * systems need. Unorm depths that are rounded to the nearest step, as GPUs do, may be half a step
 * nearer than the surface, which the method's epsilon must cover: 2^-17 in map depth for unorm16.
 * holds: the method whose combine stage or culling the host applied; NULL: the texels are the
 * nearest depths. Further errors: SHB_ERROR_ARGUMENT if texels or stride is not aligned to the
 * texel's size or the stride is below a row, SHB_ERROR_SIZE if it overflows, SHB_ERROR_UNSUPPORTED
 * if desc.occluders or desc.classifies is set, for which depths alone do not suffice. */
shb_result shb_map_wrap(shb_context *context, const shb_map_desc *desc, const void *texels,
                        size_t stride, const shb_bias *holds, shb_map **map);

/* Draws the scene into a map that shb_map_create made, in place of what it held. bias decides which
 * depths the map holds (its combine stage, SHB_NEEDS_FLIPPED); NULL or a method with neither: the
 * nearest ones, which serve all such methods. What desc.occluders asks for is kept if bias is NULL
 * or needs it, in copies: the map does not refer to the scene after the call. What a combine stage
 * writes is rounded to the format as drawn depths are; NaN becomes the far depth. stats may be
 * NULL; of a map with desc.exact_only, all but its triangles are 0. Errors, with which the map
 * keeps what it held: those of shb_draw; SHB_ERROR_UNSUPPORTED for a wrapped map, and for a map
 * with desc.exact_only if bias does not ask occluders; SHB_ERROR_MEMORY for 2^29 triangles or more
 * if the map keeps triangles or classifies without lists; SHB_ERROR_ARGUMENT if the pass over the
 * vertices for the scene's scale meets an index out of range. One call at a time for a context, and
 * none while others ask the map.
 */
shb_result shb_map_draw(shb_map *map, const shb_scene *scene, const shb_bias *bias,
                        shb_draw_stats *stats);

/* The most preparations that a map keeps at the same time. */
#define SHB_PREPARED_MAX 4

/* Lets the filter make what it reads beside the depths (shb_filter.prepare); a filter that prepares
 * nothing is SHB_OK. Call it after each drawing, and when the host changed the texels of a wrapped
 * map. The map keeps the result for all filters with the same prepare, release, params and user,
 * until it is drawn again (the next preparation of the same filter reuses the memory then), the
 * filter is prepared with other params, or more than SHB_PREPARED_MAX would be kept, when the
 * oldest goes. One call at a time for a context, and none while others ask the map.
 * SHB_ERROR_ARGUMENT for NULL, SHB_ERROR_UNSUPPORTED for a map with desc.exact_only, otherwise what
 * the filter's prepare returns; the map keeps what it held then. */
shb_result shb_map_prepare(shb_map *map, const shb_filter *filter);

/* NULL is ignored. */
void shb_map_destroy(shb_map *map);

/* What is known of a map: valid until it is destroyed, updated when it is drawn or prepared. NULL
 * for NULL. */
const shb_map_info *shb_map_get_info(const shb_map *map);

/* The stored depths, top row first, to read only; valid until the map is drawn again or destroyed.
 * For NULL, and for a map with desc.exact_only, its texels are NULL. */
shb_depth_image shb_map_get_depth(const shb_map *map);

/* Points of a host: any count, any layout. All arrays are aligned to 4 bytes; strides are multiples
 * of 4 bytes and at least 12; 0: 12. */
typedef struct shb_points {
    size_t count;
    const float *positions; /* x, y, z in world units */
    size_t position_stride;
    const float *normals; /* unit geometric normals, not shading normals, pointing to either side;
                             NULL if neither method nor filter needs them */
    size_t normal_stride;
    shb_own_triangles own; /* the triangles that the points lie on, or all NULL */
} shb_points;

/* Visibility of the light from count points: 0 shadowed .. 1 lit. filter NULL: hard. Allocates
 * nothing, but needs up to 250 KB of stack; may be called from any number of threads at once.
 * SHB_ERROR_UNSUPPORTED if normals are missing that method or filter needs, if the map was not
 * drawn or prepared for them, or if they do not go together; SHB_ERROR_ARGUMENT for NULL pointers,
 * bad alignments and strides, weights without ids or one weight without the other, and ids that the
 * map's scene does not have if the exact method may read them (SHB_ID_NONE, unknown, is allowed
 * where there are no weights); SHB_ERROR_SIZE if count times a stride overflows. */
shb_result shb_map_visibility(const shb_map *map, const shb_points *points, const shb_bias *bias,
                              const shb_filter *filter, float *visibility);

/* What is certain of the light at a point. */
enum {
    SHB_LIGHT_UNSURE = 0,
    SHB_LIGHT_LIT = 1,     /* nothing stands between point and light */
    SHB_LIGHT_SHADOWED = 2 /* something does */
};

/* answers[i]: SHB_LIGHT_* of point i, for hosts that cast rays: only unsure points need one.
 *
 * LIT and SHADOWED are never wrong. If the point lies on the surface of the scene that was drawn,
 * within half a unit in the last place of each coordinate, they are what a ray to the light finds
 * in exact arithmetic, whatever the culling; what lies in front of the near plane casts no shadow.
 * (SHADOWED holds for any point; a point that floats just behind a surface may be called LIT.)
 * Unsure are points that the light sees near an edge of what is nearest to it (an open edge, a
 * silhouette, a line of contact), points outside the view, and points whose coordinates are so
 * large, or so small that floats have no finer steps, that rounding moves them by 1/32 texel (1/256
 * if the map keeps lists).
 *
 * The map must have been created with desc.classifies (SHB_ERROR_UNSUPPORTED); while it is empty
 * all is unsure. Normals are not read. Maps with lists know edges by 64-bit hashes, sums of which
 * agree by accident once in 2^64. Other errors as shb_map_visibility. Allocates nothing; may be
 * called from any number of threads at once. */
shb_result shb_map_classify(const shb_map *map, const shb_points *points, uint8_t *answers);

#ifdef __cplusplus
}
#endif

#endif
