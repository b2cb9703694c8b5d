#include "strict.h"

#include "cells.h"

#include "scratch.h"

static size_t round_to_blocks(size_t samples) {
    return (samples + SHB_SMALL - 1) / SHB_SMALL * (SHB_SMALL / SHB_CELL);
}

size_t shb_cells_stride(size_t width) {
    return round_to_blocks(width);
}

size_t shb_cells_count(size_t width, size_t height) {
    return round_to_blocks(width) * round_to_blocks(height);
}

float *shb_cells_reserve(shb_context *context, size_t count, size_t width, size_t height) {
    shb_buffer *buffer = &context->draw_scratch[SHB_SCRATCH_CELLS];
    return shb_buffer_reserve(context, buffer, count,
                              2 * shb_cells_count(width, height) * sizeof(float));
}

void shb_cells_reset(const shb_tile *tile) {
    const size_t count =
        shb_cells_count((size_t)(tile->x1 - tile->x0), (size_t)(tile->y1 - tile->y0));
    for (size_t i = 0; i < count; i++)
        tile->cells[i] = SHB_NOT_CLEARED;
    for (size_t i = 0; tile->second_cells && i < count; i++)
        tile->second_cells[i] = SHB_NOT_CLEARED;
}
