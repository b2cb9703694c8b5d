/* Rows of LANES samples of one triangle. Included once for each width of the wide types. */

#define W(name) SHB_JOIN(name, LANES)

/* Draws some of a block's cells, for draw_large. */
#define FOR_CELLS(cells, covered)                                                                  \
    for (uint64_t set = (cells); set; set &= set - 1) {                                            \
        const int32_t c = __builtin_ctzll(set);                                                    \
        W(draw_square)                                                                             \
        (tile, layers, boxes, planes, t, id, plain, covered, SHB_CELL, &edges, &part, left, top,   \
         c % BLOCK_CELLS * SHB_CELL, c / BLOCK_CELLS * SHB_CELL);                                  \
    }

/* Merges one vector of samples into the tile; edges is negative outside the triangle. At equal
 * depth the lower id wins, so that the order of triangles does not matter. */
static inline __attribute__((always_inline)) void
W(merge)(tile_texels tile, int layers, ptrdiff_t at, W(wi) edges, W(wf) z, W(wi) id) {
    const W(wf) nearest = W(wf_load)(tile.depth + at);
    W(wf_store)(tile.depth + at, W(wf_min_inside)(edges, z, nearest));
    if (layers & LAYER_IDS)
        W(wi_store_closer)(tile.ids + at, edges, z, nearest, id);
    if (layers & LAYER_SECOND) {
        const W(wf) second = W(wf_load)(tile.second + at);
        const W(wf) loser = W(wf_max)(nearest, z);
        W(wf_store)(tile.second + at, W(wf_min_inside)(edges, loser, second));
    }
}

static inline __attribute__((always_inline)) W(wf)
    W(add_anchor)(int layers, W(wf) anchor, W(wf) z) {
    return layers & LAYER_PLANES ? W(wf_add)(anchor, z) : z;
}

/* Samples of a block: columns left .. right - 1, rounded up to whole vectors, rows top .. bottom
 * - 1. edges counts from (left, top); covered: all are inside. */
static inline __attribute__((always_inline)) void
W(draw_block)(const shb_tile *tile, int layers, const chunk_boxes *boxes,
              const chunk_planes *planes, int t, uint32_t triangle, bool plain, bool covered,
              const block_edges *edges, int32_t left, int32_t top, int32_t right, int32_t bottom) {
    const tile_texels texels = texels_of(tile);
    const shb_plane exact = {.z0 = planes->base[t],
                             .gx = planes->step_x[t],
                             .gy = planes->step_y[t],
                             .lo = planes->lo[t],
                             .hi = planes->hi[t]};
    const int32_t first_row = boxes->y[t];
    const W(wi) id = W(wi_splat)((int32_t)triangle);
    W(wi) row[3], step_x[3], step_y[3];
    for (int k = 0; k < 3; k++) {
        row[k] = W(wi_add)(W(wi_splat)(edges->value[k]), W(wi_ramp)(edges->step_x[k]));
        step_x[k] = W(wi_splat)(edges->step_x[k] * LANES);
        step_y[k] = W(wi_splat)(edges->step_y[k]);
    }
    const int32_t first_column = left - boxes->x[t], vectors = (right - left + LANES - 1) / LANES;
    W(wf) along[SHB_SMALL / LANES];
    for (int32_t v = 0; plain && v < vectors; v++)
        along[v] =
            W(wf_mul)(W(wf_splat)(planes->depth_x[t]),
                      W(wf_add)(W(wf_splat)((float)(first_column + v * LANES)), W(wf_lanes)()));
    const W(wf) depth = W(wf_splat)(planes->depth[t]), depth_y = W(wf_splat)(planes->depth_y[t]);
    const W(wf) anchor = W(wf_splat)(layers & LAYER_PLANES ? planes->anchor[t] : 0);
    W(wf) rows = W(wf_splat)((float)(top - first_row));
    ptrdiff_t start = (top - tile->y0) * texels.stride + left - tile->x0;
    for (int32_t y = top; y < bottom; y++, start += texels.stride) {
        const W(wf) base = W(wf_add)(depth, W(wf_mul)(depth_y, rows));
        const double careful_base = exact.z0 + exact.gy * (y - first_row);
        W(wi) edge[3] = {row[0], row[1], row[2]};
        for (int32_t v = 0; v < vectors; v++) {
            const W(wf) z =
                plain ? W(add_anchor)(layers, anchor, W(wf_add)(base, along[v]))
                      : W(wf_plane)(careful_base, exact.gx, (double)(first_column + v * LANES),
                                    exact.lo, exact.hi);
            const W(wi) outside = W(wi_or_three)(edge[0], edge[1], edge[2]);
            W(merge)(texels, layers, start + v * LANES, covered ? W(wi_splat)(0) : outside, z, id);
            for (int k = 0; k < 3; k++)
                edge[k] = W(wi_add)(edge[k], step_x[k]);
        }
        for (int k = 0; k < 3; k++)
            row[k] = W(wi_add)(row[k], step_y[k]);
        rows = W(wf_add)(rows, W(wf_splat)(1.0f));
    }
}

