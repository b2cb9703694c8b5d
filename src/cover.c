#include "strict.h"

#include "cover.h"

/* Where a row meets an edge: the winding number changes from that column of the box on. */
typedef struct crossing {
    int32_t column;
    int change;
} crossing;

static shb_edge edge_at(const shb_shape *shape, size_t a, size_t b, shb_samples box) {
    const int64_t dx = (int64_t)shape->snapped_x[b] - shape->snapped_x[a];
    const int64_t dy = (int64_t)shape->snapped_y[b] - shape->snapped_y[a];
    const int64_t px = (int64_t)box.first_column * SHB_SUBPIXELS + SHB_SUBPIXELS / 2;
    const int64_t py = (int64_t)box.first_row * SHB_SUBPIXELS + SHB_SUBPIXELS / 2;
    const int64_t e = dx * (py - shape->snapped_y[a]) - dy * (px - shape->snapped_x[a]);
    const int64_t bias = dy < 0 ? 0 : -1;
    return (shb_edge){(e + bias) >> 8, -dy, dx, shape->snapped_y[a], shape->snapped_y[b]};
}

shb_cover shb_cover_of(const shb_shape *shape, shb_samples box) {
    shb_cover cover = {.box = box, .count = shape->count};
    for (size_t i = 0; i < shape->count; i++)
        cover.edges[i] = edge_at(shape, i, (i + 1) % shape->count, box);
    return cover;
}

/* The first column at which the edge's value is not negative (going up), or is negative (going
 * down), held to 0 .. columns. */
static int32_t first_column(const shb_edge *edge, int64_t value, int64_t columns) {
    int64_t column = 0;
    if (edge->per_column > 0 && value < 0)
        column = (-value + edge->per_column - 1) / edge->per_column;
    if (edge->per_column < 0 && value >= 0)
        column = value / -edge->per_column + 1;
    return (int32_t)(column < columns ? column : columns);
}

/* The crossings of a row, sorted by column. */
static size_t find_crossings(const shb_cover *cover, int32_t row, crossing *crossings) {
    const int32_t py = row * SHB_SUBPIXELS + SHB_SUBPIXELS / 2;
    const int64_t columns = cover->box.last_column - cover->box.first_column + 1;
    size_t count = 0;
    for (size_t k = 0; k < cover->count; k++) {
        const shb_edge *edge = &cover->edges[k];
        if ((edge->from_y <= py) == (edge->to_y <= py))
            continue;
        const int64_t value = edge->value + edge->per_row * (row - cover->box.first_row);
        const crossing found = {first_column(edge, value, columns), edge->per_column > 0 ? 1 : -1};
        size_t at = count++;
        for (; at > 0 && crossings[at - 1].column > found.column; at--)
            crossings[at] = crossings[at - 1];
        crossings[at] = found;
    }
    return count;
}

size_t shb_cover_row(const shb_cover *cover, int32_t row, shb_run runs[SHB_RUNS_MAX]) {
    crossing crossings[SHB_POLYGON_MAX];
    const size_t count = find_crossings(cover, row, crossings);
    const int32_t left = cover->box.first_column;
    size_t found = 0;
    int winding = 0;
    for (size_t i = 0; i + 1 < count; i++) {
        winding += crossings[i].change;
        const int32_t first = left + crossings[i].column, end = left + crossings[i + 1].column;
        if (winding <= 0 || first == end)
            continue;
        if (found && runs[found - 1].end == first)
            runs[found - 1].end = end;
        else
            runs[found++] = (shb_run){first, end};
    }
    return found;
}
