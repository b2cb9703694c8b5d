/* Cells of a few texels; each lists the edges that pass within a texel of it. */
#include "../strict.h"

#include "edge_grid.h"

/* Positions that are meant to touch may lie half a unit in the last place of the largest coordinate
 * apart, and a plane through rounded corners strays by more beyond its triangle: 8 units for both.
 */
#define TOUCH 0x1p-20

/* What cells are widened by: the texel, and the rounding of coordinates. */
#define MARGIN (1 + 0x1p-10)

enum { CELL_SIZE = 4, CELLS_MAX = 1024 /* along an axis */ };

/* The cell along an axis that holds a texel coordinate, or the nearest one. */
static uint32_t cell_at(const shb_edge_grid *grid, double texel, uint32_t cells) {
    const double cell = texel / grid->cell_size;
    return cell > 0 ? (cell < cells - 1 ? (uint32_t)cell : cells - 1) : 0;
}

/* The cells between two texel coordinates and within MARGIN of them. */
typedef struct cell_range {
    uint32_t first, last;
} cell_range;

static cell_range cells_between(const shb_edge_grid *grid, double a, double b, uint32_t cells) {
    const double lo = a < b ? a : b, hi = a < b ? b : a;
    return (cell_range){cell_at(grid, lo - MARGIN, cells), cell_at(grid, hi + MARGIN, cells)};
}

static double lerp(double a, double b, double t) {
    return a + (b - a) * t;
}

/* Texel coordinate of a point of an edge along an axis. */
static double texel_at(const shb_silhouette_edge *edge, double t, int axis) {
    return lerp(edge->texel[0][axis], edge->texel[1][axis], t) /
           lerp(edge->texel[0][2], edge->texel[1][2], t);
}

typedef void visit_fn(shb_edge_grid *grid, size_t cell, uint32_t edge);

/* Visits the cells that the edge comes near, row by row. */
static void visit_cells(shb_edge_grid *grid, uint32_t number, visit_fn *visit) {
    const shb_silhouette_edge *edge = &grid->edges[number];
    const double size = grid->cell_size;
    shb_texel_box box = {-MARGIN, size * grid->columns + MARGIN, -MARGIN,
                         size * grid->rows + MARGIN};
    double begin, end;
    if (!shb_silhouette_clip(edge, &box, &begin, &end))
        return;
    const cell_range rows =
        cells_between(grid, texel_at(edge, begin, 1), texel_at(edge, end, 1), grid->rows);
    for (uint32_t row = rows.first; row <= rows.last; row++) {
        box.top = size * row - MARGIN;
        box.bottom = size * row + size + MARGIN;
        if (!shb_silhouette_clip(edge, &box, &begin, &end))
            continue;
        const cell_range columns =
            cells_between(grid, texel_at(edge, begin, 0), texel_at(edge, end, 0), grid->columns);
        for (uint32_t column = columns.first; column <= columns.last; column++)
            visit(grid, (size_t)row * grid->columns + column, number);
    }
}

/* Entries are counted two cells on. After summation starts[cell + 1] is the first entry of cell;
 * writing moves it to the end of cell, which is where the next one starts. */
static void count_entry(shb_edge_grid *grid, size_t cell, uint32_t edge) {
    (void)edge;
    grid->starts[cell + 2]++;
}

static void write_entry(shb_edge_grid *grid, size_t cell, uint32_t edge) {
    grid->entries[grid->starts[cell + 1]++] = edge;
}

static bool fill_cells(const shb_context *context, shb_edge_grid *grid) {
    const size_t cells = (size_t)grid->columns * grid->rows;
    grid->starts = shb_alloc(context, cells + 2, sizeof *grid->starts);
    if (!grid->starts)
        return false;
    for (size_t i = 0; i < cells + 2; i++)
        grid->starts[i] = 0;
    for (uint32_t i = 0; i < grid->edge_count; i++)
        visit_cells(grid, i, count_entry);
    for (size_t i = 1; i < cells + 2; i++)
        grid->starts[i] += grid->starts[i - 1];
    grid->entries = shb_alloc(context, grid->starts[cells + 1], sizeof *grid->entries);
    if (!grid->entries)
        return false;
    for (uint32_t i = 0; i < grid->edge_count; i++)
        visit_cells(grid, i, write_entry);
    return true;
}

bool shb_edge_grid_build(const shb_context *context, const shb_triangle *triangles,
                         const shb_edges *edges, const shb_map_info *map, shb_edge_grid *grid) {
    shb_edge_grid built = {.cell_size = CELL_SIZE};
    const uint32_t larger = map->width > map->height ? map->width : map->height;
    while (built.cell_size * CELLS_MAX < larger)
        built.cell_size *= 2;
    built.columns = (map->width - 1) / built.cell_size + 1;
    built.rows = (map->height - 1) / built.cell_size + 1;
    built.edges = shb_silhouette_collect(context, triangles, edges, map, MARGIN, &built.edge_count);
    if (!built.edges || !fill_cells(context, &built)) {
        shb_edge_grid_free(context, &built);
        return false;
    }
    *grid = built;
    return true;
}

void shb_edge_grid_free(const shb_context *context, shb_edge_grid *grid) {
    shb_free(context, grid->edges);
    shb_free(context, grid->starts);
    shb_free(context, grid->entries);
}

/* Height of a point of an edge above the receiver's plane. */
static double height_at(const shb_silhouette_edge *edge, double t,
                        const shb_edge_receiver *receiver) {
    double height = 0;
    for (int i = 0; i < 3; i++)
        height += receiver->normal[i] *
                  (lerp(edge->world[0][i], edge->world[1][i], t) - receiver->position[i]);
    return height;
}

static bool is_near(const shb_silhouette_edge *edge, const shb_edge_receiver *receiver) {
    const shb_texel_box box = {receiver->x - 1, receiver->x + 1, receiver->y - 1, receiver->y + 1};
    double begin, end;
    if (!shb_silhouette_clip(edge, &box, &begin, &end))
        return false;
    const double touch = TOUCH * (edge->reach > receiver->reach ? edge->reach : receiver->reach);
    return height_at(edge, begin, receiver) > touch || height_at(edge, end, receiver) > touch;
}

bool shb_edge_grid_is_near(const shb_edge_grid *grid, const shb_edge_receiver *receiver) {
    const uint32_t column = cell_at(grid, receiver->x, grid->columns);
    const uint32_t row = cell_at(grid, receiver->y, grid->rows);
    const size_t cell = (size_t)row * grid->columns + column;
    for (size_t i = grid->starts[cell]; i < grid->starts[cell + 1]; i++)
        if (is_near(&grid->edges[grid->entries[i]], receiver))
            return true;
    return false;
}
