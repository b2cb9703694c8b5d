/* Texels of a map as quads that stand between a fragment and a square light, projected on the light
 * in the map's own coordinates (light_span.h).
 *
 * Neighbours of different depth leave gaps or overlap on the light. Where both are occluders, a
 * quad is extended over the gap to its left and its upper neighbour (Guennebaud, Barthe and Paulin
 * 2006, section 4.2). */
#ifndef SRC_BACKPROJECTION_H
#define SRC_BACKPROJECTION_H

#include "light_span.h"

/* Sides of windows, in quads; a larger window has quads of several texels. */
enum { SHB_WINDOW_MIN = 4, SHB_WINDOW_MAX = 64, SHB_WINDOW_BUFFER = SHB_WINDOW_MAX + 1 };

typedef struct shb_backprojection {
    shb_light_span span;
    int window; /* SHB_WINDOW_MIN .. SHB_WINDOW_MAX */
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
    int32_t texel_x, texel_y;  /* of the fragment */
    float ref, step_x, step_y; /* its plane */
    float x, y, depth;         /* its place in the map, texels, and its depth there */
    int32_t first_x, first_y;  /* quad */
    int32_t columns, rows, stride;
    /* 1 / difference of depth of the quads of the row that is read and the one above; 0: none. What
     * lies before the window never reaches into the light. */
    float above[SHB_WINDOW_BUFFER], here[SHB_WINDOW_BUFFER];
} shb_quad_window;

/* The windows of a batch, for shb_quad_window_open. */
void shb_quad_windows_find(const shb_filter_args *args, shb_light_windows *windows);

/* False if nothing is in front of fragment index: it is lit. */
bool shb_quad_window_open(const shb_filter_args *args, const shb_light_windows *windows,
                          size_t index, shb_quad_window *window);

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