/* The part of the box that lies in the tile, widened to the left so that whole vectors stay in it.
 */
static inline sample_rectangle W(clip_box)(const shb_tile *tile, const chunk_boxes *boxes, int t) {
    const int32_t x = boxes->x[t], y = boxes->y[t];
    sample_rectangle part = {MAX(x, tile->x0), MAX(y, tile->y0), MIN(x + boxes->width[t], tile->x1),
                             MIN(y + boxes->height[t], tile->y1)};
    const int32_t span = (part.right - part.left + LANES - 1) / LANES * LANES;
    part.left = MIN(part.left, tile->x1 - span);
    return part;
}

/* A triangle whose box is at most SHB_SMALL samples wide and high. */
static inline __attribute__((always_inline)) void W(draw_small)(const shb_tile *tile, int layers,
                                                                const chunk_boxes *boxes,
                                                                const chunk_planes *planes, int t,
                                                                uint32_t id, bool plain) {
    const sample_rectangle part = W(clip_box)(tile, boxes, t);
    if (!(layers & LAYER_SECOND) && is_part_hidden(tile, layers, boxes, planes, t, plain, &part))
        return;
    const int32_t i = part.left - boxes->x[t], j = part.top - boxes->y[t];
    block_edges edges;
    for (int k = 0; k < 3; k++) {
        edges.step_x[k] = planes->edge_x[k][t];
        edges.step_y[k] = planes->edge_y[k][t];
        edges.value[k] = planes->edge[k][t] + edges.step_x[k] * i + edges.step_y[k] * j;
    }
    W(draw_block)
    (tile, layers, boxes, planes, t, id, plain, false, &edges, part.left, part.top, part.right,
     part.bottom);
}

/* A cell, or a whole block of them, that starts column and row samples from the block's corner:
 * what of it lies in the part of the box. size is a constant where this is inlined. */
static inline __attribute__((always_inline)) void
W(draw_square)(const shb_tile *tile, int layers, const chunk_boxes *boxes,
               const chunk_planes *planes, int t, uint32_t id, bool plain, bool covered,
               int32_t size, const block_edges *block, const sample_rectangle *part, int32_t left,
               int32_t top, int32_t column, int32_t row) {
    const int32_t x = left + column, y = top + row, first = MAX(y, part->top);
    if (x >= part->right || x + size <= part->left)
        return;
    block_edges edges = *block;
    for (int k = 0; k < 3; k++)
        edges.value[k] += edges.step_x[k] * column + edges.step_y[k] * (first - top);
    W(draw_block)
    (tile, layers, boxes, planes, t, id, plain, covered, &edges, x, first, x + size,
     MIN(y + size, part->bottom));
    if (covered)
        lower_bounds(tile, layers, boxes, planes, t, plain, x, y, size / SHB_CELL);
}

/* Any triangle: blocks of SHB_SMALL samples are rejected or freed of the edges that cover them
 * whole; the edges that cross a block fit into 32 bits there. */
