/* Clusters that lie behind all that is drawn: the bounds of the cells under them are found anew
 * from the samples as far as they do not tell it. */

/* The last layer that is wanted, whose depths decide. */
static inline const float *last_layer(const shb_tile *tile) {
    return tile->second ? tile->second : tile->depth;
}

static inline float *last_cells(const shb_tile *tile) {
    return tile->second ? tile->second_cells : tile->cells;
}

static bool is_sample_nearer(const shb_tile *tile, int32_t x, int32_t y, float nearest) {
    const ptrdiff_t column = x - tile->x0, row = y - tile->y0;
    const float bound = last_cells(tile)[row / SHB_CELL * tile->cell_stride + column / SHB_CELL];
    return bound != SHB_NOT_CLEARED && last_layer(tile)[row * tile->stride + column] < nearest;
}

/* The farthest depth in count rows of a cell. */
static float farthest_in_rows(const float *restrict samples, ptrdiff_t stride, int32_t count) {
    float farthest[SHB_CELL];
    memcpy(farthest, samples, sizeof farthest);
    for (int32_t row = 1; row < count; row++)
        for (int i = 0; i < SHB_CELL; i++) {
            const float depth = samples[row * stride + i];
            farthest[i] = MAX(depth, farthest[i]);
        }
    float all = farthest[0];
    for (int i = 1; i < SHB_CELL; i++)
        all = MAX(farthest[i], all);
    return all;
}

/* True if all samples of the cell are nearer. */
static bool is_cell_nearer(const shb_tile *tile, int32_t column, int32_t row, float nearest) {
    float *const bound = last_cells(tile) + row * tile->cell_stride + column;
    if (*bound < nearest || *bound == SHB_NOT_CLEARED)
        return *bound < nearest;
    const int32_t y = row * SHB_CELL, rows = MIN(SHB_CELL, tile->y1 - tile->y0 - y);
    *bound = farthest_in_rows(last_layer(tile) + y * tile->stride + column * SHB_CELL, tile->stride,
                              rows);
    return *bound < nearest;
}

/* True if the cluster lies behind all that is drawn there, by more than an equal depth. Most of
 * those that do not show it at one of five samples. */
static bool is_cluster_hidden(const shb_tile *tile, const shb_seen_cluster *cluster) {
    const shb_samples *samples = &cluster->samples;
    const float nearest = cluster->nearest;
    const int32_t left = MAX(samples->first_column, tile->x0);
    const int32_t right = MIN(samples->last_column, tile->right - 1);
    const int32_t top = MAX(samples->first_row, tile->y0);
    const int32_t bottom = MIN(samples->last_row, tile->y1 - 1);
    if (!is_sample_nearer(tile, left + (right - left) / 2, top + (bottom - top) / 2, nearest) ||
        !is_sample_nearer(tile, left, top, nearest) ||
        !is_sample_nearer(tile, right, top, nearest) ||
        !is_sample_nearer(tile, left, bottom, nearest) ||
        !is_sample_nearer(tile, right, bottom, nearest))
        return false;
    const int32_t first = (left - tile->x0) / SHB_CELL, last = (right - tile->x0) / SHB_CELL;
    const int32_t last_row = (bottom - tile->y0) / SHB_CELL;
    for (int32_t row = (top - tile->y0) / SHB_CELL; row <= last_row; row++)
        for (int32_t column = first; column <= last; column++)
            if (!is_cell_nearer(tile, column, row, nearest))
                return false;
    return true;
}
