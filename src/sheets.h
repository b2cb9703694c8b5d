/* Front sheets: what of a texel the light surely reaches, and what it surely does not.
 *
 * A texel has a depth, its split. Let front be the triangles that come before it somewhere in the
 * texel. The texel is whole if
 *   (a) each triangle of the front ends before the split, all over the texel,
 *   (b) no edge of a front triangle in the texel is open, shared by more than two, or one at which
 *       the mesh turns round as the light sees it, so that beyond each edge lies exactly one other
 *       triangle, on the other side of it; and
 *   (c) exactly one triangle of the front covers a certain point near the texel's centre.
 *
 * Then every ray of the texel meets the front exactly once. For take a way from that point to the
 * ray that passes no vertex. The number of front triangles above it can change only where it passes
 * an edge of one; there it leaves one triangle and enters the other of that edge (b), which shares
 * the edge, so it comes before the split there and is of the front, too. So the number stays what
 * it is at the point (c): 1. (A ray through a vertex is the limit of others, and two hits on it
 * would be two on those.)
 *
 * So a point of the scene before the split lies on the front (a) and is itself the only thing that
 * the front has on its ray; everything else lies behind the split: it is lit. A point behind the
 * split, of the scene or not, has the front between itself and the light: it is shadowed.
 *
 * Maps with lists find their sheets while they put triangles into cells, in another way
 * (kernels/k_list_sheet.inl); of others sheets.c does.
 *
 * A texel that is not whole keeps the depth at which the nearest of all triangles that cover it
 * altogether ends: what lies behind is shadowed.
 *
 * Rounding. A point may be off by rounding of its coordinates to float, at most `margin` texels
 * where its w is at least least_w; so what is said of a texel holds for a square that is larger by
 * the margin on all sides, and a triangle begins and ends by as much earlier and later as the depth
 * of points on it may be off (k_sheet_triangles.inl). */
#ifndef SRC_SHEETS_H
#define SRC_SHEETS_H

#include "sheets_bin.h"

typedef struct shb_sheet_frame {
    shb_list_frame list;
    double margin;  /* texels */
    double least_w; /* of points that can be told anything */
    double reach;   /* largest coordinate of such points */
} shb_sheet_frame;

/* A texel's bound. The last bit of its significand is set where the texel is whole: the bound is
 * the split. */
typedef struct shb_sheets {
    shb_sheet_frame frame;
    uint32_t width, height;
    size_t stride; /* in texels */
    float *bounds;
} shb_sheets;

/* For points that rounding of their coordinates moves by no more than a margin in the map, texels.
 */
shb_sheet_frame shb_sheet_frame_of(const shb_list_frame *list, double margin);

/* Reserves the texels of a map; false: out of memory. */
bool shb_sheets_create(const shb_map *map, shb_sheets *sheets);
void shb_sheets_destroy(const shb_context *context, shb_sheets *sheets);

/* Finds the sheets of a map whose depths were drawn. */
void shb_sheets_find(shb_map *map, const shb_light_mesh *mesh, const shb_sheet_bins *bins);

#endif
