/* Texels of a map as quads that stand between a fragment and a square light.
 *
 * Let u = 1 / w, which is affine in the map's depth: depth = c - q u. A texel at the clip distance
 * w_b whose place in the map lies x texels from that of the fragment, at w_r, is t x w_b away from
 * the line between fragment and light in the texel's plane, t being a texel's width where w is 1.
 * The ray from the fragment past it meets the light's plane, where w is 0, in
 *     t x w_b w_r / (w_r - w_b) = t x / (u_b - u_r) = t q x / (depth_r - depth_b)
 * from the middle of the light. So with the width L of the light, and in parts of it,
 *     0.5 + x / (k (depth_r - depth_b)),   k = L / (t q):
 * quads are projected in the map's own coordinates, with one division a texel. The light spans
 * k (depth_r - depth_b) texels about the fragment's place. Under parallel rays, with L the width at
 * the distance of one unit, the same follows at once.
 *
 * Neighbours of different depth leave gaps or overlap on the light. Where both are occluders, a
 * quad is extended over the gap to its left and its upper neighbour (Guennebaud, Barthe and Paulin
 * 2006, section 4.2). */
#ifndef SRC_BACKPROJECTION_H
#define SRC_BACKPROJECTION_H

#include "depth_minima.h"

/* Sides of windows, in quads; a larger window has quads of several texels. */
enum { SHB_WINDOW_MIN = 4, SHB_WINDOW_MAX = 64, SHB_WINDOW_BUFFER = SHB_WINDOW_MAX + 1 };

typedef struct shb_backprojection {
    shb_depth_minima minima;
    float near_depth, far_depth; /* canonical */
    float span_x, span_y;        /* k: texels that the light spans per difference of depth */
    int window;                  /* SHB_WINDOW_MIN .. SHB_WINDOW_MAX */
} shb_backprojection;

/* Parameters that filters by backprojection have in common. */
enum { SHB_PARAM_LIGHT, SHB_PARAM_WINDOW };

/* For shb_filter.prepare and .release. */
shb_result shb_backprojection_prepare(const shb_map *map, const shb_filter *filter, void **prepared,
                                      size_t *bytes);
void shb_backprojection_release(const shb_map *map, void *prepared);

/* What may stand between one fragment and the light, and the rows of it read so far. */
typedef struct shb_quad_window {
    const shb_backprojection *projection;
    const shb_map *map;
    int32_t texel_x, texel_y; /* of the fragment */
    float to_center_x, to_center_y;
    float ref, step_x, step_y; /* its plane */
    float depth;               /* of the plane at its own place */
    int32_t first_x, first_y;  /* quad */
    int32_t columns, rows, stride;
    /* 1 / difference of depth of the quads of the row that is read and the one above; 0: none. What
     * lies before the window never reaches into the light. */
    float above[SHB_WINDOW_BUFFER], here[SHB_WINDOW_BUFFER];
} shb_quad_window;

/* False if nothing is in front of fragment index: it is lit. */
bool shb_quad_window_open(const shb_backprojection *projection, const shb_map *map,
                          const shb_receivers *receivers, size_t index, shb_quad_window *window);

/* What the quads of one row cover of the light, rounded to parts of its width: 0 .. parts. An empty
 * one has equal sides. Sides that quads share are the same number. */
typedef struct shb_quad_row {
    int32_t x0[SHB_WINDOW_BUFFER], x1[SHB_WINDOW_BUFFER];
    int32_t y0[SHB_WINDOW_BUFFER], y1[SHB_WINDOW_BUFFER];
} shb_quad_row;

/* Rows in order: 0 .. window->rows - 1, window->columns quads each. False if all of them are empty:
 * the row is not written then. */
bool shb_quad_window_read(shb_quad_window *window, int32_t row, float parts, shb_quad_row *quads);

#endif
