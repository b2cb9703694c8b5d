/* Silhouettes: the edges that bound shadows, as a map sees them. */
#ifndef SRC_REFERENCE_SILHOUETTE_H
#define SRC_REFERENCE_SILHOUETTE_H

#include "edges.h"
#include "shadowbias/bias.h"

/* The rows of a matrix that gives texel coordinates of a map: x, y and w. The point lies at
 * (x / w, y / w), and before the light if w > 0. */
typedef struct shb_texel_rows {
    double rows[3][4];
} shb_texel_rows;

shb_texel_rows shb_texel_rows_of(const shb_map_info *map);

/* x, y and w of a world position. */
void shb_texel_project(const shb_texel_rows *texel, const double position[3], double out[3]);

typedef struct shb_silhouette_edge {
    double world[2][3]; /* the ends */
    double texel[2][3]; /* their x, y and w */
    double reach;       /* the largest world coordinate */
} shb_silhouette_edge;

/* A box in texel coordinates. */
typedef struct shb_texel_box {
    double left, right, top, bottom;
} shb_texel_box;

/* The part begin .. end (0 .. 1) of an edge that lies in the box and before the light; false: none.
 */
bool shb_silhouette_clip(const shb_silhouette_edge *edge, const shb_texel_box *box, double *begin,
                         double *end);

/* Lists the silhouette edges within margin texels of the map; NULL: out of memory. An edge is one
 * unless it has triangles on both sides of the plane through the light and itself. */
shb_silhouette_edge *shb_silhouette_collect(const shb_context *context,
                                            const shb_triangle *triangles, const shb_edges *edges,
                                            const shb_map_info *map, double margin, size_t *count);

#endif