static inline __attribute__((always_inline)) void W(draw_large)(const shb_tile *tile, int layers,
                                                                const chunk_boxes *boxes,
                                                                const chunk_planes *planes, int t,
                                                                uint32_t id, bool plain) {
    const int32_t x = boxes->x[t], y = boxes->y[t];
    const sample_rectangle part = {MAX(x, tile->x0), MAX(y, tile->y0),
                                   MIN(x + boxes->width[t], tile->x1),
                                   MIN(y + boxes->height[t], tile->y1)};
    int64_t first[3];
    find_wide_edges(boxes, planes, t, first);
    const int32_t first_left = part.left - (part.left - tile->x0) % SHB_SMALL;
    const int32_t first_top = part.top - (part.top - tile->y0) % SHB_SMALL;
    for (int32_t top = first_top; top < part.bottom; top += SHB_SMALL)
        for (int32_t left = first_left; left < part.right; left += SHB_SMALL) {
            block_edges edges;
            float farthest[BLOCK_CELLS * BLOCK_CELLS];
            if (!find_block_edges(planes, t, first, left - x, top - y, SHB_SMALL, SHB_SMALL,
                                  &edges))
                continue;
            load_farthest(tile, layers, left, top, farthest);
            const block_cells cells =
                find_cells(planes, t, layers, plain, &edges, left - x, top - y, farthest);
            if (cells.covered == ALL_CELLS && left + SHB_SMALL <= tile->x1) {
                W(draw_square)
                (tile, layers, boxes, planes, t, id, plain, true, SHB_SMALL, &edges, &part, left,
                 top, 0, 0);
                continue;
            }
            FOR_CELLS(cells.covered, true)
            FOR_CELLS(cells.crossed, false)
        }
}

/* Columns left .. left + width - 1 of a plain triangle whose box lies in the tile and is at most
 * height rows high. Width and height are constants where this is inlined, and width a multiple of
 * LANES, so the loops unroll and no branch depends on the triangle. */
static inline __attribute__((always_inline)) void
W(draw_rows)(const shb_tile *tile, int layers, const chunk_boxes *boxes, const chunk_planes *planes,
             int t, uint32_t triangle, int32_t left, int width, int height) {
    enum { VECTORS_MAX = 2 };
    const tile_texels texels = texels_of(tile);
    const W(wi) id = W(wi_splat)((int32_t)triangle);
    const int vectors = width / LANES;
    W(wi) edge[VECTORS_MAX][3], step[3];
    W(wf) along[VECTORS_MAX];
    for (int v = 0; v < vectors; v++) {
        const int32_t shift = left - boxes->x[t] + v * LANES;
        for (int k = 0; k < 3; k++)
            edge[v][k] = W(wi_add)(W(wi_splat)(planes->edge[k][t] + planes->edge_x[k][t] * shift),
                                   W(wi_ramp)(planes->edge_x[k][t]));
        along[v] = W(wf_mul)(W(wf_splat)(planes->depth_x[t]),
                             W(wf_add)(W(wf_splat)((float)shift), W(wf_lanes)()));
    }
    for (int k = 0; k < 3; k++)
        step[k] = W(wi_splat)(planes->edge_y[k][t]);
    const W(wf) depth = W(wf_splat)(planes->depth[t]), depth_y = W(wf_splat)(planes->depth_y[t]);
    const W(wf) anchor = W(wf_splat)(layers & LAYER_PLANES ? planes->anchor[t] : 0);
    W(wf) row = W(wf_splat)(0);
    ptrdiff_t at = (boxes->y[t] - tile->y0) * texels.stride + left - tile->x0;
    for (int j = 0; j < height; j++, at += texels.stride) {
        const W(wf) base = W(wf_add)(depth, W(wf_mul)(depth_y, row));
        for (int v = 0; v < vectors; v++) {
            W(merge)
            (texels, layers, at + v * LANES, W(wi_or_three)(edge[v][0], edge[v][1], edge[v][2]),
             W(add_anchor)(layers, anchor, W(wf_add)(base, along[v])), id);
            for (int k = 0; k < 3; k++)
                edge[v][k] = W(wi_add)(edge[v][k], step[k]);
        }
        row = W(wf_add)(row, W(wf_splat)(1.0f));
    }
}

#undef FOR_CELLS
#undef W
