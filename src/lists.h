/* Lists: for cells of a light's view the triangles that can stand between the light and a point
 * there. A point asks the triangles of its cell whether one of them blocks its own ray to the
 * light, so the answer is that of a ray caster, inside a cell too: it does not depend on the size
 * of the cells, there is no bias and no aliasing.
 *
 * What casts a shadow is every triangle, whatever its culling, where it lies at or beyond the
 * light's near plane. There is no far plane. A point outside the view, or not in front of the
 * light, or not finite, is lit.
 *
 * Which triangles a cell needs. Let far be the least depth such that a triangle that covers the
 * whole cell ends in front of it, and by so much that rounding does not matter. A point behind it
 * is in shadow, and a triangle that begins behind it is hidden from the light all over the cell.
 *
 * Tiles of SHB_LIST_TILE texels have as many cells as their triangles call for, up to one a texel:
 * a tile that nearly nothing reaches costs nearly nothing. */
#ifndef SRC_LISTS_H
#define SRC_LISTS_H

#include "kernels/lists.h"
#include "lists_scratch.h"
#include "ray.h"
#include "shadowbias/scene.h"
#include "sheets.h"

typedef struct shb_lists {
    shb_context *context;
    shb_list_frame frame;
    uint32_t width, height; /* texels */
    uint32_t tile_columns, tile_rows;
    shb_list_tile *tiles;
    shb_list_cell *cells;    /* of each tile row by row, and one for the end */
    shb_list_entry *entries; /* of each cell front to back by the levels of their triangles */
    /* by id */
    shb_list_triangle *triangles; /* of those that have entries */
    uint32_t (*corners)[3];       /* vertices */
    double (*vertices)[3];        /* world */
    uint32_t id_count;
    shb_sheets sheets;                /* bounds NULL: none were wanted */
    size_t memory_bytes;              /* of all the above */
    shb_buffer memory[SHB_LIST_KEPT]; /* where all the above is */
} shb_lists;

typedef struct shb_lists_desc {
    const char *caller;     /* in whose name failures are logged */
    const shb_scene *scene; /* checked, its indices are in range */
    const shb_view *view;   /* can be inverted */
    uint32_t width, height; /* texels */
    size_t memory_cap;      /* bytes; 0: none */
    bool with_sheets;
} shb_lists_desc;

/* Builds lists. They have half the size, or a quarter, and so on, if they would take more than the
 * cap otherwise. SHB_ERROR_MEMORY if one texel's would still take more, SHB_ERROR_SIZE for 2^32
 * vertices or more, SHB_ERROR_NUMBER for a view without a light; *lists is untouched then. What a
 * cell holds does not depend on threads. */
shb_result shb_lists_build(shb_context *context, const shb_lists_desc *desc, shb_lists **lists);

/* Both free lists; NULL is ignored. The first keeps their memory in the context for the next ones:
 * only where nothing else is built at the same time. */
void shb_lists_recycle(shb_lists *lists);
void shb_lists_destroy(shb_lists *lists);

/* Points that ask. Those without rounding get exact answers: those of shb_reference_occluded, near
 * plane apart. */
typedef struct shb_list_points {
    size_t count;
    const double *x, *y, *z; /* world */
    const uint32_t *own_ids; /* triangle that each point lies on, or SHB_ID_NONE; NULL: unknown */
    double rounding; /* of each coordinate relative to its size: 0x1p-24 for floats; 0: points are
                        exact but for the double arithmetic they were computed in */
} shb_list_points;

/* Visibility of the light: 0 shadowed, 1 lit. A triangle blocks if it lies in front of a point by
 * more than the rounding of the point and of this arithmetic. Any thread, any number at a time. */
void shb_lists_query(const shb_lists *lists, const shb_list_points *points, float *visibility);

/* What a map with desc.classifies answers certainly from. */
const shb_sheets *shb_map_sheets(const shb_map *map);

/* The world corners of a triangle. */
shb_triangle shb_lists_triangle(const shb_lists *lists, uint32_t id);

#endif
