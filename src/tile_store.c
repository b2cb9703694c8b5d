#include "strict.h"

#include "tile_store.h"

#include "kernels/raster.h"
#include "marks.h"

static size_t cells_of(int32_t first, int32_t last) {
    return (size_t)(last - first) / SHB_CELL + 1;
}

void shb_tile_begin_marks(const shb_layers *layers, uint32_t width) {
    const shb_samples *all = &layers->samples;
    const size_t rows = cells_of(all->first_row, all->last_row);
    const size_t columns = cells_of(all->first_column, all->last_column);
    uint8_t *marks = layers->marks;
    for (size_t row = 0; marks && row < rows; row++, marks += shb_marks_stride(width))
        for (size_t i = 0; i < columns; i++)
            marks[i] = marks[i] == SHB_MARK_CLEAR ? SHB_MARK_CLEAR : SHB_MARK_LEFT;
}

/* The layers of count cells of which the first one has this place. */
static shb_layers part_of(const shb_layers *layers, size_t column, size_t row, size_t count) {
    const shb_samples *all = &layers->samples;
    const int32_t left = all->first_column + (int32_t)column * SHB_CELL;
    const int32_t top = all->first_row + (int32_t)row * SHB_CELL;
    const int32_t width = (int32_t)count * SHB_CELL;
    const size_t at = row * SHB_CELL * layers->pitch + column * SHB_CELL;
    shb_layers part = *layers;
    part.samples =
        shb_samples_intersect((shb_samples){left, top, left + width - 1, top + SHB_CELL - 1}, *all);
    part.nearest += at;
    part.second = layers->second ? layers->second + at : NULL;
    part.ids = layers->ids ? layers->ids + at : NULL;
    return part;
}

void shb_tile_store(const shb_layers *layers, const shb_draw_desc *desc, const shb_target *target,
                    shb_format_store_fn *store) {
    const shb_samples *all = &layers->samples;
    const size_t rows = cells_of(all->first_row, all->last_row);
    const size_t columns = cells_of(all->first_column, all->last_column);
    uint8_t *marks = layers->marks;
    if (!marks) {
        shb_layers_store(layers, desc, target, store);
        return;
    }
    for (size_t row = 0; row < rows; row++, marks += shb_marks_stride(desc->width))
        for (size_t i = 0, end; i < columns; i = end + 1) {
            for (end = i; end < columns && marks[end] != SHB_MARK_CLEAR; end++)
                marks[end] = marks[end] == SHB_MARK_LEFT ? SHB_MARK_CLEAR : SHB_MARK_DRAWN;
            if (end == i)
                continue;
            const shb_layers part = part_of(layers, i, row, end - i);
            shb_layers_store(&part, desc, target, store);
        }
}
