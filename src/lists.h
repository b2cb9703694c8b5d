/* Lists: per texel of a light's view the triangles that can stand between the light and a point
 * there. A point asks the triangles of its texel whether one of them blocks its own ray to the
 * light, so the answer is that of a ray caster, inside a texel too: it does not depend on the size
 * of the lists, there is no bias and no aliasing.
 *
 * What casts a shadow is every triangle, whatever its culling, where it lies at or beyond the
 * light's near plane. There is no far plane. A point outside the view, or not in front of the
 * light, or not finite, is lit.
 *
 * Which triangles a texel needs. Let far be the least depth such that a triangle that covers the
 * whole texel ends in front of it. What begins behind it is hidden from the light all over the
 * texel: points there are in the shadow of the covering triangle, which stays in the list. */
#ifndef SRC_LISTS_H
#define SRC_LISTS_H

#include "context.h"
#include "list_triangle.h"

/* Texels are kept in square tiles, each row by row, and tiles row by row. */
#define SHB_LIST_TILE 64

typedef struct shb_lists {
    shb_context *context;
    shb_list_frame frame;
    uint32_t width, height; /* texels */
    uint32_t tile_columns, tile_rows;
    uint32_t *starts;             /* of each texel's entries; one more for the end of the last */
    uint32_t *entries;            /* numbers of triangles, in ascending order: front to back */
    shb_list_triangle *triangles; /* by nearest depth */
    uint32_t count;               /* of these triangles */
    shb_triangle *source; /* by id, in world units; the id is SHB_ID_NONE where not finite */
    uint32_t id_count;
    size_t memory_bytes; /* of all the above */
} shb_lists;

/* Builds lists of width by height texels of a view that can be inverted, from a checked scene whose
 * indices are in range. They have half that size, or a quarter, and so on, if they would take more
 * than memory_cap bytes otherwise; 0: no cap. SHB_ERROR_SIZE if one texel's would still take more,
 * SHB_ERROR_NUMBER for a view without a light, SHB_ERROR_MEMORY; *lists is untouched then. The bits
 * do not depend on threads. Failures are logged in the name of caller. */
shb_result shb_lists_build(shb_context *context, const char *caller, const shb_view *view,
                           uint32_t width, uint32_t height, const shb_scene *scene,
                           size_t memory_cap, shb_lists **lists);

/* NULL is ignored. */
void shb_lists_destroy(shb_lists *lists);

typedef struct shb_list_points {
    size_t count;
    const double *x, *y, *z; /* world */
    const uint32_t *own_ids; /* triangle that each point lies on, or SHB_ID_NONE; NULL: unknown */
    double rounding; /* of each coordinate relative to its size: 0x1p-24 for floats; 0: points are
                        exact but for the double arithmetic they were computed in */
} shb_list_points;

/* Visibility of the light: 0 shadowed, 1 lit. A triangle blocks if it lies in front of a point by
 * more than the rounding of the point and of this arithmetic. Exact points get the answers of
 * shb_reference_occluded, near plane apart. Any thread, any number at a time. */
void shb_lists_query(const shb_lists *lists, const shb_list_points *points, float *visibility);

/* The texel's run of entries: first, and the one behind the last. */
static inline void shb_lists_entries(const shb_lists *lists, uint32_t column, uint32_t row,
                                     const uint32_t **first, const uint32_t **end) {
    const size_t tile =
        (size_t)(row / SHB_LIST_TILE) * lists->tile_columns + column / SHB_LIST_TILE;
    const size_t texel =
        (tile * SHB_LIST_TILE + row % SHB_LIST_TILE) * SHB_LIST_TILE + column % SHB_LIST_TILE;
    *first = lists->entries + lists->starts[texel];
    *end = lists->entries + lists->starts[texel + 1];
}

#endif
